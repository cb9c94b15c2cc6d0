"""One joint of a log as a recording, in the terms of its own equation; and how it breaks away where it sticks.

First of all, whether the other joints stand still in the log: the torque that their motion puts on it.
"""

import math
from dataclasses import dataclass
from typing import Literal

import numpy as np

from harness.core.arrays import FloatArray
from harness.core.errors import InputError, did_you_mean
from harness.core.quantity import Quantity
from harness.core.recording import Recording
from harness.core.robot import JointLog
from harness.estimate.rest import rests
from harness.robot.arm import Arm
from harness.robot.reduction import Reduced, reduced
from harness.robot.smooth import Even, moving, noise_of

Pull = Literal["spring", "pendulum", "none"]
_LOAD = 100.0
"""Times what the rigid model asks for, above or below which an effort has hardly that unit."""


@dataclass(frozen=True, slots=True)
class OneJoint:
    """A joint's motion and, where it is driven, its torque, what the model knows besides taken off.

    recording : x is the position from ``rest`` (rad or m), v, and u. restoring : what pulls x back. inertia : kg m^2 or
    kg where no torque tells it, else None. warnings : what looks wrong.
    """

    recording: Recording
    restoring: Pull
    rest: float
    inertia: float | None
    warnings: tuple[str, ...] = ()

    @property
    def driven(self) -> bool:
        """Whether a measured torque acts."""
        return self.inertia is None


def one_joint(log: JointLog, own: Reduced) -> OneJoint:
    """The recording of a joint whose equation is ``own``.

    Raises InputError for a free swing of a joint that nothing pulls back, or that gravity and a spring of its own do.
    """
    name, unit, force = own.joint, *(("m", "N") if own.slides else ("rad", "N m"))
    effort, where = log.effort.get(name), f"{log.file}: {name}"
    driven = effort is not None and float(np.ptp(effort)) > 0.0
    pull: Pull = "spring" if own.spring > 0.0 else "none"
    if not own.slides and not own.upright:
        pull = "pendulum"
    if not driven:
        found = f"no {name}.effort" if effort is None else f"a {name}.effort that is {effort[0]:g} throughout"
        if pull == "none":
            why = "a slide" if own.slides else "an axis along gravity"
            raise InputError(where, f"{found}, and nothing pulls {why} back", "an effort in N m or N")
        if pull == "pendulum" and own.spring > 0.0:
            accepted = "an effort, which distinguishes the two"
            raise InputError(where, f"{found}, and both gravity and a spring pull it back", accepted)
    q, rest = log.position[name], own.q_ref if pull == "spring" else 0.0
    if pull == "pendulum":
        # the nearest of those a turn apart
        near = float(np.mean(q)) if driven else float(q[-1])
        rest = own.q_eq + 2.0 * math.pi * round((near - own.q_eq) / (2.0 * math.pi))
    channels: dict[str, FloatArray] = {"x": q - rest}
    if name in log.velocity and float(np.ptp(log.velocity[name])) > 0.0:
        channels["v"] = log.velocity[name]
    notes, warnings = list(log.notes), []
    if pull != "none":
        notes.append(f"{name}.position is counted from {rest:.6g} {unit}, where it is at rest.")
    if driven and effort is not None:
        asked, given = (float(np.sqrt(np.mean(one**2))) for one in (own.load(q), effort))
        if asked != 0.0 and not own.upright and not asked / _LOAD < given < asked * _LOAD:
            warnings.append(
                f"the effort of {name} is {given:.3g} rms, and its gravity alone asks for {asked:.3g} {force}: it is"
                f" hardly in {force}"
            )
        # what the model knows and the fit has no word for
        if pull == "pendulum" and own.spring > 0.0:
            effort = effort - own.spring * (q - own.q_ref)
            notes.append(f"The torque of the joint's own spring, {own.spring:.4g} N m/rad, is taken off its effort.")
        if own.slides and own.constant != 0.0:
            effort = effort - own.constant
            notes.append(f"Gravity's {own.constant:.4g} N are taken off its effort.")
        channels["u"] = effort
    recording = Recording(log.t, channels, log.file, log.sha256, angular=not own.slides, notes=tuple(notes))
    return OneJoint(recording, pull, rest, None if driven else own.moved, tuple(warnings))


_NOISES = 3.0
"""Standard deviations of a position that scatters about one place, to either side."""
_REST, _LOOK = 0.1, 0.05
"""s: shorter rests are reversals; and before a slip, over which the torque is followed to its end."""
_GONE = 5.0
"""Ranges of a rest that a slip goes at least."""
FEWEST = 4
"""Slips, of which a break-away is read: three degrees of freedom are left for its error."""


@dataclass(frozen=True, slots=True)
class Slips:
    """still : share of the time at rest. torques (n,) : before each slip, N m or N, along the slip. rise :
    of them in the time in which its beginning is not known. unit : of both."""

    still: float
    torques: FloatArray
    rise: float
    unit: str

    @property
    def break_away(self) -> Quantity | None:
        """Mean torque at which it comes loose; None of few slips."""
        n = self.torques.size
        if n < FEWEST:
            return None
        error = math.hypot(float(np.std(self.torques, ddof=1)) / math.sqrt(n), self.rise)
        return Quantity(float(np.mean(self.torques)), error, self.unit)


