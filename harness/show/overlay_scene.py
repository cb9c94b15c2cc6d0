"""The scene of several traces laid over each other: the motions of all in the same plots, notes of each in a tab."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from harness.core.arrays import FloatArray
from harness.core.errors import InputError
from harness.core.trajectory import Trajectory
from harness.show import scene as s
from harness.show.axes import roomy
from harness.show.compare import position_error
from harness.show.decimate import keep
from harness.show.motion_units import SLIDES, TURNS, units_of
from harness.show.palette import REFERENCE, of_engines, of_names
from harness.show.recording_scene import ANGLES, NAMES
from harness.show.run_scene import DRAWN
from harness.show.stored import StoredTrace

CHANNELS = ("x", "v", "a")
_TOGETHER = "traces of one kind of motion are accepted together"


@dataclass(frozen=True, slots=True)
class _Motion:
    """One curve of a plot. t (n,) : s. channels : those of CHANNELS that there are, (n,) each, SI."""

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
        raise InputError("view", found, _TOGETHER)
    motions = _motions(traces)
    hues = iter(_hues([one for one in motions if not one.reference]))
    references = [one.of for one in motions if one.reference]
    items: list[s.Item] = []
    drawn: dict[str, list[str]] = {}
    errors: dict[str, FloatArray] = {}
    for i, one in enumerate(motions):
        color = REFERENCE if one.reference else next(hues)
        chosen = keep(one.t, list(one.channels.values()), np.empty(0), DRAWN)
        for channel, values in one.channels.items():
            # the number keeps the order: the viewer draws by name, and references belong below the others
            path = f"/{channel}/{i:02d}"
            width = 2.5 if one.reference else 1.5
            items.append(s.Line(path, one.name, one.t[chosen], values[chosen], color, width))
            drawn.setdefault(channel, []).append(path)
        if one.of is not None and not one.reference and len(references) == 1 and references[0] is not None:
            error = 1e3 * position_error(one.t[chosen], one.of.x[chosen], references[0])
            path = f"/error/{i:02d}"
            items.append(s.Line(path, one.name, one.t[chosen], error, color))
            errors[path] = error
    turns = any(turning.values())
    names = ANGLES if turns else NAMES
    views: list[s.Layout] = [
        s.Plot(names[channel], drawn[channel], roomy([m.channels[channel] for m in motions if channel in m.channels]))
        for channel in CHANNELS
        if channel in drawn
    ]
    if errors:
        unit = (TURNS if turns else SLIDES).small
        views.insert(1, s.Plot(f"error against the reference / {unit}", list(errors), roomy(list(errors.values()))))
    pages: list[s.Layout] = []
    for i, (name, trace) in enumerate(traces.items()):
        text = (trace.properties.get("notes") or {}).get("text", f"# {name}")
        items.append(s.Page(f"/notes/{i:02d}", text))
        pages.append(s.Words(name, f"/notes/{i:02d}"))
    return s.Scene(", ".join(traces), items, s.Columns([s.Rows(views), s.Tabs(pages)], [3.0, 2.0]))


def _hues(motions: Sequence[_Motion]) -> list[str]:
    """Those of the engines, as everywhere, where they tell the motions apart; else one each."""
    sources = [one.of.source for one in motions if one.of is not None]
    engines = of_engines(sources)
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
        for trajectory in trace.trajectories:
            one = _of(trajectory, f"{name}: {trajectory.source.label}")
            if not one.reference:
                others.append(one)
                continue
            place = next((i for i, (known, _) in enumerate(references) if scenario and known == scenario), None)
            if place is None:
                references.append((scenario, one))
            elif one.t.size > references[place][1].t.size:
                references[place] = scenario, one
        for recording in trace.recordings:
            channels = {c: recording[c] for c in CHANNELS if c in recording}
            others.append(_Motion(f"{name}: {recording.file.rpartition('/')[2]}", recording.t, channels))
    first = [one for _, one in references]
    if len(first) == 1 and first[0].of is not None:
        first = [replace(first[0], name=first[0].of.source.label)]
    return [*first, *others]


def _of(trajectory: Trajectory, name: str) -> _Motion:
    channels = {"x": trajectory.x, "v": trajectory.v, "a": trajectory.a}
    return _Motion(name, trajectory.t, channels, trajectory)


def named(places: Sequence[str]) -> list[str]:
    """A short name for each place: its last part, or all of it where several end alike."""
    short = [place.rstrip("/").rpartition("/")[2] for place in places]
    return [one if short.count(one) == 1 else place for one, place in zip(short, places, strict=True)]
