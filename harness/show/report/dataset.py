"""Pages of published cases: the drive axis (figures beside ours), real machines."""

from collections.abc import Callable, Sequence
from typing import Any

from harness.results.dataset import DatasetResult, FigureRow, MachineRow, MachinesResult, RippleResult
from harness.show.blocks import Cell, Column, Page, Section, lines, tabulated, verdict
from harness.show.report.diagnosis import VERDICTS
from harness.show.report.page import made_with


def dataset_page(result: DatasetResult) -> Page:
    headline = " ".join(result.found) or "Nothing beyond viscous and Coulomb friction was found."
    sections = [
        verdict(headline, [f"Still unexplained: {result.unexplained}", *result.diagnosis.warnings]),
        _figures(result.rows, result.ripples),
        made_with(result.diagnosis.machine, result.files, result.command),
    ]
    return Page("The drive-axis benchmark (EMPS)", result.source, sections)


def _figures(rows: Sequence[FigureRow], ripples: Sequence[RippleResult]) -> Section:
    columns = [
        Column("mass", lambda row: _cell(row.mass_kg, row.mass_stderr_kg), "kg"),
        Column(
            "viscous friction",
            lambda row: ", ".join(f"{value:.4g}" for value in row.viscous),
            "N s/m",
            "one, or forwards and backwards",
        ),
        Column("dry friction", lambda row: _cell(row.dry_n), "N"),
        Column("offset", lambda row: _cell(row.offset_n), "N"),
        Column("force error, fitted file", lambda row: _cell(row.fit_error_percent), "%"),
        Column(
            "force error, other file",
            lambda row: _cell(row.cross_error_percent),
            "%",
            "nothing refitted, without a ripple",
        ),
    ]
    figures = tabulated("model", columns, rows, lambda row: row.label)
    columns = [
        Column("period", lambda r: _cell(1e3 * r.period_m), "mm"),
        Column("amplitude", lambda r: _cell(r.amplitude_n), "N"),
        Column("phase", lambda r: _cell(r.phase_rad), "rad"),
    ]
    caption = "A force that repeats along the screw, found in each file by itself."
    repeating = tabulated("file", columns, ripples, lambda r: r.file, caption=caption)
    return Section("Published figures beside ours", [figures, repeating])


def _cell(value: float | None, stderr: float | None = None) -> Cell:
    if value is None:
        return Cell("-")
    return Cell(f"{value:.4g}", () if stderr is None else (f"± {stderr:.1g}",))


def machines_page(result: MachinesResult) -> Page:
    rows = result.rows
    named = sum(row.verdict in ("missing_physics", "main_effect") for row in rows)
    listed = sum(row.verdict == "one_of" for row in rows)
    headline = (
        f"{len(rows)} recordings of real machines: in {named} one omission is the main one, in {listed} it is one of a"
        f" few, in {len(rows) - named - listed} none has a name of its own."
    )
    sentences = [line for row in rows for line in _said(row)]
    if result.absent:
        sentences.append(f"Not in the folder: {', '.join(result.absent)}.")
    sections = [
        verdict(headline, heading="Real machines"),
        _machines(rows),
        verdict("", sentences, [row.name for row in rows], heading="In sentences"),
        made_with(result.machine, result.files, result.command),
    ]
    return Page("Real machines", "Published recordings, diagnosed by one command", sections)


def _machines(rows: Sequence[MachineRow]) -> Section:
    columns = [
        Column("named or listed", _each(lambda m: f"{m.name} ({m.grade})")),
        Column(
            "explains",
            _each(lambda m: "-" if m.share is None else f"{100.0 * m.share:.0f}"),
            "%",
            "of the misfit beyond the noise, alone",
        ),
        Column(
            "held out", _each(lambda m: _ratio(m.holdout)), "", "error after over before, blocks held out of the fit"
        ),
        Column("free run", _each(lambda m: _ratio(m.forward)), "", "the same of the last 40 %, from a fit of the rest"),
        Column("left", lambda row: "-" if row.over_noise is None else f"{row.over_noise:.2g}", "times noise"),
    ]
    caption = "Nobody knows the truth of these machines; what others said is what fits of a handful of laws came to."
    table = tabulated(
        "machine", columns, rows, lambda row: row.name, lambda row: VERDICTS[row.verdict], caption=caption
    )
    return Section("Recording by recording", [table])


def _each(of: Callable[[Any], str]) -> Callable[[MachineRow], Cell]:
    """A line a mechanism."""
    return lambda row: lines([of(one) for one in row.found])


def _ratio(value: float | None) -> str:
    return "-" if value is None else f"x {value:.2g}"


def _said(row: MachineRow) -> list[str]:
    """What is said of a recording, and by whom; each begins with its name."""
    parts = [
        row.said,
        f"Other fits said: {row.others}" if row.others else "",
        f"From {row.source}." if row.source else "",
    ]
    return [f"{row.name}: {part}" for part in parts if part]
