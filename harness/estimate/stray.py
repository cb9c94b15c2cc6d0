"""Samples that stray from the motion and come back to it at once, as a tracker that lost its mark for a few frames.

What has a mass cannot do that. The cubic through the samples on both sides tells the two apart: it goes through these
as well as noise lets it where the samples between them are wrong, and badly where the motion itself has a corner or a
step. Of corners, steps, bounces and sines of eight samples a period and more no run of six lies further off the cubic
throughout than 5.7 times what the sides leave (tests/estimate/test_saturation.py).
"""

import math
from collections.abc import Sequence

import numpy as np

from harness.core.arrays import BoolArray, FloatArray, IntArray
from harness.core.errors import InputError
from harness.core.jit import compiled
from harness.core.recording import MINIMUM_SAMPLES, Recording
from harness.estimate.noise import Noise, channel_noise


def without(recording: Recording, lost: BoolArray, notes: Sequence[str], which: str) -> Recording:
    """The samples that are not ``lost`` (n,).

    notes : a sentence on each kind of them. which : those that are accepted, "within the sensor's range".
    Raises InputError where too few are left.
    """
    if not lost.any():
        return recording
    kept = int(np.count_nonzero(~lost))
    if kept < MINIMUM_SAMPLES:
        found = f"{notes[0]}, and {kept} stay"
        raise InputError(recording.file, found, f"at least {MINIMUM_SAMPLES} {which}")
    return recording.cut(~lost)


_LONGEST = 6
"""Samples in a row that may stray: what lasts longer may be motion."""
_BESIDE = 5
"""Samples at either side that the cubic is laid through."""
_CLEAR = 10.0
"""How many times as far off as the sides leave, and as the noise, the nearest of them must be."""
_STEPS = 5.0
"""Steps of a quantised channel by which it must be."""
_GAP = 3.0
"""Usual sampling intervals that part what is beside each other."""
_OTHERS, _BEYOND_OTHERS = 0.9, 3.0
"""Share of all samples that stray less, and how many times less: what is coarsely sampled is off everywhere."""
_ENOUGH = 100_000
"""Samples that tell what the others are off."""
_LONE = 1.0
"""Times the range of its four neighbours by which a lone sample lies outside of it."""
_TURNS = 4
"""How often is looked again: what strays hides what strays beside it."""
_UNITS = {"x": ("m", "rad"), "v": ("m/s", "rad/s")}


def without_stray(recording: Recording, channels: Sequence[str]) -> tuple[Recording, tuple[str, ...]]:
    """A recording without the samples at which one of the channels strays, and a sentence on each that does.

    Raises InputError where too few samples are left.
    """
    off, notes = stray_in(recording, channels)
    lost = np.zeros(len(recording), dtype=np.bool_)
    for values in off.values():
        lost |= values != 0.0
    return without(recording, lost, notes, "that do not"), notes


def stray_in(recording: Recording, channels: Sequence[str]) -> tuple[dict[str, FloatArray], tuple[str, ...]]:
    """How far the samples of channels stray, (n,) each, and a sentence on each channel of which one does."""
    found, notes = {}, []
    for name in channels:
        if name in recording:
            t, y = recording.t, recording[name]
            # what a lone sample that is far enough off makes of the noise would hide it
            off = stray(t, y, channel_noise(t, without_spikes(y)))
            if off.any():
                found[name] = off
                notes.append(_said(name, t, off, _UNITS[name][recording.angular]))
    return found, tuple(notes)


def _said(name: str, t: FloatArray, off: FloatArray, unit: str) -> str:
    many, first = int(np.count_nonzero(off)), float(t[np.flatnonzero(off)[0]])
    far = f"by {'up to ' if many > 1 else ''}{float(np.abs(off).max()):.2g} {unit} and"
    at = f"the first at t = {first:.6g} s" if many > 1 else f"at t = {first:.6g} s"
    stray = f"{many} samples of {name} stray" if many > 1 else f"1 sample of {name} strays"
    return f"{stray} from the motion {far} come{'' if many > 1 else 's'} back at once ({at}): skipped"


def without_spikes(y: FloatArray) -> FloatArray:
    """Samples (n,) that stray alone put between their neighbours: what lies far outside both sides of them."""
    before, after = np.maximum(y[:-4], y[1:-3]), np.maximum(y[3:-1], y[4:])
    top = np.maximum(before, after)
    bottom = np.minimum(np.minimum(y[:-4], y[1:-3]), np.minimum(y[3:-1], y[4:]))
    out, room = y.copy(), _LONE * (top - bottom)
    out[2:-2] = np.where((y[2:-2] > top + room) | (y[2:-2] < bottom - room), 0.5 * (y[1:-3] + y[3:-1]), y[2:-2])
    return out


