"""A diagnosis of a robot's joint in the words of the robot: its name, its torques, what to paste into its model."""

import math
from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from harness.app.diagnose.joint_case import JointCase
from harness.app.diagnose.joint_doubts import stands_for, surely
from harness.app.diagnose.result import Diagnosed
from harness.app.shared.parts import reduction_of
from harness.core.arrays import FloatArray, IntArray
from harness.core.quantity import Quantity
from harness.diagnosis.fit.model_fit import Fit
from harness.diagnosis.fit.standard_errors import plain_parameters
from harness.diagnosis.inverse_dynamics.asked import inverse_force
from harness.diagnosis.kinds.known import kind_of
from harness.diagnosis.outcome import Outcome
from harness.results.common import P
from harness.results.diagnosis import DiagnosisResult, FitResult
from harness.robot.arm import Arm
from harness.robot.coupling import Coupling
from harness.robot.paste import JointPaste
from harness.robot.recording import OneJoint

_CLEARLY = 2.0
"""Standard errors by which an inertia must be above the model's for a rotor to be pasted."""
_MULTIPLE = 2.0
"""Of the model's gravity or inertia, from which on a unit is in doubt."""
_NO_OFFSET = "not fitted beside where it hangs: a constant torque shifts that, and this log tells no more"
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
    curved = shapes(outcome)
    nearest = refined["f_k"], refined["c"]
    if curved:
        nearest = line(outcome, (refined["f_k"].unit, refined["c"].unit))
    paste = _paste(nearest, refined["inertia"], arm, found)
    terms = [entry.term.name for entry in outcome.refined.model.terms]
    left_out = [*paste.cannot_say("mjcf", terms), *paste.cannot_say("urdf", terms)]
    reduction = reduction_of(arm, found.reduced)
    update = {
        "statement": _statement(result.statement, refined, arm, found, one) + stands_for(*nearest, curved),
        "baseline": _with(result.baseline, base),
        "refined": _with(result.refined, refined),
        "mechanisms": [m.model_copy(update={"statement": f"{case.joint}: {m.statement}"}) for m in result.mechanisms],
        "robot": case.robot(paste, mode="locked", reduction=reduction, confounded=_confounded(found, one)),
        "model_left_out": [*result.model_left_out, *left_out],
        "warnings": [*one.warnings, *_scale(refined, found), *arm.notes, *result.warnings],
    }
    return result.model_copy(update=update), paste, nearest[0]


def _parameters(fitted: Fit, outcome: Outcome, one: OneJoint, explained: bool) -> dict[str, Quantity]:
    """inertia, c, f_k, offset; of a pendulum gravity and rest_angle, of a spring stiffness."""
    plain = plain_parameters(fitted, outcome.problem, outcome.scales.omega, explained)
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


def _statement(statement: str, fitted: Mapping[str, Quantity], arm: Arm, found: Coupling, one: OneJoint) -> str:
    own = found.reduced
    i = arm.index(own.joint)
    force = "N" if own.slides else "N m"
    said = [
        f"{own.joint}, the others still: {statement}",
        f"Its dry friction is {fitted['f_k']}, its damping {fitted['c']}; the model has frictionloss"
        f" {arm.frictionloss[i]:.4g} and damping {arm.damping[i]:.4g}.",
    ]
    if fitted["inertia"].stderr:
        said.append(f"Its inertia is {fitted['inertia']}, in the model {own.moved:.4g} with its rotor.")
    if "gravity" in fitted:
        rest = fitted.get("rest_angle")
        hangs = "" if rest is None or rest.value is None else f", and it hangs at {rest}, in the model {one.rest:.4g}"
        said.append(f"Gravity's torque is {fitted['gravity']}, in the model {own.gravity:.4g} {force}{hangs}.")
    return " ".join(said)


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


_PARTS = 10
"""Of a log, from whose differences the errors are taken."""
_MOVING = 0.05
"""Of the largest speed: slower samples do not count, where friction's sign is not known."""
_SURE = 2.0
_LOSING = ("friction", "damping")


def shapes(outcome: Outcome) -> tuple[str, ...]:
    """Names of the refined model's laws beside which f_k and c are coefficients."""
    terms = outcome.refined.model.terms
    return tuple(dict.fromkeys(one.term.name for one in terms if one.term.family in _LOSING))


def line(outcome: Outcome, units: tuple[str, str]) -> tuple[Quantity, Quantity]:
    """Dry friction and damping that come nearest to what the joint loses, with errors from tenths of the log.

    Alone where the other is not surely above none: no robot's model takes less.
    """
    model = outcome.refined.model
    bare = replace(model, c=0.0, f_k=0.0, f_s=None).with_terms(
        *(one for one in model.terms if one.term.family not in _LOSING)
    )
    left = kind_of(outcome.problem).left_over(outcome.problem, outcome.refined, outcome.scales)
    t, x, v = left.t, left.at_x, left.at_v
    still = np.zeros_like(v)
    lost = inverse_force(model, t, x, v, still) - inverse_force(bare, t, x, v, still) + model.m * left.force
    kept = np.isfinite(lost) & (np.abs(v) > _MOVING * float(np.nanmax(np.abs(v))))
    columns = np.column_stack((np.sign(v), v, np.ones_like(v)))[kept]
    found, errors = _fitted(columns, lost[kept])
    unsure = next((i for i in (1, 0) if found[i] < _SURE * errors[i]), None)
    if unsure is not None:
        rest = [i for i in range(found.size) if i != unsure]
        found[unsure], errors[unsure] = 0.0, math.inf
        found[rest], errors[rest] = _fitted(columns[:, rest], lost[kept])
    return Quantity(float(found[0]), float(errors[0]), units[0]), Quantity(float(found[1]), float(errors[1]), units[1])


def _fitted(columns: FloatArray, y: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Numbers and standard errors (p,) of columns (n, p) in y (n,)."""
    rows: IntArray = np.arange(y.size)
    without = np.array(
        [
            np.linalg.lstsq(columns[others], y[others], rcond=None)[0]
            for others in (np.setdiff1d(rows, part) for part in np.array_split(rows, _PARTS))
        ]
    )
    spread = np.sum((without - without.mean(axis=0)) ** 2, axis=0)
    found = np.linalg.lstsq(columns, y, rcond=None)[0]
    errors = np.sqrt((_PARTS - 1) / _PARTS * spread)
    return np.asarray(found, dtype=np.float64), np.asarray(errors, dtype=np.float64)
