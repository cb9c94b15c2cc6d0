"""Do two channels of one recording tell of the same motion? Without a model, from the data alone.

A channel is never differentiated. Both are weighed with smooth windows phi that vanish with their derivatives at their
ends: integration by parts gives int phi a dt = int phi'' x dt, jumps of a and all. Gain, lag and offset between the two
are a least-squares line through many windows.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from harness.core.arrays import FloatArray
from harness.core.quantity import Quantity
from harness.diagnosis.rules import CHANNELS_AGREE, CHANNELS_RELATED
from harness.estimate.means import ENOUGH, is_dense, means
from harness.estimate.noise import Noise
from harness.estimate.saturation import limit_said, limits
from harness.fit.least_squares import Bounds, Until, inverse_of, least_squares

_WINDOW = 0.9
"""Length of a window, in periods."""
_STEP = 4
"""Windows overlap: each begins a quarter of a window after the one before."""
_DONE = 1e-10
"""Share of the squares that a lag must still take off."""
_FEWEST = 8
"""Samples of a window, and windows: more than twice the three numbers fitted."""
_GAP = 3.0
"""Sampling intervals from which on a window does not reach across."""
_SHARP = 8.0
"""Times its usual scatter by which a step between samples is a jump: none by chance."""
_MOST_JUMPS = 400
"""Jumps allowed for, the largest first."""
_A_UNIT = 0.2
"""How near the logarithm of a gain must lie to that of a unit's factor: these are a factor of five apart or more."""
_UNITS = {
    1000.0: ("1000", "second", "mm"),
    1e-3: ("1/1000", "first", "mm"),
    1e6: ("1000000", "t", "ms"),
    1e-6: ("1/1000000", "first", "um"),
    9.80665: ("9.81", "second", "m"),
    1.0 / 9.80665: ("1/9.81", "second", "g"),
    math.degrees(1.0): ("180/pi", "second", "deg"),
    math.radians(1.0): ("pi/180", "first", "deg"),
}
"""Factors that come of a unit taken for another: in words, which of the two channels, or the time, and its unit."""
_EXCHANGED = 0.1
"""How near the logarithm of a gain must lie to none, and its lag to none in radians of the swing, where two channels
have each other's names.
"""
_OTHERWISE = math.log(2.0)
"""How far it must lie from none by their own: a swing near 1 rad/s is as large as its own second derivative."""
_FAR = 1.1
"""Of a gain, from which its inverse is told too."""
_ORDER = {("x", "v"): 1, ("v", "a"): 1, ("x", "a"): 2}
_NAMES = {"x": "displacement", "v": "velocity", "a": "acceleration"}
_SI = {"x": "m", "v": "m/s", "a": "m/s^2"}
_A_TIME = {"x": "", "v": "/s", "a": "/s^2"}


@dataclass(frozen=True, slots=True)
class Consistency:
    """What one channel says of another.

    pair : ("x", "a"). gain : of the second over the derivative of the first; lag : s, by which the first is late
    against the second; offset : of the second, its unit. related : whether they move together at all. consistent :
    gain 1, lag 0, offset 0 within three standard errors each. sentence : plainly. mirrored : related but for the sign.
    likelier : a channel, or "t", and the unit that it is in, where the gain is that of one taken for another.
    exchanged : each is what its name says of the other.
    """

    pair: tuple[str, str]
    gain: Quantity
    lag: Quantity
    offset: Quantity
    related: bool
    consistent: bool
    sentence: str
    mirrored: bool = False
    likelier: tuple[str, str] | None = None
    exchanged: bool = False


@dataclass(frozen=True, slots=True)
class _Windows:
    """Sample range of each window (m,) and its centre, s; length, s."""

    low: np.ndarray
    high: np.ndarray
    centre: FloatArray
    length: float


