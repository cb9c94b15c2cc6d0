"""What differs between the sources of a run, and why, in sentences with numbers."""

from collections.abc import Sequence

from harness.core.scenario import Scenario
from harness.results.run import TraceResult
from harness.show.numbers import AT_REST, heading, mm

SMEARED = 0.9
"""An estimate at the reversal below this share of the guarded one means that the jump is spread out."""
CLOSE = 0.02
"""Estimates within this share of the truth are right for most purposes."""


def _x_k(trace: TraceResult, method: str) -> float | None:
    estimate = trace.estimates.get(method)
    return None if estimate is None else estimate.x_k.value


def _friction(trace: TraceResult, scenario: Scenario) -> str | None:
    """Whether friction jumps at the reversal or is spread around it."""
    true, step, lead = scenario.slider.x_k, trace.dt_s, trace.metrics.reversal_lead_s
    guarded, local = _x_k(trace, "acceleration"), _x_k(trace, "acceleration-local")
    if true == 0.0 or guarded is None or local is None or step is None:
        return None
    numbers = f"Estimated x_k: {mm(local)} at the reversal, {mm(guarded)} away from it (true: {mm(true)})"
    if abs(local) >= SMEARED * abs(guarded):
        return f"friction jumps at the reversal, as dry friction does. {numbers}."
    if lead is None or abs(lead) <= step:
        return f"friction reverses within one step of {step * 1e3:.3g} ms. {numbers}."
    return (
        f"friction is regularised: it ramps through zero {lead * 1e3:.2g} ms before the velocity reversal. {numbers}."
    )


def _rest(trace: TraceResult, scenario: Scenario) -> str | None:
    """Whether it comes to rest."""
    creep, error = trace.metrics.creep_m_s, trace.metrics.rest_error_m
    if creep is None or error is None:
        return None
    if abs(creep) > AT_REST:
        return f"it never sticks: it creeps at {mm(abs(creep))}/s towards the relaxed spring."
    return f"it comes to rest {mm(abs(error))} from the exact place."


def _damping(trace: TraceResult, scenario: Scenario) -> str | None:
    """Damping that the engine or its integrator adds."""
    estimate, true = trace.estimates.get("acceleration"), scenario.slider.zeta
    if estimate is None or estimate.zeta.value is None:
        return None
    found, x_k = estimate.zeta.value, estimate.x_k.value
    if abs(found - true) <= max(CLOSE * true, 1e-5):
        return None
    own = trace.settings.get("linearDamping")
    if isinstance(own, float) and own > 0.0 and found > true:
        why = f"its own linear damping of {own:g} (with a quadratic part) acts beside the damper"
    else:
        why = f"its integrator {'adds' if found > true else 'takes away'} damping"
    wrong = x_k is not None and abs(x_k - scenario.slider.x_k) > CLOSE * scenario.slider.x_k
    also = f"; it biases x_k too: {mm(x_k)} (true: {mm(scenario.slider.x_k)})" if wrong and x_k else ""
    return f"estimated zeta: {found:.4f} (true: {true:.4f}), because {why}{also}."


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
            found = [text for say in (_friction, _damping, _rest) if (text := say(trace, scenario)) is not None]
        else:
            found = [*_creep(trace), *_against(trace, traces[0])]
        if (trace.metrics.lift_m or 0.0) > LIFTED:
            found.append(f"it leaves what bears it, by at most {mm(trace.metrics.lift_m or 0.0)}.")
        if scenario.action is not None:
            found += filter(None, [position_error(trace)])
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
