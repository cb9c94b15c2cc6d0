"""The page of a run: the answer and its plots, then what differs and why, then tables."""

import math
import re
from collections.abc import Mapping, Sequence
from typing import Any

from harness.core.trajectory import Trajectory
from harness.results.common import P
from harness.results.run import Estimates, RunResult, TraceResult
from harness.show import blocks as b
from harness.show.numbers import (
    DECAY,
    MINUS,
    SLIDES,
    TURNS,
    MotionUnits,
    colors,
    engine_name,
    heading,
    number,
    quantity,
    units_of,
    without_step,
)
from harness.show.plots import reversal_times
from harness.show.report.motion import motion_section, phase_figure, reversal_section, turning
from harness.show.report.page import made_with

METHODS = {
    "acceleration": "each side of a reversal fitted, without a guard interval found from the data",
    "acceleration-local": "last sample before a reversal and first after it, no guard: the reversal itself",
    "acceleration-paper": "five-point average, first period dropped, estimates averaged: the paper's own practice",
    "displacement": "turning points of the displacement",
    "log-decrement": "viscous damping alone",
    "constant-decrement": "Coulomb friction alone",
}
QUANTITIES = {"x_k": "Friction displacement x_k", "zeta": "Damping ratio zeta", "omega_n": "Natural frequency omega_n"}
_SHOWN_FACTOR = {"mm": 1e3, "rad": 1.0, "rad/s": 1.0, "": 1.0}
_SLIDING = (("m", "m", "kg"), ("k", "k", "N/m"), ("c", "c", "N s/m"), ("f_k", "f_k", "N"))
_TURNING = (("J", "m", "kg m²"), ("k", "k", "N m/rad"), ("c", "c", "N m s/rad"), ("f_k", "f_k", "N m"))
_ACTING = {
    "Hold": "under a load of {force:.4g} N",
    "Belt": "on a belt at {speed:.4g} m/s",
    "Harmonic": "driven with {amplitude:.4g} N at {omega:.4g} rad/s",
}
"""What acts on the slider, by the kind of action."""


def run_page(result: RunResult, trajectories: Sequence[Trajectory]) -> b.Page:
    """trajectories : the first is the reference, in the order of those traces of the result that have no error."""
    scenario = result.scenario
    traces = [trace for trace in result.traces if not trace.error]
    failed = [f"{trace.label} could not be run: {trace.error}" for trace in result.traces if trace.error]
    palette = ["var(--ink)", *colors([trajectory.source for trajectory in trajectories])[1:]]
    decays = scenario.get("action") is None
    units = units_of(scenario)
    turns = len(turning(trajectories[0].events)) > 0 and reversal_times(trajectories[0]).size > 0
    sections = [b.verdict(headline(traces, units), failed)]
    if turns:
        sections.append(reversal_section(trajectories, units))
    sections.append(motion_section(trajectories, units))
    if result.conclusions:
        sections.append(b.verdict("", result.conclusions, [trace.label for trace in traces], "Engine by engine"))
    sections.append(_scorecard(traces, scenario, palette))
    if decays:
        sections.append(_estimates(traces, scenario, palette))
    sections += [
        b.Section("Phase portrait", [phase_figure(trajectories, decays, units)]),
        _sources(traces, palette, without_step(scenario)),
        made_with(result.machine, result.files, result.command),
    ]
    return b.Page("Dry friction, engine by engine", _subtitle(result, traces), sections)


def _subtitle(result: RunResult, traces: Sequence[TraceResult]) -> str:
    scenario, units = result.scenario, units_of(result.scenario)
    engines = ", ".join(dict.fromkeys(f"{trace.source} {trace.version}" for trace in traces[1:]))
    slider = scenario.get("slider")
    if not isinstance(slider, Mapping):
        return f"{scenario.get('name', 'run')}: {engines}"
    name = str(scenario.get("name", "run")).replace("-", " ")
    action = scenario.get("action") or {}
    what_acts = _ACTING.get(action.get("kind", ""), "").format(**action)
    values = ", ".join(
        f"{symbol} = {slider[key]:g} {unit}"
        for symbol, key, unit in (_TURNING if units is TURNS else _SLIDING)
        if isinstance(slider.get(key), (int, float))
    )
    thing = "pendulum" if units is TURNS else "slider"
    of = "" if thing in name else f" of a {thing}"
    about = f"{name}: a {thing} {what_acts}" if what_acts else f"{name}{of}"
    return f"{about}, {values}: {engines or 'reference only'}"