def _windows(t: FloatArray, length: float) -> _Windows:
    starts = np.arange(t[0], t[-1] - length, length / _STEP)
    low, high = np.searchsorted(t, starts), np.searchsorted(t, starts + length, side="right")
    interval = float(np.median(np.diff(t)))
    # a gap spoils the windows over it
    gaps = np.concatenate(([0], np.cumsum(np.diff(t) > _GAP * interval)))
    whole = (gaps[np.minimum(high, t.size) - 1] == gaps[np.minimum(low, t.size - 1)]) & (high - low >= _FEWEST)
    return _Windows(low[whole], high[whole], starts[whole] + 0.5 * length, length)


def _phi(s: FloatArray, order: int, length: float) -> FloatArray:
    """Derivative of the given order of cos^6(pi s / length), zero outside |s| < length / 2.

    cos^6 y = (10 + 15 cos 2y + 6 cos 4y + cos 6y) / 32.
    """
    y = math.pi * s / length
    total = np.full_like(s, 10.0 if order == 0 else 0.0)
    for weight, k in ((15.0, 2), (6.0, 4), (1.0, 6)):
        total += weight * (k * math.pi / length) ** order * np.cos(k * y + 0.5 * math.pi * order)
    return np.where(np.abs(s) < 0.5 * length, total / 32.0, 0.0)


def _weigh(t: FloatArray, y: FloatArray, windows: _Windows, order: int, shift: float = 0.0) -> FloatArray:
    """Integral of y (n,) times the derivative of phi over every window (m,), by the trapezium rule."""
    weights = np.gradient(t)
    out = np.empty(windows.centre.size)
    for i, (low, high, centre) in enumerate(zip(windows.low, windows.high, windows.centre, strict=True)):
        part = slice(low, high)
        out[i] = np.dot(_phi(t[part] - centre - shift, order, windows.length), weights[part] * y[part])
    return out


def _covariance(length: float, order: int, noise: Noise, interval: float) -> FloatArray:
    """Covariance (4,) of window integrals that begin 0, 1, 2, 3 quarters apart, for first-order noise."""
    s = np.arange(-0.5 * length, 0.5 * length, interval)
    density = noise.sigma**2 * interval * noise.inflation(2.0 * math.pi / length, interval)
    first = _phi(s, order, length)
    return np.array(
        [density * interval * float(first @ _phi(s - k * length / _STEP, order, length)) for k in range(_STEP)]
    )


