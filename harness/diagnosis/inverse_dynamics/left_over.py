"""Is what a fitted force leaves no more than noise leaves of a true model? Compared with simulated draws of that."""

from dataclasses import dataclass

import numpy as np

from harness.core.arrays import FloatArray
from harness.core.errors import SimulationError
from harness.diagnosis.inverse_dynamics.bootstrap_null import draws
from harness.diagnosis.inverse_dynamics.force_fit import ForceFit
from harness.diagnosis.problems.inverse_dynamics import InverseDynamics
from harness.diagnosis.residual_tests.structure import Left
from harness.diagnosis.rules import NULL_DRAWS, OVER_SIMULATED
from harness.kernels.solve import Scales

_WIDER = 4
"""Each length of means is so many times the one before."""
_FEWEST = 16
"""Means of one length: fewer scatter too much to be compared."""


@dataclass(frozen=True, slots=True)
class LeftOver:
    """What a force leaves. ratio : its rms over the most of the draws', at the length of means where it is largest.

    noise : squares a value, N^2, that noise leaves of a true model; None where that could not be simulated.
    """

    ratio: float
    noise: float | None

    @property
    def left(self) -> Left:
        """Noise, where it is no more than the draws leave; what could not be tested is not called noise."""
        return Left.NOISE if self.ratio <= OVER_SIMULATED.value else Left.STRUCTURE


def left_over(found: ForceFit, problem: InverseDynamics, scales: Scales) -> LeftOver:
    """What a model leaves of a force beside what it would leave if it were the whole truth.

    In means over ever longer stretches too: what noise leaves is fast, what a law leaves is slow.
    """
    try:
        simulated = [_by_length(again.residual) for again, _ in draws(found, problem, scales, NULL_DRAWS.count)]
    except SimulationError:
        return LeftOver(np.inf, None)
    seen = _by_length(found.residual)
    common = min(seen.size, *(s.size for s in simulated))
    most = np.max([s[:common] for s in simulated], axis=0)
    ratio = float(np.sqrt(np.max(seen[:common] / np.maximum(most, 1e-300))))
    return LeftOver(ratio, float(np.mean([s[0] for s in simulated])))


def _by_length(residual: FloatArray) -> FloatArray:
    """Mean squares of a residual (m,) and of its means over 4, 16, ... neighbours."""
    size = 1
    found: list[float] = []
    while not found or residual.size // size >= _FEWEST:
        used = residual.size // size * size
        found.append(float(np.mean(residual[:used].reshape(-1, size).mean(axis=1) ** 2)))
        size *= _WIDER
    return np.array(found)
