"""The page of a run: which sections, in which order."""

import math
import re
from collections.abc import Mapping, Sequence
from typing import Any

from harness.core.trajectory import Trajectory
from harness.show.decimate import reversal_times
from harness.show.numbers import DECAY, MINUS, TURNS, colors, heading, number, quantity, units_of, without_step
from harness.show.report.motion import motion_section, phase_section, reversal_section, turning
from harness.show.report.section import Cell, Column, Row, Section, Table, grade
from harness.show.report.verdict import headline, made_with_section, sources_section, verdict_section


def scorecard_section(
    traces: Sequence[Mapping[str, Any]], scenario: Mapping[str, Any], palette: Sequence[str]
) -> Section:
    """traces : as in harness.run/1, the exact reference first. palette : a CSS colour each."""
    shown = measured(traces, scenario)
    headings = [heading(metric) for metric in shown]
    small = units_of(scenario).small
    columns = [Column(one.head, re.sub(r"^mm\b", small, one.unit), one.hint) for one in headings]
    columns.append(Column("run time", "ms", "wall clock time of the simulation"))
    rows = [_row(traces, scenario, trace, color, shown) for trace, color in zip(traces, palette, strict=True)]
    caption = (
        "Colours run from green (as good as exact) to red (off by more than 5 % of the start, the friction "
        "displacement x_k or the period, whichever the figure belongs to). A dash: there is no such figure."
    )
    return Section(
        "Scorecard",
        "folded.html.j2",
        {
            "tables": [Table("source", columns, rows, caption)],
            "summary": "Each source by each figure",
            "open": True,
        },
    )


def _row(
    traces: Sequence[Mapping[str, Any]],
    scenario: Mapping[str, Any],
    trace: Mapping[str, Any],
    color: str,
    shown: Sequence[str],
) -> Row:
    cells = [_cell(traces, scenario, trace, metric) for metric in shown]
    cells.append(Cell(number(None if trace["wall_s"] is None else trace["wall_s"] * 1e3, 3)))
    step = without_step(scenario) if trace["dt_s"] is None else f"step {trace['dt_s'] * 1e3:.4g} ms"
    return Row(f"{trace['source']} {trace['preset']}".strip(), cells, f"{trace['version']}, {step}".lstrip(", "), color)


def _cell(
    traces: Sequence[Mapping[str, Any]], scenario: Mapping[str, Any], trace: Mapping[str, Any], metric: str
) -> Cell:
    """A metric, graded by its distance from the exact motion's own."""
    value, exact = trace["metrics"].get(metric), traces[0]["metrics"].get(metric)
    if metric == "half_cycles":
        same = None if value is None or exact is None else 4 * (value != exact)
        return Cell(number(None) if value is None else str(value), grade=same)
    if metric == "stick_time_s":
        if value is None and exact is not None:
            return Cell("never", grade=4)
        return Cell(number(value, 5), grade=_graded(scenario, metric, value, exact))
    digits = 2 if metric == "energy_error" else 4
    shown = number(None if value is None else value * heading(metric).factor, digits)
    return Cell(shown, grade=_graded(scenario, metric, value, 0.0 if metric in DECAY else exact))


def _graded(scenario: Mapping[str, Any], metric: str, value: float | None, exact: float | None) -> int | None:
    scale = scales(scenario).get(metric)
    if scale is None and exact is not None:
        scale = 1.0 if metric.endswith("fraction") else abs(exact)
    return None if value is None or exact is None or not scale else grade((value - exact) / scale)


def measured(traces: Sequence[Mapping[str, Any]], scenario: Mapping[str, Any]) -> list[str]:
    """Metrics that a table of these traces shows, in order: a free decay's always, others where one trace has them."""
    every = dict.fromkeys([*DECAY, *(metric for trace in traces for metric in trace["metrics"])])
    always = DECAY if scenario.get("action") is None else ()
    there = [metric for metric in every if any(trace["metrics"].get(metric) is not None for trace in traces)]
    return [metric for metric in every if metric in always or metric in there]


