"""Scenes of recordings: one, two that are compared, several traces laid over each other."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from harness.core.arrays import FloatArray
from harness.core.errors import InputError
from harness.core.recording import Recording
from harness.core.trajectory import Trajectory
from harness.results.compare import CompareResult
from harness.results.identify import IdentifyResult
from harness.show import scene as s
from harness.show.decimate import keep, position_error
from harness.show.numbers import REFERENCE, SLIDES, TURNS, of_engines, of_names, units_of
from harness.show.pack import pack_recording
from harness.show.report.compare import Shown, compare_headline
from harness.show.run_scene import DRAWN
from harness.show.scene import kept, padded, plane_grid, roomy
from harness.show.stored import StoredTrace

NAMES = {"x": "position / m", "v": "speed / (m/s)", "a": "acceleration / (m/s²)", "u": "force / N"}
ANGLES = {"x": "angle / rad", "v": "speed / (rad/s)", "a": "acceleration / (rad/s²)", "u": "torque / (N m)"}
_COLORS = {"x": "#e4632d", "v": "#1f9e77", "a": "#2b7fd6", "u": "#a45bc2"}


def recording_scene(
    recording: Recording, result: IdentifyResult, notes: str, reversals: Sequence[tuple[float, str]] = ()
) -> s.Scene:
    """Scene of a recording.

    notes : Markdown. reversals : time in s and a sentence, in order.
    """
    channels = list(recording.channels)
    values = [recording[name] for name in channels]
    times = np.array([t for t, _ in reversals], dtype=np.float64)
    chosen = keep(recording.t, values, times[:64], DRAWN)
    names = ANGLES if recording.angular else NAMES
    items: list[s.Item] = [s.Page("/notes", notes)]
    views: list[s.Layout] = []
    for name in channels:
        items.append(s.Line(f"/channels/{name}", name, recording.t[chosen], recording[name][chosen], _COLORS[name]))
        views.append(s.Plot(names[name], [f"/channels/{name}"], roomy([recording[name]])))
    side: list[s.Layout] = [s.Words("notes", "/notes")]
    if reversals:
        items.append(s.Log("/reversals", times, [sentence for _, sentence in reversals]))
        side.append(s.Events("reversals", "/reversals"))
    return s.Scene(
        recording.file.rpartition("/")[2],
        items,
        s.Columns([s.Rows(views), s.Rows(side)], [3.0, 2.0]),
        {"recording-000": pack_recording(recording)},
        {"result": kept(result), "notes": {"text": notes}},
    )


_PAIR = ("#e4632d", "#8a93a0")
_APART = "#2b7fd6"


def compare_scene(sim: Recording, real: Recording, moved: FloatArray, shown: Shown, result: CompareResult) -> s.Scene:
    """Scene of a comparison.

    moved : times of ``sim`` (n,) by the clock of ``real``, s. shown : both at shared times.
    """
    labels = ANGLES if shown.angular else NAMES
    items: list[s.Item] = []
    views: list[s.Layout] = []
    for channel, pair in shown.channels.items():
        paths = []
        for name, one, t, color in zip(shown.names, (sim, real), (moved, real.t), _PAIR, strict=True):
            chosen = keep(t, [one[channel]], np.empty(0), DRAWN)
            paths.append(f"/channels/{channel}/{'first' if one is sim else 'second'}")
            items.append(s.Line(paths[-1], name, t[chosen], one[channel][chosen], color))
        views.append(s.Plot(labels[channel], paths, roomy([real[channel], sim[channel]])))
        apart = pair[1] - pair[0]
        chosen = keep(shown.t, [apart], np.empty(0), DRAWN)
        path = f"/difference/{channel}"
        items.append(s.Line(path, f"{shown.names[1]} minus {shown.names[0]}", shown.t[chosen], apart[chosen], _APART))
        views.append(s.Plot(f"difference of {labels[channel]}", [path], roomy([apart]) if np.ptp(apart) else None))
    phase, plane = _phase(shown)
    notes = "\n".join(
        [f"# {result.verdict}", "", compare_headline(result), "", *(f"- {line}" for line in result.sentences)]
    )
    items += [*phase, s.Page("/notes", notes)]
    return s.Scene(
        "comparison",
        items,
        s.Columns([s.Rows(views), s.Rows([plane, s.Words("notes", "/notes")])], [3.0, 2.0]),
        {"recording-000": pack_recording(sim), "recording-001": pack_recording(real)},
        {"result": kept(result), "notes": {"text": notes}},
    )


def _phase(shown: Shown) -> tuple[list[s.Item], s.Plane]:
    """Speed over position of both, the speed to a scale that makes them about as high as wide."""
    spans = [max(float(np.ptp(one[i])) for one in shown.motion) for i in (0, 1)]
    scale = 10.0 ** round(float(np.log10(spans[1] / spans[0]))) if min(spans) > 0.0 else 1.0
    bounds = [padded([one[i] / by for one in shown.motion], 0.05) for i, by in ((0, 1.0), (1, scale))]
    axes = (("angle / rad", 1.0), ("speed / (rad/s)", scale))
    if not shown.angular:
        axes = (("x / mm", 1e3), ("v / (mm/s)", 1e3 * scale))
    items: list[s.Item] = [plane_grid("/phase/axes", bounds[0], bounds[1], axes[0], axes[1])]
    chosen = keep(shown.t, [y for pair in shown.motion for y in pair], np.empty(0), DRAWN)
    for name, (x, v), color, place in zip(shown.names, shown.motion, _PAIR, ("first", "second"), strict=True):
        points = np.column_stack([x[chosen], v[chosen] / scale])
        items.append(s.Orbit(f"/phase/{place}", name, points, color, (shown.t[chosen], points)))
    return items, s.Plane("phase portrait, v over x", ["/phase"], bounds[0], bounds[1])


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
