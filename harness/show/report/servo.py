"""The page of a joint under its servo: what its log says, free runs against it, what to paste."""

import math
from collections.abc import Sequence

from harness.core.arrays import FloatArray
from harness.results.common import P
from harness.results.diagnosis import DiagnosisResult
from harness.results.robot import RobotResult, ServoErrorResult, ServoResult
from harness.show import blocks as b
from harness.show.numbers import number, of_names, sentence_quantity
from harness.show.plots import axes, curve
from harness.show.report.page import made_with
from harness.show.report.robot import to_paste
from harness.show.stored import AFTER, AFTER_NAME, BEFORE, BEFORE_NAME

Runs = Sequence[tuple[FloatArray, FloatArray, FloatArray, FloatArray, FloatArray]]
"""Of each log t, s; goal, position, and free runs before and after, rad; each (n,)."""
_MOST = 4
"""Logs that are drawn."""
_MRAD = 1e3


def servo_page(result: DiagnosisResult, runs: Runs, engines: Sequence[tuple[str, FloatArray]]) -> b.Page:
    """engines : by name, positions (n,) in the first log, rad."""
    robot = result.robot
    assert robot is not None
    assert robot.servo is not None
    servo = robot.servo
    sections = [
        b.verdict(result.statement, result.warnings),
        _free_runs(servo, runs, engines),
        *([_terms(servo)] if servo.terms else []),
        _numbers(servo),
        *([_engines(robot)] if robot.simulated else []),
        b.verdict("", servo.confounded, heading="What goal and position cannot separate"),
        to_paste(robot.paste, result.model_left_out),
        *([_bam(servo)] if servo.bam else []),
        b.verdict("", servo.understood, heading="What was read"),
        made_with(result.machine, result.files, result.command),
    ]
    return b.Page(f"The servo of {robot.joint}", result.recording.file, sections)


def _free_runs(servo: ServoResult, runs: Runs, engines: Sequence[tuple[str, FloatArray]]) -> b.Section:
    figures: list[b.Block] = []
    for i, (t, goal, q, before, after) in enumerate(runs[:_MOST]):
        ran = [(BEFORE_NAME, before, BEFORE), *([(AFTER_NAME, after, AFTER)] if servo.terms else [])]
        lines = [
            curve("goal", t, goal, "rule", "rad", 1.0),
            curve("log", t, q, "ink", "rad"),
            *(curve(name, t, y, color, "rad") for name, y, color in ran),
        ]
        figures.append(b.Figure(f"run-{i}", lines, axes("time / s", "position / rad", showlegend=True)))
        if i == 0:
            hues = of_names(len(ran) + len(engines))[len(ran) :]
            ran += [(name, y, hue) for (name, y), hue in zip(engines, hues, strict=True)]
        off = [curve(name, t, _MRAD * (y - q), color, "mrad", 1.0) for name, y, color in ran]
        caption = "Free runs minus the log, from its first sample on, by goals alone."
        figures.append(b.Figure(f"off-{i}", off, axes("time / s", "simulation minus log / mrad"), caption))
    errors = [*servo.fitted, *servo.held_out]
    columns = [
        b.Column(BEFORE_NAME, lambda one: number(one.before, 3), "mrad"),
        b.Column(AFTER_NAME, lambda one: number(one.after, 3), "mrad"),
        b.Column("factor", lambda one: number(one.after / one.before, 3) if one.before else None),
    ][: None if servo.terms else 1]
    least = f"the sensor's noise and steps are {number(servo.floor_mrad, 2)} mrad rms"
    caption = f"Mean absolute error of free runs; {least}."

    def of(one: ServoErrorResult) -> str:
        return one.of if one in servo.fitted else f"held out: {one.of}"

    table = b.tabulated("log", columns, errors, of, caption=caption)
    return b.Section("Free runs", [*([table] if len(errors) > 1 else []), *figures])


def _terms(servo: ServoResult) -> b.Section:
    columns = [
        b.Column("what it is", lambda one: one.said),
        b.Column("evidence", lambda one: number(one.evidence, 3), hint="by which BIC is better with it"),
        b.Column("held out, before", lambda one: _held(one.held_out_mrad, 0), "mrad"),
        b.Column("after", lambda one: _held(one.held_out_mrad, 1), "mrad"),
        b.Column("not ruled out in its place", lambda one: ", ".join(one.rivals) or None),
    ]
    blocks: list[b.Block] = [b.tabulated("term", columns, servo.terms, lambda one: one.name)]
    return b.Section("Further effects", blocks)


def _held(pair: Sequence[float], at: int) -> str | None:
    return number(pair[at], 3) if len(pair) > at else None


def _numbers(servo: ServoResult) -> b.Section:
    told = {one.parameter: one for one in servo.identifiable}

    def size(p: P | None) -> str | None:
        return None if p is None else sentence_quantity(p)

    names = list(servo.parameters)
    columns = [
        *([b.Column(BEFORE_NAME, lambda name: size(servo.base.get(name)))] if servo.terms else []),
        b.Column(AFTER_NAME if servo.terms else "value", lambda name: size(servo.parameters[name])),
        b.Column(
            "identifiable",
            lambda name: b.Cell(told[name].verdict, told[name].why.split("; ")) if name in told else "given",
        ),
    ]
    return b.Section("Numbers", [b.tabulated("number", columns, names, str)])


def _bam(servo: ServoResult) -> b.Section:
    pairs = ", ".join(f'"{k}": {v:.6g}' if isinstance(v, float) else f'"{k}": "{v}"' for k, v in servo.bam.items())
    blocks: list[b.Block] = [b.Code(f"{{{pairs}}}")]
    return b.Section("BAM's parameters", [*blocks, *([b.Items(servo.not_in_bam)] if servo.not_in_bam else [])])


def _engines(robot: RobotResult) -> b.Section:
    """The joint in engines, its file's own servo against what is pasted."""

    def rms(side: str) -> b.Column:
        head = "as your file has it" if side == "before" else "as pasted"
        return b.Column(head, lambda one: number(_MRAD * getattr(one, side).get("x", math.nan), 3), "mrad")

    ran = [one for one in robot.simulated if one.error is None]
    notes = [f"{one.engine}: {one.error}" for one in robot.simulated if one.error is not None]
    caption = "rms of simulation minus the first log; the joint alone, with the inertia and gravity of what it moves."
    table = b.tabulated(
        "engine", [rms("before"), rms("after")], ran, lambda one: one.engine, caption=caption, footnotes=notes
    )
    return b.Section("In engines", [table])
