"""What a sweep shows of friction beyond one level and of bodies in contact.

Friction that is static, falls with the sliding speed, or is a polynomial of it; slopes, grips, what rolls and spins.
"""

from collections.abc import Callable, Sequence
from typing import Any

from harness.fidelity.kind import Row, kind, kinds
from harness.fidelity.laws import TOLD
from harness.fidelity.scores import distance, settings_of
from harness.show import blocks as b
from harness.show.numbers import engine_name, number

_STATIC, _STRIBECK, _POLYNOMIAL = "belt", "stribeck-belt", "polynomial-belt"
_SHOWN = (
    (_STATIC, "static", "period of stick-slip off; friction jumps from f_s to f_k"),
    (_STRIBECK, "Stribeck", "friction falls from f_s to f_k with the sliding speed"),
    (_POLYNOMIAL, "and polynomial", "the same with c_2 u|u| + c_3 u^3 of the sliding speed u beside it"),
)
_SHARES = (1e-4, 1e-3, 5e-3, 2e-2)
_SAID = (
    "Where an engine has no word for it, the limit of its own friction is set in each step from the speed at its start,"
    " or all of it is a force (route law). Each period is exact to ten digits."
)


def curves_section(
    rows: Sequence[Row], table: Callable[[str, Sequence[b.Column], Sequence[Row]], b.Table]
) -> list[b.Section]:
    """The section of a page; none where a sweep has no such rows. table : of the engines' rows."""
    lines: dict[tuple[object, ...], dict[str, Row]] = {}
    for row in rows:
        if row["scenario"] in (_STATIC, _STRIBECK, _POLYNOMIAL) and not row["changed"]:
            key = (row["engine"], row["version"], row["environment"], row["route"], row["preset"], row["dt_s"])
            lines.setdefault(key, {})[row["scenario"]] = row
    every = {id(line[_STRIBECK]): line for line in lines.values() if _STRIBECK in line}
    if not every:
        return []

    def off(first: Row, scenario: str) -> b.Cell | None:
        row = every[id(first)].get(scenario)
        if row is None or row["error"] is not None:
            return None
        period, share, _ = (distance(row, figure) for figure in kind(scenario).figures)
        small = "" if share is None else f"share {number(100.0 * share, 2)}"
        return b.Cell(number(None if period is None else 100.0 * period, 2), (small,), b.grade(period, _SHARES))

    columns = [b.Column(head, b.by(scenario, off), "%", hint) for scenario, head, hint in _SHOWN]
    columns.append(b.Column("steps", lambda row: number((row["steps_per_s"] or 0.0) / 1e3 or None, 3), "1000/s"))
    cells = [
        b.Column("static", lambda one: one.static),
        b.Column("Stribeck", lambda one: one.stribeck),
        b.Column("polynomial", lambda one: one.polynomial),
    ]
    here = {row["engine"] for row in rows}
    told = b.tabulated(
        "engine",
        cells,
        [one for one in TOLD if one.engine in here],
        lambda one: engine_name(one.engine),
        lambda one: one.by,
    )
    firsts = [line[_STRIBECK] for line in every.values()]
    folded = b.Folded("What it costs: period of stick-slip", [table("engine, route", columns, firsts)])
    return [
        b.Section(
            "Static, Stribeck and polynomial friction",
            [b.Text(_SAID), b.Folded("How each engine is told", [told]), folded],
        )
    ]


_CREEPS = (1e-6, 1e-5, 1e-4, 1e-3)
"""m/s at which the colour changes."""
_DECELERATIONS = (1e-4, 2e-3, 1e-2, 5e-2)


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
        return b.Cell(number(None if share is None else 100.0 * share, 2), grade=b.grade(share, _DECELERATIONS))

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
