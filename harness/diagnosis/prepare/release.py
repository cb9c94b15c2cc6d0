"""When the slider was let go, and when the hand was off it: what comes before is no free decay.

A recording may begin while a hand still pulls or holds. The hold shows as a level that the channel leaves for good; the
hand's own part of the release (it gives way over some 10 to 50 ms) shows as what a base model, fitted to what follows
and run from the release, does not meet in the first quarter of a period.
"""

import math

import numpy as np

from harness.core.arrays import FloatArray
from harness.core.errors import InputError, SimulationError
from harness.diagnosis.baseline.base_fit import baseline
from harness.diagnosis.problem import P
from harness.diagnosis.rules import HAND_SHOWN, HAND_STANDS_OUT, HAND_UNUSUAL, HAND_USUAL
from harness.estimate.noise import Noise
from harness.estimate.reversals import HalfCycles

_HOLD = (0.6, 0.15)
"""Stretch before the first turning point, in half-cycles, in which a hold must show."""
_FEWEST_HELD = 3
"""Samples that show a hold: of a free motion they lie apart by half of its swing."""
_FEWEST = 5
"""Samples that show a hand."""
_LEAVES = 5.0
"""Standard deviations of noise, and the share of the swing, beyond which a channel has left its hold."""
_SHARE_OF_SWING = 0.003
"""As _LEAVES, of the swing: a hand's tremor."""
_MOSTLY = 0.9
"""Share of its samples that lie on a hold; the others are stray."""
_FIRST_HALF = {False: (1.0,), True: (1.0, 1.4, 1.9)}
"""Half-cycles, in usual ones, that the first may last: of a spring, and of a pendulum let go from high up."""
_LONGEST_HALF = {False: 1.35, True: 2.2}
"""Half-cycles before the first reversal that a free motion can last, of a spring and of a pendulum swung high."""
_CLEAR = 2
"""Samples left out after the last that shows the hand."""


def released(t: FloatArray, y: FloatArray, noise: Noise, found: HalfCycles, displacement: bool, pendulum: bool) -> int:
    """First sample after the release, 0 when the recording begins in free motion.

    y (n,) : the channel in which the half-cycles were found; displacement : whether that is x.
    """
    half = found.half_time
    turn = float(found.edges[1])
    for first_half in _FIRST_HALF[pendulum]:
        begin = _left_hold(t, y, noise, turn - first_half * half, turn, half, displacement)
        if begin > 0:
            return begin
    if t[0] < turn - _LONGEST_HALF[pendulum] * half:
        # a hand moved it up to this point, where it turned back: free since then, or not much later
        return int(np.searchsorted(t, turn))
    return 0


def _left_hold(
    t: FloatArray, y: FloatArray, noise: Noise, around: float, turn: float, half: float, displacement: bool
) -> int:
    """First sample after a hold that ends ``around`` (s), 0 where there is none."""
    low, high = np.searchsorted(t, (around - _HOLD[0] * half, around - _HOLD[1] * half))
    if high - low < _FEWEST_HELD:
        return 0
    level = float(np.median(y[low:high]))
    tolerance = max(_LEAVES * noise.sigma, _SHARE_OF_SWING * float(np.ptp(y)))
    inside = np.abs(y - level) <= tolerance
    if np.mean(inside[low:high]) <= _MOSTLY:
        return 0
    until = int(np.searchsorted(t, turn if displacement else around + 0.25 * half))
    last = int(low) + int(np.flatnonzero(inside[low:until])[-1])
    if not displacement:
        return last + 1
    # it leaves along a parabola, from rest
    push = (math.pi / half) ** 2 * abs(level - 0.5 * float(y.max() + y.min()))
    return max(int(np.searchsorted(t, t[last] - math.sqrt(2.0 * tolerance / max(push, 1e-300)))), 1)


def without_hand(problem: P, half: float, within: float = HAND_SHOWN.value) -> tuple[P, float]:
    """A free decay from the first sample on that a hand no longer touches, and for how long one did, s.

    half : of a half-cycle, s. within : half-cycles in which it is looked for.
    """
    t = problem.t
    first = int(np.searchsorted(t, t[0] + within * half))
    usual = int(np.searchsorted(t, t[0] + (within + HAND_USUAL.value) * half))
    if first < _FEWEST or usual >= t.size:
        return problem, 0.0
    try:
        found, _ = baseline(problem.weighted(np.arange(t.size) >= first))
    except (InputError, SimulationError):
        return problem, 0.0
    off = 0
    for name, y in problem.channels.items():
        residual = np.abs(y - found.shown.y[name])
        level = math.sqrt(float(np.mean(residual[first:usual] ** 2)))
        stands_out = max(HAND_STANDS_OUT.value * problem.noise[name].sigma, HAND_UNUSUAL.value * level)
        out = np.flatnonzero(residual[:first] > stands_out)
        if out.size > _CLEAR:
            off = max(off, int(out[-1]) + 1 + _CLEAR)
    return (problem.part(slice(off, None)), float(t[off] - t[0])) if off else (problem, 0.0)
