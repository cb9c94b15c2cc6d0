"""Several recordings: the page of a diagnosis each, a row with a link; of one of all, what each has of its own."""

from collections import Counter
from collections.abc import Mapping, Sequence
from pathlib import PurePath
from typing import Any

from harness.show.numbers import number, quantity
from harness.show.report.section import Section
from harness.show.report.table import Cell, Column, Row, Table
from harness.show.report.verdict import verdict_section

VERDICTS = {
    "missing_physics": "physics left out",
    "main_effect": "main effect",
    "one_of": "one of several",
    "adequate": "adequate",
    "unexplained": "unexplained",
    "error": "could not be diagnosed",
}


def index_title(answers: Sequence[Mapping[str, Any]]) -> tuple[str, str]:
    """Title and subtitle of the page."""
    counts = Counter(answer["verdict"] for answer in answers)
    said = ", ".join(f"{counts[verdict]} {words}" for verdict, words in VERDICTS.items() if counts[verdict])
    return f"What simulations leave out of {len(answers)} recordings", said


def index_sections(answers: Sequence[Mapping[str, Any]], command: str) -> list[Section]:
    """Sections of the page. answers : entries of harness.diagnosis/2, each with "link", its page or ""."""
    counts = Counter(m["name"] for answer in answers for m in answer["mechanisms"])
    named = ", ".join(f"{name} ({count})" for name, count in counts.most_common())
    headline = f"Left out: {named}." if named else "No physics was found to be left out."
    sentences = [
        f"{answer['recording']['file']}: {answer['error']}" for answer in answers if answer["verdict"] == "error"
    ]
    return [verdict_section(headline, sentences, heading="Over all recordings"), recordings_section(answers, command)]


def recordings_section(answers: Sequence[Mapping[str, Any]], command: str) -> Section:
    """answers : entries with "link". command : the line that makes it again."""
    rows = [
        {
            "name": PurePath(answer["recording"]["file"]).name,
            "link": answer["link"],
            "verdict": VERDICTS[answer["verdict"]],
            "names": ", ".join(m["name"] for m in answer["mechanisms"]),
            "others": ", ".join(a["name"] for m in answer["mechanisms"] for a in m["alternatives"]),
            "before": number((answer.get("baseline") or {}).get("chi2_per_point"), 4),
            "after": number((answer.get("refined") or {}).get("chi2_per_point"), 4),
        }
        for answer in answers
    ]
    return Section("Recordings", "recordings.html.j2", {"rows": rows, "command": command})


def own_section(result: Mapping[str, Any]) -> Section:
    """A row a recording. result : as in harness.diagnosis/2, of several recordings."""
    own = result["own"]
    channels = list(own[0]["rmse"])
    length = own[0]["start"]["x0"]["unit"]
    zero = [Column("zero", length)] if own[0]["zero"] else []
    columns = [Column("begins at", "s", "on the axis of time on which all lie"), Column("start", length), *zero]
    for c in channels:
        columns += [Column(f"noise of {c}"), Column(f"rmse of {c}", "", "viscous and Coulomb")]
        columns += [Column("refined", "", f"rmse of {c}")] if result["mechanisms"] else []
    alone = [Column(name, p["unit"]) for name, p in own[0]["alone"].items()]
    rows = [Row(_name(one), [_cell(p) for p in one["alone"].values()]) for one in own]
    return Section(
        "Recordings of one machine",
        "table.html.j2",
        {
            "tables": [
                Table("recording", columns, [_row(result, one, channels) for one in own]),
                Table("recording", alone, rows, "Viscous and Coulomb friction fitted to each by itself."),
                *repeated_tables(result.get("together", {})),
            ]
        },
    )


def _row(result: Mapping[str, Any], one: Mapping[str, Any], channels: list[str]) -> Row:
    cells = [Cell(number(one["begins_s"], 4)), _cell(one["start"]["x0"])]
    cells += [_cell(one["zero"])] if one["zero"] else []
    for c in channels:
        noise, before = one["noise"][c], number(one["baseline_rmse"][c], 3)
        cells += [Cell(noise if isinstance(noise, str) else number(noise, 3)), Cell(before)]
        cells += [Cell(number(one["rmse"][c], 3))] if result["mechanisms"] else []
    return Row(_name(one), cells, "; ".join(one["differs"]))


def repeated_tables(together: Mapping[str, Any]) -> list[Table]:
    """What recordings say together of each parameter; none of one recording."""
    columns = [
        Column("of all", "", "its error counts the spread between recordings"),
        Column("error of one", "", "standard error of a single recording's value"),
        Column("spread between", "", "standard deviation beyond those errors"),
        Column("stands out"),
    ]
    rows = [
        Row(
            f"{name}, {one['value']['unit']}",
            [
                _cell(one["value"]),
                Cell(number(one["within"], 2)),
                Cell(number(one["between"], 2)),
                Cell(", ".join(PurePath(file).name for file in one["outliers"]) or "none"),
            ],
        )
        for name, one in together.items()
    ]
    return [Table("parameter", columns, rows, "The model above fitted to each by itself.")] if rows else []


def _name(one: Mapping[str, Any]) -> str:
    return PurePath(one["file"]).name


def _cell(p: Mapping[str, Any]) -> Cell:
    value, error, _ = quantity(p)
    return Cell(value, [f"\u00b1 {error}"] if error else [])
