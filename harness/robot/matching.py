"""A log beside a model: the joints that both have, and units that cannot be the model's."""

import math

import numpy as np

from harness.core.arrays import FloatArray
from harness.core.errors import InputError
from harness.core.near import did_you_mean
from harness.core.robot.joint_log import JointLog
from harness.robot.arm import Arm

_MANY_TURNS = 20.0
"""rad: a hinge with stops that is farther out was logged in degrees."""
STILL = 3.0
"""Times its noise within which a joint's position scatters where it stands still."""
_NOWHERE = 1e-6
"""rad or m: less than the finest encoder resolves is no motion, whatever the digits of a log say."""


def moves(y: FloatArray) -> bool:
    """Whether a position (n,) does more than scatter about its mean."""
    return float(np.std(y)) > max(STILL * noise_of(y), _NOWHERE)


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


def noise_of(y: FloatArray) -> float:
    """Standard deviation of a position's noise, its steps included, in its own unit."""
    steps = np.abs(np.diff(y))
    smallest = float(np.min(steps[steps > 0.0], initial=math.inf))
    step = smallest / math.sqrt(12.0) if math.isfinite(smallest) else 0.0
    second = np.diff(y, 2)
    return max(float(np.median(np.abs(second))) / (0.6745 * math.sqrt(6.0)), step)
