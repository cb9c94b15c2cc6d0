"""The entry: friction of the joints of an arm that moves as a whole."""

import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace

import numpy as np

from harness.core.arrays import FloatArray
from harness.core.checks import not_negative
from harness.core.errors import InputError
from harness.core.quantity import Quantity
from harness.core.robot import JointLog
from harness.diagnosis.grading.likely import Chosen, Likely, beside_other_forms, of_steps
from harness.robot.arm import Arm
from harness.robot.friction_curve import FrictionCurve
from harness.robot.whole_arm.columns import (
    ARMATURE,
    ASYMMETRIC,
    CARRIED,
    DELAY,
    DRIFT,
    ERRORS,
    INERTIA,
    LOAD,
    LOAD_OR_POSITION,
    MOTOR,
    OF_GRAVITY,
    OF_MOTION,
    PAYLOAD,
    POSITION,
    POWER,
    QUADRATIC,
    RIPPLE,
    SENSOR,
    SPRING,
    STRIBECK,
    TILT,
    WITHIN_A_SAMPLE,
    ZERO,
    Key,
)
from harness.robot.whole_arm.curve import curves
from harness.robot.whole_arm.design import Design, Named, Whitened
from harness.robot.whole_arm.perturb import called, with_load, without_armature
from harness.robot.whole_arm.result import Entry, Grade, JointFriction, Left, WholeArm, identifiable, with_joint
from harness.robot.whole_arm.rules import (
    EXPLAINED,
    LEAST_SAMPLES,
    LEAST_SIZE,
    MAIN,
    REACH,
    RIVAL,
    RULES,
    SAID_BETTER,
    TOLD_DELAY,
    TOLD_GRAVITY,
    UNSMOOTHED,
    WITHIN,
)
from harness.robot.whole_arm.search import CORRECTED, Known, Problem, Solved, rms, solve
from harness.robot.whole_arm.turning import AT_REVERSALS, BACKLASH, PRESLIDING, STATIC, at_reversals

LINK, MOTOR_SIDE = "link", "motor"
_STILL = "the joint does not move to and fro enough"
_NOTHING = 1e-9
"""N m or N: gravity below it is rounding."""
_BASE = ("N m", "N m s/rad", "N m")
"""Units of Coulomb, viscous and offset."""
_SAID = {
    STRIBECK: "Friction falls with speed: by {0} more at rest than when it slides, over {1}.",
    LOAD: "Friction grows with the joint's load: {0} of {load}.",
    ASYMMETRIC: "Viscous friction differs between the directions: by {0} on either side.",
    QUADRATIC: "Drag grows with the square of the speed: {0}.",
    POWER: "Friction has a part that grows with the power {1} of the speed: c_p = {0}.",
    DRIFT: "Friction changes during the log: Coulomb by {0}, viscous by {1}.",
    RIPPLE: "The torque ripples with the position: {0} and {1} (sine and cosine), {2}.",
    POSITION: "Coulomb friction depends on the position: {0} and {1} (sine and cosine), {2}.",
    PRESLIDING: "After a reversal friction builds up over a distance: {0} over {1}.",
    STATIC: "Friction is higher at the moment of reversal: by {0}, below {1}.",
    BACKLASH: "After a reversal the load is missing: {0} of it.",
    INERTIA: "Masses of the model are off, by shares of {all}",
    PAYLOAD: "There is {0} more {place} than the model has",
    MOTOR: "The torque is scaled: by {0} more than it says",
    DELAY: "The torque is late by {0}",
    SENSOR: "The sensor does not see the rotors: {0} of their inertia is missing in the torque",
    TILT: "The base is tilted: by {0} about x and {1} about y",
    ZERO: "Zeros of positions are off, which --offset puts right, by {all}",
    ARMATURE: "The inertia about the joint's axis is off by {0}",
    SPRING: "A spring that the model has not pulls the joint: {0}",
}

_LOADS = {
    OF_GRAVITY: "the torque of gravity",
    OF_MOTION: "the torque of gravity and motion",
    CARRIED: "all torque that its gears carry",
}
"""What a share is of."""

_SEEN = 2.0
"""Standard errors from which a number is said; several below it may show together that something is off."""


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
        raise InputError("sensor", repr(sensor), f"{LINK} or {MOTOR_SIDE}")
    if payload is not None and not_negative("payload", payload, "kg") > 0.0:
        arm = with_load(arm, payload)
    if sensor == LINK:
        arm = without_armature(arm)
    known = Known(payload is not None, sensor is not None, gain_known)
    solved = solve(log, arm, joints, lowpass, known)
    return _Told(solved, arm).result(known)