def slips(log: JointLog, own: Reduced) -> Slips | None:
    """The slips of a joint, the others still; None of one without effort, or that never rests."""
    q, effort = log.position[own.joint], log.effort.get(own.joint)
    if effort is None:
        return None
    within, step = 2.0 * _NOISES * noise_of(q), float(np.median(np.diff(log.t)))
    first, last = rests(q, within, max(int(_REST / step), 2))
    if not first.size:
        return None
    held = effort - own.load(q)
    found, rises = [], []
    for start, stop, after in zip(first, last, [*first[1:], q.size - 1], strict=True):
        gone = float(q[after] - np.median(q[start : stop + 1]))
        rows = slice(max(start, stop - max(int(_LOOK / step), 3)), stop + 1)
        if abs(gone) < _GONE * within or log.t[stop] - log.t[start] < _REST:
            continue
        slope, end = np.polyfit(log.t[rows] - log.t[stop], held[rows], 1)
        found.append(math.copysign(1.0, gone) * float(end))
        rises.append(abs(float(slope)) * _LOOK / 2.0)
    still = float(np.sum(log.t[last] - log.t[first])) / float(log.t[-1] - log.t[0])
    rise = float(np.mean(rises)) if rises else 0.0
    return Slips(min(still, 1.0), np.array(found), rise, "N" if own.slides else "N m")


QUARTER = 0.25
"""Of the mean square that the joint's own equation leaves: as long as the others take less of it off, half of its rms,
what they do does not decide."""
_MOST = 20_000
"""Samples at which the whole arm's equations are evaluated."""
_MOVING = 0.05
"""Of the largest speed: slower samples do not count, where friction's sign is not known."""
_MANY_TURNS = 20.0
"""rad: a hinge with stops that is farther out was logged in degrees."""


@dataclass(frozen=True, slots=True)
class Coupling:
    """What the other joints do to one.

    torque : rms, N m or N. residual : rms that the joint's own equation leaves, with inertia, damping, dry friction and
    gravity fitted. share : of its square that the others' torque takes off, whatever its factor: the log's unit may be
    wrong; or that it is, where that is more. moving : the others that move. reduced : with the others at their means.
    """

    torque: float
    residual: float
    share: float
    moving: tuple[str, ...]
    reduced: Reduced

    @property
    def mode(self) -> Literal["locked", "whole-arm"]:
        """Whether the joint's own equation will do."""
        return "locked" if not self.moving or self.share < QUARTER else "whole-arm"


def coupling(arm: Arm, log: JointLog, joint: str) -> Coupling:
    """What the motion of the others puts on a joint.

    Joints of the model that the log has not are held at the model's reference. Raises InputError where log and model
    do not go together, and for a joint that does not move alone.
    """
    at = _checked(arm, log, joint)
    others = [name for name in arm.joints if name != joint and name in log.position]
    own = reduced(arm, joint, {name: float(np.mean(log.position[name])) for name in others})
    those = tuple(name for name in moving(arm, log) if name != joint)
    even = Even.of(log.t)
    thin = even.settled(_MOST)
    still = np.array([own.held.get(name, 0.0) for name in arm.joints])
    q, v, a = (y[thin] for y in even.motion(arm, log, still, (*those, joint)))
    alone = own.torque(q[:, at], a[:, at])
    extra = arm.inverse(q, v, a)[:, at] - alone if those else np.zeros(alone.size)
    effort = even.low(log.t, log.effort[joint])[0][thin] if joint in log.effort else np.zeros(alone.size)
    fast = np.abs(v[:, at]) > _MOVING * float(np.max(np.abs(v[:, at])))
    # what friction, damping, gravity and, if it is driven, inertia make of the motion
    angle, speed, driven = q[:, at], v[:, at], [a[:, at]] if joint in log.effort else []
    columns = np.column_stack((speed, np.sign(speed), np.sin(angle), np.cos(angle), np.ones(angle.size), *driven))
    left = _left((effort - alone)[fast], columns[fast])
    less = _left((effort - alone)[fast], np.column_stack((columns, extra))[fast]) if those else left
    # where the model does not go together with the log, the others' torque explains nothing and is there all the same
    size = _left(extra[fast], columns[fast]) if those else 0.0
    share = max(1.0 - (less / left) ** 2, min((size / left) ** 2, 1.0)) if left > 0.0 else 1.0
    return Coupling(float(np.sqrt(np.mean(extra**2))), left, share, those, own)


def _checked(arm: Arm, log: JointLog, joint: str) -> int:
    """Number of a joint; InputError for one that the model or the log has not, and for positions in degrees.

    Where model and log share no joint, both are listed.
    """
    if not set(arm.joints) & set(log.joints):
        found = f"joints {', '.join(log.joints)}, and {arm.file} has {', '.join(arm.joints)}"
        raise InputError(log.file, found, "a log of the model's joints, by their names")
    i = arm.index(joint)
    if joint not in log.position:
        accepted = f"a joint of the log: {', '.join(log.joints)}{did_you_mean(joint, log.joints)}"
        raise InputError("--joint", f"{joint!r}, whose position {log.file} does not hold", accepted)
    if arm.model.jnt_limited[i] and not arm.slides(joint):
        farthest, most = float(np.max(np.abs(log.position[joint]))), float(np.max(np.abs(arm.model.jnt_range[i])))
        if farthest > max(_MANY_TURNS, 2.0 * most) and math.radians(farthest) <= 2.0 * most:
            found = (
                f"positions up to {farthest:.4g}, as in degrees, of a hinge that goes to {most:.4g} rad in {arm.file}"
            )
            raise InputError(f"{log.file}: {joint}.position", found, "try: --angle-unit deg")
    return i


def _left(torque: FloatArray, columns: FloatArray) -> float:
    """Rms (N m or N) of what columns (n, q) do not say of a torque (n,)."""
    left = torque - columns @ np.linalg.lstsq(columns, torque, rcond=None)[0]
    return float(np.sqrt(np.mean(left**2))) if left.size else 0.0
