"""Whether the other joints stand still in a log: the torque that their motion puts on one joint."""

import math
from dataclasses import dataclass
from typing import Literal

import numpy as np

from harness.core.arrays import FloatArray
from harness.core.errors import InputError, did_you_mean
from harness.core.robot import JointLog
from harness.robot.arm import Arm
from harness.robot.reduction import Reduced, reduced
from harness.robot.smooth import Even, moving

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