def _viscous(number: Quantity) -> str:
    """A joint's viscous friction in a sentence, which a law may stand in place of."""
    return f"viscous friction {number}" if number.stderr is not None else f"no viscous friction: {number.why}"


def within_sample(delay: Quantity, rate: float) -> bool:
    """Whether a delay is within one sample of a log at so many Hz, where it is no error of that.

    A sampled controller drives from each sample to the next (zero-order hold; Franklin, Powell and Workman 1998,
    Digital Control of Dynamic Systems, section 6.4), and a bus hands on what it has.
    """
    if delay.value is None or delay.stderr is None:
        return False
    return abs(delay.value) < WITHIN.value / rate + 2.0 * delay.stderr


class _Told:
    """What was solved, told joint by joint."""

    def __init__(self, solved: Solved, arm: Arm) -> None:
        self.solved, self.arm, self.filtered = solved, arm, solved.problem.filtered
        self.design, self.plain = solved.model.design, Design(solved.first.parts, ())
        self.covariance, self.spread = self.design.covariance(), self.plain.covariance()
        self.gain = {j: self._scaled(j) for j in self.design.parts}
        units = {
            j: (self._unit(name, _BASE[0]), self._unit(name, _BASE[1])) for j, name in enumerate(self.filtered.joints)
        }
        self.curved = curves(solved.problem, self.design, solved.arm, units, self.gain)

    def result(self, known: Known) -> WholeArm:
        """Everything that is told."""
        solved, filtered = self.solved, self.filtered
        held_out = np.column_stack((rms(self.plain, solved.first.filtered.t), rms(self.design, filtered.t)))
        found = {name: self._joint(j, *held_out[j].tolist()) for j, name in enumerate(filtered.joints)}
        for name in solved.still:
            first, second, third = (Quantity.refused(self._unit(name, unit), _STILL) for unit in _BASE)
            found[name] = JointFriction(name, first, second, third, f"{name}: {_STILL} to tell its friction.")
        notes, errors = [*filtered.notes, *self._allowed()], []
        for one in self._surest(one for one in self.design.named if not one.candidate.of_friction):
            error = self._error(one)
            if error.name == DELAY and error.joint is None and within_sample(error.parameters[0][1], self._rate):
                notes.append(self._apart(error.parameters[0][1]))
                continue
            if not any(abs(one.value or 0.0) >= _SEEN * (one.stderr or 0.0) for _, one in error.parameters):
                notes.append(f"{error.name} is allowed for: none of its numbers is beyond two standard errors.")
                continue
            least = LEAST_SIZE.value * one.candidate.spread
            small = bool(np.all(np.isfinite(least)) and np.all(np.abs(solved.total(one)) < least))
            if small and error.share <= MAIN.value:
                notes.append(f"Allowed for, and smaller than models are exact: {error.statement}")
                continue
            errors.append(error)
        entries = [*(effect for one in found.values() for effect in one.effects), *errors]
        return WholeArm(
            tuple(found[name] for name in self.arm.joints if name in found),
            tuple(errors),
            confounded(solved.problem, known),
            solved.model.left_out,
            filtered.band.lowpass,
            filtered.out.rate,
            filtered.seconds,
            RULES,
            tuple(notes),
            identifiable(solved.first, solved.still),
            self._likely(entries),
        )

    def _likely(self, entries: Sequence[Entry]) -> Likely:
        """Which names are missing; where any are told, another effect may look like them."""
        solved, by_label = self.solved, self._one_by_one()
        gains = [by_label.get(one.label, one.evidence) for one in entries]
        sizes = [one.bic + gain - one.evidence for one, gain in zip(entries, gains, strict=True)]
        first = {one.label: size for one, size in zip(entries, sizes, strict=True) if one.name in CORRECTED}
        others = {
            (*first, self._label(key)): sum(first.values()) + gain - self._unit_information(key[1])
            for key, gain in solved.model.alone.items()
        }
        names = len(solved.first.candidates) + len(self.filtered.joints) * len(AT_REVERSALS)
        # beside the first effects of a real arm the others still counted as noise: what the end loses without each
        whole = max(sum(sizes), sum(one.bic for one in entries))
        likely = of_steps([Chosen(one.label, one.bic, one.worse) for one in entries], whole, others, names)
        return beside_other_forms(likely, sum(gains)) if entries else likely

    def _one_by_one(self) -> dict[str, float]:
        """Evidence of each that was named beside those before it, which add up to that of all; what was corrected was
        found first.
        """
        named, parts = self.design.named, self.design.parts
        return {
            self._label(one.candidate.key): one.evidence
            if one.candidate.name in CORRECTED or i == len(named) - 1
            else Design(parts, named[:i]).score(one.whitened).evidence
            for i, one in enumerate(named)
            if one.candidate.name != WITHIN_A_SAMPLE
        }

    def _label(self, key: Key) -> str:
        """A candidate's name with the joint that it is of."""
        return with_joint(key[0], None if key[1] is None else self.filtered.joints[key[1]])

    def _unit_information(self, joint: int | None) -> float:
        """Logarithm of the guarded samples of a joint, or of all, which a number has to be worth (Schwarz 1978)."""
        every = [part.stretches.kept for j, part in self.design.parts.items() if joint in (j, None)]
        return math.log(sum(int(np.sum(kept)) for kept in every))

    @property
    def _rate(self) -> float:
        """Hz, of the log."""
        return self.solved.first.filtered.band.rate

    def _allowed(self) -> Iterator[str]:
        """What is said of a delay too small to be named, where it shows."""
        for one, place in zip(self.design.named, self.design.places, strict=True):
            if one.candidate.name == WITHIN_A_SAMPLE:
                delay = Quantity(float(self.design.numbers[place][0]), float(self._errors(place)[0]), "s")
                if abs(delay.value or 0.0) >= _SEEN * (delay.stderr or 0.0):
                    yield self._apart(delay)

    def _apart(self, delay: Quantity) -> str:
        size = Quantity(abs(delay.value or 0.0), delay.stderr, "s")
        less = ", less than a sample" if within_sample(delay, self._rate) else ""
        return f"Torque and position are {size} apart{less}: allowed for."

    def _surest(self, named: Iterator[Named]) -> list[Named]:
        return sorted(named, key=lambda one: -one.evidence)

    def _unit(self, joint: str | None, unit: str) -> str:
        """Of a hinge, or of a slide; those of the whole arm stand as they are."""
        slides = joint is not None and self.arm.slides(joint)
        return unit.replace("N m", "N").replace("rad", "m") if slides else unit

    def _joint(self, j: int, before: float, after: float) -> JointFriction:
        design, filtered, name = self.design, self.filtered, self.filtered.joints[j]
        coulomb, viscous, offset = self._base(j, design, self.covariance, self.gain[j])
        kept = design.parts[j].stretches.kept
        # a record that was smoothed shows no noise
        smoothed = filtered.torque_noise[j] < UNSMOOTHED.value * math.sqrt(float(np.mean(filtered.torque[:, j] ** 2)))
        far = kept & filtered.away(j, REACH.value / filtered.band.lowpass)
        sliding = far if np.sum(far) >= LEAST_SAMPLES.value else kept
        left = math.sqrt(float(np.mean(design.left(j)[sliding] ** 2)))
        remainder = None if smoothed else left / float(self.solved.problem.noise[j])
        unit = self._unit(name, "N m")
        better = f", {after:.3g} {unit} with the effects found" if after < SAID_BETTER.value * before else ""
        both, dof = kept & self.plain.parts[j].stretches.kept, filtered.dof[j]
        effects, first = tuple(self._effects(j, remainder)), self.solved.first.parts[j].torque
        found = self.curved.get(j)
        return JointFriction(
            name,
            coulomb,
            viscous,
            offset,
            f"{name}: Coulomb friction {coulomb}, {_viscous(viscous)}; residual torque {before:.3g} {unit} rms"
            f"{better}.",
            effects,
            (before, after),
            remainder,
            self.solved.problem.guard[j],
            int(np.sum(kept)),
            self._base(j, self.plain, self.spread, 1.0),
            Left(
                filtered.t[both], filtered.q[both, dof], filtered.v[both, dof],
                self.plain.left(j)[both], design.left(j)[both],
                first[both], (first if found is None else found.friction)[both],
            ),
            self._curve(j, effects, coulomb),
        )  # fmt: skip

    def _base(self, j: int, design: Design, covariance: FloatArray, gain: float) -> tuple[Quantity, Quantity, Quantity]:
        """Coulomb, viscous and offset of a joint, with their errors."""
        name, place = self.filtered.joints[j], design.base[j]
        errors, numbers = np.sqrt(np.diag(covariance)[place]) / gain, design.numbers[place] / gain
        first, second, third = (
            Quantity(float(x), float(e), self._unit(name, unit))
            for x, e, unit in zip(numbers, errors, _BASE, strict=False)
        )
        if (other := design.in_place_of_viscous(j)) is not None:  # held at nothing: its error is of no measurement
            second = Quantity(0.0, None, second.unit, f"{other} is fitted in its place")
        return first, second, third

    def _scaled(self, j: int) -> float:
        """The torque of a joint as logged over what it was."""
        design = self.design
        return 1.0 + sum(
            float(design.numbers[place][0])
            for one, place in zip(design.named, design.places, strict=True)
            if one.candidate.name == MOTOR and one.candidate.joint in (j, None)
        )

    def _curve(self, j: int, effects: Sequence[Entry], coulomb: Quantity) -> FrictionCurve | None:
        """The curve of a joint with what its reversals show."""
        if j not in self.curved:
            return None
        found, at_zero = self.curved[j].found, {one.name: dict(one.parameters) for one in effects}
        held = at_zero.get(PRESLIDING, {}).get("length")
        more = at_zero.get(STATIC, {}).get("f_s - f_c")
        loose = None
        if more is not None and more.value is not None and coulomb.value is not None:
            errors = math.hypot(more.stderr or 0.0, coulomb.stderr or 0.0)
            loose = Quantity(coulomb.value + more.value, errors, more.unit)
        return replace(found, presliding=held, break_away=loose)

    def _effects(self, j: int, remainder: float | None) -> Iterator[Entry]:
        """What was named on guarded samples of a joint, the surest first, and what at its reversals."""
        design, turned, name = self.design, at_reversals(self.solved, j), self.filtered.joints[j]
        mine = self._surest(
            one
            for one in self.solved.model.of_joint(j)
            # a fall with speed that the reversals tell better
            if not (turned and turned.of_stribeck and one.candidate.name == STRIBECK)
        )
        shared = [one for one in design.named if one.candidate.joint is None]
        for one in mine:
            share = self._share(Design(design.parts, shared), Design(design.parts, [*shared, one]), (j,))
            place = design.place(one)
            numbers = design.numbers[place]
            either = {one.candidate.name, *(rival for rival, _ in one.rivals)} >= {LOAD, POSITION}
            if one.candidate.name == LOAD and one.value == OF_GRAVITY:
                either |= load_is_position(self.solved.problem, j, float(numbers[0]))
            errors = self._errors(place)
            alone = remainder if len(mine) == 1 else None
            yield self._entry(one, name, numbers, errors, share, alone, pair=LOAD_OR_POSITION if either else "")
        if turned:
            told = ERRORS.get(turned.named.candidate.name, ())
            yield self._entry(turned.named, name, turned.numbers, turned.errors, turned.share, None, *told)

    def _error(self, one: Named) -> Entry:
        """What was named beside friction."""
        candidate, first = one.candidate, self.solved.first
        (as_found,) = (c for c in first.candidates if c.key == candidate.key)
        alone = Named(Whitened.of(as_found, first.parts), one.setting)
        share = self._share(self.plain, Design(first.parts, [alone]), first.parts)
        errors = self._errors(self.design.place(one))
        joint = None if candidate.joint is None else self.filtered.joints[candidate.joint]
        return self._entry(one, joint, self.solved.total(one), errors, share, None, *ERRORS[candidate.name])

    def _errors(self, place: slice) -> FloatArray:
        """Standard errors of numbers of the model."""
        return np.asarray(np.sqrt(np.diag(self.covariance)[place]))

    def _share(self, base: Design, refined: Design, joints: Iterable[int]) -> float:
        """Share of what the base leaves beyond the noise that a refined model takes, of guarded squares."""
        above = gained = 0.0
        for j in joints:
            before, after = base.squares(j), refined.squares(j)
            floor = float(np.sum(base.parts[j].stretches.kept)) * float(self.solved.problem.noise[j]) ** 2
            weight = 1.0 / max(float(np.var(self.filtered.torque[:, j])), 1e-300)
            above += weight * max(before - floor, 0.0)
            gained += weight * (before - after)
        return float(np.clip(gained / above, 0.0, 1.0)) if above > 0.0 else 0.0

    def _entry(
        self, one: Named, joint: str | None, numbers: FloatArray, errors: FloatArray, share: float,
        remainder: float | None, partner: str = "", pair: str = "",
    ) -> Entry:  # fmt: skip
        """What is named, in a sentence with what it cannot be told from; remainder : what is left over its noise, where
        this is all that is named of a joint.
        """
        candidate, name = one.candidate, one.candidate.name
        what, unit = candidate.what or ("", "")
        found = {
            number: Quantity(one.value if number == what else float(x), float(e), self._unit(joint, its))
            for (number, its), x, e in zip(candidate.numbers, numbers, errors, strict=True)
        }
        if what and what not in found:
            nearest = "the nearest of the values that were tried"
            found[what] = Quantity(one.value, None, self._unit(joint, unit), nearest)
        everything = ", ".join(f"{number} {value}" for number, value in found.items())
        place = "at the end of the arm"
        if candidate.bodies and one.setting:
            body = called(self.arm, candidate.bodies[one.setting])
            place, partner, pair = f"on {body}", f"mass of {body}", f"extra mass on {body}"
        said = _SAID[name].format(*map(str, found.values()), all=everything, place=place, load=_LOADS.get(one.value))
        if candidate.form:
            said = f"{said.removesuffix('.')}, as {candidate.form}."
        if name in ERRORS:
            said += f" ({joint})" if joint else ""
            said += f", or it is the {partner}: no log of this kind can tell." if partner else "."
        taken = {other.candidate.key for other in self.design.named}
        worse = {self._label(key): by for key, by in one.rivals.items() if key not in taken}
        entry = Entry(
            name, joint, said, tuple(found.items()), Grade.MINOR, share, one.evidence,
            one.evidence - self._unit_information(candidate.joint), worse, partner, pair,
        )  # fmt: skip
        if worse:
            said += f" {' or '.join(entry.rivals)} would explain it nearly as well."
        if pair and name not in ERRORS:
            said += f" It may be either of the pair: {pair}; this log cannot tell which."
        explains = remainder is not None and remainder < EXPLAINED.value
        grade = Grade.EXPLAINS if explains else Grade.MAIN if share > MAIN.value else Grade.MINOR
        return replace(entry, statement=said, grade=Grade.ONE_OF if worse else grade)


