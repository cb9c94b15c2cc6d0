"""The entry: friction of the joints of an arm that moves as a whole."""

import math
from collections.abc import Iterator, Sequence

import mujoco
import numpy as np

from harness.core.arrays import FloatArray
from harness.core.checks import not_negative
from harness.core.errors import InputError
from harness.core.quantity import Quantity
from harness.core.robot.joint_log import JointLog
from harness.robot.arm import Arm
from harness.robot.whole_arm.columns import (
    ARMATURE,
    ASYMMETRIC,
    DELAY,
    DRIFT,
    FRICTION,
    INERTIA,
    LOAD,
    LOAD_OR_POSITION,
    MOTOR,
    PAYLOAD,
    POSITION,
    QUADRATIC,
    RIPPLE,
    SENSOR,
    STRIBECK,
    TILT,
)
from harness.robot.whole_arm.correct import Solved, solve, total
from harness.robot.whole_arm.design import Design, Part, Whitened
from harness.robot.whole_arm.perturb import with_load, without_armature
from harness.robot.whole_arm.prepare import Known, Problem
from harness.robot.whole_arm.result import Effect, Grade, JointFriction, Left, ModelError, WholeArm
from harness.robot.whole_arm.rules import (
    EXPLAINED,
    MAIN,
    RIVAL,
    RULES,
    SAID_BETTER,
    TOLD_DELAY,
    TOLD_GRAVITY,
    UNSMOOTHED,
    WITHIN,
)
from harness.robot.whole_arm.search import Chosen, left_over, of_joint, rms
from harness.robot.whole_arm.turning import BACKLASH, PRESLIDING, STATIC, Turned, at_reversals

_NOTHING = 1e-9
"""N m or N: gravity below it is rounding."""


def confounded(problem: Problem, known: Known) -> tuple[tuple[str, str], ...]:
    """Pairs of names, with the joint where it is one joint's."""
    found: list[tuple[str, str]] = []
    if not known.gain:
        found.append((MOTOR, INERTIA))
    if not known.sensor:
        found.append(("Coulomb friction of the gearbox", SENSOR))
    filtered = problem.filtered
    for j, (name, part) in enumerate(zip(filtered.joints, problem.parts, strict=True)):
        gravity = problem.gravity[:, j]
        if np.max(np.abs(gravity)) > _NOTHING and _shown(part, TOLD_GRAVITY.value * gravity) < RIVAL.value:
            found.append((f"offset of {name}", "gravity"))
        change = np.gradient(problem.rigid[:, j], 1.0 / filtered.out.rate)
        if _shown(part, TOLD_DELAY.value * change) < RIVAL.value:
            found.append((f"viscous friction of {name}", DELAY))
    return tuple(found)


def load_is_position(problem: Problem, joint: int, share: float) -> bool:
    """Whether a joint's load is a function of its own position, as far as friction of this share of it shows.

    Alone in its plane a joint carries a sine of its angle, and nothing tells what friction follows.
    """
    gravity, angle = problem.gravity[:, joint], problem.filtered.q[:, problem.filtered.dof[joint]]
    own = np.stack((np.ones_like(angle), np.sin(angle), np.cos(angle)), axis=1)
    fitted = own @ np.linalg.lstsq(own, gravity, rcond=None)[0]
    part = problem.parts[joint]
    return _shown(part, share * part.base[:, 0] * (np.abs(gravity) - np.abs(fitted))) < RIVAL.value


def _shown(part: Part, torque: FloatArray) -> float:
    """Gain that this torque (m,) would bring beyond Coulomb, viscous and offset."""
    base, added = part.white(part.base), part.white(torque)
    left = added - base @ np.linalg.lstsq(base, added, rcond=None)[0]
    return float(left @ left)


