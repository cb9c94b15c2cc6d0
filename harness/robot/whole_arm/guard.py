"""Which samples lie away from reversals: there the sign of the speed is sure and friction slides."""

import numpy as np

from harness.core.arrays import BoolArray, FloatArray
from harness.robot.whole_arm.differentiate import Filtered
from harness.robot.whole_arm.rules import RESTING, SURE


def sure_speed(filtered: Filtered, joint: int) -> float:
    """Speed from which its sign is sure, rad/s."""
    fast = float(np.quantile(np.abs(filtered.v_fine[:, filtered.dof[joint]]), 0.95))
    return max(SURE.value * float(filtered.velocity_noise[joint]), RESTING.value * fast)


def away(filtered: Filtered, joint: int, width: float) -> BoolArray:
    """Samples (m,) over whose whole +-``width``, s, a joint moves one way at a sure speed."""
    v = filtered.v_fine[:, filtered.dof[joint]]
    slow = np.abs(v) <= sure_speed(filtered, joint)
    slow[1:] |= np.sign(v[1:]) != np.sign(v[:-1])
    return filtered.good & filtered.at(~widened(slow, round(width * filtered.fine.rate)))


def widened(mask: BoolArray, reach: int) -> BoolArray:
    """A mask (n,) with ``reach`` more on either side of what it holds."""
    total = np.concatenate(([0], np.cumsum(mask)))
    rows = np.arange(mask.size)
    return np.asarray(total[np.minimum(rows + reach + 1, mask.size)] - total[np.maximum(rows - reach, 0)] > 0)


def reversals(v: FloatArray, sure: float) -> FloatArray:
    """Where (r,) in samples the speed (n,) changes its sign, from beyond one sure level to beyond the other."""
    side = np.where(v > sure, 1, np.where(v < -sure, -1, 0))
    known = np.flatnonzero(side)
    turns = np.flatnonzero(side[known][1:] != side[known][:-1])
    return (known[turns] + known[turns + 1]) / 2.0
