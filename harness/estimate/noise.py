"""The noise of a channel, from the channel itself: level, colour and quantisation.

The signal is taken away by polynomials over windows much shorter than the motion, so that what stays is noise. Windows
that hold a jump are outvoted by the median; windows at rest are left out, because a quantised sensor is silent there.
"""

import math
from dataclasses import dataclass, replace

import numpy as np

from harness.core.arrays import BoolArray, FloatArray

FLOOR = 1e-5
"""A trace without noise is given this share of the channel's rms."""

DECISIVE = 10.0
"""Twice the logarithm of a likelihood ratio (Kass and Raftery 1995)."""
_FEWEST_WINDOWS = 4
_ENOUGH = 200_000
"""Samples in windows that are looked at: they tell a level to a third of a per cent."""
_PARTS = 1000
_PERIOD_SHARE = 0.12
_LONGEST = 48
_SHORTEST = 8, 6
"""Samples of the shortest windows, and the degree of their polynomials."""


@dataclass(frozen=True, slots=True)
class Noise:
    """What the noise of one channel looks like.

    sigma : standard deviation in the channel's unit, never 0. found : False when sigma is only the floor.
    phi : lag-one autocorrelation at the median sampling interval (0 is white). step : quantisation step, 0 if none.
    """

    sigma: float
    found: bool
    phi: float = 0.0
    step: float = 0.0

    @property
    def said(self) -> float | str:
        """The level, or the words used for a channel without noise."""
        return self.sigma if self.found else "none found"

    def inflation(self, omega: float, interval: float) -> float:
        """Spectral density at ``omega`` rad/s over that of white noise of the same variance (first-order colour)."""
        p = self.phi
        return (1.0 - p * p) / (1.0 - 2.0 * p * math.cos(min(omega * interval, math.pi)) + p * p)

    def whitened(self, values: FloatArray) -> FloatArray:
        """Residuals (n,) or partials (n, q) in units of the noise, colour taken out: what each sample adds to the one
        before it.
        """
        white = values / self.sigma
        if self.phi != 0.0:
            white[1:] = (white[1:] - self.phi * white[:-1]) / math.sqrt(1.0 - self.phi**2)
        return white

    def of_means(self, size: int) -> "Noise":
        """Noise of the mean of ``size`` neighbours, by its first-order colour."""
        lags = np.arange(1, size)
        shared = 1.0 + 2.0 * float(np.sum((1.0 - lags / size) * self.phi**lags)) if self.phi else 1.0
        return replace(self, sigma=self.sigma * math.sqrt(shared / size), phi=self.phi**size)

    def drawn(self, count: int, random: np.random.Generator) -> FloatArray:
        """A draw (count,) of noise of this level and first-order colour; it is not quantised."""
        # imported when it is needed: it brings half of its library along
        from scipy.signal import lfilter

        fresh = self.sigma * random.standard_normal(count)
        fresh[1:] *= math.sqrt(1.0 - self.phi**2)
        return np.asarray(lfilter([1.0], [1.0, -self.phi], fresh), dtype=np.float64)

    def over(self, y: FloatArray, random: np.random.Generator) -> FloatArray:
        """A signal (n,) as a sensor with this noise would give it, quantised as it does."""
        if not self.found:
            return y
        if self.step == 0.0:
            return y + self.drawn(y.size, random)
        rest = replace(self, sigma=math.sqrt(max(self.sigma**2 - self.step**2 / 12.0, 0.0)))
        noisy: FloatArray = self.step * np.round((y + rest.drawn(y.size, random)) / self.step)
        return noisy


def rounded(variance: float, step: float) -> bool:
    """Whether noise of this variance is hardly more than the rounding to a step, in the channel's unit."""
    return variance < _ROUNDED * step**2 / 12.0


