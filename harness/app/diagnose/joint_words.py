"""A diagnosis of a robot's joint in the words of the robot: its name, its torques, what to paste into its model.

Whether a joint's friction is known well enough to be called adequate, and what its slips say of break-away.
"""

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace

import numpy as np

from harness.app.diagnose.joint_case import JointCase
from harness.app.diagnose.result import Diagnosed
from harness.app.shared.parts import reduction_of
from harness.core.arrays import FloatArray
from harness.core.quantity import Quantity, outweighs
from harness.diagnosis.explain.could_hide import with_systematic
from harness.diagnosis.fit.model_fit import Fit
from harness.diagnosis.fit.standard_errors import plain_parameters
from harness.diagnosis.kinds.known import kind_of
from harness.diagnosis.outcome import Outcome
from harness.diagnosis.problems.asked import inverse_force
from harness.model.terms import static_friction
from harness.results.common import P, Where
from harness.results.diagnosis import DiagnosisResult, FitResult, MechanismResult
from harness.results.robot import CurveResult, SimulatedResult
from harness.robot.arm import Arm
from harness.robot.friction_curve import FrictionCurve, of_series
from harness.robot.paste import JointPaste
from harness.robot.recording import Coupling, OneJoint, Slips

_KNOWN = 0.3
"""Share of dry friction to which it is known, at least, where it is much of the torque."""
_MUCH = 0.02
"""Of the torque's standard deviation: a smaller error of dry friction does not matter, whatever share it is."""
_FEW = "too few for their errors to be trusted"
_SURE = 2.0
"""Standard errors above none from which a friction is there."""


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
        f" Pasted is the nearest straight line: dry friction {dry} and damping {viscous} in place of"
        f" {', '.join(names)} at the speeds and loads of this log."
    )


_SHOWN = 3
"""Speeds at which a sentence says friction."""


def of_curve(found: FrictionCurve) -> str:
    """A sentence on a friction curve: a few of its points, mean of both directions, and the law that says it best."""
    back, on = np.split(np.arange(found.v.size), 2)
    at = np.unique(np.linspace(0, on.size - 1, _SHOWN).round().astype(int))
    size = (found.friction[on] - found.friction[back[::-1]]) / 2.0
    speed = "rad/s" if "m" in found.unit else "m/s"
    points = [
        f"{Quantity(float(size[k]), float(found.error[on[k]]), found.unit)} at {found.v[on[k]]:.2g} {speed}" for k in at
    ]
    best = found.laws[0]
    uneven = float(np.max(np.abs(found.friction[on] + found.friction[back[::-1]]) / np.maximum(size, 1e-300))) / 2.0
    apart = " It differs between the directions." if found.apart < _DIFFER and uneven > _UNEVEN else ""
    sure = [one for one in found.changes if one.surely]
    more = f" It changes with {' and '.join(f'{one.what} ({one.by})' for one in sure)}." if sure else ""
    return f"Friction is {', '.join(points)}; {best.name} says it best (P {best.probability:.2f}).{apart}{more}"


_DIFFER = 0.001
"""Probability by chance alone below which the directions are said to differ."""
_UNEVEN = 0.02
"""Of friction: a smaller difference of a direction from the mean of both is less than two logs of one robot differ by,
3 to 8 % as mujoco.sysid's authors repeat it."""


