"""What a log cannot part: pairs that none can, and pairs that this one's motion does not."""

import numpy as np

from harness.core.arrays import FloatArray
from harness.robot.whole_arm.design import Part
from harness.robot.whole_arm.model_columns import DELAY, INERTIA, MOTOR, SENSOR
from harness.robot.whole_arm.prepare import Known, Problem
from harness.robot.whole_arm.rules import RIVAL, TOLD_DELAY, TOLD_GRAVITY

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
