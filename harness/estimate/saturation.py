"""Samples at which a sensor stood at the end of its range while the motion went on beyond it.

A sensor at its limit gives the very same number for several samples, and the motion runs into that number and out of it
at full speed. A slider that turns round, rests or is held gives equal numbers too, but it comes to them with a speed
that goes to zero: a parabola through the samples beside the run then ends at the run, and does not go on beyond it.

What of a recording is believed to show the motion: neither the end of a sensor's range nor samples that stray.
"""

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from harness.core.arrays import BoolArray, FloatArray
from harness.core.errors import InputError
from harness.core.recording import Recording
from harness.estimate.noise import Noise, channel_noise
from harness.estimate.stray import without, without_stray

_FEWEST = 3
"""Equal samples that show a limit: of a free motion without quantisation no two are equal."""
_BESIDE = (4, 200)
"""Samples beside a run that the parabola is laid through, as many as the run has."""
_DEPTH = 0.3
"""Of half the swing, how far these may reach down: a parabola through the first .8 rad of a cosine from its turning
point, .3 deep, goes beyond it by a sixth of that."""
_BEYOND = 0.2
"""Of the depth reached, by which the parabola must go beyond: more than it does where the motion comes to rest."""
_CLEAR = 5.0
"""Standard errors by which it must: noise in its place does so once in 3e6, at both sides of a run once in 1e13."""
_STEPS = 3.0
"""Steps of a quantised channel by which it must: one is what rounding hides at a turning point, and its fit doubles."""
_GAP = 3.0
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
        out = saturated(recording.t, y, channel_noise(recording.t, y), speed=name == "v")
        if not out.any():
            continue
        lost |= out
        ends = " and ".join(f"{end:.4g}" for end in np.unique(y[out]))
        unit = {"x": "rad" if recording.angular else "m", "v": "rad/s" if recording.angular else "m/s"}[name]
        many = int(np.count_nonzero(out))
        notes.append(
            f"{name} stops at {ends} {unit} at full speed, as a sensor at its limit does: {many} samples are skipped"
        )
    return without(recording, lost, notes, "within the sensor's range"), tuple(notes)


def saturated(t: FloatArray, y: FloatArray, noise: Noise, speed: bool = False) -> BoolArray:
    """Samples (n,) of a channel y (n,), at times t (n,), s, that are its largest or smallest value and no measurement.

    noise : of the channel. speed : whether what runs down to 0 may rest there. Every sample of that value is one as
    soon as one run of them is shown to be cut off at each side that was recorded.
    """
    found = np.zeros(y.size, dtype=np.bool_)
    if y.size < 2 * _BESIDE[0] or float(np.ptp(y)) == 0.0:
        return found
    for side in (1.0, -1.0):
        limit = float((side * y).max())
        at = side * y == limit
        runs = [one for one in _runs(at) if not (speed and limit == 0.0 and (one[0] == 0 or one[1] == y.size))]
        if any(_cut_off(t, side * y - limit, noise, run) for run in runs):
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
    many = min(max(end - begin, _BESIDE[0]), _BESIDE[1])
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
        chosen = beside[: max(int(reached[0]), _BESIDE[0])] if reached.size else beside
        together = np.sort(np.concatenate((t[chosen], t[inside])))
        told.append(
            chosen.size >= _BESIDE[0]
            and float(below[chosen].min()) >= -2.0 * deepest
            and float(np.diff(together).max()) <= _GAP * usual
            and _goes_beyond(t[chosen], below[chosen], t[inside], noise)
            and not _comes_to_rest(t[chosen], below[chosen], noise)
        )
    return bool(told) and all(told)


def _goes_beyond(t: FloatArray, y: FloatArray, times: FloatArray, noise: Noise) -> bool:
    """Whether the parabola through y (m,) at t (m,) is clearly above 0 at any of the times (k,)."""
    said, error = _said_there(t, y, times, noise)
    least = max(_STEPS * noise.step, -_BEYOND * float(y.min()))
    return bool(np.any((said > _CLEAR * error) & (said > least)))


def _comes_to_rest(t: FloatArray, y: FloatArray, noise: Noise) -> bool:
    """Whether the first 4, 8, .. samples beside a run, of y (m,) at t (m,), contradict that the motion goes on.

    A servo's way from rest to rest bends twice, and one parabola through all of it runs on through the rest.
    """
    near = _BESIDE[0]
    while near <= t.size:
        said, error = _said_there(t[:near], y[:near], 2.0 * t[0] - t[:near], noise)
        if np.all(said + 2.0 * error < -_BEYOND * float(y[:near].min())):
            return True
        near *= 2
    return False


def _said_there(t: FloatArray, y: FloatArray, times: FloatArray, noise: Noise) -> tuple[FloatArray, FloatArray]:
    """What the parabola through y (m,) at t (m,) says at times (k,), and its standard errors."""
    middle, half = float(np.mean(t)), float(np.ptp(t)) / 2.0
    basis = np.vander((t - middle) / half, 3)
    there = np.vander((times - middle) / half, 3)
    inverse = np.linalg.inv(basis.T @ basis)
    error = max(noise.sigma, 0.5 * noise.step) * np.sqrt(np.einsum("ij,jk,ik->i", there, inverse, there))
    return there @ inverse @ (basis.T @ y), error


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