def scales(scenario: Mapping[str, Any]) -> Mapping[str, float]:
    """What each metric is measured against, SI units; the scenario's own where it says them."""
    truth = true_values(scenario)
    found = {"max_error_m": abs(float((scenario.get("release") or {}).get("x0") or 0.0)), "energy_error": 1.0}
    found |= {"lift_m": found["max_error_m"], "rest_error_m": truth.get("x_k", 0.0)}
    if truth:
        period = 2.0 * math.pi / truth["omega_n"]
        found |= {"stick_time_s": period, "reversal_lead_s": period, "creep_m_s": truth["x_k"] / period}
    return found | dict(scenario.get("scales") or {})


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


_SLIDING = (("m", "m", "kg"), ("k", "k", "N/m"), ("c", "c", "N s/m"), ("f_k", "f_k", "N"))
_TURNING = (("J", "m", "kg m²"), ("k", "k", "N m/rad"), ("c", "c", "N m s/rad"), ("f_k", "f_k", "N m"))


def run_sections(trajectories: Sequence[Trajectory], result: Mapping[str, Any], command: str = "") -> list[Section]:
    """Sections of a run: the answer and its plots, then what differs and why, then tables.

    trajectories : the first is the reference, in the order of those of result["traces"] that have no error.
    result : RunResult.model_dump(mode="json", by_alias=True) (harness.run/1). command : the line that makes it again,
    "" when it is not known.
    """
    traces = [trace for trace in result["traces"] if not trace.get("error")]
    labels = [f"{trace['source']} {trace['preset']}".strip() for trace in traces]
    failed = [
        f"{trace['source']} {trace['preset']}".strip() + f" could not be run: {trace['error']}"
        for trace in result["traces"]
        if trace.get("error")
    ]
    palette = ["var(--ink)", *colors([trajectory.source for trajectory in trajectories])[1:]]
    decays = result["scenario"].get("action") is None
    units = units_of(result["scenario"])
    turns = len(turning(trajectories[0].events)) > 0 and reversal_times(trajectories[0]).size > 0
    conclusions = result["conclusions"]
    return [
        verdict_section(headline(traces, units), failed),
        *([reversal_section(trajectories, units)] if turns else []),
        motion_section(trajectories, units),
        *([verdict_section("", conclusions, labels, "Engine by engine")] if conclusions else []),
        scorecard_section(traces, result["scenario"], palette),
        *([estimates_section(traces, result["scenario"], palette)] if decays else []),
        phase_section(trajectories, decays, units),
        sources_section(traces, palette, without_step(result["scenario"])),
        made_with_section(result["machine"], result["files"], command),
    ]


def run_title(result: Mapping[str, Any]) -> tuple[str, str]:
    """Title and subtitle of the page of a run."""
    scenario = result["scenario"]
    engines = ", ".join(dict.fromkeys(f"{trace['source']} {trace['version']}" for trace in result["traces"][1:]))
    slider = scenario.get("slider")
    what = "Dry friction, engine by engine"
    if not isinstance(slider, Mapping):
        return what, f"{scenario.get('name', 'run')}: {engines}"
    name = str(scenario.get("name", "run")).replace("-", " ")
    what_acts = _ACTING.get((scenario.get("action") or {}).get("kind", ""), "").format(**(scenario.get("action") or {}))
    values = ", ".join(
        f"{symbol} = {slider[key]:g} {unit}"
        for symbol, key, unit in (_TURNING if units_of(scenario) is TURNS else _SLIDING)
        if isinstance(slider.get(key), (int, float))
    )
    thing = "pendulum" if units_of(scenario) is TURNS else "slider"
    of = "" if thing in name else f" of a {thing}"
    about = f"{name}: a {thing} {what_acts}" if what_acts else f"{name}{of}"
    return what, f"{about}, {values}: {engines or 'reference only'}"


_ACTING = {
    "Hold": "under a load of {force:.4g} N",
    "Belt": "on a belt at {speed:.4g} m/s",
    "Harmonic": "driven with {amplitude:.4g} N at {omega:.4g} rad/s",
}
"""What acts on the slider, by the kind of action."""
