"""DeepLabCut: the row of a scorer, of individuals where there are several, of body parts and of coordinates, in pixels;
the first column counts the frames of the video, whose rate is nowhere in it.
"""

from collections.abc import Sequence

from harness.io.layout import Head, Layout

_ROWS = ("scorer", "individuals", "bodyparts", "coords")


def _find(lines: Sequence[str], name: str) -> Head | None:
    heads: dict[str, list[str]] = {}
    for line in lines[: len(_ROWS)]:
        first, *rest = (cell.strip() for cell in line.split(","))
        if first in _ROWS:
            heads[first] = rest
    if not {"scorer", "bodyparts", "coords"} <= set(heads) or len({len(rest) for rest in heads.values()}) > 1:
        return None
    coords = heads["coords"]
    parts = zip(heads.get("individuals", [""] * len(coords)), heads["bodyparts"], coords, strict=True)
    fields = ["frame", *(" ".join(filter(None, one)) for one in parts)]
    units = ["", *("px" if coord in ("x", "y", "z") else "" for coord in coords)]
    return Head(first=len(heads), fields=tuple(fields), units=tuple(units), separator=",", own=False)


LAYOUT = Layout(name="DeepLabCut", find=_find)
