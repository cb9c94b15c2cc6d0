"""Whether the speed of a motion keeps one sign and falls: a run-down, or backwards in time a spin-up.

A slider on a spring turns round, or creeps back without: the latter looks like a wheel with viscous friction alone.
"""

import math
from dataclasses import dataclass

import numpy as np

from harness.core.arrays import FloatArray
from harness.core.recording import MINIMUM_SAMPLES, Recording
from harness.diagnosis.problems.run_down import WINDOWS, Course

_CLEAR = 5.0
"""Standard errors of a window's speed from which it moves, at its fastest and by what it loses."""
_LOST, _ALIKE = 0.15, 3
"""Of the first speed, that a run-down loses at least; windows whose median a speed is."""
_BACK = 0.1
"""Of the speed lost, that may be won back: a ripple or a knock does so."""
_STOPPED = 0.01
"""Of the fastest speed: slower is rest."""
_LEVEL, _HELD = 0.98, 0.3
"""Of the fastest speed, until which it was held; there it loses less than this share of what it loses afterwards."""
_REST = 0.1
"""How long a rest is kept after the stop, in times of the run-down: it says where and when it stopped."""
_AGAINST, _NEARLY, _LONGER = 0.2, 0.1, 1.3
"""Of the fastest speed: what goes the other way; from rest and from the fastest, between which it is brought to speed
and slows; how much longer the one lasts than the other."""
_SHORTEST = 4
"""Windows that it takes to slow, at least."""
_SLOW, _MOST_OF_IT = 0.25, 0.5
"""Of the fastest speed, nearly rest; share of the time that several run-downs of one file take."""
_FINE, _SURE = 256, 0.02
"""Windows in which the beginning and the stop are looked for; fewer until errors are so much of the fastest speed."""


@dataclass(frozen=True, slots=True)
class _Falling:
    """Speeds (m,) of one sign, as amounts, and their standard errors."""

    t: FloatArray
    speed: FloatArray
    sd: FloatArray

    @classmethod
    def of(cls, recording: Recording, part: slice, windows: int) -> "_Falling":
        channels = {c: recording[c][part] for c in ("x", "v") if c in recording}
        course = Course.of(recording.t[part], channels, windows)
        return cls(course.t, course.v * np.sign(course.v[np.argmax(np.abs(course.v))]), course.v_sd)

    def lost_before(self, begin: float) -> float:
        """What it lost since the last rest before a time: what is driven slows again and again."""
        before = self.speed[self.t < begin]
        rests = np.flatnonzero(before <= _STOPPED * float(np.max(self.speed)))
        steps = np.diff(before[rests[-1] :] if rests.size else before)
        return float(np.sum(np.maximum(-steps - float(np.median(self.sd)), 0.0)))

    @property
    def let_go(self) -> bool:
        """Whether it goes one way alone, and slows for longer than it was brought to speed: a hand does both alike."""
        v, n = self.speed / float(np.max(self.speed)), self.speed.size
        if np.any(v < -np.maximum(_AGAINST, _CLEAR * self.sd / float(np.max(self.speed)))):
            return False
        first, last = np.flatnonzero(v >= 1.0 - _NEARLY)[[0, -1]].tolist()
        slow = np.flatnonzero(v <= _NEARLY)
        began = max((int(i) for i in slow if i < first), default=first)
        stopped = min((int(i) for i in slow if i > last), default=n - 1)
        lasts = self.t[stopped] - self.t[last]
        return bool(stopped - last >= _SHORTEST and lasts >= _LONGER * (self.t[first] - self.t[began]))


