"""What of a recording is believed to show the motion: neither the end of a sensor's range nor samples that stray.

Straying samples leave the motion and come back to it at once, as a tracker that lost its mark for a few frames. What
has a mass cannot do that. The cubic through the samples on both sides tells the two apart: it goes through these
as well as noise lets it where the samples between them are wrong, and badly where the motion itself has a corner or a
step. Of corners, steps, bounces and sines of eight samples a period and more no run of six lies further off the cubic
throughout than 5.7 times what the sides leave (tests/estimate/test_stray.py).

A sensor at its limit gives the very same number for several samples, and the motion runs into that number and out of it
at full speed. A slider that turns round, rests or is held gives equal numbers too, but it comes to them with a speed
that goes to zero: a parabola through the samples beside the run then ends at the run, and does not go on beyond it.
"""

import math
from collections.abc import Iterator, Sequence
from dataclasses import replace

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
        raise InputError(recording.file, found, f"at least {MINIMUM_SAMPLES} {which} are accepted")
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
            off = stray(t, y, channel_noise(t, y))
            if off.any():
                found[name] = off
                notes.append(_said(name, t, off, _UNITS[name][recording.angular]))
    return found, tuple(notes)


def _said(name: str, t: FloatArray, off: FloatArray, unit: str) -> str:
    many, first = int(np.count_nonzero(off)), float(t[np.flatnonzero(off)[0]])
    far = f"by {'up to ' if many > 1 else ''}{float(np.abs(off).max()):.2g} {unit} and"
    at = f"the first at t = {first:.6g} s" if many > 1 else f"at t = {first:.6g} s"
    stray = f"{many} samples of {name} stray" if many > 1 else f"1 sample of {name} strays"
    return f"{stray} from the motion {far} come{'' if many > 1 else 's'} back at once ({at}): left out"


def stray(t: FloatArray, y: FloatArray, noise: Noise) -> FloatArray:
    """How far samples of a channel y (n,) at times t (n,), s, stray, (n,) in its unit; 0 for those that do not.

    noise : of the channel.
    """
    found, kept = np.zeros(y.size), np.arange(y.size)
    gap = _GAP * float(np.median(np.diff(t))) if t.size > 1 else 0.0
    for _ in range(_TURNS):
        times, values = t[kept], y[kept]
        usual = _compiled_alone(times, values, gap) if times.size > 2 * _BESIDE else np.zeros(0)
        if not usual.size:
            break
        others = _BEYOND_OTHERS * float(np.quantile(usual, _OTHERS))
        off = _compiled_strays(times, values, gap, max(_CLEAR * noise.sigma, _STEPS * noise.step, others))
        if not off.any():
            break
        found[kept] = off
        kept = kept[off == 0.0]
    return found


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


_compiled_cubic = compiled(_cubic)


