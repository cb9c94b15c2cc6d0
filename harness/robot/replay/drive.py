"""What a joint is driven by, and the stretches of a log in which it is simulated."""

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from harness.core.arrays import FloatArray
from harness.core.robot import JointLog
from harness.robot.arm import Arm
from harness.robot.smooth import Even

WINDOW = 0.5
"""s: an error of the torque grows with its square into one of the position, noise of the start only with itself."""
_MOST = 60
"""Windows, spread evenly over the log."""


@dataclass(frozen=True, slots=True)
class Drive:
    """A log at the steps of a simulation; everything (n, nv) or (n,) in SI units.

    at : number of the joint. t : s, of step dt (s). q, v, a : smoothed positions, speeds and accelerations of every
    joint. u : torque on the joint from each time to the next. windows : first and last step of each. led : whether the
    others move.
    """

    at: int
    dt: float
    t: FloatArray
    q: FloatArray
    v: FloatArray
    a: FloatArray
    u: FloatArray
    windows: tuple[tuple[int, int], ...]

    @property
    def others(self) -> list[int]:
        """Joints that are led along the log."""
        return [i for i in range(self.q.shape[1]) if i != self.at]

    def errors(self, q: FloatArray, v: FloatArray) -> dict[str, float]:
        """Rms over all windows of position (x) and speed (v) of the joint against the log; nan where it was left."""
        kept = [np.arange(first + 1, last + 1) for first, last in self.windows]
        at = np.concatenate(kept) if kept else np.zeros(0, dtype=np.int64)
        found = {"x": q[at] - self.q[at, self.at], "v": v[at] - self.v[at, self.at]}
        return {name: float(np.sqrt(np.mean(error**2))) for name, error in found.items()}


def drive_of(arm: Arm, log: JointLog, joint: str, held: Mapping[str, float], offset: float = 0.0) -> Drive:
    """A log as it drives a joint; held : positions of joints that are not logged. offset : taken off its torque, N m.

    A joint without an effort swings freely.
    """
    even = Even.of(log.t)
    inside = even.t[even.settled()]
    dt = float(arm.model.opt.timestep)
    t = np.arange(float(inside[0]), float(inside[-1]), dt)
    still = np.array([held.get(name, float(arm.model.qpos0[i])) for i, name in enumerate(arm.joints)])
    q, v, a = (np.column_stack([np.interp(t, even.t, one) for one in y.T]) for y in even.motion(arm, log, still))
    u = np.zeros(t.size)
    if joint in log.effort:
        u = np.interp(t + 0.5 * dt, log.t, log.effort[joint]) - offset
    length = round(WINDOW / dt)
    count = (t.size - 1) // max(length, 1)
    starts = range(0, count, max(1, math.ceil(count / _MOST)))
    return Drive(arm.index(joint), dt, t, q, v, a, u, tuple((k * length, (k + 1) * length) for k in starts))
