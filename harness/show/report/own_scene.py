"""The page and the trace of a body of the user's own scene."""

from collections.abc import Sequence

from harness.core.trajectory import Trajectory
from harness.results.scene import SceneMotion, SceneResult
from harness.show import blocks as b
from harness.show import scene as s
from harness.show.numbers import number
from harness.show.plots import GROUP, axes, curve
from harness.show.report.page import made_with
from harness.show.stored import HELD, LIFTED, SPUN

_LOOKS = {
    "own": ("your file", "#e4632d"),
    "dry friction": ("dry friction", "#8a93a0"),
    "changed": ("with the change", "#2b7fd6"),
}
_GRADES = (1e-6, 1e-5, 1e-4, 1e-3)


def own_scene_page(result: SceneResult, motions: Sequence[Trajectory]) -> b.Page:
    """motions : slide, with lift and spin beside it, one a run."""
    first, *rest = result.conclusions
    sections = [
        b.verdict(first, rest),
        *([_change(result)] if result.change else []),
        b.Section("How it moves", own_scene_figures(motions)),
        _runs(result),
        _touches(result),
        made_with(result.machine, result.files, result.command),
    ]
    return b.Page(f"{result.body} in your own scene", result.file, sections)


def own_scene_scene(result: SceneResult, motions: Sequence[Trajectory]) -> s.Scene:
    """The trace of the same."""
    notes = s.notes_of(f"{result.body} in your own scene", result.conclusions, result.change)
    layout = s.Columns([s.Rows(own_scene_figures(motions)), s.Words("what it does", notes)], [2.0, 1.0])
    return s.of_result(f"{result.body} in a scene", layout, result, notes, {HELD: motions})


_TURNS = 1e-6
"""rad, below which nothing turns that could be drawn."""


def own_scene_figures(motions: Sequence[Trajectory]) -> list[b.Figure]:
    """Slide, lift and spin over time."""
    figures = []
    shown = [("slide", "mm", 1e3), ("lift", "mm", 1e3), ("spin", "rad", 1.0)]
    if all(max(one.extra[SPUN]) - min(one.extra[SPUN]) < _TURNS for one in motions):
        shown.pop()
    for name, unit, factor in shown:
        traces = []
        for one in motions:
            label, color = _LOOKS[one.source.name]
            values = one.x if name == "slide" else one.extra[LIFTED if name == "lift" else SPUN]
            traces.append(curve(label, one.t, factor * values, color, unit, 1.8))
        layout = axes("time / s", f"{name} / {unit}", showlegend=True)
        caption = "From where the later half begins, against what bears the body." if name == "slide" else ""
        figures.append(b.Figure(f"own-scene-{name}", traces, layout, caption, GROUP, 280))
    return figures


def _change(result: SceneResult) -> b.Section:
    how = "the least change that mends it" if result.changed and result.changed.mends else "what comes nearest"
    return b.Section("What to change", [b.Code(result.change, intro=f"A diff of your file: {how}.")])


def _runs(result: SceneResult) -> b.Section:
    """Your file, dry friction, and every change in order."""
    runs: list[tuple[str, SceneMotion]] = [("your file", result), ("dry friction", result.expected)]
    for one in result.tried:
        words = " ".join(f"{name} {value:g}" if isinstance(value, float) else f"{name} {value}"
                         for name, value in one.options.items())  # fmt: skip
        runs.append((words, one))
    columns = [
        b.Column("creep", lambda run: _graded(run[1], result), "µm/s", "mean speed across the contact"),
        b.Column("spin", lambda run: number(run[1].spin_rad_s, 2), "rad/s"),
        b.Column("lift", lambda run: number(run[1].lift_m * 1e3, 2), "mm"),
        *([] if result.expected.rests else [b.Column("deceleration", lambda run: run[1].deceleration_m_s2, "m/s²")]),
        b.Column("cone", lambda run: _percent(run[1].cone_use), "%", "share of the friction cones in use"),
        b.Column("steps", lambda run: number(run[1].steps_per_s / 1e3, 3), "1000/s", "per second of a processor"),
    ]
    caption = "The later half of each run. Changes stand in the order in which they were tried, the least first."
    table = b.tabulated("options", columns, runs, lambda run: run[0], _ended, caption=caption)
    return b.Section("What was run", [table])


def _graded(one: SceneMotion, result: SceneResult) -> b.Cell:
    return b.Cell(
        number(one.creep_m_s * 1e6, 3), grade=b.grade(one.creep_m_s, _GRADES) if result.expected.rests else None
    )


def _ended(run: tuple[str, SceneMotion]) -> str:
    one = run[1]
    if one.diverged_after is not None:
        return f"diverges after {one.diverged_after} steps"
    return "" if one.lost_s is None else f"last contact at {one.lost_s:.3g} s"


def _percent(value: float | None) -> str | None:
    return None if value is None else number(100.0 * value, 3)


def _touches(result: SceneResult) -> b.Section:
    columns = [
        b.Column("condim", lambda one: str(one.condim)),
        b.Column("friction", lambda one: " ".join(f"{value:g}" for value in dict.fromkeys(one.friction))),
        b.Column("whose", lambda one: one.rule),
        b.Column("force", lambda one: number(one.normal, 3), "N"),
        b.Column("cone", lambda one: _percent(one.use), "%", "share of the friction cone in use"),
    ]
    table = b.tabulated("contact", columns, result.touches, lambda one: f"{one.own} on {one.other}")
    return b.Section("Its contacts", [table] if result.touches else [b.Text("It touches nothing.")])
