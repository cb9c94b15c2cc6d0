"""Two traces of any origin laid over each other: the shift between them, and what differs in units of the noise."""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType

import numpy as np
from scipy.interpolate import Akima1DInterpolator

from harness.core.arrays import FloatArray
from harness.core.errors import InputError
from harness.core.quantity import Quantity
from harness.core.recording import MINIMUM_SAMPLES, Recording
from harness.diagnosis.baseline import dominant_frequency
from harness.diagnosis.cleaned import isolated
from harness.estimate.noise import Noise, channel_noise

_COARSE = 40
_LOOKS = 2000
_LEAST_SHARED = 0.5
_ITERATIONS = 12


@dataclass(frozen=True, slots=True)
class Match:
    """real minus sim at shared times t (n,), s, of the real trace's clock.

    shift : s, to be added to the sim's times. sim, real : channels in common at t. difference : real - sim, SI.
    whitened : the same in units of the noise of both. partial : of whitened by the shift. noise : of the difference,
    by channel. found : noise of each trace, (sim, real). omega : rad/s of the swing. shift_used : s, 0 where the shift
    found is none. interpolated : whether one of the two had to be, so that samples next to a jump mean little.
    """

    t: FloatArray
    shift: Quantity
    shift_used: float
    sim: Mapping[str, FloatArray]
    real: Mapping[str, FloatArray]
    whitened: Mapping[str, FloatArray]
    partial: Mapping[str, FloatArray]
    noise: Mapping[str, Noise]
    found: tuple[Mapping[str, Noise], Mapping[str, Noise]]
    omega: float
    interpolated: bool

    @property
    def difference(self) -> dict[str, FloatArray]:
        """Real minus sim by channel, SI units."""
        return {c: self.real[c] - self.sim[c] for c in self.real}


def swing_of(recording: Recording) -> float:
    """Angular frequency of a recording's motion, rad/s; raises InputError when it does not swing."""
    name = next(c for c in ("x", "v", "a") if c in recording)
    omega = dominant_frequency(recording.t, recording[name])
    if not math.isfinite(omega) or omega <= 0.0:
        raise InputError(recording.file, "nothing that swings", "a motion that swings is accepted")
    return omega


def noise_of(recording: Recording, omega: float) -> dict[str, Noise]:
    """Noise of every channel of motion."""
    period = 2.0 * math.pi / omega
    return {c: channel_noise(recording.t, recording[c], period) for c in ("x", "v", "a") if c in recording}


def match(sim: Recording, real: Recording) -> Match:
    """Lay a simulated trace over a recorded one.

    Times are those of the trace that is sampled less densely; the other is interpolated. When the clocks of the two
    overlap by half, the shift is looked for within half a period, so that an amplitude that decays too fast is not
    taken for a later start; otherwise wherever the two overlap by half.

    Raises InputError when no channel is common, or too few samples are.
    """
    common = [c for c in ("x", "v", "a") if c in sim and c in real]
    if not common:
        raise InputError(
            f"{sim.file} and {real.file}",
            f"channels {', '.join(sim.channels)} and {', '.join(real.channels)}",
            "two traces with one of x, v, a in common are accepted",
        )
    omega = swing_of(real)
    found = noise_of(sim, omega), noise_of(real, omega)
    noise = {c: _both(found[0][c], found[1][c]) for c in common}
    pair = _Pair(sim, real, common, noise)
    shift = _refined(pair, _coarse(pair, 2.0 * math.pi / omega))
    error = _shift_error(pair, shift, 2.0 * math.pi / omega)
    # a shift that is none is not applied: samples at the same instants need no interpolation then
    used = 0.0 if abs(shift) < 3.0 * error else shift
    t, left, right = pair.at(used)
    if t.size < MINIMUM_SAMPLES:
        raise InputError(
            f"{sim.file} and {real.file}",
            f"{t.size} samples at shared times",
            f"traces that overlap by at least {MINIMUM_SAMPLES} samples are accepted",
        )
    partial = {c: _whiten(np.gradient(left[c], t), noise[c]) for c in common}
    whitened = {c: _whiten(right[c] - left[c], noise[c]) for c in common}
    frozen = MappingProxyType
    interpolated = not (used == 0.0 and t.size == len(sim) == len(real))
    quantity = Quantity(shift, error, "s")
    return Match(
        t,
        quantity,
        used,
        frozen(left),
        frozen(right),
        frozen(whitened),
        frozen(partial),
        noise,
        found,
        omega,
        interpolated,
    )


def _both(a: Noise, b: Noise) -> Noise:
    """Noise of a difference."""
    variance = a.sigma**2 + b.sigma**2
    phi = (a.phi * a.sigma**2 + b.phi * b.sigma**2) / variance
    return Noise(math.sqrt(variance), a.found or b.found, phi, max(a.step, b.step))


