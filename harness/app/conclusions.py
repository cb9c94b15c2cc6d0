"""What differs between the sources of a run, and why, in sentences with numbers."""

from collections.abc import Callable, Sequence
from typing import TypeAlias

from harness.core.scenario import Scenario
from harness.results.run import TraceResult

SMEARED = 0.9
"""An estimate at the reversal below this share of the guarded one means that the jump is spread out."""
CLOSE = 0.02
"""Estimates within this share of the truth are right for most purposes."""
MEANS_TO_STICK = 1e-6
"""Creep below this speed in m/s is rest."""

Say: TypeAlias = Callable[[TraceResult, Scenario], str | None]


def conclusions(traces: Sequence[TraceResult], scenario: Scenario) -> list[str]:
    """Sentences on every engine's trace, in their order; the reference needs none."""
    said = []
    for trace in traces:
        if trace.source == "reference":
            continue
        name = f"{trace.source} {trace.preset}"
        if trace.error is not None:
            said.append(f"{name} could not be run: {trace.error}")
            continue
        said += [f"{name}: {text}" for say in _SAYERS if (text := say(trace, scenario)) is not None]
    return said


def _x_k(trace: TraceResult, method: str) -> float | None:
    estimate = trace.estimates.get(method)
    return None if estimate is None else estimate.x_k.value


def _friction(trace: TraceResult, scenario: Scenario) -> str | None:
    """Whether friction jumps at the reversal or is spread around it."""
    true, step, lead = scenario.slider.x_k, trace.dt_s, trace.metrics.reversal_lead_s
    guarded, local = _x_k(trace, "acceleration"), _x_k(trace, "acceleration-local")
    if true == 0.0 or guarded is None or local is None or step is None:
        return None
    numbers = (
        f"x_k is {_mm(local)} read at the reversal itself, {_mm(guarded)} read outside a guard, {_mm(true)} put in"
    )
    if abs(local) >= SMEARED * abs(guarded):
        return f"friction jumps at the reversal, as dry friction does: {numbers}."
    if lead is None or abs(lead) <= step:
        return f"friction reverses within one step of {step * 1e3:.3g} ms: {numbers}."
    return (
        "friction is no jump at the reversal but a steep, continuous function of the speed and of the acceleration to"
        f" come, and passes zero {lead * 1e3:.2g} ms before the speed does: {numbers}. The estimator at the reversal"
        " sees the last sample before it and the first after, between which only part of the jump 2 x_k has happened;"
        " away from the reversal the force is the right one."
    )


def _rest(trace: TraceResult, scenario: Scenario) -> str | None:
    """Whether it comes to rest."""
    creep, error = trace.metrics.creep_m_s, trace.metrics.rest_error_m
    if creep is None or error is None:
        return None
    if abs(creep) > MEANS_TO_STICK:
        return f"it never sticks, but creeps at {_mm(abs(creep))}/s towards where the spring is relaxed."
    return f"it comes to rest {_mm(abs(error))} from the exact place."


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
    also = (
        f", which also makes x_k read {_mm(x_k)} where {_mm(scenario.slider.x_k)} was put in" if wrong and x_k else ""
    )
    return f"zeta reads {found:.4f} where {true:.4f} was put in: {why}{also}."


def _position(trace: TraceResult, scenario: Scenario) -> str | None:
    """See position_error."""
    return position_error(trace)


def position_error(trace: TraceResult) -> str | None:
    """How far it is from the exact motion."""
    error = trace.metrics.max_error_m
    if error is None or trace.dt_s is None:
        return None
    return f"its position is at most {_mm(error)} from the exact one, at a step of {trace.dt_s * 1e3:.3g} ms."


_SAYERS: tuple[Say, ...] = (_friction, _damping, _rest, _position)


def _mm(metres: float) -> str:
    return f"{metres * 1e3:.3g} mm" if abs(metres) >= 1e-6 else "less than 0.001 mm"
