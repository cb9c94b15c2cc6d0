"""The table of a run for people."""

from collections.abc import Callable

from harness.results.common import P
from harness.results.run import RunResult, TraceResult
from harness.show.numbers import heading
from harness.show.report.run import measured

Lines = list[list[str]]


def summary(result: RunResult) -> tuple[str, tuple[str, ...], Lines]:
    """What it shows, headings, and a line for every source."""
    if result.scenario.get("action") is None:
        turns = (result.scenario.get("model") or {}).get("restoring") == "pendulum"
        unit = "mrad" if turns else "mm"
        heads: tuple[str, ...] = (
            f"x_k {unit}", f"x_k at reversal {unit}", "zeta", f"error {unit}", f"creep {unit}/s", "stick s", "lead ms"
        )  # fmt: skip
        about = "x_k and zeta as the estimators read them; error, creep, rest and lead against the exact motion"
        return about, ("source", "step ms", *heads), [_line(trace, _decay) for trace in result.traces]
    shown = measured(result.traces, result.scenario)
    headings = [heading(metric) for metric in shown]

    def figures(trace: TraceResult) -> list[str]:
        found = trace.metrics.model_dump()
        return [_number(found.get(metric), one.factor) for metric, one in zip(shown, headings, strict=True)]

    heads = tuple(f"{one.head} {one.unit}".strip() for one in headings)
    about = "each figure beside that of the exact motion, which comes first"
    return about, ("source", "step ms", *heads), [_line(trace, figures) for trace in result.traces]


def _line(trace: TraceResult, figures: Callable[[TraceResult], list[str]]) -> list[str]:
    label = f"{trace.source} {trace.preset}"
    return [label, "failed"] if trace.error is not None else [label, _number(trace.dt_s, 1e3), *figures(trace)]


def _decay(trace: TraceResult) -> list[str]:
    guarded, local = trace.estimates.get("acceleration"), trace.estimates.get("acceleration-local")
    metrics = trace.metrics
    return [
        _estimate(guarded.x_k if guarded else None, 1e3),
        _estimate(local.x_k if local else None, 1e3),
        _estimate(guarded.zeta if guarded else None, 1.0),
        _number(metrics.max_error_m, 1e3),
        _number(metrics.creep_m_s, 1e3),
        _number(metrics.stick_time_s, 1.0),
        _number(metrics.reversal_lead_s, 1e3),
    ]


def _number(value: float | None, scale: float) -> str:
    return "-" if value is None else f"{value * scale:.4g}"


def _estimate(number: P | None, scale: float) -> str:
    return "-" if number is None else _number(number.value, scale)
