"""The law that was found beside the recording: force over what it depends on."""

from typing import Any

import numpy as np

from harness.core.arrays import FloatArray
from harness.results.diagnosis import DiagnosisResult, SeenLawResult
from harness.show.blocks import Figure, Items, Section
from harness.show.numbers import SHOWN
from harness.show.plots import axes, dots, per, plain
from harness.show.report.diagnosis_figures import AFTER, BEFORE, model_names

_ERRORS = 2.0
"""Standard errors of a bar."""
_OF = {
    "v": ("speed", "friction and damping", "all friction and damping"),
    "x": ("position", "force beyond the spring", "what the refined model's spring is not"),
    "t": ("time", "force", "what acts besides the slider's own forces"),
}
_LEVEL = "level of dry friction"


def law_section(result: DiagnosisResult) -> Section:
    """A plot for each thing that the laws depend on, and what each law says."""
    title = "Friction by speed" if any(law.between for law in result.laws) else "The law"
    return Section(title, [*law_figures(result), *statements(result)])


def statements(result: DiagnosisResult) -> list[Items]:
    """What each law says, where the verdict does not."""
    said = [one.statement for one in result.mechanisms if one.statement not in result.statement]
    return [Items(said)] if said else []


def law_figures(result: DiagnosisResult) -> list[Figure]:
    """A plot for each thing that the laws depend on."""
    return [_figure(i, law, result) for i, law in enumerate(result.laws)]


def _figure(number: int, law: SeenLawResult, result: DiagnosisResult) -> Figure:
    over, label, what = _OF[law.over]
    label, what = (_LEVEL, "the level of dry friction") if law.level else (label, what)
    # as pages have it, a length in mm and a speed in m/s
    unit, factor = SHOWN.get(law.at_unit, (law.at_unit, 1.0)) if law.over == "x" else (law.at_unit, 1.0)
    at, seen = factor * np.array(law.at), np.array(law.seen)
    bars = {"type": "data", "array": _ERRORS * np.array(law.stderr), "thickness": 1.2, "width": 0, "color": "ink"}
    hover = f"%{{y:.4g}} at %{{x:.4g}} {unit}<extra></extra>"
    names, drawn = model_names(result), law.between or law
    along = factor * np.array(drawn.at)
    lines: list[dict[str, Any]] = [
        plain(name, *_broken(along, np.array(y), law.over), color, 2.2, hovertemplate=hover)
        for name, y, color in zip(names, (drawn.base, drawn.fitted), (BEFORE, AFTER), strict=False)
    ]
    points = dots("recording", at, seen, {"color": "ink", "size": 6}, hover, error_y=bars)
    caption = (
        f"Points: {what} as the recording shows it, with two standard errors. Lines: the law that was found, and"
        " viscous and Coulomb friction alone."
    )
    if law.between:
        caption = f"Points: the {len(law.at)} rows of the recording, with two standard deviations of their noise."
    labels = f"{over} / {per(unit)}", f"{label} / {per(law.force_unit.replace('^2', '²'))}"
    return Figure(
        f"law-{number}", [*lines, points], axes(*labels, showlegend=True, hovermode="closest"), caption, "", 380
    )


def _broken(at: FloatArray, y: FloatArray, over: str) -> tuple[FloatArray, FloatArray]:
    """A line over speeds has no value where it jumps."""
    turn = int(np.searchsorted(at, 0.0))
    if over != "v" or turn in (0, at.size):
        return at, y
    return np.insert(at, turn, 0.0), np.insert(y, turn, np.nan)
