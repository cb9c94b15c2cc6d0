"""What is shown of a robot besides a diagnosis, and how a trace keeps it."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from harness.core.arrays import FloatArray
from harness.core.robot.bodies import Bodies
from harness.core.trajectory import Source, Trajectory

Left = Mapping[str, NDArray[np.float64]]
"""By joint: t, q, v, torque left by the base and by the model, (m, 5)."""
BEFORE, AFTER = "#e4632d", "#2b7fd6"
BEFORE_NAME, AFTER_NAME = "viscous and Coulomb", "with what is named"
LEFT, MOTION, HELD, SWING = "left", "motion", "held", "swing"
"""Of what a trace keeps under these names."""
_MEANS = 48
_BEFORE, _AFTER, _INSIDE = "before", "after", "inside"


@dataclass(frozen=True, slots=True)
class Motion:
    """A joint in an engine, driven by its log's torque.

    t (m,) : s. logged, before, after (m,) : rad or m, as logged, by the model's file and by the copy; nan between
    windows.
    """

    engine: str
    t: FloatArray
    logged: FloatArray
    before: FloatArray
    after: FloatArray


@dataclass(frozen=True, slots=True)
class Shown:
    """left : torque that is left of joints. motions : one an engine. bodies : the robot, None where a page is made
    again of a trace, which shows it."""

    left: Left
    motions: tuple[Motion, ...] = ()
    bodies: Bodies | None = None


def binned(rows: NDArray[np.float64], column: int) -> FloatArray:
    """Means of the rows over stretches of one column that hold equally many, by it."""
    ordered = rows[np.argsort(rows[:, column])]
    return np.array([part.mean(axis=0) for part in np.array_split(ordered, min(_MEANS, len(rows)))])


def moved_in(unit: str) -> str:
    """Unit of the position of a joint whose torque has this one: N m of a hinge, N of a slide."""
    return "rad" if "m" in unit else "m"


def parts_of(shown: Shown) -> dict[str, list[Trajectory]]:
    """As a trace keeps it: one motion a joint or an engine, named after it."""
    left = []
    for joint, rows in shown.left.items():
        t, q, v, before, after = rows.T
        left.append(Trajectory(t, q, v, np.zeros_like(t), Source(joint), extra={_BEFORE: before, _AFTER: after}))
    motions = []
    for motion in shown.motions:
        inside = np.isfinite(motion.before) & np.isfinite(motion.after)
        extra = {name: np.where(inside, y, 0.0) for name, y in ((_BEFORE, motion.before), (_AFTER, motion.after))}
        extra[_INSIDE] = inside.astype(np.float64)
        still = np.zeros_like(motion.t)
        motions.append(Trajectory(motion.t, motion.logged, still, still, Source(motion.engine), extra=extra))
    return {LEFT: left, MOTION: motions}


def unpacked(left: Iterable[Trajectory], motions: Iterable[Trajectory]) -> Shown:
    """What ``parts_of`` was given. Raises LookupError for what is something else."""
    rows = {
        one.source.name: np.column_stack((one.t, one.x, one.v, one.extra[_BEFORE], one.extra[_AFTER])) for one in left
    }
    found = []
    for one in motions:
        before, after = (np.where(one.extra[_INSIDE] > 0.0, one.extra[n], np.nan) for n in (_BEFORE, _AFTER))
        found.append(Motion(one.source.name, one.t, one.x, before, after))
    return Shown(rows, tuple(found))