_EFFECTS = {
    STRIBECK: "Friction falls with speed: by {0} more at rest than when it slides, over {1}.",
    LOAD: "Friction grows with the joint's load: {0} of the torque of gravity.",
    ASYMMETRIC: "Viscous friction differs between the directions: by {0} on either side.",
    QUADRATIC: "Drag grows with the square of the speed: {0}.",
    DRIFT: "Friction changes during the log: Coulomb by {0}, viscous by {1}.",
    RIPPLE: "The torque ripples with the position: {0} and {1} (sine and cosine), {2}.",
    POSITION: "Coulomb friction depends on the position: {0} and {1} (sine and cosine), {2}.",
    PRESLIDING: "After a reversal friction builds up over a distance: {0} over {1}.",
    STATIC: "Friction is higher at the moment of reversal: by {0}, below {1}.",
    BACKLASH: "After a reversal the load is missing: {0} of it.",
}
_ERRORS = {
    INERTIA: "Masses of the model are off, by shares of {all}",
    PAYLOAD: "There is {0} more at the end of the arm than the model has",
    MOTOR: "The torque is scaled: by {0} more than it says",
    DELAY: "The torque is late by {0}",
    SENSOR: "The sensor does not see the rotors: {0} of their inertia is missing in the torque",
    TILT: "The base is tilted: by {0} about x and {1} about y",
    ARMATURE: "The inertia about the joint's axis is off by {0}",
}


def of_effect(name: str, parameters: Sequence[tuple[str, Quantity]], rivals: Sequence[str], pair: str = "") -> str:
    """One sentence about an effect, a second one where others do nearly as well, or can never be told from it."""
    said = _with_rivals(_filled(_EFFECTS.get(name, "{all}"), parameters), rivals)
    return f"{said} It stands for the pair: {pair}; this log cannot tell which." if pair else said


def of_error(
    name: str, joint: str | None, parameters: Sequence[tuple[str, Quantity]], partner: str, rivals: Sequence[str]
) -> str:
    """One sentence about an error of the model, with what it cannot be told from."""
    said = _filled(_ERRORS[name], parameters)
    where = f" ({joint})" if joint else ""
    beside = f", or it is the {partner}: no log of this kind can tell." if partner else "."
    return _with_rivals(f"{said}{where}{beside}", rivals)


def of_base(joint: str, coulomb: Quantity, viscous: Quantity, held_out: tuple[float, float], unit: str) -> str:
    """What a joint's friction is, and how well it predicts."""
    before, after = held_out
    better = f", {after:.3g} {unit} with what is named" if after < SAID_BETTER.value * before else ""
    return (
        f"{joint}: Coulomb friction {coulomb}, viscous friction {viscous}; it leaves {before:.3g} {unit} of torque that"
        f" was not fitted{better}."
    )


def _filled(said: str, parameters: Sequence[tuple[str, Quantity]]) -> str:
    everything = ", ".join(f"{name} {value}" for name, value in parameters)
    return said.format(*(str(value) for _, value in parameters), *["an unknown amount"] * 3, all=everything)


def _with_rivals(said: str, rivals: Sequence[str]) -> str:
    if not rivals:
        return said
    return f"{said} {' or '.join(rivals)} would explain it nearly as well."


LINK, MOTOR_SIDE = "link", "motor"
_STILL = "the joint does not move to and fro enough"


def whole_arm(
    log: JointLog,
    arm: Arm,
    *,
    joints: Sequence[str] | None = None,
    payload: float | None = None,
    sensor: str | None = None,
    lowpass: float | None = None,
    gain_known: bool = False,
) -> WholeArm:
    """Friction of every joint from a log in which the whole arm moves.

    Parameters
    ----------
    joints : those to look at, by default every one logged with effort.
    payload : kg at the centre of mass of the last body, where it is known; 0 for none.
    sensor : "link" behind the gearbox, which does not see rotors, "motor" before it, None where that is not known.
    lowpass : Hz of the filter, by default chosen from the motion.
    gain_known : the scale of the torque is to be trusted (a motor constant and gear ratio that were measured).

    Raises InputError for a log without effort, of less than three seconds, in which nothing moves, or with a joint that
    the arm has not; and for a payload, sensor or lowpass that cannot be.
    """
    if sensor not in (None, LINK, MOTOR_SIDE):
        raise InputError("sensor", repr(sensor), f"{LINK} or {MOTOR_SIDE} is accepted")
    if payload is not None and not_negative("payload", payload, "kg") > 0.0:
        arm = with_load(arm, payload)
    if sensor == LINK:
        arm = without_armature(arm)
    known = Known(payload is not None, sensor is not None, gain_known)
    solved = solve(log, arm, joints, lowpass, known)
    return _result(solved, arm, known)