def _windows(y: FloatArray, width: int, every: int = 1) -> FloatArray:
    """Every so manieth window of ``width`` samples of y (n,)."""
    return y[: y.size // width * width].reshape(-1, width)[::every]


def _window_residuals(t: FloatArray, y: FloatArray, width: int, degree: int, every: int = 1) -> FloatArray:
    """Residuals (windows, width) of a polynomial of ``degree`` in every window of ``width`` samples of y (n,), or in
    every so manieth, by Gram-Schmidt on the window's own times.
    """
    times, left = (_windows(one, width, every) for one in (t, y))
    middle, half = 0.5 * (times[:, :1] + times[:, -1:]), 0.5 * (times[:, -1:] - times[:, :1])
    place = (times - middle) / half
    basis: list[FloatArray] = []

    def without(values: FloatArray, other: FloatArray) -> FloatArray:
        return np.asarray(values - np.einsum("ij,ij->i", values, other)[:, None] * other, dtype=np.float64)

    for _ in range(degree + 1):
        one = basis[-1] * place if basis else np.ones_like(place)
        for other in (*basis, *basis):  # twice, for the rounding of the first
            one = without(one, other)
        basis.append(one / np.sqrt(np.einsum("ij,ij->i", one, one))[:, None])
        left = without(left, basis[-1])
    return left


_RATIOS = (0.0, *np.logspace(-1.0, 8.0, 46).tolist())
"""Noise where the signal changes fastest over that where it stands still, as variances, less one."""
_ROUNDED = 2.0
"""Times its own variance, up to which the noise of a quantised channel is its rounding, less of it where it is slow."""


_LEAST_EVEN = 1e-2
"""Least noise where nothing makes it grow over the largest, as variances: what holds of a sensor at work is not to make
its last samples before a rest outweigh all others, along which a fit then cannot move: 6 of 14 run-downs told by the
marks of a wheel ended far from their own truth at 1e-6, and none at 1e-2."""

_FINEST_JITTER = 1e-4
"""Of a step: of stamps that jitter by less, in a trace without noise, an integrator's error is seen."""


@dataclass(frozen=True, slots=True)
class Uneven:
    """Noise that is not the same throughout: stamps that jitter, or a sensor's noise in proportion to what it shows.

    level : (n,), noise of each sample of a channel over its typical one. jitter : standard deviation of the stamps, s;
    share : of the noise over what the channel shows; 0 where none shows. gain : twice the logarithm of the likelihood
    ratio over an even noise.
    """

    level: FloatArray
    jitter: float = 0.0
    share: float = 0.0
    gain: float = 0.0

    @classmethod
    def of(
        cls,
        channel: str,
        t: FloatArray,
        y: FloatArray,
        value: FloatArray,
        slope: FloatArray,
        noise: Noise,
        width: int,
        degree: int,
        left_out: BoolArray | None = None,
    ) -> "Uneven":
        """Of a channel y (n,) at t (n,), s, or what a model leaves of it, with its smooth value and slope (n,).

        A polynomial of ``degree`` in windows of ``width`` samples leaves noise of variance s^2 + (jitter slope)^2, or
        of a speed s^2 + (share value)^2, as a tachometer's; even unless one is decisive, then the likelier.
        left_out (n,) : samples whose windows do not count.
        """  # fmt: skip
        found = [cls(np.ones(t.size))]
        if not noise.found or rounded(noise.sigma**2, noise.step) or t.size < _FEWEST_WINDOWS * width:
            return found[0]
        whole = t.size // width * width
        power = np.sum(_window_residuals(t, y, width, degree) ** 2, axis=1)
        usable = power > 0.0
        if left_out is not None:
            usable &= ~np.any(left_out[:whole].reshape(-1, width), axis=1)
        for by in (slope, value) if channel == "v" else (slope,):
            square = np.mean(by[:whole].reshape(-1, width) ** 2, axis=1)
            grows = _growth(power[usable], square[usable], float(np.max(square)), width - degree - 1)
            if grows is None:
                continue
            even, factor, gain = grows
            jitters = by is slope
            step = float(np.median(np.diff(t)))
            # a sample is taken within its own step: what is larger is no stamp's, nor what no clock would show
            if jitters and not _FINEST_JITTER * step < factor <= step / math.sqrt(12.0):
                continue
            more = factor**2 * by**2
            rest = max(noise.sigma**2 - float(np.mean(more)), even) if jitters else even
            rest = max(rest, _LEAST_EVEN * float(np.max(more)))
            level = np.sqrt((rest + more) / float(np.mean(rest + more)))
            found.append(cls(level, factor, 0.0, gain) if jitters else cls(level, 0.0, factor, gain))
        return max(found, key=lambda one: one.gain)


def _growth(power: FloatArray, square: FloatArray, most: float, freedom: int) -> tuple[float, float, float] | None:
    """Of windows (m,), whose noise leaves sums of squares ``power`` at mean squares of what it may grow with: the even
    variance, the factor of what grows, and the gain of it; None where an even noise does as well.

    freedom : of each window.
    """
    if most <= 0.0 or not power.size:
        return None

    def variance(ratio: float) -> float:
        return float(np.mean(power / (1.0 + ratio * square / most))) / freedom

    def likelihood(ratio: float) -> float:
        spread = np.log(1.0 + ratio * square / most)
        return -freedom * float(np.sum(spread) + spread.size * math.log(variance(ratio)))

    best = max(_RATIOS, key=likelihood)
    gain = likelihood(best) - likelihood(0.0)
    return None if gain <= DECISIVE else (variance(best), math.sqrt(variance(best) * best / most), gain)


_BANDS = 10
"""Of a spectrum, the quietest of which bounds a white noise; a noise fills them all alike."""


def white_at_most(y: FloatArray) -> float:
    """Standard deviation of the white noise that a channel (n,) of even steps has room for, the unit of the channel.

    What is fast beside a sample is noise within a few of them, and in a spectrum only where all of it is as loud.
    """
    taper = np.hanning(y.size + 2)[1:-1]
    power = np.abs(np.fft.rfft((y - np.mean(y)) * taper)) ** 2 / float(np.sum(taper**2))
    return math.sqrt(min(float(np.mean(band)) for band in np.array_split(power[1:], _BANDS)))


def quantisation_step(y: FloatArray) -> float:
    """Distance between the levels of a quantised channel, 0 for one that is not; same unit as ``y`` (n,)."""
    part = y if y.size <= 40_000 else y[:: y.size // 20_000]
    levels, visits = np.unique(part, return_counts=True)
    if levels.size < 3 or levels.size > 0.6 * part.size:
        return 0.0
    gaps = np.diff(levels)
    often = (visits[1:] > 1) & (visits[:-1] > 1)
    if np.count_nonzero(often) < 3:
        return 0.0
    step = float(np.median(gaps[often]))
    # levels lie on a ladder: gaps near one step, give or take the decimals a file was written with
    return step if np.mean(np.abs(gaps[often] / step - 1.0) < 0.25) > 0.8 else 0.0


def _moving(y: FloatArray, width: int, every: int) -> BoolArray:
    """Which of the windows that are looked at are in motion: they span at least 1 % of the range of the channel.

    Of a long channel the spans are of a thousandth of it: a window alone would show its noise more than the motion.
    """
    wide = width if every == 1 else width * (y.size // (_PARTS * width))
    moving = np.ptp(_windows(y, wide), axis=1) > 0.01 * np.ptp(y)
    moving = moving if np.any(moving) else np.ones_like(moving)
    part = np.arange(0, y.size // width, every) * width // wide
    return np.asarray(moving[np.minimum(part, moving.size - 1)], dtype=np.bool_)


def _expected(width: int, degree: int, grid: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Expected power of a detrended window, and its lag-one share, for first-order noise of each phi in ``grid``."""
    q, _ = np.linalg.qr(np.vander(np.linspace(-1.0, 1.0, width), degree + 1))
    keep = np.eye(width) - q @ q.T
    beside = keep @ np.eye(width, k=1) @ keep
    lags = np.abs(np.subtract.outer(np.arange(width), np.arange(width))).ravel()
    powers = grid[:, None] ** np.arange(width)
    level = powers @ np.bincount(lags, keep.ravel(), width)
    return level, powers @ np.bincount(lags, beside.ravel(), width) / level


def _colour(residuals: FloatArray, width: int, degree: int) -> tuple[float, float]:
    """Autocorrelation phi and variance of first-order noise whose detrended windows look like ``residuals``."""
    grid = np.linspace(-0.95, 0.98, 194)
    level, ratio = _expected(width, degree, grid)
    seen = float(np.sum(residuals[:, 1:] * residuals[:, :-1]) / np.sum(residuals**2))
    phi = float(np.interp(seen, np.maximum.accumulate(ratio), grid))
    # colour that is no more than chance is none
    if abs(seen - float(np.interp(0.0, grid, ratio))) < 4.0 / math.sqrt(residuals.size):
        phi = 0.0
    return phi, float(np.mean(np.sum(residuals**2, axis=1)) / np.interp(phi, grid, level))


def channel_noise(t: FloatArray, y: FloatArray, period: float | None = None, rests: bool = False) -> Noise:
    """Noise of a channel ``y`` (n,) sampled at ``t`` (n,) in s, n >= 16.

    period : of the motion in s; without it windows are as short as can be and colour cannot be seen. rests : whether
    windows at rest tell of the noise as well, as those of a force do, which is switched and does not come to rest.
    Jumps in fewer than half of the windows do no harm. Levels below 1e-5 of the channel's rms count as none found.
    """
    interval = float(np.median(np.diff(t)))
    width, degree = _SHORTEST
    if period is not None:
        width = min(int(_PERIOD_SHARE * period / interval), _LONGEST)
        width, degree = (width, 5) if width >= 12 else _SHORTEST
    return _floored(y, *_in_windows(t, y, width, degree, rests), FLOOR)


def _in_windows(t: FloatArray, y: FloatArray, width: int, degree: int, rests: bool = False) -> tuple[float, float]:
    """Variance and colour of what polynomials of ``degree`` leave of a channel y (n,) at t (n,) in windows."""
    every = max(y.size // _ENOUGH, 1)
    windows = _window_residuals(t, y, width, degree, every)
    windows = windows if rests else windows[_moving(y, width, every)]
    power = np.mean(windows**2, axis=1)
    freedom = width - degree - 1
    # median of a chi-square over its mean (Wilson and Hilferty)
    typical = float(np.median(power)) / ((1.0 - 2.0 / (9.0 * freedom)) ** 3 if freedom > 1 else 0.4549)
    sane = windows[power <= max(typical * 6.0, float(np.median(power)))]
    phi, variance = 0.0, typical * width / freedom
    if freedom >= 6 and sane.shape[0] >= 8 and np.any(sane):
        phi, measured = _colour(sane, width, degree)
        if phi != 0.0:
            variance = measured
    return variance, phi


def _floored(y: FloatArray, variance: float, phi: float, floor: float) -> Noise:
    """Noise of a channel y (n,), no less than its rounding; none is found below the share ``floor`` of its rms."""
    step = quantisation_step(y)
    sigma = math.sqrt(max(variance, step * step / 12.0))
    rms = float(np.std(y))
    if sigma > floor * rms:
        return Noise(sigma, True, phi, step)
    return Noise(FLOOR * rms if rms > 0.0 else np.finfo(float).tiny, False)


_LONGER = 10, 6
"""Samples of windows a little longer than the shortest, and the degree of their polynomials."""
_LEAST = 1e-6
"""Share of a channel's rms down to which what looks like noise is noise: encoders count to that."""
_NO_SIGNAL = 1.5
"""Factor within which longer windows leave as much of a noise; of a signal they leave (10/8)^7, five times it."""


def fine_noise(t: FloatArray, y: FloatArray) -> Noise:
    """White noise of a channel y (n,) at t (n,), s, of a fine encoder, too; n >= 16.

    A window of the shortest kind leaves one number, of which an encoder that counts shows few values: their median is
    up to a third too high, that of longer windows is not, but for what a signal leaves there. Levels down to 1e-6 of
    the channel's rms are noise where longer windows leave no more.
    """
    short, longer = (_in_windows(t, y, *size)[0] for size in (_SHORTEST, _LONGER))
    return _floored(y, min(short, longer), 0.0, _LEAST if longer < _NO_SIGNAL**2 * short else FLOOR)


_COLOURED = 24
"""Samples of windows that show a colour: of shorter ones a polynomial leaves the fast part alone."""
_GOES_ON = 1.0 / 3.0
"""Least ratio of the ways in two thirds of a window that neither turns nor starts nor stops."""
_FEWEST_COLOURED = 16
"""Windows of a motion that goes on, from which a colour is told."""
_ALIKE = 1.25
"""Factor within which the fast part of a coloured noise is what shorter windows leave; that of a bend is larger."""


def with_colour(t: FloatArray, y: FloatArray, noise: Noise) -> Noise:
    """The noise of a channel y (n,) at t (n,), s, with the colour that longer windows show of it.

    noise : as the shortest windows tell it, white; it stays where the longer ones hold more than noise.
    """
    if not noise.found or noise.phi != 0.0 or rounded(noise.sigma**2, noise.step):
        return noise
    times, windows = (_windows(one, _COLOURED) for one in (t, y))
    first, second = np.diff(windows.reshape(len(windows), 3, _COLOURED // 3).mean(axis=2)).T
    # friction bends what turns, stops or starts within one
    goes_on = first * second > _GOES_ON * np.maximum(first**2, second**2)
    if np.count_nonzero(goes_on) < _FEWEST_COLOURED:
        return noise
    interval = float(np.median(np.diff(t)))
    going = times[goes_on].ravel(), windows[goes_on].ravel()
    seen = channel_noise(*going, (_COLOURED + 0.5) / _PERIOD_SHARE * interval)
    if seen.phi <= 0.0:
        return noise
    fast = seen.sigma * math.sqrt(float(_expected(*_SHORTEST, np.array([seen.phi]))[0][0]))
    return seen if 1.0 / _ALIKE < fast / noise.sigma < _ALIKE else noise
