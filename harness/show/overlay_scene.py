"""Several traces laid over each other."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from harness.core.arrays import FloatArray
from harness.core.errors import InputError
from harness.core.trajectory import Trajectory
from harness.show import scene as s
from harness.show.blocks import Figure
from harness.show.numbers import REFERENCE, SLIDES, TURNS, of_engines, of_names, units_of
from harness.show.plots import ANGLES, CHANNELS, Trace, axes, curve, per, position_error
from harness.show.stored import StoredTrace

_DRAWN = ("x", "v", "a")


@dataclass(frozen=True, slots=True)
class _Motion:
    """One curve of a plot. t (n,) : s. channels : x, v, a that there are, (n,) each, SI."""

    name: str
    t: FloatArray
    channels: Mapping[str, FloatArray]
    of: Trajectory | None = None

    @property
    def reference(self) -> bool:
        """Whether it is what the others are held against."""
        return self.of is not None and self.of.source.name == "reference"


def overlay_scene(traces: Mapping[str, StoredTrace]) -> s.Scene:
    """Scene of several traces by name.

    The reference of several runs of one scenario is drawn once. Raises InputError where some slide and others turn.
    """
    turning = {name: _turns(trace) for name, trace in traces.items()}
    if len(set(turning.values())) > 1:
        found = ", ".join(f"{name} {'turns' if turns else 'slides'}" for name, turns in turning.items())
        raise InputError("view", found, "traces of one kind of motion together")
    motions = _motions(traces)
    hues = iter(_hues([one for one in motions if not one.reference]))
    references = [one.of for one in motions if one.reference]
    turns = any(turning.values())
    small = (TURNS if turns else SLIDES).small
    lines: dict[str, list[Trace]] = {"x": [], "error": [], "v": [], "a": []}
    labels = {"error": f"error against the reference / {small}"}
    for one in motions:
        color, width = (REFERENCE, 2.5) if one.reference else (next(hues), 1.5)
        for channel, values in one.channels.items():
            label, unit, factor = (ANGLES if turns else CHANNELS)[channel]
            labels[channel] = f"{label} / {per(unit)}"
            lines[channel].append(curve(one.name, one.t, values * factor, color, unit, width))
        if one.of is not None and not one.reference and len(references) == 1 and references[0] is not None:
            apart = 1e3 * position_error(one.t, one.of.x, references[0])
            lines["error"].append(curve(one.name, one.t, apart, color, small))
    views = [Figure(name, drawn, axes("time / s", labels[name])) for name, drawn in lines.items() if drawn]
    pages = [
        s.Words(name, (trace.properties.get("notes") or {}).get("text", f"# {name}")) for name, trace in traces.items()
    ]
    return s.Scene(", ".join(traces), s.Columns([s.Rows(views), s.Tabs(pages)], [3.0, 2.0]))


def _hues(motions: Sequence[_Motion]) -> list[str]:
    """Those of the engines, as everywhere, where they tell the motions apart; else one each."""
    engines = of_engines([one.of.source for one in motions if one.of is not None])
    return engines if len(set(engines)) == len(motions) else of_names(len(motions))


def _turns(trace: StoredTrace) -> bool:
    if trace.recordings:
        return any(recording.angular for recording in trace.recordings)
    return units_of(trace.properties.get("scenario") or {}) is TURNS


def _motions(traces: Mapping[str, StoredTrace]) -> list[_Motion]:
    """References first, one a scenario, the most finely sampled; then what every trace has, in their order."""
    references: list[tuple[object, _Motion]] = []
    others: list[_Motion] = []
    for name, trace in traces.items():
        scenario = trace.properties.get("scenario")
        for found in trace.trajectories:
            channels = {c: np.asarray(getattr(found, c)) for c in _DRAWN}
            one = _Motion(f"{name}: {found.source.label}", found.t, channels, found)
            if not one.reference:
                others.append(one)
                continue
            place = next((i for i, (known, _) in enumerate(references) if scenario and known == scenario), None)
            if place is None:
                references.append((scenario, one))
            elif one.t.size > references[place][1].t.size:
                references[place] = scenario, one
        for recording in trace.recordings:
            channels = {c: recording[c] for c in _DRAWN if c in recording}
            others.append(_Motion(f"{name}: {recording.file.rpartition('/')[2]}", recording.t, channels))
    first = [one for _, one in references]
    if len(first) == 1 and first[0].of is not None:
        first = [replace(first[0], name=first[0].of.source.label)]
    return [*first, *others]


def named(places: Sequence[str]) -> list[str]:
    """A short name for each place: its last part, or all of it where several end alike."""
    short = [place.rstrip("/").rpartition("/")[2] for place in places]
    return [one if short.count(one) == 1 else place for one, place in zip(short, places, strict=True)]
