"""A robot's servo, and words that do nothing."""

from collections.abc import Mapping, Sequence
from typing import Any

from harness.show.numbers import number
from harness.show.report.section import Section
from harness.show.report.table import Cell, Column, Row, Table, grade
from harness.show.report.verdict import verdict_section

Data = Mapping[str, Any]


def servos_section(about: str, rows: Sequence[Data], exact: float) -> Section:
    """about : the servo in words. exact : its zeta.

    rows : ("who", "n", "own", "false_damping" in N s/m, "zeta") each.
    """
    columns = [Column("false damping", "N s/m"), Column("ζ becomes")]
    lines = [
        Row(
            f"{'own drive' if one['own'] else 'held torque'}, n = {one['n']}",
            [
                Cell(f"{one['false_damping']:+.3g}" if one["false_damping"] else "0"),
                Cell(number(one["zeta"], 3), grade=grade(one["zeta"] / exact - 1.0)),
            ],
        )
        for one in rows
    ]
    notes = [f"{row.head}: {one['who']}." for row, one in zip(lines, rows, strict=True)]
    return Section(
        "A robot's servo", "table.html.j2", {"tables": [Table("n sub-steps", columns, lines, about, footnotes=notes)]}
    )


def silent_words(rows: Sequence[Data]) -> Section:
    """Words that do nothing; rows : ("engine" with its version, "what") each."""
    note = (
        "These are words and settings of friction that an engine takes and does not act on, or acts on unasked. The "
        "versions are those it was found in, and docs/fidelity.md names the test of each."
    )
    said = [f"{one['engine']}: {one['what']}." for one in rows]
    return verdict_section("", [*said, note], [one["engine"] for one in rows], "Words that do nothing")