def _whiten(y: FloatArray, noise: Noise) -> FloatArray:
    scaled = y / noise.sigma
    if noise.phi == 0.0:
        return scaled
    out = scaled.copy()
    out[1:] = (scaled[1:] - noise.phi * scaled[:-1]) / math.sqrt(1.0 - noise.phi**2)
    return out


class _Pair:
    """Two recordings, read at the times of the coarser one."""

    def __init__(self, sim: Recording, real: Recording, common: list[str], noise: Mapping[str, Noise]) -> None:
        self.sim, self.real, self.common, self.noise = sim, real, common, noise
        self.onto_real = sim.interval <= real.interval * 1.0001
        self.fine, self.coarse = (sim, real) if self.onto_real else (real, sim)
        # Akima's curve keeps a jump where it is, and is of third order elsewhere
        self.curves = {c: Akima1DInterpolator(self.fine.t, self.fine[c]) for c in common}

    def at(self, shift: float, stride: int = 1) -> tuple[FloatArray, dict[str, FloatArray], dict[str, FloatArray]]:
        """Shared times of real's clock, sim's and real's channels there, for sim's times plus ``shift``."""
        t = self.coarse.t[::stride]
        since = t - shift if self.onto_real else t + shift
        inside = (since >= self.fine.t[0]) & (since <= self.fine.t[-1])
        t, since = t[inside], since[inside]
        fine = {c: np.asarray(self.curves[c](since)) for c in self.common}
        if np.array_equal(since, self.fine.t):
            fine = {c: self.fine[c] for c in self.common}
        coarse = {c: self.coarse[c][::stride][inside] for c in self.common}
        return (t, fine, coarse) if self.onto_real else (since, coarse, fine)

    def misfit(self, shift: float, stride: int = 1) -> float:
        """Mean square difference in units of the noise."""
        t, left, right = self.at(shift, stride)
        if t.size < 8:
            return math.inf
        return sum(float(np.mean((right[c] - left[c]) ** 2)) / self.noise[c].sigma ** 2 for c in self.common)


def _coarse(pair: _Pair, period: float) -> float:
    sim, real = pair.sim, pair.real
    shorter = min(sim.duration, real.duration)
    overlap = min(sim.t[-1], real.t[-1]) - max(sim.t[0], real.t[0])
    step = period / _COARSE
    if overlap >= _LEAST_SHARED * shorter:
        shifts = np.linspace(-0.5, 0.5, _COARSE + 1) * period
    else:
        first = float(real.t[0] - sim.t[-1] + _LEAST_SHARED * shorter)
        shifts = np.arange(first, float(real.t[-1] - sim.t[0] - _LEAST_SHARED * shorter) + step, step)
    stride = max(1, len(pair.coarse) // _LOOKS)
    return float(min(shifts, key=lambda shift: pair.misfit(float(shift), stride)))


def _refined(pair: _Pair, shift: float) -> float:
    """Gauss and Newton's iteration on the shift."""
    for _ in range(_ITERATIONS):
        t, left, right = pair.at(shift)
        if t.size < 8:
            break
        top = bottom = 0.0
        for c in pair.common:
            slope, off = np.gradient(left[c], t), left[c] - right[c]
            # a jump between two samples, seen on the wrong side of one, would pull harder than all the rest
            weight = ~isolated(off) / pair.noise[c].sigma ** 2
            top += float((weight * slope) @ off)
            bottom += float((weight * slope) @ slope)
        step = top / bottom if bottom > 0.0 else 0.0
        shift += step
        if abs(step) < 1e-6 / math.sqrt(bottom + 1e-300):
            break
    return shift


def _shift_error(pair: _Pair, shift: float, period: float) -> float:
    """Standard error of the shift, with the colour of the noise, and of the mismatch where that is larger."""
    t, left, right = pair.at(shift)
    information = chi2 = inflation = 0.0
    for c in pair.common:
        noise = pair.noise[c]
        off = right[c] - left[c]
        keep = ~isolated(off)
        slope = np.gradient(left[c], t)[keep]
        information += float(slope @ slope) / noise.sigma**2
        chi2 += float(np.mean(off[keep] ** 2)) / noise.sigma**2 / len(pair.common)
        inflation = max(inflation, noise.inflation(2.0 * math.pi / period, pair.coarse.interval))
    if chi2 > 2.0:
        # what differs is no noise: it says one thing for about a quarter of a period
        inflation = max(inflation, chi2 * 0.25 * period / pair.coarse.interval)
    return math.sqrt(inflation / information) if information > 0.0 else math.inf
