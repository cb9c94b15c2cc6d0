"""What every method reads from every source, with standard errors."""

import math
from collections.abc import Mapping, Sequence
from typing import Any

from harness.show.numbers import MINUS, quantity
from harness.show.report.section import Section
from harness.show.report.table import Cell, Column, Row, Table, grade

METHODS = {
    "acceleration": "each side of a reversal fitted, leaving out a guard interval found from the data",
    "acceleration-local": "last sample before a reversal and first after it, no guard: the reversal itself",
    "acceleration-paper": "five-point average, first period dropped, estimates averaged: the paper's own practice",
    "displacement": "turning points of the displacement",
    "log-decrement": "viscous damping alone",
    "constant-decrement": "Coulomb friction alone",
}

SHOWN_FACTOR = {"mm": 1e3, "rad": 1.0, "rad/s": 1.0, "": 1.0}

QUANTITIES = {"x_k": "Friction displacement x_k", "zeta": "Damping ratio zeta", "omega_n": "Natural frequency omega_n"}


def estimates_section(
    traces: Sequence[Mapping[str, Any]], scenario: Mapping[str, Any], palette: Sequence[str]
) -> Section:
    """traces : as in harness.run/1. scenario : its slider gives the true values where it is known."""
    found = dict.fromkeys(method for trace in traces for method in trace["estimates"])
    methods = [m for m in METHODS if m in found] + [m for m in found if m not in METHODS]
    explained = [{"name": method, "what": METHODS[method]} for method in methods if method in METHODS]
    return Section(
        "Friction and damping as the estimators read them",
        "estimates.html.j2",
        {
            "tables": [_table(traces, scenario, palette, name, methods) for name in QUANTITIES] if methods else [],
            "methods": explained,
        },
    )


def _table(
    traces: Sequence[Mapping[str, Any]],
    scenario: Mapping[str, Any],
    palette: Sequence[str],
    name: str,
    methods: Sequence[str],
) -> Table:
    truth = true_values(scenario).get(name)
    reasons: list[str] = []
    rows = [
        Row(
            f"{trace['source']} {trace['preset']}".strip(),
            [cell(trace["estimates"].get(method), name, truth, reasons) for method in methods],
            color=color,
        )
        for trace, color in zip(traces, palette, strict=True)
    ]
    unit = _unit(traces, name)
    put_in = ""
    if truth is not None:
        put_in = f", put in as {truth * SHOWN_FACTOR[unit]:.6g} {unit}".rstrip()
    columns = [Column(method, unit, METHODS.get(method, "")) for method in methods]
    return Table("source", columns, rows, "", QUANTITIES[name] + put_in, footnotes(reasons))


def true_values(scenario: Mapping[str, Any]) -> Mapping[str, float]:
    """omega_n (rad/s), zeta and x_k (m) of the scenario's slider; empty when the scenario does not say them."""
    truth = scenario.get("truth")
    return truth if isinstance(truth, Mapping) else {}


def _unit(traces: Sequence[Mapping[str, Any]], name: str) -> str:
    for trace in traces:
        for estimate in trace["estimates"].values():
            return quantity(estimate[name])[2]
    return ""


def cell(estimate: Mapping[str, Any] | None, name: str, truth: float | None, reasons: list[str]) -> Cell:
    """One estimate; a reason for what is missing is added to ``reasons`` and marked with its letter."""
    if estimate is None:
        return Cell("\u2013")
    p = estimate[name]
    value, stderr, _ = quantity(p)
    mark, why = "", p.get("why")
    if why:
        if why not in reasons:
            reasons.append(why)
        mark = letter(reasons.index(why))
    if p["value"] is None:
        return Cell("\u2013", [f"({mark})"], hint=why or "")
    notes = [f"± {stderr}" if stderr else f"({mark})"]
    relative = None
    if truth:
        relative = (p["value"] - truth) / truth
        notes.append(percent(relative))
    return Cell(value, notes, grade(relative), " ".join([*([why] if why else []), *estimate.get("notes", [])]))


def percent(relative: float) -> str:
    """A relative deviation as people read it."""
    if abs(relative) < 5e-7:
        return "exact to 10⁻⁶"
    digits = max(0, min(5, 1 - math.floor(math.log10(abs(relative) * 100.0))))
    return f"{relative * 100.0:+.{digits}f} %".replace("-", MINUS)


def letter(index: int) -> str:
    """a, b, ... z, aa, ..."""
    return (letter(index // 26 - 1) if index >= 26 else "") + chr(ord("a") + index % 26)


def footnotes(reasons: Sequence[str]) -> list[str]:
    """The reasons with the letters that the cells show."""
    return [f"({letter(i)}) {reason}" for i, reason in enumerate(reasons)]
