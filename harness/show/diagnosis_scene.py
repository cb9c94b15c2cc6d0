"""The scene of a diagnosis: recording and both simulations, residuals, and where they part as a lane of states."""

from collections.abc import Sequence

import numpy as np

from harness.core.arrays import FloatArray
from harness.core.recording import Recording
from harness.core.trajectory import Trajectory
from harness.results.diagnosis import DiagnosisResult
from harness.show import scene as s
from harness.show.decimate import keep, reversal_times
from harness.show.pack import pack_recording, pack_trajectories
from harness.show.run_scene import DRAWN
from harness.show.scene import kept, padded, plane_grid, roomy

RECORDED, BEFORE, AFTER, YOURS = "#8a93a0", "#e4632d", "#2b7fd6", "#1f9e77"
YOUR_SIMULATION = "your simulation"
_NAMES = {"x": "position / m", "v": "speed / (m/s)", "a": "acceleration / (m/s²)"}
_ANGLES = {"x": "angle / rad", "v": "speed / (rad/s)", "a": "acceleration / (rad/s²)"}
_PARTS, _ELSEWHERE = "parts", "elsewhere"
_MOST_OF_IT = 0.9
"""A place that covers more of the recording than this says nothing on where."""


def shown(simulated: Trajectory, channel: str) -> FloatArray:
    """A channel as the sensors of a simulation show it, (n,)."""
    return simulated.extra[f"shown {channel}"]


def yours(simulated: Sequence[Trajectory]) -> Trajectory | None:
    """The user's own simulation behind both models, where there is one; its times are those it reaches."""
    return simulated[2] if len(simulated) > 2 else None


def model_names(result: DiagnosisResult) -> list[str]:
    """What both models are called; one when nothing was found that helps."""
    base, mechanisms = "viscous and Coulomb", result.mechanisms
    if not mechanisms:
        return [base]
    return [base, "refined" if mechanisms[0].grade == "explains" else f"with {best_terms(result)}"]


def best_terms(result: DiagnosisResult) -> str:
    """Catalogue names of the best model found."""
    return " and ".join(dict.fromkeys(term.name for term in result.refined_model.terms))


def shaded_spans(result: DiagnosisResult) -> list[list[float]]:
    """Where simulation and recording part, s: the places found, else those of the effects; none for the whole of it."""
    found = [*result.where, *(mechanism.where for mechanism in result.mechanisms)]
    places = [place.time_s for place in found if place.regime != "throughout"]
    for spans in places:
        covered = sum(high - low for low, high in spans)
        if spans and covered < _MOST_OF_IT * result.recording.duration_s:
            return [list(span) for span in spans]
    return []


def begins(result: DiagnosisResult) -> float:
    """When the models are let go, s: before that nothing of them is to be seen."""
    return result.refined_model.release.t0


def lane(spans: Sequence[Sequence[float]], start: float, stop: float) -> tuple[FloatArray, list[str]]:
    """Times (s) and states of a lane that is on in these spans."""
    times, states = [start], [_PARTS if spans and spans[0][0] <= start else _ELSEWHERE]
    for low, high in spans:
        if low > times[-1]:
            times.append(low)
            states.append(_PARTS)
        if high < stop:
            times.append(high)
            states.append(_ELSEWHERE)
    return np.array(times), states


def diagnosis_scene(
    recording: Recording, simulated: Sequence[Trajectory], result: DiagnosisResult, notes: str
) -> s.Scene:
    """Scene of a diagnosis.

    simulated : base model and refined model at the recording's times, behind them the user's own simulation where
    there is one. notes : Markdown.
    """
    channels = [c for c in ("x", "v", "a") if c in recording and f"shown {c}" in simulated[0].extra]
    names = _ANGLES if recording.angular else _NAMES
    labels = model_names(result)
    looks = list(zip(("before", "after"), labels, (BEFORE, AFTER), strict=False))
    everything, own = simulated, yours(simulated)
    simulated = simulated[:2]
    models = list(zip(looks, simulated, strict=False))
    leaves = (labels[0], labels[-1] if result.remainder is None else f"remainder, {labels[-1]}")
    around = reversal_times(simulated[-1])
    items: list[s.Item] = [s.Page("/notes", notes)]
    curves: list[s.Layout] = []
    rests: list[s.Layout] = []
    for c in channels:
        parts = [recording[c], *(shown(model, c) for _, model in models)]
        at = keep(recording.t, parts, around, DRAWN)
        items.append(s.Line(f"/channels/{c}/recording", "recording", recording.t[at], recording[c][at], RECORDED, 3.0))
        at = at[recording.t[at] >= begins(result)]
        t, left = recording.t[at], []
        for ((key, label, color), model), rest in zip(models, leaves, strict=False):
            items.append(s.Line(f"/channels/{c}/{key}", label, t, shown(model, c)[at], color))
            left.append(recording[c][at] - shown(model, c)[at])
            items.append(s.Line(f"/residual/{c}/{key}", rest, t, left[-1], color))
        if own is not None and f"shown {c}" in own.extra:
            at = keep(own.t, [shown(own, c)], around, DRAWN)
            items.append(s.Line(f"/channels/{c}/yours", YOUR_SIMULATION, own.t[at], shown(own, c)[at], YOURS))
        curves.append(s.Plot(names[c], [f"/channels/{c}"], roomy([recording[c]])))
        rests.append(s.Plot(f"recording minus simulation, {names[c]}", [f"/residual/{c}"], roomy(left)))
    spans = shaded_spans(result)
    states_look = {_PARTS: ("they part", BEFORE), _ELSEWHERE: ("elsewhere", "#3a414b")}
    times, states = lane(spans, float(recording.t[0]), float(recording.t[-1]))
    lanes: list[s.Layout] = []
    if spans:
        items.append(s.Lane("/where", times, states, states_look))
        lanes.append(s.Lanes("where they part", ["/where"]))
    best = simulated[-1]
    at = keep(best.t, (best.x, best.v), around, DRAWN)
    # a plane of the viewer has one scale: the speed is drawn as large as the position
    drawn = float(np.ptp(best.x)) / max(float(np.ptp(best.v)), 1e-300)
    points = np.column_stack([best.x[at], best.v[at] * drawn])
    name = labels[-1] if len(models) > 1 else "simulation"
    items.append(s.Orbit("/plane/motion", name, points, AFTER, (best.t[at], points)))
    x, y = padded([best.x], 0.06), padded([best.v * drawn], 0.06)
    unit, speed = ("rad", "rad/s") if recording.angular else ("mm", "m/s")
    axes = ((f"x / {unit}", 1.0 if recording.angular else 1e3), (f"v / ({speed})", 1.0 / drawn))
    items.append(plane_grid("/plane/axes", x, y, *axes))
    shares = [*[2.0] * len(curves), *[0.5] * len(lanes), *[1.4] * len(rests)]
    layout = s.Columns(
        [
            s.Rows([*curves, *lanes, *rests], shares),
            s.Rows([s.Words("verdict", "/notes"), s.Plane("phase plane", ["/plane"], x, y)]),
        ],
        [3.0, 2.0],
    )
    blobs = {f"trajectory-{i:03d}": data for i, data in enumerate(pack_trajectories(everything))}
    blobs["recording-000"] = pack_recording(recording)
    return s.Scene(
        f"diagnosis of {recording.file.rpartition('/')[2]}",
        items,
        layout,
        blobs,
        {"result": kept(result), "notes": {"text": notes}},
    )