def with_forward_run(result: DiagnosisResult, simulated: Sequence[SimulatedResult]) -> DiagnosisResult:
    """The result with what the copy does in engines, and the sentence that belongs to one that makes it worse."""
    assert result.robot is not None
    worse = [one for one in simulated if one.after.get("x", 0.0) > one.before.get("x", math.inf)]
    update: dict[str, object] = {"simulated": list(simulated)}
    said = result.statement
    if worse:
        one = worse[0]
        whose = one.joint or "it"
        warning = (
            f"Do not paste this yet: driven by the log's torque {whose} moves worse than the file as it is"
            f" ({one.engine}: x {one.after['x']:.3g} against {one.before['x']:.3g} rms)."
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
    more = ", too shortly each time to see its sliding friction"
    if sliding is not None:
        more = ", more than its sliding friction"
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


_CLEARLY = 2.0
"""Standard errors by which an inertia must be above the model's for a rotor to be pasted."""
_MULTIPLE = 2.0
"""Of the model's gravity or inertia, from which on a unit is in doubt."""
_NO_OFFSET = "not fitted: a constant torque shifts the rest angle, and this log shows no more"
_GIVEN = "the robot's model gives it: no torque was measured"
_UNSEEN = "the torque does not show it: taken as large as it could be unseen"
_FREE = "not fitted: a constant force is tried as a mechanism of its own"


def named(
    done: Diagnosed, case: JointCase, found: Coupling, one: OneJoint
) -> tuple[DiagnosisResult, JointPaste, Quantity]:
    """The result with the joint's parameters, sentences and text to paste, that text's numbers, and dry friction as it
    slides."""
    result, outcome, arm = done.result, done.outcome, case.arm
    base = _parameters(outcome.base, outcome, one, outcome.verdict == "adequate")
    refined = _parameters(outcome.refined, outcome, one, outcome.verdict != "unexplained")
    curved, over_speed = shapes(outcome), friction_over_speed(outcome, (refined["f_k"].unit, refined["c"].unit))
    nearest = refined["f_k"], refined["c"]
    if curved and over_speed is not None:
        nearest = over_speed.line
    paste = _paste(nearest, refined["inertia"], arm, found)
    terms = [entry.term.name for entry in outcome.refined.model.terms]
    left_out = [*paste.cannot_say("mjcf", terms), *paste.cannot_say("urdf", terms)]
    reduction = reduction_of(arm, found.reduced)
    update = {
        "statement": _statement(result.statement, refined, arm, found.reduced.joint, outcome.verdict == "adequate"),
        "baseline": _with(result.baseline, base),
        "refined": _with(result.refined, refined),
        "curve": None
        if over_speed is None
        else CurveResult.model_validate(_with_rest(over_speed, result.mechanisms, refined["f_k"])),
        "mechanisms": [m.model_copy(update={"statement": f"{case.joint}: {m.statement}"}) for m in result.mechanisms],
        "robot": case.robot(paste, mode="locked", reduction=reduction, confounded=_confounded(found, one)),
        "model_left_out": [*result.model_left_out, *left_out],
        "warnings": [
            *([pasted.strip()] if (pasted := stands_for(*nearest, curved)) else []),
            *one.warnings,
            *_scale(refined, found),
            *_beside(refined, found, one),
            *arm.notes,
            *result.warnings,
        ],
    }
    return result.model_copy(update=update), paste, nearest[0]


def _with_rest(curve: FrictionCurve, named: Sequence[MechanismResult], f_k: Quantity) -> FrictionCurve:
    """The curve with what the named laws say of rest: what breaks the joint away, and how far it gives before."""
    own = {k: Quantity(p.value, p.stderr, p.unit, p.why) for one in named for k, p in one.parameters.items()}
    bristle, far = own.get("sigma0"), curve.presliding
    if bristle is not None and bristle.value and f_k.value:
        size, errors = f_k.value / bristle.value, ((p.stderr or 0.0) / (p.value or math.inf) for p in (bristle, f_k))
        far = Quantity(size, size * math.hypot(*errors), "m" if f_k.unit == "N" else "rad")
    return replace(curve, break_away=own.get("f_s", curve.break_away), presliding=far)


def _parameters(fitted: Fit, outcome: Outcome, one: OneJoint, explained: bool) -> dict[str, Quantity]:
    """inertia, c, f_k, offset; of a pendulum gravity and rest_angle, of a spring stiffness."""
    told = plain_parameters(fitted, outcome.problem, outcome.scales.omega, explained)
    # what is missing beside the base model is no shift of its numbers
    plain = with_systematic(told, outcome.shifts if outcome.verdict == "adequate" or fitted.model.terms else {})
    torque = plain["f_k"].unit
    named = {"inertia": plain["m"], "c": plain["c"], "f_k": plain["f_k"]}
    if plain["m"].stderr is None:
        named["inertia"] = replace(plain["m"], why=_UNSEEN if one.driven else _GIVEN)
    pendulum = one.restoring == "pendulum"
    named["offset"] = Quantity.refused(torque, _NO_OFFSET if one.restoring != "none" else _FREE)
    if "k" in plain:
        named["gravity" if pendulum else "stiffness"] = replace(plain["k"], unit=torque) if pendulum else plain["k"]
    if pendulum and "offset" in plain:
        zero = plain["offset"]
        named["rest_angle"] = replace(zero, value=None if zero.value is None else one.rest + zero.value)
    return named


def _with(fitted: FitResult, more: Mapping[str, Quantity]) -> FitResult:
    """The fit with these parameters first; the mass of a free axis has the joint's name for it."""
    own = {name: P.of(quantity) for name, quantity in more.items()}
    kept = {name: p for name, p in fitted.parameters.items() if name not in ("mass", *own)}
    return fitted.model_copy(update={"parameters": {**own, **kept}})


def _paste(nearest: tuple[Quantity, Quantity], inertia: Quantity, arm: Arm, found: Coupling) -> JointPaste:
    """Friction that is surely there; a rotor where the inertia is clearly more than the model's, else the file's."""
    own = found.reduced
    armature = own.armature
    if inertia.value is not None and inertia.stderr and inertia.value - own.moved > _CLEARLY * inertia.stderr:
        armature = inertia.value - own.inertia
    f_k, c = map(surely, nearest)
    return JointPaste(own.joint, f_k, c, armature, float(arm.model.opt.timestep))


def _statement(statement: str, fitted: Mapping[str, Quantity], arm: Arm, joint: str, adequate: bool) -> str:
    i = arm.index(joint)
    own = f"{arm.frictionloss[i]:.4g} and {arm.damping[i]:.4g}"
    f_k, c = fitted["f_k"], fitted["c"]
    by = [f"{q.systematic:.2g} {q.unit}" for q in (f_k, c) if outweighs(q.systematic, q.stderr)]
    which = "them" if len(by) == 2 else "it"
    hidden = f" What could hide would shift {which} by up to {' and '.join(by)}." if by and adequate else ""
    return f"{joint}: dry friction {f_k}, damping {c} (in the model {own}).{hidden} {statement}"


def _beside(fitted: Mapping[str, Quantity], found: Coupling, one: OneJoint) -> list[str]:
    """Inertia and gravity, where they are fitted, next to the model's."""
    own, said = found.reduced, []
    if fitted["inertia"].stderr:
        said.append(f"Inertia {fitted['inertia']}, in the model {own.moved:.4g} with the rotor.")
    if "gravity" in fitted:
        rest, force = fitted.get("rest_angle"), "N" if own.slides else "N m"
        angle = "" if rest is None or rest.value is None else f"; rest angle {rest}, in the model {one.rest:.4g}"
        said.append(f"Gravity torque {fitted['gravity']}, in the model {own.gravity:.4g} {force}{angle}.")
    return said


def _scale(fitted: Mapping[str, Quantity], found: Coupling) -> list[str]:
    """A torque that is a multiple of the model's: the unit of the effort, or the model."""
    own = found.reduced
    known = {"gravity": own.gravity, "inertia": own.moved}
    name = "gravity" if "gravity" in fitted else "inertia"
    value = fitted[name].value
    if (
        value is None
        or not fitted[name].stderr
        or known[name] <= 0.0
        or 1.0 / _MULTIPLE < value / known[name] < _MULTIPLE
    ):
        return []
    times = value / known[name]
    rotor = "the model lacks a rotor's inertia (armature), " if name == "inertia" and times > 1.0 else ""
    return [
        f"{name} is {times:.3g} times the model's: {rotor}the effort is in another unit (--gain is N m per A), or the"
        f" model is not that of this {own.joint}"
    ]


def _confounded(found: Coupling, one: OneJoint) -> list[list[str]]:
    """What one joint's log cannot tell apart by theory."""
    if not one.driven:
        # a free swing shows accelerations alone: every torque is as large as the inertia is taken to be
        return [[name, "inertia"] for name in ("f_k", "c", "gravity" if one.restoring == "pendulum" else "stiffness")]
    pairs = [["f_k", "motor-constant"], ["inertia", "armature"]]
    if one.restoring == "pendulum":
        pairs += [["c", "torque-delay"], ["offset", "rest_angle"]]
    return pairs


_MOVING = 0.05
"""Of the largest speed: slower samples do not count, where friction's sign is not known."""
_LOSING = ("friction", "damping")


def shapes(outcome: Outcome) -> tuple[str, ...]:
    """Names of the refined model's laws beside which f_k and c are coefficients."""
    terms = outcome.refined.model.terms
    return tuple(dict.fromkeys(one.term.name for one in terms if one.term.family in _LOSING))


def friction_over_speed(outcome: Outcome, units: tuple[str, str]) -> FrictionCurve | None:
    """What the joint loses over its speed, as the fit and what it leaves say."""
    _, v, lost = losses(outcome)
    return of_series(v, lost, units)


def losses(outcome: Outcome) -> tuple[FloatArray, FloatArray, FloatArray]:
    """t, speed and torque (m,) of friction where the joint surely moves."""
    model = outcome.refined.model
    bare = replace(model, c=0.0, f_k=0.0, f_s=None).with_terms(
        *(one for one in model.terms if one.term.family not in _LOSING)
    )
    left = kind_of(outcome.problem).left_over(outcome.problem, outcome.refined, outcome.scales)
    t, x, v = left.t, left.at_x, left.at_v
    still = np.zeros_like(v)
    lost = inverse_force(model, t, x, v, still) - inverse_force(bare, t, x, v, still) + model.m * left.force
    kept = np.isfinite(lost) & (np.abs(v) > _MOVING * float(np.nanmax(np.abs(v))))
    return t[kept], v[kept], lost[kept]
