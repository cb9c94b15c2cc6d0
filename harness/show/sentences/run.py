"""What differs between the sources of a run, and why, in sentences with numbers."""

from collections.abc import Sequence

from harness.core.scenario import Scenario
from harness.results.run import TraceResult
from harness.show.headings import heading
from harness.show.sentences.decay import decay_sentences
from harness.show.sentences.words import AT_REST, mm

EXACT = 1e-5
"""A figure within this share of the exact one is called exact."""
MUCH = 0.1
"""Deviations above this share are said in whole percent."""
LIFTED = 1e-6
"""A box higher than this above where it rests, in m, has left the floor."""


def conclusions(traces: Sequence[TraceResult], scenario: Scenario) -> list[str]:
    """Sentences on every engine's trace, in their order; the exact reference, which comes first, needs none."""
    said = []
    for trace in traces[1:]:
        name = f"{trace.source} {trace.preset}"
        if trace.error is not None:
            said.append(f"{name} could not be run: {trace.error}")
            continue
        if scenario.action is None:
            found = decay_sentences(trace, scenario)
        else:
            found = [*_creep(trace), *_against(trace, traces[0])]
        if (trace.metrics.lift_m or 0.0) > LIFTED:
            found.append(f"the box leaves the floor, by at most {mm(trace.metrics.lift_m or 0.0)}.")
        found += [text for text in (position_error(trace),) if text is not None]
        said += [f"{name}: {text}" for text in found]
    return said


def _creep(trace: TraceResult) -> list[str]:
    """Whether it holds what it should hold."""
    creep, drift = trace.metrics.creep_m_s, (trace.metrics.model_extra or {}).get("drift_m")
    if creep is None:
        return []
    if abs(creep) > AT_REST:
        return [f"it does not hold but creeps at {mm(abs(creep))}/s, for as long as the load acts."]
    return ["it holds" + (f", and gives way by {mm(abs(drift))}." if drift is not None else ".")]


def _against(trace: TraceResult, reference: TraceResult) -> list[str]:
    """The figures that a scenario has of its own, each beside that of the exact motion."""
    exact = reference.metrics.model_extra or {}
    said = []
    for metric, value in (trace.metrics.model_extra or {}).items():
        true = exact.get(metric)
        if value is None or not true:
            continue
        about, off = heading(metric), value / true - 1.0
        shown = f"{about.head} {about.factor * value:.5g} {about.unit}".rstrip()
        if abs(off) < EXACT:
            said.append(f"{shown}, as in the exact motion")
        else:
            percent = f"{100.0 * off:+.0f}" if abs(off) >= MUCH else f"{100.0 * off:+.2g}"
            said.append(f"{shown}, exactly {about.factor * true:.5g} ({percent} %)")
    return ["; ".join(said) + "."] if said else []


def position_error(trace: TraceResult, angular: bool = False) -> str | None:
    """How far it is from the exact motion, an angle where it turns."""
    error = trace.metrics.max_error_m
    if error is None or trace.dt_s is None:
        return None
    return f"its position is at most {mm(error, angular)} from the exact one, at a step of {trace.dt_s * 1e3:.3g} ms."
