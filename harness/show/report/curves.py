"""What a sweep shows of friction that is more than one level: static, Stribeck, polynomials of the sliding speed."""

from collections.abc import Callable, Sequence

from harness.fidelity.kind import Row, kind
from harness.fidelity.laws import TOLD
from harness.fidelity.scores import distance
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