def falls(recording: Recording) -> tuple[int, int] | None:
    """First sample of a run-down and the one after its last; None where it is none."""
    if not any(c in recording for c in ("x", "v")) or recording.t.size < MINIMUM_SAMPLES:
        return None
    count = min(_FINE, max(recording.t.size // 8, WINDOWS))
    whole = _Falling.of(recording, slice(None), count)
    while count > WINDOWS and float(np.median(whole.sd)) > _SURE * float(np.max(whole.speed)):
        count //= 2
        whole = _Falling.of(recording, slice(None), count)
    begin, end = _ends(whole, recording.t)
    if end - begin < MINIMUM_SAMPLES:
        return None
    seen = _Falling.of(recording, slice(begin, end), WINDOWS)
    change = np.diff(seen.speed)
    first, last = (float(np.median(v)) for v in (seen.speed[:_ALIKE], seen.speed[-_ALIKE:]))
    lost = first - last
    noise = float(np.median(seen.sd))
    fell = lost > max(_CLEAR * noise, _LOST * first)
    one_way = bool(np.all(seen.speed > -_CLEAR * np.maximum(seen.sd, noise) - _STOPPED * first))
    back = float(np.sum(np.maximum(change - _CLEAR * noise, 0.0)))
    once = whole.lost_before(float(recording.t[begin])) <= lost
    return (begin, end) if fell and one_way and back <= _BACK * lost and whole.let_go and once else None


def falls_again(recording: Recording) -> tuple[tuple[int, int], ...]:
    """As ``falls`` of each run-down of a wheel that was brought to speed several times and let go; () for any other.

    What is driven along a road slows again and again, too: here each slows nearly to rest, for longer than it was
    brought to speed, and they take most of the time.
    """
    v = recording["v"] if "v" in recording else np.zeros(0)
    if v.size < 2 * MINIMUM_SAMPLES:
        return ()
    speed = v * np.sign(v[np.argmax(np.abs(v))])
    most = float(np.max(speed))
    starts = _brought_to_speed(speed, most)
    found: list[tuple[int, int]] = []
    for begin, end in zip(starts, [*starts[1:], v.size], strict=True):
        rows = np.arange(v.size)
        span = falls(recording.cut((rows >= begin) & (rows < end))) if end - begin >= MINIMUM_SAMPLES else None
        if span is not None and float(np.min(speed[begin + span[0] : begin + span[1]])) < _SLOW * most:
            found.append((begin + span[0], begin + span[1]))
    lasts = sum(float(recording.t[last - 1] - recording.t[first]) for first, last in found)
    most_of_it = lasts > _MOST_OF_IT * float(recording.t[-1] - recording.t[0])
    return tuple(found) if len(found) > 1 and most_of_it else ()


def _brought_to_speed(speed: FloatArray, most: float) -> list[int]:
    """First samples of the parts of speeds (n,) that go from nearly rest to more than half of the fastest."""
    slow = speed < _SLOW * most
    sure = np.flatnonzero(slow | (speed > 0.5 * most))
    turns = np.flatnonzero(np.diff(slow[sure].astype(np.int8)))
    begun, starts = 0, [0]
    for at in turns.tolist():
        if slow[sure[at]]:  # from nearly rest to fast: it began where it was slowest
            starts.append(int(begun + np.argmin(speed[begun : sure[at] + 1])))
        begun = int(sure[at + 1])
    return sorted({*starts})


def _ends(seen: _Falling, t: FloatArray) -> tuple[int, int]:
    """The first sample after it was held or brought to speed, and one past the last before a rest; 0, 0 at rest."""
    most, n = float(np.max(seen.speed)), seen.speed.size
    moving = np.flatnonzero(seen.speed > np.maximum(_STOPPED * most, _CLEAR * seen.sd))
    if not moving.size:
        return 0, 0
    fastest = int(np.argmax(seen.speed))
    last = int(np.flatnonzero(seen.speed >= _LEVEL * most)[-1])
    begin = int(np.searchsorted(t, seen.t[fastest])) if fastest > 1 else 0
    later = min(last + max(n // 8, 1), n - 1)
    if last > 1 and later > last:
        before = (float(seen.speed[0]) - float(seen.speed[last])) / (seen.t[last] - seen.t[0])
        after = (float(seen.speed[last]) - float(seen.speed[later])) / (seen.t[later] - seen.t[last])
        if before < _HELD * after:
            begin = int(np.searchsorted(t, seen.t[last]))
    stop = float(seen.t[min(int(moving[-1]) + 1, n - 1)])
    return begin, int(np.searchsorted(t, stop + _REST * (stop - float(t[begin])), side="right"))


def rises(recording: Recording) -> bool:
    """Whether its speed, backwards in time, falls."""
    back = {c: y[::-1] * (-1.0 if c == "v" else 1.0) for c, y in recording.channels.items() if c in ("x", "v")}
    return bool(back) and falls(Recording(recording.t[-1] - recording.t[::-1], back)) is not None


def creeps(t: FloatArray, x: FloatArray) -> bool:
    """Whether no dry friction shows in how a place x (n,) at t (n,), s, comes to its level: as a sensor drifts.

    Of m v' = -f - c v the integral is x' = v0 - f t - c (x - x0), and once more x itself.
    """
    s = (t - t[0]) / (t[-1] - t[0])
    way = np.concatenate(([0.0], np.cumsum(0.5 * np.diff(s) * (x[1:] + x[:-1] - 2.0 * x[0]))))
    table = np.column_stack((np.ones_like(s), s, s**2, way))
    found, *_ = np.linalg.lstsq(table, x, rcond=None)
    left = x - table @ found
    # what neighbours share is one word
    words = max(x.size / _shared(left), table.shape[1] + 1.0)
    variance = np.linalg.inv(table.T @ table / x.size) * float(left @ left) / x.size / (words - table.shape[1])
    return bool(abs(found[2]) <= _CLEAR * math.sqrt(variance[2, 2]))


def _shared(left: FloatArray) -> float:
    """Neighbours of a series (n,) that say the same, from its first-order memory."""
    phi = float(np.clip(left[1:] @ left[:-1] / max(float(left @ left), 1e-300), 0.0, 0.999))
    return (1.0 + phi) / (1.0 - phi)
