"""A log's motion on even times, low-passed alike and without delay, with its derivatives; its noise."""

import math
from collections.abc import Container
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from harness.core.arrays import ComplexArray, FloatArray
from harness.core.robot import JointLog
from harness.robot.arm import Arm

CUTOFF = 15.0
"""Hz: arms move below some Hz, and a second derivative of an encoder's noise grows with the square of this."""
_SHARE = 0.4
"""Of half the sampling rate: the highest cutoff."""
_ORDER = 4
"""Of the Butterworth filter that has this gain where it runs both ways."""
_TRIM = 2.5
"""Samples left out at either end, in 1/f_lowpass: the slowest pole of the filter has then died to 0.3 %."""
_MEDIAN_OF_NORMAL = 0.6745
"""Median size of a normal number of deviation one."""
_ORDERS = range(2, 7)
"""Of differences, whose variance is that of white noise times the ways to choose n of 2 n."""
_STILL = 3.0
"""Times its noise within which a joint's position scatters where it stands still."""
_NOWHERE = 1e-6
"""rad or m: less than the finest encoder resolves is no motion, whatever the digits of a log say."""


def white_sd(y: FloatArray) -> float:
    """Standard deviation of a recorded series' white noise, from the middle of its differences.

    Of the second to the sixth, those with the least: noise is the same in each, and motion less in every further one
    where samples are not too rare to show it. The few differences across a jump do not move the middle.
    """
    found = math.inf
    for order in _ORDERS:
        middle = float(np.median(np.abs(np.diff(y, order))))
        found = min(found, middle / (_MEDIAN_OF_NORMAL * math.sqrt(math.comb(2 * order, order))))
    return found


def noise_of(y: FloatArray) -> float:
    """Standard deviation of a position's noise, its steps included, in its own unit."""
    steps = np.abs(np.diff(y))
    smallest = float(np.min(steps[steps > 0.0], initial=math.inf))
    return max(white_sd(y), smallest / math.sqrt(12.0) if math.isfinite(smallest) else 0.0)


def moves(y: FloatArray) -> bool:
    """Whether a position (n,) does more than scatter about its mean."""
    return float(np.std(y)) > max(_STILL * noise_of(y), _NOWHERE)


def moving(arm: Arm, log: JointLog) -> tuple[str, ...]:
    """Joints of the model that move in a log."""
    return tuple(name for name in arm.joints if name in log.position and moves(log.position[name]))


@dataclass(frozen=True, slots=True)
class Band:
    """lowpass : Hz, where the gain is a half. size : samples of the series filtered. rate : theirs, Hz."""

    lowpass: float
    size: int
    rate: float

    def gain(self, f: FloatArray) -> FloatArray:
        """Gain (m,) at frequencies (m,), Hz."""
        return 1.0 / (1.0 + (f / self.lowpass) ** (2 * _ORDER))

    def taken(self, lowest: float) -> "Band":
        """The same filter for a series at the least whole share of this rate that is at least ``lowest``, Hz."""
        step = max(int(self.rate // lowest), 1)
        return Band(self.lowpass, (self.size - 1) // step + 1, self.rate / step)

    def filtered(
        self, y: FloatArray, out: "Band", derivatives: int = 0, late: float = 0.0, means: bool = False
    ) -> list[FloatArray]:
        """The filtered series and so many of its derivatives, each (out.size, ...), of a series (size, ...).

        late : s by which the series is moved ahead. means : its values are means over each sample's own step.
        """
        step = round(self.rate / out.rate)
        # whole steps, so that both ends of the line are samples of the result
        y = y[: (out.size - 1) * step + 1]
        last, wide = y.shape[0] - 1, (-1,) + (1,) * (y.ndim - 1)
        slope = (y[last] - y[0]) / last
        flat = y - y[0] - slope * np.arange(y.shape[0], dtype=np.float64).reshape(wide)
        spectrum = np.fft.rfft(np.concatenate((flat[:last], flat[last:0:-1] * -1.0)), axis=0)
        turn, gain = (one.reshape(wide) for one in _passed(self, out, last, means))
        part = spectrum[: turn.size] * gain
        if late != 0.0:
            part = part * np.exp(turn * late)
        part = part / step
        line = y[0] + slope * late * self.rate + slope * step * np.arange(out.size).reshape(wide)
        added = (line, slope * self.rate, 0.0)
        return [
            np.fft.irfft(part * turn**order if order else part, 2 * (out.size - 1), axis=0)[: out.size] + added[order]
            for order in range(derivatives + 1)
        ]

    @property
    def trimmed(self) -> slice:
        """Samples that no end of the series reaches."""
        edge = math.ceil(_TRIM * self.rate / self.lowpass)
        return slice(edge, self.size - edge)


@lru_cache(maxsize=64)
def _passed(band: Band, out: Band, last: int, means: bool) -> tuple[ComplexArray, FloatArray]:
    """At the frequencies (m,) of a series of ``last`` steps that ``out`` has too: by what a derivative turns them (m,),
    rad/s, and the gain (m,), that of the means undone. Asked for again and again, and dearer than the transform.
    """
    f = np.arange(out.size) * band.rate / (2 * last)
    shape = np.sinc(f / band.rate) if means else 1.0
    return np.asarray(2j * math.pi * f, dtype=np.complex128), band.gain(f) / shape * (f < out.rate / 2.0)


@dataclass(frozen=True, slots=True)
class Even:
    """Even times t (n,), s, and the filter that every channel on them goes through."""

    t: FloatArray
    band: Band

    @classmethod
    def of(cls, t: FloatArray) -> "Even":
        """Even times over those of a log, at its median interval."""
        interval = float(np.median(np.diff(t)))
        n = max(int((t[-1] - t[0]) / interval), 1) + 1
        return cls(np.linspace(t[0], t[-1], n), Band(min(CUTOFF, _SHARE * 0.5 / interval), n, (n - 1) / (t[-1] - t[0])))

    def low(self, t: FloatArray, y: FloatArray, derivatives: int = 0) -> list[FloatArray]:
        """A channel (m,) of times t (m,) on the even ones, low-passed, and so many of its derivatives, (n,) each."""
        return self.band.filtered(np.interp(self.t, t, y), self.band, derivatives)

    def motion(
        self, arm: Arm, log: JointLog, still: FloatArray, joints: Container[str] | None = None
    ) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Positions, speeds and accelerations (n, nv) of an arm along a log; still (nv,) : where the others stand.

        joints : those that are led along it, by default all that were logged.
        """
        q = np.tile(still, (self.t.size, 1))
        v, a = np.zeros_like(q), np.zeros_like(q)
        for i, name in enumerate(arm.joints):
            if name in log.position and (joints is None or name in joints):
                q[:, i], v[:, i], a[:, i] = self.low(log.t, log.position[name], 2)
        return q, v, a

    def settled(self, most: int | None = None) -> slice:
        """Without the ends, where a filter knows nothing of what comes before and after; some ``most`` of them."""
        size, edge = self.t.size, min(self.band.trimmed.start, self.t.size // 10)
        return slice(edge, size - edge, 1 if most is None else max(1, (size - 2 * edge) // most))
