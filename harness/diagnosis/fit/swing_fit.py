"""A descent that sees a free decay as its swing's amplitude and phase, and so ends near where that of its samples does.

What each sample shows is a sine of all that decides how long the swings before it took: over hundreds of cycles a
descent must follow a canyon as narrow as its last phase, in hundreds of steps, and beyond a slip of half a cycle there
are other canyons. Amplitude and phase themselves follow every parameter nearly in proportion. To first order both have
one minimum: |z - z_m|^2 of the analytic signal z = y - i y'/omega (Gabor 1946) is the square of what the amplitude
misses and of what the phase misses times the amplitude, and half of it is the square of what the samples miss.
"""

import math
from dataclasses import dataclass

import numpy as np
from scipy import sparse

from harness.core.arrays import BoolArray, ComplexArray, FloatArray
from harness.diagnosis.fit.bounds import within
from harness.diagnosis.fit.model_fit import downhill
from harness.diagnosis.parameters import Free
from harness.diagnosis.problem import Observation, Problem
from harness.diagnosis.problems.simulated import COARSE, observe
from harness.fit.least_squares import Until
from harness.kernels.solve import Scales
from harness.model.model import Model

_PER_CYCLE, _FEWEST_PER_CYCLE = 24, 8
"""Samples of a cycle that are looked at where there are more, and the fewest."""
_FEWEST_CYCLES = 4.0
"""Below these a descent of the samples has no canyon to follow."""
_REACH = 0.17
"""Of a cycle: half of the stretch over which a rate is fitted."""
_LONGEST_GAP = 0.5
"""Of a cycle: beyond it, how often the phase went round is not seen."""
_LEAST_SWING, _ABOVE_NOISE = 0.1, 6.0
"""Of the largest amplitude, and of the noise: a weaker swing has a phase that its zero or the noise decides."""
_VANISHING = 1e-7
"""Of the largest amplitude: a model's that is smaller counts as this where it is divided by."""
_ENOUGH = 1e-3
"""Share of the squares that a step gains, from which on the samples themselves are as near."""


@dataclass(frozen=True, slots=True)
class Swing:
    """What a channel of a free decay shows as an analytic signal.

    problem : thinned. rate : from a channel (n,) to its rate over omega, (n, n). middle : what it swings about.
    z (n,) : the signal. used (n,) : where there is a phase. sigma : noise.
    """

    problem: Problem
    channel: str
    rate: sparse.csr_array
    middle: float
    z: ComplexArray
    used: BoolArray
    sigma: float

    @classmethod
    def of(cls, problem: Problem, omega: float) -> "Swing | None":
        """As a recording shows it, None where it cannot be followed from sample to sample; omega in rad/s."""
        if problem.drive is not None or problem.alone or not problem.returns or problem.t.size < 2:
            return None
        cycle = 2.0 * math.pi / omega
        span = float(problem.t[-1] - problem.t[0])
        thin = max(1, int(problem.t.size * cycle / (span * _PER_CYCLE)))
        problem = problem.part(slice(None, None, thin))
        t = problem.t
        if span < _FEWEST_CYCLES * cycle or t.size * cycle < _FEWEST_PER_CYCLE * span:
            return None
        if float(np.max(np.diff(t))) > _LONGEST_GAP * cycle:
            return None
        channel = next(c for c in ("x", "v", "a") if c in problem.channels)
        y = problem.channels[channel]
        rate = _rates(t, omega, max(1, round(_REACH * t.size * cycle / span)))
        middle = float(np.mean(y))
        z = _analytic(rate, y) - middle
        sigma = problem.noise[channel].sigma
        least = max(_LEAST_SWING * float(np.max(np.abs(z))), _ABOVE_NOISE * sigma)
        used = (np.abs(z) > least) & (problem.weight[channel] > 0.0)
        return cls(problem, channel, rate, middle, z, used, sigma) if np.any(used) else None

    def phase_missed(self, shown: Observation) -> FloatArray:
        """By how much a model's phase is off, (n,), rad; 0 where it, or the recording, does not swing any more."""
        z = self._signal(shown.y[self.channel]) - self.middle
        swings = self._swings(z)
        phase = np.zeros(z.size)
        phase[swings] = np.unwrap(np.angle(self.z * np.conj(z))[swings])
        return phase

    def missed(self, shown: Observation) -> tuple[FloatArray, FloatArray]:
        """What a model misses of amplitude, and of phase times amplitude, (2n,); partials (2n, q) of the model's."""
        z, dz = self._signal(shown.y[self.channel]) - self.middle, self._signal(shown.dy[self.channel])
        amplitude, phase = np.abs(self.z), self.phase_missed(shown)
        own = np.maximum(np.abs(z), _VANISHING * float(np.max(amplitude)))
        turned = np.conj(z)[:, None] * dz
        weight = self.used / (math.sqrt(2.0) * self.sigma)
        residual = np.concatenate(((amplitude - np.abs(z)) * weight, amplitude * phase * weight))
        by_amplitude = np.real(turned) * (weight / own)[:, None]
        by_phase = np.imag(turned) * (self._swings(z) * weight * amplitude / own**2)[:, None]
        return residual, np.concatenate((by_amplitude, by_phase))

    def _signal(self, values: FloatArray) -> ComplexArray:
        return _analytic(self.rate, values)

    def _swings(self, z: ComplexArray) -> BoolArray:
        swings: BoolArray = self.used & (np.abs(z) > _LEAST_SWING * float(np.max(np.abs(self.z))))
        return swings


def swung(model: Model, swing: Swing, free: tuple[Free, ...], scales: Scales, iterations: int = 15) -> Model:
    """The model that is nearest downhill in amplitude and phase.

    Raises SimulationError where the start cannot be simulated.
    """
    free = within(free, model, swing.problem, scales)
    by = tuple(f.by for f in free)

    def look(candidate: Model) -> tuple[FloatArray, FloatArray, Observation]:
        shown = observe(candidate, swing.problem, by, scales, COARSE)
        return *swing.missed(shown), shown

    return downhill(model, free, look, Until(share=_ENOUGH, iterations=iterations)).point.model


def _analytic(rate: sparse.csr_array, values: FloatArray) -> ComplexArray:
    """y - i y'/omega of values (n,) or (n, q); rate (n, n)."""
    signal: ComplexArray = values - 1j * (rate @ values)
    return signal


def _rates(t: FloatArray, omega: float, reach: int) -> sparse.csr_array:
    """Slopes of parabolas through 2 ``reach`` + 1 neighbours each, over omega, as a matrix (n, n)."""
    n = t.size
    count = min(2 * reach + 1, n)
    first = np.clip(np.arange(n) - reach, 0, n - count)
    columns = first[:, None] + np.arange(count)
    u = omega * (t[columns] - t[:, None])
    basis = np.stack((np.ones_like(u), u, u * u), axis=2)
    normal = np.einsum("nki,nkj->nij", basis, basis)
    slopes = np.einsum("nj,nkj->nk", np.linalg.inv(normal)[:, 1], basis)
    rows = np.repeat(np.arange(n), count)
    return sparse.csr_array((slopes.ravel(), (rows, columns.ravel())), shape=(n, n))
