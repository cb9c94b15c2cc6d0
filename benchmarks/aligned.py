"""Recordings against themselves: shifted, resampled, cropped, with noise; python -m benchmarks.aligned 500."""

import math
import sys
from dataclasses import dataclass

import numpy as np
from scipy.interpolate import Akima1DInterpolator
from scipy.signal import lfilter

from harness.core.arrays import FloatArray
from harness.core.recording import Recording
from harness.diagnosis.alignment.match import match
from harness.kernels.solve import solve
from harness.model.model import Model

MOST = 0.8
"""Share of its length by which a recording is shifted at most."""


@dataclass(frozen=True)
class Outcome:
    """apart : error of the shift over its standard error. slipped : by half a period or more. told : the true shift is
    within three standard errors, or among the alternatives as one not much worse.
    """

    seed: int
    apart: float
    slipped: bool
    told: bool


def recording(rng: np.random.Generator) -> tuple[Recording, float]:
    """A free decay that may wait before its release, or a mass driven by filtered noise; and its period, s."""
    omega, zeta = rng.uniform(3.0, 30.0), math.exp(rng.uniform(math.log(0.004), math.log(0.1)))
    period, x0 = 2.0 * math.pi / omega, rng.uniform(0.02, 0.2)
    interval = period / rng.uniform(40.0, 200.0)
    cycles = rng.uniform(5.0, 25.0)
    wait = rng.choice([0.0, rng.uniform(0.2, 3.0)]) * period
    t = np.arange(0.0, wait + cycles * period, interval)
    level = rng.choice([1e-3, 5e-3, 2e-2])
    if rng.random() < 0.2:
        u = lfilter([0.02], [1.0, -0.98], rng.normal(size=t.size))
        u *= omega**2 * x0 / np.std(u)
        x = _driven(t, u, omega, zeta)
        channels = {"x": x + level * np.std(x) * rng.normal(size=t.size), "u": u}
        return Recording(t, channels), period
    model = Model(1.0, 2.0 * zeta * omega, omega**2, x0 * omega**2 * rng.choice([0.0, 0.005, 0.02]), x0=x0)
    motion, moving = solve(model, t[t >= wait] - wait), t >= wait
    x, a = np.full(t.size, x0), np.zeros(t.size)
    x[moving], a[moving] = motion.x, motion.a
    x += level * x0 * rng.normal(size=t.size)
    if rng.random() < 0.3:
        step = 0.005 * x0
        x = step * np.round(x / step)
    a += 3.0 * level * x0 * omega**2 * rng.normal(size=t.size)
    names = [("x",), ("a",), ("x", "a")][rng.integers(3)]
    return Recording(t, {c: {"x": x, "a": a}[c] for c in names}), period


def _driven(t: FloatArray, u: FloatArray, omega: float, zeta: float) -> FloatArray:
    """A unit mass on a spring under the force u (n,), by the impulse response."""
    damped, interval = omega * math.sqrt(1.0 - zeta**2), t[1] - t[0]
    response = np.exp(-zeta * omega * t) * np.sin(damped * t) / damped * interval
    size = 2 * t.size
    return np.asarray(np.fft.irfft(np.fft.rfft(u, size) * np.fft.rfft(response, size), size)[: t.size])


def seen_again(one: Recording, rng: np.random.Generator, resampled: bool) -> Recording:
    """A stretch of 60 % or more of a recording, with more noise, and at another rate where ``resampled``."""
    share = rng.uniform(0.6, 1.0)
    begin = one.t[0] + rng.uniform(0.0, 1.0 - share) * one.duration
    t = one.t[(one.t >= begin) & (one.t <= begin + share * one.duration)]
    if resampled:
        t = np.arange(t[0], t[-1], one.interval * rng.uniform(0.7, 2.5))
    channels = {}
    for c, y in one.channels.items():
        seen = Akima1DInterpolator(one.t, y)(t) if resampled else np.interp(t, one.t, y)
        channels[c] = seen + 10.0 ** rng.uniform(-4.0, -2.0) * np.std(y) * rng.normal(size=t.size)
    return Recording(t, channels)


def outcome(seed: int) -> Outcome:
    """One random case."""
    rng = np.random.default_rng(seed)
    one, period = recording(rng)
    true = float(rng.uniform(-MOST, MOST) * one.duration)
    first, second = seen_again(one, rng, True), seen_again(one, rng, False)
    moved = Recording(first.t - true, first.channels)
    found = match(moved, second).aligned
    value, error = found.shift.value or 0.0, found.shift.stderr or 0.0
    off = abs(value - true)
    named = any(abs(other.shift - true) < 0.25 * period and other.worse_by < 1.5 for other in found.alternatives)
    return Outcome(seed, off / error if error > 0.0 else math.inf * off, off > 0.5 * period, off < 3.0 * error or named)


def figures(outcomes: list[Outcome]) -> str:
    """What came out, in a line."""
    n = len(outcomes)
    within = sum(one.apart < 3.0 for one in outcomes)
    silent = sum(one.slipped and not one.told for one in outcomes)
    return (
        f"{n} cases: shift within three standard errors in {100.0 * within / n:.1f} %,"
        f" slipped {sum(one.slipped for one in outcomes)}, without saying so {silent} ({100.0 * silent / n:.1f} %)"
    )


if __name__ == "__main__":
    results = [outcome(seed) for seed in range(int(sys.argv[1]) if len(sys.argv) > 1 else 500)]
    for one in results:
        if one.apart >= 3.0 or one.slipped:
            print(one)
    print(figures(results))
