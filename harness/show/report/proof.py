"""The page of a sealed proof: what came out, figure by figure, name by name, and how it was sealed."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from harness.show.numbers import number
from harness.show.report.page import write_report
from harness.show.report.proof_figures import (
    BAD,
    GOOD,
    by_name_section,
    confusion_section,
    detection_curve_section,
    interval_figure,
)
from harness.show.report.section import Cell, Column, Row, Section, Table
from harness.show.report.verdict import made_with_section, verdict_section

Data = Mapping[str, Any]
MOST_ROWS = 200
"""Rows of a table on the page; the rest is in result.json."""


def figures_section(figures: Sequence[Data], forced: Data, by_source: Mapping[str, Sequence[Data]]) -> Section:
    """figures : those of harness.proof/1. forced : controls with a term forced in. heading : of the section."""
    columns = [
        Column("found"),
        Column("95 % interval", hint="exact (Clopper-Pearson) for a share, resampled for a median"),
        Column("cases"),
        Column("asked"),
    ]
    rows = [
        Row(
            figure["label"],
            [
                Cell(_value(figure, "value"), grade=_grade(figure["met"])),
                Cell(_interval(figure)),
                Cell(str(figure["cases"])),
                Cell(figure["asked"]),
            ],
        )
        for figure in figures
    ]
    worst = forced["worst"]
    met = None if worst is None else worst <= 1.05
    asked = "at most 1.05"
    cells = [Cell(number(worst, 4), grade=_grade(met)), Cell(""), Cell(str(forced["cases"])), Cell(asked)]
    # recordings of machines alone have no such controls
    rows += [Row("held-out rmse of controls, a term forced in, largest", cells)] if by_source else []
    table = Table("figure", columns, rows, "Green: reached. Red: falls short. No colour: nothing is asked.")
    shares = [
        {**figure, "note": f"{figure['hits']} of {figure['cases']}", "color": _color(figure["met"])}
        for figure in figures
        if figure["share"]
    ]
    caption = "Shares with their exact 95 % intervals."
    return Section(
        "Figures",
        "proof_figures.html.j2",
        {"tables": [table, *_sources(by_source)], "figures": [interval_figure("figures", shares, caption)]},
    )


def _sources(by_source: Mapping[str, Sequence[Data]]) -> list[Table]:
    """Figures by what made the recordings, where that differs."""
    if len(by_source) < 2:
        return []
    heads = [figure["label"] for figure in next(iter(by_source.values()))]
    rows = [
        Row(name, [Cell(_value(one, "value"), (f"of {one['cases']}",)) for one in figures])
        for name, figures in by_source.items()
    ]
    return [Table("recordings made by", [Column(head) for head in heads], rows, title="By source")]


def _color(met: bool | None) -> str:
    return {True: GOOD, False: BAD, None: "#7a8594"}[met]


def _grade(met: bool | None) -> int | None:
    return {True: 0, False: 4, None: None}[met]


def _value(figure: Data, key: str) -> str:
    value = figure[key]
    if value is None:
        return number(None)
    return f"{100.0 * value:.1f} %" if figure["share"] else number(value, 3)


def _interval(figure: Data) -> str:
    if figure["low"] is None and figure["high"] is None:
        return number(None)
    low, high = _value(figure, "low"), _value(figure, "high")
    return f"{low.removesuffix(' %')} to {high}"


def tables_section(heading: str, tables: Sequence[Table]) -> Section:
    """heading, tables : tables under a heading of its own."""
    return Section(heading, "table.html.j2", {"tables": tables})


GROUPS = {
    "single": "One effect hidden",
    "control": "Nothing hidden",
    "pair": "Two effects hidden",
    "outside": "An effect that no catalogue holds",
    "main": "A machine with one large omission",
    "machine-control": "A machine with small omissions alone",
    "unknown": "A machine with a large omission that no catalogue holds",
}


def missed_section(cases: Sequence[Data]) -> Section:
    """Every recording that was not answered right, group by group."""
    columns = [
        Column("said"),
        Column("not ruled out"),
        Column("recorded"),
        Column("samples"),
        Column("loss of the base fit", hint="chi-square that viscous and Coulomb friction lose to the truth"),
        Column("R² of it"),
    ]
    tables = []
    for group, title in GROUPS.items():
        here = [case for case in cases if case["group"] == group]
        wrong = [case for case in here if not case["right"]]
        if not here:
            continue
        more = f" The first {MOST_ROWS} are shown." if len(wrong) > MOST_ROWS else ""
        caption = f"{len(here) - len(wrong)} of {len(here)} answered right.{more}"
        rows = [_missed(case) for case in wrong[:MOST_ROWS]]
        tables.append(Table("hidden", columns, rows, caption, title))
    return tables_section("What was not answered right", tables)


def _missed(case: Data) -> Row:
    cells = [
        Cell(case["said"]),
        Cell(", ".join(case["near"]) or number(None)),
        Cell(", ".join([case["setting"], case["channels"], *([] if case["source"] == "plant" else [case["source"]])])),
        Cell(str(case["points"])),
        Cell(number(case["loss"], 3)),
        Cell(f"{case['r2']:.4f}"),
    ]
    return Row(" + ".join(case["hidden"]) or "nothing", cells, case["name"])


def baselines_table(margins: Sequence[Data]) -> Table:
    """Ours beside what a practitioner would do."""
    columns = [
        Column("compared by"),
        Column("ours"),
        Column("theirs"),
        Column("margin", hint="by how much ours is better, with its 95 % interval, resampled in pairs"),
        Column("cases", hint="recordings on which the other has something to work on"),
    ]
    rows = [
        Row(
            one["name"],
            [
                Cell(one["what"] or one["why"]),
                Cell(_amount(one, "ours")),
                Cell(_amount(one, "theirs")),
                _margin(one),
                Cell(str(one["cases"])),
            ],
            one["about"],
        )
        for one in margins
    ]
    caption = "On the very same recordings. Green: the interval of the margin lies above none."
    return Table("baseline", columns, rows, caption, "Baselines")


def _margin(one: Data) -> Cell:
    if one["value"] is None:
        return Cell(number(None))
    between = f"{_amount(one, 'low')} to {_amount(one, 'high')}"
    return Cell(_amount(one, "value"), (between,), 0 if one["beaten"] else 4)


def _amount(one: Data, key: str) -> str:
    value = one[key]
    if value is None or not one["share"]:
        return number(value, 3)
    return f"{100.0 * value:.1f} %"


def must_fail_table(rows: Sequence[Data]) -> Table:
    """What diagnosers that look at nothing would have scored."""
    columns = [
        Column("single effects named"),
        Column("false alarms"),
        Column("wrong or nothing outside the catalogue"),
    ]
    lines = [
        Row(
            row["name"],
            [_rate(row["named"], 4), _rate(row["false_alarms"]), _rate(row["misled"])],
            row["about"],
        )
        for row in rows
    ]
    caption = "Scores worth having condemn these, on the very same recordings."
    return Table("a diagnoser that", columns, lines, caption, "Diagnosers that must fail")


def _rate(rate: Data, grade: int | None = None) -> Cell:
    if rate["value"] is None:
        return Cell(number(None))
    note = f"{100.0 * rate['low']:.1f} to {100.0 * rate['high']:.1f} %"
    return Cell(f"{100.0 * rate['value']:.1f} %", (note,), grade)


TOLD = (
    "A seed was taken from the operating system, and its salted hash written down, before anything else.",
    "Every recording was drawn from the seed, by a source that shares no law and no code with the diagnosis. "
    "Names, recordings and answers follow from the seed alone.",
    "The hash of every recording and a salted hash of every answer were written down.",
    "Each recording was diagnosed by a process that got it on standard input, in an empty folder, without "
    "arguments or environment that tell; seed and answers were in no file meanwhile.",
    "The hash of every verdict was written down.",
    "Seed and answers were opened, and everything was scored.",
)
LIMITS = (
    "What this cannot show: that nobody ran many proofs and published the best, and that the machine itself was "
    "honest. Both are answered by running one: harness prove."
)


def sealed_by_section(transcript: Sequence[Data]) -> Section:
    """transcript : ("step", "at", "hash") of each entry."""
    return Section("How it was sealed", "proof_sealed.html.j2", {"told": TOLD, "entries": transcript, "limits": LIMITS})


def _headline(result: Data) -> str:
    figures = {figure["key"]: figure for figure in result["figures"]}
    parts = []
    for key, what in (("listed", "named or listed"), ("wrong", "called another")):
        one = figures.get(f"machines_{key}")
        if one and one["cases"]:
            parts.append(f"{one['hits']} of {one['cases']} main effects of machines were {what}")
    nobody = {"cases": 0}
    named, alarms = figures.get("named", nobody), figures.get("false_alarms", nobody)
    if named["cases"]:
        low = 100.0 * named["low"]
        parts.append(f"{named['hits']} of {named['cases']} hidden effects were named (at least {low:.1f} % of such)")
    if alarms["cases"]:
        parts.append(f"{alarms['hits']} of {alarms['cases']} recordings with nothing hidden raised a false alarm")
    said = "; ".join(parts) + "." if parts else "There is no figure to speak of."
    if not result["evidence"]:
        return f"No evidence: {len(result['cases'])} recordings are too few for the figures to say anything. {said}"
    reached = "Every figure that is asked for is reached." if not result["shortfalls"] else ""
    return f"{said} {reached}".strip()


def proof_sections(result: Data) -> list[Section]:
    """Sections of the page; result : harness.proof/1 as data, with its transcript and the catalogue's order."""
    sizes = result["sizes"]
    drawn = f"{sizes['singles']} recordings hide one effect, {sizes['controls']} none, {sizes['pairs']} two, "
    sentences = [f"Falls short: {line}." for line in result["shortfalls"]]
    if sizes["machines"]:
        sentences.append(f"{sizes['machines']} recordings are of machines, half of them with small omissions alone.")
    else:
        sentences.append(f"{drawn}{sizes['outside']} one that no catalogue holds.")
    sentences += [f"Given up: {line}" for line in result["given_up"]]
    sections: list[Section] = [
        verdict_section(_headline(result), sentences),
        figures_section(result["figures"], result["forced"], result["by_source"]),
    ]
    if result["confusion"]:
        sections.append(confusion_section(result["confusion"], result["order"]))
        sections.append(by_name_section(result["by_name"], result["not_tested"]))
    if result["detection"] is not None:
        sections.append(detection_curve_section(result["detection"]))
    others = [baselines_table(result["baselines"])] if result["baselines"] else []
    others += [must_fail_table(result["must_fail"])] if result["must_fail"] else []
    if others:
        sections.append(tables_section("Beside others", others))
    sections += [
        missed_section(result["cases"]),
        sealed_by_section(result["transcript"]),
        made_with_section(result["machine"], result["files"], result["command"]),
    ]
    return sections


def write_proof_page(path: Path, result: Data) -> None:
    """Write the page."""
    kind = "" if result["evidence"] else "no evidence: "
    subtitle = f"{kind}{len(result['cases'])} recordings, sealed answers, seed {result['seed']}"
    write_report(path, "The sealed proof", subtitle, proof_sections(result))
