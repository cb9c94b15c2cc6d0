"""Break-away of a joint that sticks and slips: the torque that held it last before each slip, gravity taken off."""

import math
from dataclasses import dataclass

import numpy as np

from harness.core.arrays import FloatArray
from harness.core.errors import InputError, did_you_mean
from harness.core.quantity import Quantity
from harness.core.robot.joint_log import JointLog
from harness.robot.arm import Arm
from harness.robot.reduction import Reduced
from harness.robot.smooth import noise_of, rests

_MANY_TURNS = 20.0
"""rad: a hinge with stops that is farther out was logged in degrees."""


def check_joint(arm: Arm, log: JointLog, joint: str) -> None:
    """Raise InputError for a joint that the model or the log has not, and for positions in degrees.

    Where model and log share no joint, both are listed.
    """
    if not set(arm.joints) & set(log.joints):
        found = f"joints {', '.join(log.joints)}, and {arm.file} has {', '.join(arm.joints)}"
        raise InputError(log.file, found, "a log of the model's joints, by their names, is accepted")
    i = arm.index(joint)
    if joint not in log.position:
        accepted = f"a joint of the log is accepted: {', '.join(log.joints)}{did_you_mean(joint, log.joints)}"
        raise InputError("--joint", f"{joint!r}, whose position {log.file} does not hold", accepted)
    if arm.model.jnt_limited[i] and not arm.slides(joint):
        farthest, most = float(np.max(np.abs(log.position[joint]))), float(np.max(np.abs(arm.model.jnt_range[i])))
        if farthest > max(_MANY_TURNS, 2.0 * most) and math.radians(farthest) <= 2.0 * most:
            found = f"positions up to {farthest:.4g} of a hinge that goes to {most:.4g} rad in {arm.file}"
            raise InputError(
                f"{log.file}: {joint}.position",
                found,
                "rad is accepted; this looks like degrees, try: --angle-unit deg",
            )


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
    within = 2.0 * _NOISES * noise_of(q)
    step = float(np.median(np.diff(log.t)))
    width = max(int(_REST / step), 2)
    first, last = rests(q, within, width)
    if not first.size:
        return None
    held = effort - own.load(q)
    found, rises = [], []
    for start, stop, after in zip(first, last, [*first[1:], q.size - 1], strict=True):
        gone = float(q[after] - np.median(q[start : stop + 1]))
        rows = slice(max(start, stop - max(int(_LOOK / step), 3)), stop + 1)
        if abs(gone) < _GONE * within or log.t[stop] - log.t[start] < _REST:
            continue
        time = log.t[rows] - log.t[stop]
        slope, end = np.polyfit(time, held[rows], 1)
        found.append(math.copysign(1.0, gone) * float(end))
        rises.append(abs(float(slope)) * _LOOK / 2.0)
    still = float(np.sum(log.t[last] - log.t[first])) / float(log.t[-1] - log.t[0])
    return Slips(
        min(still, 1.0), np.array(found), float(np.mean(rises)) if rises else 0.0, "N" if own.slides else "N m"
    )