def _result(solved: Solved, arm: Arm, known: Known) -> WholeArm:
    filtered, design = solved.problem.filtered, solved.model.design
    covariance = design.covariance()
    turned = list(at_reversals(solved))
    plain = Design(solved.first.parts, ())
    before, spread = rms(plain, solved.first.filtered.t), plain.covariance()
    after = rms(design, filtered.t)
    found = {}
    for j, name in enumerate(filtered.joints):
        words = _Units(arm, filtered.dof[j])
        gain = _gain(solved, j)
        place = design.places[j]
        coulomb, viscous, offset = _base(design.numbers[place], covariance, place, gain, words)
        first = _base(plain.numbers[plain.places[j]], spread, plain.places[j], 1.0, words)
        left = left_over(design, j)[0][design.parts[j].stretches.kept]
        remainder = _over_noise(left, float(filtered.torque_noise[j]), filtered.torque[:, j])
        sharper = any(one.joint == j and one.of_stribeck for one in turned)
        effects = (*_effects(solved, j, covariance, remainder, words, sharper), *_turned(turned, j, remainder, words))
        held_out = (float(before[j]), float(after[j]))
        statement = of_base(name, coulomb, viscous, held_out, words.of("N m"))
        samples = int(np.sum(design.parts[j].stretches.kept))
        guard = float(solved.problem.guard[j])
        found[name] = JointFriction(
            name, coulomb, viscous, offset, effects, held_out, remainder, guard, samples, statement, first,
            _left(solved, plain, j), _line(solved, j, gain, spread[plain.places[j], plain.places[j]], words),
        )  # fmt: skip
    for name in solved.still:
        words = _Units(arm, arm.joints.index(name))
        refused = [Quantity.refused(words.of(unit), _STILL) for unit in ("N m", "N m s/rad", "N m")]
        said = f"{name}: {_STILL} to tell its friction."
        found[name] = JointFriction(name, refused[0], refused[1], refused[2], (), None, None, None, 0, said)
    return WholeArm(
        tuple(found[name] for name in arm.joints if name in found),
        tuple(_errors(solved, covariance)),
        confounded(solved.problem, known),
        solved.model.left_out,
        filtered.band.lowpass,
        filtered.out.rate,
        filtered.seconds,
        RULES,
        (*filtered.notes, *_holds(solved, covariance)),
    )


def _base(
    numbers: FloatArray, covariance: FloatArray, place: slice, gain: float, words: "_Units"
) -> tuple[Quantity, Quantity, Quantity]:
    """Coulomb, viscous and offset of a joint, with their errors."""
    units = ("N m", "N m s/rad", "N m")
    errors, numbers = np.sqrt(np.diag(covariance)[place])[: len(units)], numbers[: len(units)]
    first, second, third = (
        Quantity(float(x / gain), float(e / gain), words.of(unit))
        for x, e, unit in zip(numbers, errors, units, strict=True)
    )
    return first, second, third


def _line(
    solved: Solved, joint: int, gain: float, covariance: FloatArray, words: "_Units"
) -> tuple[Quantity, Quantity]:
    """The line through a joint's friction over its speed, at the guarded samples; covariance : of the base alone.

    Numbers of columns that nearly cancel mean nothing by themselves; what they come to at these speeds and loads does.
    """
    design = solved.model.design
    part, place = design.parts[joint], design.places[joint]
    friction = part.base[:, :2] @ design.numbers[place][:2]
    for chosen in of_joint(solved.model.chosen, joint):
        candidate = chosen.named.candidate
        columns = candidate.settings[chosen.named.setting].columns[joint]
        friction = friction + columns @ design.numbers[_place(design, chosen)]
    kept = part.stretches.kept
    errors = np.sqrt(np.diag(covariance)) / abs(gain)
    found = np.linalg.lstsq(part.base[kept, :3], friction[kept], rcond=None)[0] / gain
    if found[1] < 2.0 * errors[1]:
        # no model takes a damping below none: then dry friction is what stands for all of it
        found[[0, 2]] = np.linalg.lstsq(part.base[kept][:, [0, 2]], friction[kept], rcond=None)[0] / gain
    units = ("N m", "N m s/rad")
    first, second = (Quantity(float(found[i]), float(errors[i]), words.of(unit)) for i, unit in enumerate(units))
    return first, second


