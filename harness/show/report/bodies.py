"""What a sweep shows of bodies in contact: slopes, grips, what rolls and spins."""

from collections.abc import Callable, Sequence
from typing import Any

from harness.fidelity.kind import Row, kind, kinds
from harness.fidelity.scores import distance, settings_of
from harness.show import blocks as b
from harness.show.numbers import number

_CREEPS = (1e-6, 1e-5, 1e-4, 1e-3)
"""m/s at which the colour changes."""
_SHARES = (1e-4, 2e-3, 1e-2, 5e-2)


def bodies_section(
    rows: Sequence[Row], name: Callable[[str, str], str], color: Callable[[str, str], str]
) -> list[b.Section]:
    """The section of a page; none where a sweep has no such rows. name, color : by engine and version."""
    lines: dict[tuple[str, ...], dict[str, Row]] = {}
    for row in rows:
        if kind(row["scenario"]).part == "bodies":
            key = (row["engine"], row["version"], row["environment"], row["preset"], repr(row["changed"]))
            lines.setdefault((*key, repr(row["dt_s"])), {})[row["scenario"]] = row
    if not lines:
        return []
    every = list(lines.values())
    scenarios = [name for name, one in kinds().items() if one.part == "bodies" and any(name in line for line in every)]

    def cell(line: dict[str, Row], scenario: str) -> b.Cell | None:
        row = line.get(scenario)
        if row is None or row["error"] is not None:
            return None
        creep = row["metrics"].get("creep_m_s")
        if creep is not None:
            return b.Cell(number(creep * 1e6, 2), grade=b.grade(creep, _CREEPS))
        share = distance(row, kind(scenario).figures[0])
        return b.Cell(number(None if share is None else 100.0 * share, 2), grade=b.grade(share, _SHARES))

    def unit(scenario: str) -> str:
        return "µm/s" if any("creep_m_s" in line[scenario]["metrics"] for line in every if scenario in line) else "%"

    first: Callable[[Any], Row] = lambda line: next(iter(line.values()))  # noqa: E731
    tables: list[b.Block] = []
    said = "All six freedoms are free. On a slope half of friction is asked for, or 97 %, in a grip a tenth."
    for title, some in (("A body that rests: creep", "µm/s"), ("A body that moves: deceleration off by", "%")):
        columns = [b.Column(one, b.by(one, cell), unit(one)) for one in scenarios if unit(one) == some]
        table = b.tabulated(
            "engine",
            columns,
            every,
            lambda line: name(first(line)["engine"], first(line)["version"]),
            lambda line: settings_of(first(line)),
            lambda line: color(first(line)["engine"], first(line)["version"]),
        )
        tables.append(b.Folded(title, [table]))
    return [b.Section("Bodies in contact", [b.Text(said), *tables])]