def headline(traces: Sequence[TraceResult], units: MotionUnits = SLIDES) -> str:
    """One sentence for each preset: how far its engines are from exact, and whether they come to rest."""
    groups: dict[str, list[TraceResult]] = {}
    for trace in traces:
        if trace.metrics.max_error_m is not None and trace.source != "reference":
            groups.setdefault(trace.preset, []).append(trace)
    said = [_sentence(preset, members, units.small) for preset, members in sorted(groups.items(), reverse=True)]
    return " ".join(said) or "The exact reference alone was run; there is nothing to compare it with."


def _sentence(preset: str, traces: Sequence[TraceResult], unit: str) -> str:
    parts = []
    for trace in traces:
        off, creep = (trace.metrics.max_error_m or 0.0) * 1e3, trace.metrics.creep_m_s
        part = f"{engine_name(trace.source)} is off by at most {number(off, 3)} {unit}"
        if creep is not None and abs(creep) > 1e-6:
            part += f" and never rests (it creeps at {number(creep * 1e3, 3)} {unit}/s)"
        parts.append(part)
    start = {"as-shipped": "As shipped, ", "tuned": "Tuned, "}.get(preset, f"{preset}: " if preset else "")
    several = "; " * (len(parts) > 2) + " and " * (len(parts) == 2)
    text = start + (parts[0] if len(parts) == 1 else ", ".join(parts[:-1]) + several + parts[-1])
    return text[0].upper() + text[1:] + "."


def _scorecard(traces: Sequence[TraceResult], scenario: Mapping[str, Any], palette: Sequence[str]) -> b.Section:
    """traces : the exact reference first. palette : a CSS colour each."""
    shown = metrics_shown(traces, scenario)
    small = units_of(scenario).small
    found = [trace.metrics.model_dump() for trace in traces]
    headings = [heading(metric) for metric in shown]
    columns = [b.Column(one.head, str, re.sub(r"^mm\b", small, one.unit), one.hint) for one in headings]
    columns.append(b.Column("run time", str, "ms", "wall clock time of the simulation"))
    rows = []
    for trace, metrics, color in zip(traces, found, palette, strict=True):
        cells = [_metric(scenario, metric, metrics.get(metric), found[0].get(metric)) for metric in shown]
        cells.append(b.Cell(number(None if trace.wall_s is None else trace.wall_s * 1e3, 3)))
        step = without_step(scenario) if trace.dt_s is None else f"step {trace.dt_s * 1e3:.4g} ms"
        rows.append(b.Row(trace.label, cells, f"{trace.version}, {step}".lstrip(", "), color))
    caption = (
        "Colours run from green (as good as exact) to red (off by more than 5 % of the start, the friction "
        "displacement x_k or the period, whichever the figure belongs to). A dash: there is no such figure."
    )
    table = b.Table("source", columns, rows, caption)
    return b.Section("Scorecard", [b.Folded("Each source by each figure", [table], open=True)])


def _metric(scenario: Mapping[str, Any], metric: str, value: float | None, exact: float | None) -> b.Cell:
    """A metric, graded by its distance from the exact motion's own."""
    if metric == "half_cycles":
        same = None if value is None or exact is None else 4 * (value != exact)
        return b.Cell(number(None) if value is None else str(value), grade=same)
    if metric == "stick_time_s":
        if value is None and exact is not None:
            return b.Cell("never", grade=4)
        return b.Cell(number(value, 5), grade=_graded(scenario, metric, value, exact))
    digits = 2 if metric == "energy_error" else 4
    shown = number(None if value is None else value * heading(metric).factor, digits)
    return b.Cell(shown, grade=_graded(scenario, metric, value, 0.0 if metric in DECAY else exact))


def _graded(scenario: Mapping[str, Any], metric: str, value: float | None, exact: float | None) -> int | None:
    scale = scales(scenario).get(metric)
    if scale is None and exact is not None:
        scale = 1.0 if metric.endswith("fraction") else abs(exact)
    return None if value is None or exact is None or not scale else b.grade((value - exact) / scale)


def metrics_shown(traces: Sequence[TraceResult], scenario: Mapping[str, Any]) -> list[str]:
    """Metrics that a table of these traces shows, in order: a free decay's always, others where one trace has them."""
    found = [trace.metrics.model_dump() for trace in traces]
    every = dict.fromkeys([*DECAY, *(metric for metrics in found for metric in metrics)])
    always = DECAY if scenario.get("action") is None else ()
    return [m for m in every if m in always or any(metrics.get(m) is not None for metrics in found)]


def scales(scenario: Mapping[str, Any]) -> Mapping[str, float]:
    """What each metric is measured against, SI units; the scenario's own where it says them."""
    truth = true_values(scenario)
    found = {"max_error_m": abs(float((scenario.get("release") or {}).get("x0") or 0.0)), "energy_error": 1.0}
    found |= {"lift_m": found["max_error_m"], "rest_error_m": truth.get("x_k", 0.0)}
    if truth:
        period = 2.0 * math.pi / truth["omega_n"]
        found |= {"stick_time_s": period, "reversal_lead_s": period, "creep_m_s": truth["x_k"] / period}
    return found | dict(scenario.get("scales") or {})