def _left(solved: Solved, plain: Design, joint: int) -> Left:
    """What is left of a joint's torque, by its base and by the model, where both are guarded."""
    filtered, design = solved.problem.filtered, solved.model.design
    kept = design.parts[joint].stretches.kept & plain.parts[joint].stretches.kept
    dof = filtered.dof[joint]
    before, after = (left_over(one, joint)[0][kept] for one in (plain, design))
    return Left(filtered.t[kept], filtered.q[kept, dof], filtered.v[kept, dof], before, after)


def _over_noise(left: FloatArray, noise: float, torque: FloatArray) -> float | None:
    """Rms of what is left over that of the noise; None where the record was smoothed and shows no noise."""
    if noise < UNSMOOTHED.value * math.sqrt(float(np.mean(torque**2))):
        return None
    return math.sqrt(float(np.mean(left**2))) / noise


class _Units:
    """Units of a hinge, or of a slide."""

    def __init__(self, arm: Arm, dof: int) -> None:
        joint = int(arm.model.dof_jntid[dof])
        self._slide = int(arm.model.jnt_type[joint]) == int(mujoco.mjtJoint.mjJNT_SLIDE)

    def of(self, unit: str) -> str:
        return unit.replace("N m", "N").replace("rad", "m") if self._slide else unit


def _gain(solved: Solved, joint: int) -> float:
    """Measured over true torque of a joint, as the model has it."""
    design, gain = solved.model.design, 1.0
    for one, place in zip(design.named, design.places[len(design.parts) :], strict=True):
        if one.candidate.name == MOTOR and one.candidate.joint in (joint, None):
            gain += float(design.numbers[place][0])
    return gain


def _place(design: Design, chosen: Chosen) -> slice:
    """Where the numbers of what was chosen stand."""
    i = [one.candidate.key for one in design.named].index(chosen.named.candidate.key)
    return design.places[len(design.parts) + i]


def _effects(
    solved: Solved, joint: int, covariance: FloatArray, remainder: float | None, words: _Units, replaced: bool
) -> Iterator[Effect]:
    """What was named on guarded samples of a joint, the surest first.

    replaced : but for a fall with speed that the reversals tell better.
    """
    design = solved.model.design
    mine = [c for c in of_joint(solved.model.chosen, joint) if not (replaced and c.named.candidate.name == STRIBECK)]
    for chosen in sorted(mine, key=lambda c: -c.evidence):
        candidate, place = chosen.named.candidate, _place(design, chosen)
        errors = np.sqrt(np.diag(covariance)[place])
        parameters = _parameters(chosen, design.numbers[place], errors, words)
        others = [one for one in design.named if one.candidate.joint is None]
        share = _share(Design(design.parts, others), Design(design.parts, [*others, chosen.named]), (joint,), solved)
        pair = LOAD_OR_POSITION if {candidate.name, *chosen.rivals} >= {LOAD, POSITION} else ""
        if candidate.name == LOAD and load_is_position(solved.problem, joint, float(design.numbers[place][0])):
            pair = LOAD_OR_POSITION
        said = of_effect(candidate.name, parameters, chosen.rivals, pair)
        grade = _graded(chosen.rivals, share, remainder, len(mine) == 1)
        yield Effect(candidate.name, said, parameters, grade, share, chosen.evidence, chosen.rivals, pair)


def _turned(turned: Sequence[Turned], joint: int, remainder: float | None, words: _Units) -> Iterator[Effect]:
    """What was named at the reversals of a joint."""
    for one in turned:
        if one.joint == joint:
            candidate, rivals = one.chosen.named.candidate, one.chosen.rivals
            parameters = _parameters(one.chosen, one.numbers, one.errors, words)
            said = of_effect(candidate.name, parameters, rivals)
            grade = _graded(rivals, one.share, remainder, False)
            evidence = one.chosen.evidence
            yield Effect(candidate.name, said, parameters, grade, one.share, evidence, rivals, candidate.pair)