def _beside_cubic(
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
    _compiled_cubic(t, y, places, middle, half, least)
    left = 0.0
    for i in range(first, last):
        r = (t[i] - middle) / half
        off[i] = y[i] - (least[4, 0] + r * (least[4, 1] + r * (least[4, 2] + r * least[4, 3])))
        if i < begin or i >= end:
            left += off[i] * off[i]
    return math.sqrt(left / (2 * _BESIDE - 4))


beside_cubic = compiled(_beside_cubic)


def _alone(t: FloatArray, y: FloatArray, gap: float) -> FloatArray:
    """How far each sample with neighbours is off the cubic through them."""
    out, off, least = np.empty(y.size), np.empty(y.size), np.empty((5, 4))
    many = 0
    for begin in range(_BESIDE, y.size - _BESIDE):
        if beside_cubic(t, y, begin, begin + 1, gap, off, least) < math.inf:
            out[many] = abs(off[begin])
            many += 1
    return out[:many]


_compiled_alone = compiled(_alone)


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
                if np.all(np.abs(off[begin:end]) > beyond):
                    out[begin:end] = off[begin:end]
                    after = end
        begin = after
    return out


_compiled_strays = compiled(_strays)


_FEWEST = 3
"""Equal samples that show a limit: of a free motion without quantisation no two are equal."""
_BESIDE_SATURATION = (4, 200)
"""Samples beside a run that the parabola is laid through, as many as the run has."""
_DEPTH = 0.3
"""Of half the swing, how far these may reach down: a parabola through the first .8 rad of a cosine from its turning
point, .3 deep, goes beyond it by a sixth of that."""
_BEYOND = 0.2
"""Of the depth reached, by which the parabola must go beyond: more than it does where the motion comes to rest."""
_CLEAR_SATURATION = 5.0
"""Standard errors by which it must: noise in its place does so once in 3e6, at both sides of a run once in 1e13."""
_STEPS_SATURATION = 3.0
"""Steps of a quantised channel by which it must: one is what rounding hides at a turning point, and its fit doubles."""
_GAP_SATURATION = 3.0
"""Usual sampling intervals that part what is beside each other."""


def within_range(recording: Recording, channels: Sequence[str]) -> tuple[Recording, tuple[str, ...]]:
    """A recording without the samples at which one of the channels is saturated, and a sentence on each that is.

    Raises InputError where too few samples are left.
    """
    lost, notes = np.zeros(len(recording), dtype=np.bool_), []
    for name in channels:
        if name not in recording:
            continue
        y = recording[name]
        out = saturated(recording.t, y, channel_noise(recording.t, y))
        if not out.any():
            continue
        lost |= out
        ends = " and ".join(f"{end:.4g}" for end in np.unique(y[out]))
        unit = {"x": "rad" if recording.angular else "m", "v": "rad/s" if recording.angular else "m/s"}[name]
        many = int(np.count_nonzero(out))
        notes.append(
            f"{name} stops at {ends} {unit} at full speed, as a sensor at its limit does: {many} samples are left out"
        )
    return without(recording, lost, notes, "within the sensor's range"), tuple(notes)


def saturated(t: FloatArray, y: FloatArray, noise: Noise) -> BoolArray:
    """Samples (n,) of a channel y (n,), at times t (n,), s, that are its largest or smallest value and no measurement.

    noise : of the channel. Every sample of that value is one as soon as one run of them is shown to be cut off at each
    side that was recorded.
    """
    found = np.zeros(y.size, dtype=np.bool_)
    if y.size < 2 * _BESIDE_SATURATION[0] or float(np.ptp(y)) == 0.0:
        return found
    for side in (1.0, -1.0):
        limit = float((side * y).max())
        at = side * y == limit
        if any(_cut_off(t, side * y - limit, noise, run) for run in _runs(at)):
            found |= at
    return found


def limits(t: FloatArray, y: FloatArray, noise: Noise) -> tuple[float, ...]:
    """Ends of the range at which a sensor of acceleration stood; none where it did not. y, t as for ``saturated``.

    An acceleration neither rests at its extremes nor comes to them slowly: friction makes it jump there. So where noise
    is seen in more than steps, equal extreme values one after another are the sensor's. Reversals lie beyond them.
    """
    if noise.step > 0.0 or not noise.found:
        return tuple(np.unique(y[saturated(t, y, noise)]).tolist())
    return tuple(end for end in (float(y.min()), float(y.max())) if next(_runs(y == end), None) is not None)


def limit_said(ends: Sequence[float], angular: bool) -> str:
    """That an acceleration's sensor stood at these ends, in words."""
    unit = "rad/s^2" if angular else "m/s^2"
    return f"acceleration stops at {' and '.join(f'{end:.4g}' for end in ends)} {unit}, as a sensor at its limit does"


def _runs(at: BoolArray) -> Iterator[tuple[int, int]]:
    """Begin and end of the runs that are long enough."""
    edges = np.flatnonzero(np.diff(np.concatenate(([False], at, [False])).astype(np.int8)))
    for begin, end in zip(edges[::2], edges[1::2], strict=True):
        if end - begin >= _FEWEST:
            yield int(begin), int(end)


def _cut_off(t: FloatArray, below: FloatArray, noise: Noise, run: tuple[int, int]) -> bool:
    """Whether the motion goes on beyond a run at 0, as the samples beside it tell; below (n,) : the rest, negative."""
    begin, end = run
    many = min(max(end - begin, _BESIDE_SATURATION[0]), _BESIDE_SATURATION[1])
    near, usual, deepest = (end - begin + 1) // 2, float(np.median(np.diff(t))), 0.5 * _DEPTH * float(np.ptp(below))
    told = []
    # outwards from the run; where the recording begins or ends in it, the other side alone tells
    for beside, inside in (
        (np.arange(begin - 1, max(begin - many, 0) - 1, -1), np.arange(begin, begin + near)),
        (np.arange(end, min(end + many, t.size)), np.arange(end - 1, end - 1 - near, -1)),
    ):
        if beside.size == 0:
            continue
        reached = np.flatnonzero(below[beside] < -deepest)
        chosen = beside[: max(int(reached[0]), _BESIDE_SATURATION[0])] if reached.size else beside
        together = np.sort(np.concatenate((t[chosen], t[inside])))
        told.append(
            chosen.size >= _BESIDE_SATURATION[0]
            and float(below[chosen].min()) >= -2.0 * deepest
            and float(np.diff(together).max()) <= _GAP_SATURATION * usual
            and _goes_beyond(t[chosen], below[chosen], t[inside], noise)
        )
    return bool(told) and all(told)


def _goes_beyond(t: FloatArray, y: FloatArray, times: FloatArray, noise: Noise) -> bool:
    """Whether the parabola through y (m,) at t (m,) is clearly above 0 at any of the times (k,)."""
    middle, half = float(np.mean(t)), float(np.ptp(t)) / 2.0
    basis = np.vander((t - middle) / half, 3)
    there = np.vander((times - middle) / half, 3)
    inverse = np.linalg.inv(basis.T @ basis)
    said = there @ inverse @ (basis.T @ y)
    error = max(noise.sigma, 0.5 * noise.step) * np.sqrt(np.einsum("ij,jk,ik->i", there, inverse, there))
    least = max(_STEPS_SATURATION * noise.step, -_BEYOND * float(y.min()))
    return bool(np.any((said > _CLEAR_SATURATION * error) & (said > least)))


def believed(recording: Recording, channels: Sequence[str]) -> tuple[Recording, tuple[str, ...]]:
    """A recording without samples of these channels that are no measurement, and a sentence on each kind of them.

    Raises InputError where too few samples are left.
    """
    # a short stop at the end of a range would count as straying
    recording, beyond = within_range(recording, channels)
    recording, stray = without_stray(recording, channels)
    return recording, (*beyond, *stray)


def without_limited(recording: Recording) -> tuple[Recording, tuple[str, ...]]:
    """A recording without an acceleration whose sensor stood at its limit, and a sentence on it.

    Friction makes an acceleration jump at its extremes, which then lie beyond the limit: what is left of it says little
    of friction, and says it wrongly. Raises InputError where nothing else was recorded.
    """
    ends = limits(recording.t, recording["a"], channel_noise(recording.t, recording["a"])) if "a" in recording else ()
    if not ends:
        return recording, ()
    at = np.isin(recording["a"], ends)
    stops, many = limit_said(ends, recording.angular), int(np.count_nonzero(at))
    others = {c: y for c, y in recording.channels.items() if c != "a"}
    if not any(c in others for c in ("x", "v")):
        found = f"{stops}: {many} samples, and its reversals lie beyond"
        # a diagnosis fits the limit beside the motion
        raise InputError(f"{recording.file}: channel a", found, f"try: harness diagnose {recording.file}")
    return replace(recording, channels=others), (f"{stops}: {many} samples, and it was not used",)