def consistency(
    t: FloatArray, channels: Mapping[str, FloatArray], noise: Mapping[str, Noise], omega: float, angular: bool = False
) -> tuple[Consistency, ...]:
    """Every pair of x, v, a (n,) against each other; t in s, omega of the swing in rad/s. Linear in samples."""
    pairs = [pair for pair in _ORDER if pair[0] in channels and pair[1] in channels]
    ends = limits(t, channels["a"], noise["a"]) if "a" in channels else ()
    size = max(t.size // ENOUGH, 1)
    if size > 1 and all(is_dense(y, size) for y in channels.values()):
        t, channels = means(t, size), {c: means(y, size) for c, y in channels.items()}
        noise = {c: one.of_means(size) for c, one in noise.items()}
    windows, found = _windows(t, _WINDOW * 2.0 * math.pi / omega), []
    for pair in pairs:
        unit = _SI[pair[1]].replace("m", "rad", 1) if angular else _SI[pair[1]]
        if "a" in pair and ends:
            # of an acceleration whose sensor stood at its limit a gain of what is left of it would say nothing
            found.append(_refused(pair, unit, limit_said(ends, angular), consistent=False))
        elif windows.centre.size < _FEWEST:
            why = f"{windows.centre.size} windows without a gap; {_FEWEST} are needed"
            found.append(_refused(pair, unit, why, consistent=True))
        else:
            one = _pair(t, channels, noise, omega, pair, unit, windows)
            found.append(one if one.consistent or one.likelier else _named(one, t, channels, noise, omega, windows))
    return tuple(found)


def _named(
    one: Consistency,
    t: FloatArray,
    channels: Mapping[str, FloatArray],
    noise: Mapping[str, Noise],
    omega: float,
    windows: _Windows,
) -> Consistency:
    """The same, unless the two agree by each other's names."""
    if abs(math.log(abs(one.gain.value or 1.0))) < _OTHERWISE:
        return one
    a, b = one.pair
    series, errors = {a: channels[b], b: channels[a]}, {a: noise[b], b: noise[a]}
    other = _pair(t, series, errors, omega, one.pair, one.offset.unit, windows)
    gain, lag = other.gain.value or 0.0, other.lag.value or 0.0
    if not other.related or max(abs(math.log(gain)), abs(lag) * omega) > _EXCHANGED:
        return one
    return replace(
        one, sentence=f"{_NAMES[a]} and {_NAMES[b]} agree if each is what the other is called", exchanged=True
    )


def _refused(pair: tuple[str, str], unit: str, why: str, consistent: bool) -> Consistency:
    gain, lag, offset = (Quantity.refused(of, why) for of in ("1", "s", unit))
    return Consistency(pair, gain, lag, offset, True, consistent, why)


@dataclass(frozen=True, slots=True)
class _Line:
    """One channel's integrals (m,) as a line of the other's, seen, at one lag; slope : of seen, by the lag."""

    seen: FloatArray
    slope: FloatArray
    gain: float
    offset: float
    left: FloatArray
    partial: FloatArray

    @classmethod
    def of(cls, y: FloatArray, one: FloatArray, seen: FloatArray, slope: FloatArray) -> "_Line":
        """Gain and offset follow the lag: they are linear."""
        plane, _ = np.linalg.qr(np.column_stack([seen, one]))
        gain, offset = np.linalg.lstsq(np.column_stack([seen, one]), y, rcond=None)[0].tolist()
        partial = gain * slope
        return cls(seen, slope, gain, offset, y - gain * seen - offset * one, partial - plane @ (plane.T @ partial))

    @property
    def squares(self) -> float:
        """Of what the line leaves."""
        return float(self.left @ self.left)

    def normal_equations(self) -> tuple[FloatArray, FloatArray]:
        """Of the lag, gain and offset eliminated."""
        return np.array([[self.partial @ self.partial]]), np.array([self.partial @ self.left])


def _pair(
    t: FloatArray,
    channels: Mapping[str, FloatArray],
    noise: Mapping[str, Noise],
    omega: float,
    pair: tuple[str, str],
    unit: str,
    windows: _Windows,
) -> Consistency:
    first, second = pair
    order, interval, limit = _ORDER[pair], float(np.median(np.diff(t))), 0.25 * math.pi / omega
    y, one = _weigh(t, channels[second], windows, 0), _weigh(t, np.ones(t.size), windows, 0)

    def evaluated(at: FloatArray) -> _Line:
        # x late by lag: its window must be late as well; then the partial by the lag
        late = ((-1.0) ** n * _weigh(t, channels[first], windows, n, float(at[0])) for n in (order, order + 1))
        return _Line.of(y, one, *late)

    found = least_squares(evaluated, np.zeros(1), Until(share=_DONE), Bounds.of(1, -limit, limit))
    lag, line = float(found.coordinates[0]), found.point
    gain, left = line.gain, line.left
    design = np.column_stack([line.seen, line.slope, one])
    covariance = _covariance(windows.length, 0, noise[second], interval)
    covariance = covariance + gain**2 * _covariance(windows.length, order, noise[first], interval)
    errors = _standard_errors(design, left, covariance, _jumps(t, channels[second], noise[second], windows))
    swing = y - one * (one @ y) / (one @ one)
    related = float(left @ left) < CHANNELS_RELATED.value * float(swing @ swing)
    quantities = (
        Quantity(gain, float(errors[0]), "1"),
        Quantity(lag, float(errors[1]) / (abs(gain) or 1.0), "s"),
        Quantity(line.offset, float(errors[2]), unit),
    )
    return _judged(pair, quantities, related)


def _jumps(t: FloatArray, y: FloatArray, noise: Noise, windows: _Windows) -> FloatArray:
    """One standard error (jumps, m) of every window's integral by each jump of y, anywhere in its interval."""
    d = np.diff(y)
    sharp = np.zeros(d.size)
    sharp[1:-1] = d[1:-1] - 0.5 * (d[:-2] + d[2:])
    size = np.abs(sharp)
    level = _SHARP * max(noise.sigma, float(np.median(size)) / 0.6745 / math.sqrt(2.5))
    size[1:-1] *= (size[1:-1] >= size[:-2]) & (size[1:-1] >= size[2:])
    at = np.flatnonzero(size > level)
    at = at[np.argsort(size[at])[::-1][:_MOST_JUMPS]]
    middle, spread = 0.5 * (t[at] + t[at + 1]), size[at] * (t[at + 1] - t[at]) / math.sqrt(12.0)
    return spread[:, None] * _phi(middle[:, None] - windows.centre[None, :], 0, windows.length)


def _standard_errors(design: FloatArray, left: FloatArray, covariance: FloatArray, jumps: FloatArray) -> FloatArray:
    """Of the three numbers, for windows that overlap; inflated by what the windows scatter beyond the noise."""
    bread = inverse_of(design.T @ design)
    middle = covariance[0] * (design.T @ design)
    for k in range(1, covariance.size):
        across = covariance[k] * (design[k:].T @ design[:-k])
        middle = middle + across + across.T
    by_jump = jumps @ design
    middle = middle + by_jump.T @ by_jump
    known = (left.size - 3) * covariance[0] + float(np.sum(jumps * jumps))
    scatter = float(left @ left) / max(known, 1e-300)
    errors: FloatArray = np.sqrt(np.maximum(np.diag(bread @ middle @ bread), 0.0) * max(scatter, 1.0))
    return errors


def _judged(pair: tuple[str, str], found: tuple[Quantity, Quantity, Quantity], related: bool) -> Consistency:
    gain, lag, offset = found
    first, second = (_NAMES[c] for c in pair)
    value, late, off = (one.value or 0.0 for one in found)
    wrong = [
        abs((one.value or 0.0) - wanted) > CHANNELS_AGREE.value * (one.stderr or 0.0)
        for one, wanted in ((gain, 1.0), (lag, 0.0), (offset, 0.0))
    ]
    mirrored, related = related and value < 0.0, related and value > 0.0
    if not related:
        opposite = " (they move against each other)" if value < 0.0 else ""
        sentence = f"{second} and {first} do not belong together{opposite}"
        return Consistency(pair, gain, lag, offset, False, False, sentence, mirrored)
    unit = next((told for f, told in _UNITS.items() if abs(math.log(max(value, 1e-300) / f)) < _A_UNIT), None)
    if unit is not None:
        times, at, word = unit
        channel = {"first": pair[0], "second": pair[1]}.get(at, at)
        likelier = channel, f"{word}{_A_TIME.get(channel, '') if word != 'g' else ''}"
        sentence = f"{second} is about {times} times what {first} says, as where {' is in '.join(likelier)}"
        return Consistency(pair, gain, lag, offset, True, False, sentence, likelier=likelier)
    small = f" ({1.0 / value:.4g} times too small)" if value < 1.0 / _FAR else ""
    times = f"is {value:.4g} times what {first} says{small}"
    if f"{value:.4g}" == "1":
        times = f"is {'above' if value > 1.0 else 'below'} what {first} says by {100.0 * abs(value - 1.0):.2g} %"
    faults = (
        times,
        f"is {'early' if late > 0.0 else 'late'} by {abs(late):.3g} s",
        f"is offset by {off:.3g} {offset.unit}",
    )
    said = [fault for fault, there in zip(faults, wrong, strict=True) if there]
    sentence = f"{second} " + " and ".join(said) if said else f"{second} agrees with {first}"
    return Consistency(pair, gain, lag, offset, True, not said, sentence)
