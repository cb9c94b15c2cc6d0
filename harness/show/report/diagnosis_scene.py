"""The scene of a diagnosis: recording and both simulations, residuals, and where they differ as a lane of states."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from harness.core.arrays import FloatArray
from harness.core.recording import Recording
from harness.core.trajectory import Trajectory
from harness.results.diagnosis import DiagnosisResult
from harness.show import scene as s
from harness.show.blocks import Figure
from harness.show.report.curves import law_figures
from harness.show.report.diagnosis import gained, said, to_change
from harness.show.report.diagnosis_figures import BEFORE, Curves, shaded_spans
from harness.show.report.robot_scene import robot_view, torque_tabs
from harness.show.stored import Shown, parts_of

_APART, _ELSEWHERE = "parts", "elsewhere"


def lane(spans: Sequence[Sequence[float]], start: float, stop: float) -> tuple[FloatArray, list[str]]:
    """Times (s) and states of a lane that is on in these spans."""
    times, states = [start], [_APART if spans and spans[0][0] <= start else _ELSEWHERE]
    for low, high in spans:
        if low > times[-1]:
            times.append(low)
            states.append(_APART)
        if high < stop:
            times.append(high)
            states.append(_ELSEWHERE)
    return np.array(times), states


def diagnosis_scene(
    result: DiagnosisResult,
    recording: Recording,
    simulated: Sequence[Trajectory],
    robot: Shown | None = None,
) -> s.Scene:
    """Scene of a diagnosis; arguments as of diagnosis_page."""
    notes, laws = _notes(result), law_figures(result)
    verdict = s.Words("verdict", notes)
    side: list[s.Layout] = [verdict, *([s.Tabs(laws)] if len(laws) > 1 else laws)]
    parts: dict[str, Sequence[Trajectory | Recording]] = {"trajectory": simulated, "recording": [recording]}
    name = f"diagnosis of {recording.file.rpartition('/')[2]}"
    if recording.steady:
        # no time to draw over
        return s.of_result(name, s.Columns(side[::-1], [3.0, 2.0][-len(side) :]), result, notes, parts)
    seen = Curves(recording, simulated, result)
    curves, rests = seen.over_time(), [_from(recording.t[0], figure) for figure in seen.residuals()]
    lanes = list[s.Layout]()
    if spans := shaded_spans(result):
        looks = {_APART: ("they differ", BEFORE), _ELSEWHERE: ("elsewhere", "#3a414b")}
        states = lane(spans, float(recording.t[0]), float(recording.t[-1]))
        lanes.append(s.Lanes("where they differ", [s.Lane("where", *states, looks)]))
    shares = [*[1.4] * len(rests), *[0.5] * len(lanes), *[2.0] * len(curves)]
    plane = seen.orbit()
    side = [*side, plane]
    if robot is not None:
        side = [
            *([robot_view(robot.bodies)] if robot.bodies else []),
            s.Tabs([verdict, *laws, *torque_tabs(result, robot), plane]),
        ]
    layout = s.Columns([s.Rows([*rests, *lanes, *curves], shares), s.Rows(side)], [3.0, 2.0])
    return s.of_result(name, layout, result, notes, parts | ({} if robot is None else parts_of(robot)))


def _from(start: float, figure: Figure) -> Figure:
    """The figure from an earlier time on, s, so that its axis shows the same time as the others."""
    earlier = [{**one, "x": np.append(start, one["x"]), "y": np.append(np.nan, one["y"])} for one in figure.traces]
    return replace(figure, traces=earlier)


def _notes(result: DiagnosisResult) -> str:
    """The verdict in words, and the evidence as a table."""
    lines = [s.notes_of("Verdict", gained(result) + said(result), result.statement)]
    told = result.attribution
    if told is not None and result.has_own_simulation and (change := to_change(told)):
        lines += ["", "## What to change in your simulation", "", *(f"- {sentence}" for sentence in change)]
    if result.evidence:
        lines += ["", "## Evidence over the catalogue", ""]
        shared = any(one.share is not None for one in result.evidence)
        lines += [f"| name | better by, in BIC |{' share of the misfit |' * shared}", "|---|---|" + "---|" * shared]
        shares = ["-" if one.share is None else f"{100.0 * one.share:.0f} %" for one in result.evidence]
        rows = zip(result.evidence, shares, strict=True)
        lines += [f"| {one.name} | {one.delta_bic:.1f} |{f' {share} |' * shared}" for one, share in rows]
    return "\n".join(lines)