def confounded(problem: Problem, known: Known) -> tuple[tuple[str, str], ...]:
    """Pairs of names, with the joint where it is one joint's."""
    found: list[tuple[str, str]] = []
    if not known.gain:
        found.append((MOTOR, INERTIA))
    if not known.sensor:
        found.append(("Coulomb friction of the gearbox", SENSOR))
    for j, name in enumerate(problem.filtered.joints):
        gravity = problem.gravity[:, j]
        if np.max(np.abs(gravity)) > _NOTHING and _shown(problem, j, TOLD_GRAVITY.value * gravity) < RIVAL.value:
            found.append((f"offset of {name}", "gravity"))
        change = np.gradient(problem.rigid[:, j], 1.0 / problem.filtered.out.rate)
        if _shown(problem, j, TOLD_DELAY.value * change) < RIVAL.value:
            found.append((f"viscous friction of {name}", DELAY))
    return tuple(found)


def load_is_position(problem: Problem, joint: int, share: float) -> bool:
    """Whether a joint's load is a function of its own position, as far as friction of this share of it shows.

    Alone in its plane a joint carries a sine of its angle, and nothing tells what friction follows.
    """
    gravity, angle = problem.gravity[:, joint], problem.filtered.q[:, problem.filtered.dof[joint]]
    own = np.stack((np.ones_like(angle), np.sin(angle), np.cos(angle)), axis=1)
    fitted = own @ np.linalg.lstsq(own, gravity, rcond=None)[0]
    by_load = share * problem.parts[joint].base[:, 0] * (np.abs(gravity) - np.abs(fitted))
    return _shown(problem, joint, by_load) < RIVAL.value


def _shown(problem: Problem, joint: int, torque: FloatArray) -> float:
    """Gain that this torque (m,) on a joint would bring beyond Coulomb, viscous and offset."""
    part = problem.parts[joint]
    base, added = part.white(part.base), part.white(torque)
    left = added - base @ np.linalg.lstsq(base, added, rcond=None)[0]
    return float(left @ left)
