"""Whether a joint's friction is known well enough to be called adequate, and what its slips say of break-away."""

import math
from collections.abc import Iterator, Sequence

from harness.core.quantity import Quantity
from harness.model.terms import static_friction
from harness.results.common import P, Where
from harness.results.diagnosis import DiagnosisResult, MechanismResult
from harness.results.robot import SimulatedResult
from harness.robot.recording import Slips

_KNOWN = 0.3
"""Share of dry friction to which it is known, at least, where it is much of the torque."""
_MUCH = 0.02
"""Of the torque's standard deviation: a smaller error of dry friction does not matter, whatever share it is."""
_FEW = "too few for their errors to be trusted"
_SURE = 2.0


def surely(found: Quantity) -> float:
    """A friction's value where that is two standard errors above none, else 0: that is pasted."""
    value, error = found.value or 0.0, found.stderr or 0.0
    return value if value > max(_SURE * error, 0.0) else 0.0


def stands_for(f_k: Quantity, c: Quantity, names: Sequence[str]) -> str:
    """A sentence, a blank before it, on the line that is pasted in place of laws that no model has; "" without any."""
    if not names:
        return ""
    dry, viscous = (str(q) if surely(q) else "none" for q in (f_k, c))
    return (
        f" Pasted is the line that comes nearest: dry friction {dry} and damping {viscous} stand for"
        f" {', '.join(names)} at the speeds and loads of this log."
    )


def with_forward_run(result: DiagnosisResult, simulated: Sequence[SimulatedResult]) -> DiagnosisResult:
    """The result with what the copy does in engines, and the sentence that belongs to one that makes it worse."""
    assert result.robot is not None
    worse = [one for one in simulated if one.after.get("x", 0.0) > one.before.get("x", math.inf)]
    update: dict[str, object] = {"simulated": list(simulated)}
    said = result.statement
    if worse:
        one = worse[0]
        warning = (
            f"Do not paste this yet: driven by the log's torque it moves worse than the file as it is ({one.engine}:"
            f" x {one.after['x']:.3g} against {one.before['x']:.3g} rms)."
        )
        update["paste"] = result.robot.paste.model_copy(update={"warning": warning})
        said = f"{said} {warning}"
    return result.model_copy(update={"robot": result.robot.model_copy(update=update), "statement": said})


def doubted(
    result: DiagnosisResult,
    outcome: str,
    found: Slips | None,
    sliding: Quantity,
    simulated: Sequence[SimulatedResult],
    torque: float,
) -> DiagnosisResult:
    """The result with the break-away that slips show, and never adequate where the log does not say that much.

    outcome : the sentence of the fit's own verdict. sliding : dry friction as it slides. torque : standard deviation of
    the log's, N m or N.
    """
    assert result.robot is not None
    slipping = None if found is None else breaking(found, sliding)
    reasons = list(_reasons(result, simulated, torque))
    update: dict[str, object] = {}
    said = outcome
    if reasons and result.verdict == "adequate":
        update["verdict"] = "unexplained"
        said = f"Viscous and Coulomb friction are not shown to be enough: {'; '.join(reasons)}."
    if slipping is not None:
        update["mechanisms"] = [slipping, *result.mechanisms]
        if result.verdict == "adequate":
            update["verdict"] = "main_effect"
        said = f"{slipping.statement} {said}"
    update["statement"] = result.statement.replace(outcome, said, 1)
    return result.model_copy(update=update)


def breaking(found: Slips, sliding: Quantity | None) -> MechanismResult | None:
    """Static friction, where the torques before slips are surely above what the joint slides with.

    sliding : None where the joint slides too shortly for it to be told.
    """
    broken = found.break_away
    if broken is None or broken.value is None:
        return None
    more = ", too shortly each time for what it slides with to be told"
    if sliding is not None:
        more = ", more than it slides with"
        error = math.hypot(broken.stderr or 0.0, sliding.stderr or 0.0)
        if sliding.value is None or broken.value - sliding.value < _SURE * error:
            return None
    return MechanismResult(
        name=static_friction.TERM.name,
        family=static_friction.TERM.family,
        statement=(
            f"It stands still {found.still:.0%} of the time and breaks away {found.torques.size} times at"
            f" {broken}{more}."
        ),
        parameters={"f_s": P.of(broken)},
        grade="main",
        delta_bic=0.0,
        where=Where(time_s=[], regime="stick", condition="v = 0", share=None),
        alternatives=[],
    )


def _reasons(result: DiagnosisResult, simulated: Sequence[SimulatedResult], torque: float) -> Iterator[str]:
    """Why a fit that leaves nothing is not enough."""
    fit = None if result.fit_percent is None else result.fit_percent.refined.get("x")
    if fit is not None and fit < 0.0:
        yield f"the fitted model does not follow the log (fit of x {fit:.0f} %)"
    if any(one.after.get("x", 0.0) > one.before.get("x", math.inf) for one in simulated):
        yield "what is pasted moves worse than the file as it is"
    f_k = result.refined.parameters["f_k"]
    if f_k.value is not None and f_k.stderr and f_k.stderr > max(_KNOWN * abs(f_k.value), _MUCH * torque):
        yield f"its dry friction is known to {f_k.stderr / max(abs(f_k.value), 1e-300):.0%} only"
    if any(_FEW in line for line in result.warnings):
        yield "few samples count"
