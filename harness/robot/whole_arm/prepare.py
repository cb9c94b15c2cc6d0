"""Every joint's guarded samples and base, and everything that may be missing, from a filtered log."""

from dataclasses import dataclass

import numpy as np

from harness.core.arrays import BoolArray, FloatArray
from harness.robot.arm import Arm
from harness.robot.whole_arm.columns import Candidate, base_columns, friction_candidates, model_candidates
from harness.robot.whole_arm.design import Part
from harness.robot.whole_arm.differentiate import Filtered
from harness.robot.whole_arm.noise import Noise, Stretches
from harness.robot.whole_arm.rules import EITHER_WAY, GUARD, LEAST_SAMPLES, RESTING, SURE
from harness.robot.whole_arm.search import beside_everything


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


_EXACT = 3e-4
"""Share of a joint's rms torque to which filter and columns are exact: less is no noise of a sensor."""
_WIDER = 1.5
"""Times that a guard grows in one step."""
_WIDEST = 8
"""Steps of growth, by then fifteen times the least width."""


@dataclass(frozen=True, slots=True)
class Known:
    """What the user vouches for: the load at the end, the side of the sensor, the scale of the torque."""

    payload: bool = False
    sensor: bool = False
    gain: bool = False


@dataclass(frozen=True, slots=True)
class Problem:
    """filtered : the log, of the joints that move enough. parts : one a joint. guard (k,) : s. rigid, gravity (m, k) :
    torque of the model and of gravity alone, N m. candidates : everything that may be missing.
    """

    filtered: Filtered
    parts: tuple[Part, ...]
    guard: FloatArray
    rigid: FloatArray
    gravity: FloatArray
    candidates: tuple[Candidate, ...]


def moving(filtered: Filtered) -> tuple[int, ...]:
    """Joints with enough guarded samples in both directions."""
    found = []
    for j, dof in enumerate(filtered.dof):
        kept = away(filtered, j, GUARD.value / filtered.band.lowpass)
        v = filtered.v[kept, dof]
        most, fewer = int(np.sum(kept)), min(np.sum(v > 0), np.sum(v < 0))
        if most >= LEAST_SAMPLES.value and fewer >= EITHER_WAY.value * LEAST_SAMPLES.value:
            found.append(j)
    return tuple(found)


def prepare(filtered: Filtered, arm: Arm, known: Known) -> Problem:
    """The problem of a filtered log whose joints all move."""
    rigid = arm.inverse(filtered.q, filtered.v, filtered.a)[:, filtered.dof]
    still = np.zeros_like(filtered.q_fine)
    gravity = arm.inverse(filtered.q_fine, still, still)[:, filtered.dof]
    weight = arm.inverse(filtered.q, np.zeros_like(filtered.q), np.zeros_like(filtered.q))[:, filtered.dof]
    parts, guards, candidates = [], [], []
    for j in range(len(filtered.joints)):
        torque, base = filtered.torque[:, j] - rigid[:, j], base_columns(filtered, j)
        floor = _EXACT * float(np.sqrt(np.mean(filtered.torque[:, j] ** 2)))
        width, kept = _guarded(filtered, j, torque, base, floor)
        guards.append(width)
        candidates += list(friction_candidates(filtered, j, gravity[:, j], kept))
        numbers, noise = _plain(torque, base, kept, floor)
        base, spread = _timed(filtered, j, base, float(numbers[1]))
        parts.append(Part(torque, base, spread, Stretches.of(kept), noise, floor))
    candidates += list(model_candidates(filtered, arm, known.payload, known.sensor, known.gain))
    learnt = tuple(beside_everything(part, j, candidates) for j, part in enumerate(parts))
    return Problem(filtered, learnt, np.array(guards), rigid, weight, tuple(candidates))


def _guarded(
    filtered: Filtered, joint: int, torque: FloatArray, base: FloatArray, floor: float
) -> tuple[float, BoolArray]:
    """Width, s, and samples of the guard that stands when Coulomb friction moves by less than its error."""
    width = GUARD.value / filtered.band.lowpass
    kept = away(filtered, joint, width)
    coulomb = _plain(torque, base, kept, floor)[0][0]
    for _ in range(_WIDEST):
        wider = away(filtered, joint, width * _WIDER)
        if np.sum(wider) < max(LEAST_SAMPLES.value, 0.5 * np.sum(kept)):
            break
        (next_coulomb, *_), next_noise = _plain(torque, base, wider, floor)
        part = Part(torque, base, np.full(base.shape[1], np.inf), Stretches.of(wider), next_noise, floor)
        white = part.white(base)
        error = float(np.sqrt(np.linalg.pinv(white.T @ white)[0, 0]))
        if abs(next_coulomb - coulomb) < error:
            break
        width, kept, coulomb = width * _WIDER, wider, next_coulomb
    return width, kept


def _timed(filtered: Filtered, joint: int, base: FloatArray, viscous: float) -> tuple[FloatArray, FloatArray]:
    """The base with what viscous friction does that acts some time after the rest of the torque, N m/s, and spreads.

    Within one sample a log tells no order of what happened: a controller holds its torque, an integrator takes friction
    from the speed at the end of its step. Left out, this is an inertia of viscous friction times that time.
    """
    column = viscous * filtered.a[:, filtered.dof[joint]]
    spread = np.append(np.full(base.shape[1], np.inf), 1.0 / filtered.band.rate)
    return np.column_stack((base, column)), spread


def _plain(torque: FloatArray, base: FloatArray, kept: BoolArray, floor: float) -> tuple[FloatArray, Noise]:
    """Coulomb, viscous friction and offset by plain least squares, and the noise of what is left."""
    numbers = np.linalg.lstsq(base[kept], torque[kept], rcond=None)[0]
    return np.asarray(numbers, dtype=np.float64), Noise.learnt(
        torque - base @ numbers, Stretches.of(kept), base.shape[1], floor
    )