def true_values(scenario: Mapping[str, Any]) -> Mapping[str, float]:
    """omega_n (rad/s), zeta and x_k (m) of the scenario's slider; empty when the scenario does not say them."""
    truth = scenario.get("truth")
    return truth if isinstance(truth, Mapping) else {}


def _estimates(traces: Sequence[TraceResult], scenario: Mapping[str, Any], palette: Sequence[str]) -> b.Section:
    """scenario : its slider gives the true values where it is known."""
    title = "Friction and damping as the estimators read them"
    found = dict.fromkeys(method for trace in traces for method in trace.estimates)
    methods = [m for m in METHODS if m in found] + [m for m in found if m not in METHODS]
    if not methods:
        return b.Section(title, [b.Text("No estimator was run.")])
    tables = []
    for name, label in QUANTITIES.items():
        truth, reasons = true_values(scenario).get(name), b.Reasons(letter)
        rows = [
            b.Row(trace.label, [estimated(trace.estimates.get(m), name, truth, reasons) for m in methods], color=color)
            for trace, color in zip(traces, palette, strict=True)
        ]
        unit = next((quantity(p_of(one, name))[2] for trace in traces for one in trace.estimates.values()), "")
        put_in = "" if truth is None else f", true value {truth * _SHOWN_FACTOR[unit]:.6g} {unit}".rstrip()
        columns = [b.Column(method, str, unit, METHODS.get(method, "")) for method in methods]
        tables.append(b.Table("source", columns, rows, "", label + put_in, reasons.footnotes))
    said = (
        "Below each value: one standard error, and the deviation from the true value. The gap between acceleration and"
        "\nacceleration-local measures how far an engine smears the jump of the acceleration."
    )
    explained = b.Facts({method: METHODS[method] for method in methods if method in METHODS})
    summary = f"{len(tables)} tables: every method on every source"
    return b.Section(title, [b.Text(said), b.Folded("The methods", [explained]), b.Folded(summary, tables)])


def p_of(estimate: Estimates, name: str) -> P:
    """One of its QUANTITIES."""
    found: P = getattr(estimate, name)
    return found


def estimated(estimate: Estimates | None, name: str, truth: float | None, reasons: b.Reasons) -> b.Cell:
    """One estimate; a reason for what is missing is added to ``reasons`` and marked with its letter."""
    if estimate is None:
        return b.Cell("\u2013")
    p = p_of(estimate, name)
    value, stderr, _ = quantity(p)
    mark = reasons.mark(p.why) if p.why else "()"
    if p.value is None:
        return b.Cell("\u2013", [mark], hint=p.why or "")
    notes = [f"± {stderr}" if stderr else mark]
    relative = None
    if truth:
        relative = (p.value - truth) / truth
        notes.append(percent(relative))
    return b.Cell(value, notes, b.grade(relative), " ".join([*([p.why] if p.why else []), *estimate.notes]))


def percent(relative: float) -> str:
    """A relative deviation as people read it."""
    if abs(relative) < 5e-7:
        return "exact to 10⁻⁶"
    digits = max(0, min(5, 1 - math.floor(math.log10(abs(relative) * 100.0))))
    return f"{relative * 100.0:+.{digits}f} %".replace("-", MINUS)


def letter(index: int) -> str:
    """a, b, ... z, aa, ..."""
    return (letter(index // 26 - 1) if index >= 26 else "") + chr(ord("a") + index % 26)


def _sources(traces: Sequence[TraceResult], palette: Sequence[str], exact: str) -> b.Section:
    """exact : how one without a step moves."""
    cards = []
    for trace, color in zip(traces, palette, strict=True):
        step = f"{exact}, no step" if trace.dt_s is None else f"step {trace.dt_s * 1e3:.6g} ms"
        line = f"version {trace.version}, {step}" if trace.version else step
        cards.append(b.Card(trace.label, color, line, trace.ignored, settings_of(trace.settings)))
    blocks: list[b.Block] = [b.Cards(cards)]
    return b.Section("Engines, settings, and what is ignored", blocks)


def settings_of(settings: Mapping[str, Any]) -> dict[str, str]:
    """Each value as one line."""
    return {name: _setting(value) for name, value in settings.items()}


def _setting(value: object) -> str:
    if isinstance(value, float):
        return f"{value:.10g}"
    if isinstance(value, (list, tuple)):
        return " ".join(_setting(inner) for inner in value)
    return str(value)