def _parameters(
    chosen: Chosen, numbers: FloatArray, errors: FloatArray, words: _Units
) -> tuple[tuple[str, Quantity], ...]:
    """Numbers and settings with their errors."""
    candidate = chosen.named.candidate
    settings = {what: value for what, _, value in candidate.settings[chosen.named.setting].values}
    found = {
        what: Quantity(float(settings.pop(what) if what in settings else x), float(e), words.of(unit))
        for (what, unit), x, e in zip(candidate.numbers, numbers, errors, strict=True)
    }
    for what, unit, value in candidate.settings[chosen.named.setting].values:
        if what not in found:
            found[what] = Quantity(value, None, words.of(unit), "the nearest of the values that were tried")
    return tuple(found.items())


def _share(base: Design, refined: Design, joints: Sequence[int], solved: Solved) -> float:
    """Share of what the base leaves beyond the noise that a refined model takes, of guarded squares."""
    above = gained = 0.0
    for j in joints:
        kept = base.parts[j].stretches.kept
        squares = [float(np.sum(left_over(one, j)[0][kept] ** 2)) for one in (base, refined)]
        floor = float(np.sum(kept)) * float(solved.problem.filtered.torque_noise[j]) ** 2
        weight = 1.0 / max(float(np.var(solved.problem.filtered.torque[:, j])), 1e-300)
        above += weight * max(squares[0] - floor, 0.0)
        gained += weight * (squares[0] - squares[1])
    return float(np.clip(gained / above, 0.0, 1.0)) if above > 0.0 else 0.0


def _graded(rivals: Sequence[str], share: float, remainder: float | None, alone: bool) -> Grade:
    """The word for an entry."""
    if rivals:
        return Grade.ONE_OF
    if alone and remainder is not None and remainder < EXPLAINED.value:
        return Grade.EXPLAINS
    return Grade.MAIN if share > MAIN.value else Grade.MINOR


def _errors(solved: Solved, covariance: FloatArray) -> Iterator[ModelError]:
    """What was named beside friction, the surest first."""
    design, first = solved.model.design, solved.first
    joints, words = range(len(first.parts)), _Hinge()
    for chosen in sorted(solved.model.chosen, key=lambda c: -c.evidence):
        candidate = chosen.named.candidate
        if candidate.family == FRICTION:
            continue
        place = _place(design, chosen)
        numbers = total(solved, candidate.name, design.numbers[place])
        parameters = _parameters(chosen, numbers, np.sqrt(np.diag(covariance)[place]), words)
        (as_found,) = (c for c in first.candidates if c.key == candidate.key)
        alone = Design(first.parts, [Whitened.of(as_found, first.parts).at(0)])
        share = _share(Design(first.parts, ()), alone, joints, solved)
        joint = None if candidate.joint is None else solved.problem.filtered.joints[candidate.joint]
        if candidate.name == DELAY and joint is None and within_sample(solved, parameters[0][1]):
            continue
        said = of_error(candidate.name, joint, parameters, candidate.partner, chosen.rivals)
        grade = _graded(chosen.rivals, share, None, False)
        yield ModelError(
            candidate.name, joint, candidate.partner, said, parameters, grade, share, chosen.evidence, chosen.rivals,
            candidate.pair,
        )  # fmt: skip


def within_sample(solved: Solved, delay: Quantity) -> bool:
    """Whether a delay is within one sample of the log, where it is no error of that.

    A sampled controller drives from each sample to the next (zero-order hold; Franklin, Powell and Workman 1998,
    Digital Control of Dynamic Systems, section 6.4), and a bus hands on what it has.
    """
    if delay.value is None or delay.stderr is None:
        return False
    return abs(delay.value) < WITHIN.value / solved.first.filtered.band.rate + 2.0 * delay.stderr


def _holds(solved: Solved, covariance: FloatArray) -> Iterator[str]:
    """A sentence where the torque is held, and that was allowed for."""
    for chosen in solved.model.chosen:
        candidate = chosen.named.candidate
        if candidate.name == DELAY and candidate.joint is None:
            place = _place(solved.model.design, chosen)
            numbers = total(solved, DELAY, solved.model.design.numbers[place])
            delay = Quantity(float(numbers[0]), float(np.sqrt(np.diag(covariance)[place])[0]), "s")
            if within_sample(solved, delay):
                yield f"Torque and position are {abs(delay.value or 0.0):.2g} s apart, less than a sample: allowed for."


class _Hinge(_Units):
    """Units of the whole arm stand as they are."""

    def __init__(self) -> None:
        self._slide = False
