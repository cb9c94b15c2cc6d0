"""Every joint's guarded samples and base, and everything that may be missing, from a filtered log."""

from dataclasses import dataclass, replace

import numpy as np

from harness.core.arrays import BoolArray, FloatArray
from harness.robot.arm import Arm
from harness.robot.whole_arm.columns import Candidate, friction_candidates, model_candidates, signs
from harness.robot.whole_arm.design import Part, Parts
from harness.robot.whole_arm.differentiate import Filtered
from harness.robot.whole_arm.noise import Noise, Stretches
from harness.robot.whole_arm.rules import GUARD, LEAST_SAMPLES

_EXACT = 3e-4
"""Share of a joint's rms torque to which filter and columns are exact: less is no noise of a sensor."""
_WIDER = 1.5
"""Times that a guard grows in one step."""
_WIDEST = 8
"""Steps of growth, by then fifteen times the least width."""
_SEEN = 1e-8
"""Share of the largest eigenvalue below which columns are taken for alike."""
_SETTINGS = 3
"""Of each candidate that the noise is learnt beside."""


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
    parts: Parts
    guard: tuple[float, ...]
    rigid: FloatArray
    gravity: FloatArray
    candidates: tuple[Candidate, ...]


def prepare(filtered: Filtered, arm: Arm, known: Known) -> Problem:
    """The problem of a filtered log whose joints all move."""
    rigid = arm.inverse(filtered.q, filtered.v, filtered.a)[:, filtered.dof]
    gravity, weight = (
        arm.inverse(q, np.zeros_like(q), np.zeros_like(q))[:, filtered.dof] for q in (filtered.q_fine, filtered.q)
    )
    parts, guards, candidates = {}, [], list[Candidate]()
    for j, dof in enumerate(filtered.dof):
        torque, v = filtered.torque[:, j] - rigid[:, j], filtered.v[:, dof]
        sign = filtered.column(signs(filtered.v_fine[:, dof]), jumps=True)
        base = np.stack((sign, v, np.ones_like(sign)), axis=1)
        floor = _EXACT * float(np.sqrt(np.mean(filtered.torque[:, j] ** 2)))
        width, kept, numbers, noise = _guarded(filtered, j, torque, base, floor)
        guards.append(width)
        candidates += friction_candidates(filtered, j, gravity[:, j], kept)
        # What viscous friction does that acts some time after the rest of the torque. Within one sample a log tells no
        # order of what happened: a controller holds its torque, an integrator takes friction from the speed at the end
        # of its step. Left out, this is an inertia of viscous friction times that time.
        base = np.column_stack((base, float(numbers[1]) * filtered.a[:, dof]))
        spread = np.array([np.inf, np.inf, np.inf, 1.0 / filtered.band.rate])
        parts[j] = Part(torque, base, spread, Stretches.of(kept), noise, floor)
    candidates += model_candidates(filtered, arm, known.payload, known.sensor, known.gain)
    learnt = {j: _beside_everything(part, j, candidates) for j, part in parts.items()}
    return Problem(filtered, learnt, tuple(guards), rigid, weight, tuple(candidates))


def _guarded(
    filtered: Filtered, joint: int, torque: FloatArray, base: FloatArray, floor: float
) -> tuple[float, BoolArray, FloatArray, Noise]:
    """Width, s, and samples of the guard that stands when Coulomb friction moves by less than its error.

    With them Coulomb, viscous friction and offset by plain least squares, and the noise of what is left.
    """

    def plain(width: float) -> tuple[float, BoolArray, FloatArray, Noise]:
        kept = filtered.away(joint, width)
        numbers = np.linalg.lstsq(base[kept], torque[kept], rcond=None)[0]
        noise = Noise.learnt(torque - base @ numbers, Stretches.of(kept), base.shape[1], floor)
        return width, kept, np.asarray(numbers, dtype=np.float64), noise

    found = plain(GUARD.value / filtered.band.lowpass)
    for _ in range(_WIDEST):
        width, kept, (coulomb, *_), _ = found
        if np.sum(filtered.away(joint, width * _WIDER)) < max(LEAST_SAMPLES.value, 0.5 * np.sum(kept)):
            break
        wider = plain(width * _WIDER)
        white = wider[3].whitened(base, Stretches.of(wider[1]))
        if abs(wider[2][0] - coulomb) < float(np.sqrt(np.linalg.pinv(white.T @ white)[0, 0])):
            break
        found = wider
    return found


def _beside_everything(part: Part, joint: int, candidates: list[Candidate]) -> Part:
    """A part whose noise is learnt from what all candidates together leave of its torque."""
    kept = part.stretches.kept
    columns = [part.base]
    for candidate in (one for one in candidates if one.joint in (joint, None)):
        count = len(candidate.values)
        places = np.unique(np.linspace(0, count - 1, min(count, _SETTINGS)).round().astype(int))
        columns += [candidate.torque(candidate.values[i])[joint] for i in places]
    everything = np.hstack(columns)
    size = np.sqrt(np.mean(everything[kept] ** 2, axis=0))
    everything = everything[:, size > 0.0] / size[size > 0.0]
    power, turn = np.linalg.eigh(everything[kept].T @ everything[kept])
    seen = power > _SEEN * power[-1]
    u = everything[kept] @ (turn[:, seen] / np.sqrt(power[seen]))
    left = np.zeros(kept.size)
    left[kept] = part.torque[kept] - u @ (u.T @ part.torque[kept])
    return replace(part, noise=Noise.learnt(left, part.stretches, u.shape[1], part.floor))
