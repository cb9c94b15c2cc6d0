"""Markers in space: Qualisys' text (a header of names and values, then rows), Vicon's (a title, the rate, names of
markers, axes, units), both in mm, OptiTrack's (a line of names and values, with the unit, then five of names) and
OpenSim's markers (a line of names and one of values, with the unit, then names of markers and axes).
"""

from collections.abc import Sequence

from harness.io.layout import Head, Layout, rate_of

_DEEP = 30
"""Lines of a header at most."""


def _find(lines: Sequence[str], name: str) -> Head | None:
    if lines and lines[0].startswith("NO_OF_FRAMES"):
        return _qualisys(lines)
    if len(lines) > 5 and lines[0].strip(' ",').lower() in ("trajectories", "model outputs"):
        return _vicon(lines)
    if len(lines) > 6 and lines[0].startswith("PathFileType\t"):
        return _opensim(lines)
    if lines and lines[0].startswith("Format Version,"):
        return _motive(lines)
    return None


def _opensim(lines: Sequence[str]) -> Head | None:
    said = dict(zip(lines[1].split("\t"), lines[2].split("\t"), strict=False))
    markers, axes = lines[3].split("\t"), lines[4].rstrip().split("\t")
    first = 5 if lines[5].strip() else 6
    if "Units" not in said or len(axes) < 3:
        return None
    fields, marker = ["Frame", "Time"], ""
    for i in range(2, len(axes)):
        marker = (markers[i].strip() if i < len(markers) else "") or marker
        fields.append(f"{marker} {axes[i].strip()[:1].lower()}")
    units = ("", "s", *[said["Units"].strip()] * (len(fields) - 2))
    return Head(first=first, fields=tuple(fields), units=units)


def _motive(lines: Sequence[str]) -> Head | None:
    said = lines[0].split(",")
    at = next((i for i, line in enumerate(lines[:_DEEP]) if line.startswith("Frame,Time")), None)
    if at is None or at + 1 >= len(lines) or "Length Units" not in said[:-1]:
        return None
    length = said[said.index("Length Units") + 1].strip().lower()
    axes, kinds = lines[at].split(","), lines[at - 1].split(",")
    names = next((line.split(",") for line in lines[:at] if line.startswith(",Name,")), [])
    fields, units = ["Frame", "Time"], ["", "s"]
    for i in range(2, len(axes)):
        kind, name = (cells[i].strip() if i < len(cells) else "" for cells in (kinds, names))
        fields.append(f"{name} {kind} {axes[i].strip()}".strip())
        units.append(length if kind == "Position" else "")
    return Head(first=at + 1, fields=tuple(fields), units=tuple(units), separator=",")


def _qualisys(lines: Sequence[str]) -> Head | None:
    said = {line.partition("\t")[0]: line.partition("\t")[2] for line in lines[:_DEEP]}
    markers = [one for one in said.get("MARKER_NAMES", "").split("\t") if one.strip()]
    at = next((i for i, line in enumerate(lines[:_DEEP]) if line.startswith("MARKER_NAMES")), len(lines)) + 1
    named = at < len(lines) and lines[at].startswith("Frame\t")
    if not markers or at + named >= len(lines):
        return None
    clock, axes = (("Frame", "Time") if named else ()), [f"{one} {axis}" for one in markers for axis in "xyz"]
    units = (*("" if one == "Frame" else "s" for one in clock), *["mm"] * len(axes))
    return Head(first=at + named, fields=(*clock, *axes), units=units, rate=rate_of(said.get("FREQUENCY", "")))


def _vicon(lines: Sequence[str]) -> Head | None:
    markers, axes, units = (line.split(",") for line in lines[2:5])
    if axes[:2] != ["Frame", "Sub Frame"]:
        return None
    fields, marker = [], ""
    for i, axis in enumerate(axes):
        marker = (markers[i].strip() if i < len(markers) else "") or marker
        fields.append(f"{marker} {axis.strip()}" if i > 1 and marker else axis.strip())
    of = [one.strip() for one in (*units, *[""] * len(axes))][: len(axes)]
    return Head(first=5, fields=tuple(fields), units=tuple(of), separator=",", rate=rate_of(lines[1].strip(' ",')))


LAYOUT = Layout(name="motion capture", find=_find)