def stray(t: FloatArray, y: FloatArray, noise: Noise) -> FloatArray:
    """How far samples of a channel y (n,) at times t (n,), s, stray, (n,) in its unit; 0 for those that do not.

    noise : of the channel.
    """
    found, kept = np.zeros(y.size), None
    gap = _GAP * float(np.median(np.diff(t)[:: max(t.size // _ENOUGH, 1)])) if t.size > 1 else 0.0
    for _ in range(_TURNS):
        # copies, as a kernel is compiled anew for what cannot be written
        times, values = (t.copy(), y.copy()) if kept is None else (t[kept], y[kept])
        usual = _alone(times, values, gap, max(times.size // _ENOUGH, 1)) if times.size > 2 * _BESIDE else np.zeros(0)
        if not usual.size:
            break
        others = _BEYOND_OTHERS * float(np.quantile(usual, _OTHERS))
        off = _strays(times, values, gap, max(_CLEAR * noise.sigma, _STEPS * noise.step, others))
        if not off.any():
            break
        found[slice(None) if kept is None else kept] = off
        kept = np.flatnonzero(found == 0.0)
    return found


@compiled
def _cubic(t: FloatArray, y: FloatArray, places: IntArray, middle: float, half: float, least: FloatArray) -> None:
    """Coefficients of the cubic of (t - middle) / half through y at ``places`` (m,), by least squares, into row 4.

    least (5, 4) : scratch, normal equations and what they say.
    """
    least[:] = 0.0
    for at in places:
        r, power = (t[at] - middle) / half, 1.0
        for i in range(4):
            least[4, i] += power * y[at]
            other = power
            for j in range(i + 1):
                least[i, j] += other * r**j
            power *= r
    # by Cholesky's factors, in place
    for i in range(4):
        for j in range(i + 1):
            total = least[i, j]
            for k in range(j):
                total -= least[i, k] * least[j, k]
            least[i, j] = math.sqrt(total) if i == j else total / least[j, j]
        for k in range(i):
            least[4, i] -= least[i, k] * least[4, k]
        least[4, i] /= least[i, i]
    for i in range(3, -1, -1):
        for k in range(i + 1, 4):
            least[4, i] -= least[k, i] * least[4, k]
        least[4, i] /= least[i, i]


@compiled
def beside_cubic(
    t: FloatArray, y: FloatArray, begin: int, end: int, gap: float, off: FloatArray, least: FloatArray
) -> float:
    """How far y from begin to end is off the cubic through what is beside it, into off (n,); returns what that leaves
    of the sides, root of the mean square; infinity where a gap parts them.
    """
    first, last = begin - _BESIDE, end + _BESIDE
    for i in range(first + 1, last):
        if t[i] - t[i - 1] > gap:
            return math.inf
    middle, half = 0.5 * (t[first] + t[last - 1]), 0.5 * (t[last - 1] - t[first])
    places = np.empty(2 * _BESIDE, dtype=np.int64)
    for i in range(_BESIDE):
        places[i], places[_BESIDE + i] = first + i, end + i
    _cubic(t, y, places, middle, half, least)
    left = 0.0
    for i in range(first, last):
        r = (t[i] - middle) / half
        off[i] = y[i] - (least[4, 0] + r * (least[4, 1] + r * (least[4, 2] + r * least[4, 3])))
        if i < begin or i >= end:
            left += off[i] * off[i]
    return math.sqrt(left / (2 * _BESIDE - 4))


@compiled
def _alone(t: FloatArray, y: FloatArray, gap: float, every: int) -> FloatArray:
    """How far each sample with neighbours, or every so manieth, is off the cubic through them."""
    out, off, least = np.empty(y.size), np.empty(y.size), np.empty((5, 4))
    many = 0
    for begin in range(_BESIDE, y.size - _BESIDE, every):
        if beside_cubic(t, y, begin, begin + 1, gap, off, least) < math.inf:
            out[many] = abs(off[begin])
            many += 1
    return out[:many]


@compiled
def _strays(t: FloatArray, y: FloatArray, gap: float, nearest: float) -> FloatArray:
    """How far samples stray, 0 for those that do not; of runs that begin together the longest.

    nearest : how far, in the unit of y, each of a run must be off.
    """
    out, off, least = np.zeros(y.size), np.empty(y.size), np.empty((5, 4))
    begin = _BESIDE
    while begin < y.size - _BESIDE:
        after = begin + 1
        # what does not jump is not looked at: most of a finely sampled recording
        if abs(y[begin] - 2.0 * y[begin - 1] + y[begin - 2]) >= 0.5 * nearest:
            for end in range(begin + 1, min(begin + _LONGEST, y.size - _BESIDE) + 1):
                beyond = max(nearest, _CLEAR * beside_cubic(t, y, begin, end, gap, off, least))
                strays = True
                for i in range(begin, end):
                    strays = strays and abs(off[i]) > beyond
                if strays:
                    for i in range(begin, end):
                        out[i] = off[i]
                    after = end
        begin = after
    return out
