"""How sure shares are: the same game with the refined model moved by what the recording leaves open of it.

A share is a function of the refined model's numbers. Its variance is the sum, over the principal axes of their
covariance, of the squares of what one standard deviation along the axis does to it: the first order of propagation.
"""

import math
from collections.abc import Callable, Mapping, Sequence

import numpy as np

from harness.core.arrays import FloatArray
from harness.core.errors import SimulationError
from harness.diagnosis.fit.model_fit import Fit
from harness.diagnosis.fit.parameters import with_values
from harness.model.model import Model

Nearby = Sequence[Sequence[Model]]
"""For each covariance the models one standard deviation along its axes; the larger error counts."""


def nearby_of(found: Fit, matrices: Sequence[FloatArray]) -> Nearby:
    """Models beside a fit, for each covariance (q, q) of its numbers; what a recording does not tell stays as it is."""
    return [[_moved(found, step) for step in _axes(matrix).T] for matrix in matrices]


def _axes(covariance: FloatArray) -> FloatArray:
    """Steps (q, r) whose squares sum to a covariance, of numbers of any units."""
    variance = np.diag(covariance)
    known = np.flatnonzero(np.isfinite(variance) & (variance > 0.0))
    scale = np.sqrt(variance[known])
    values, vectors = np.linalg.eigh(covariance[np.ix_(known, known)] / np.outer(scale, scale))
    steps: FloatArray = np.zeros((variance.size, known.size))
    steps[known] = scale[:, None] * vectors * np.sqrt(np.maximum(values, 0.0))
    return steps


def _moved(found: Fit, step: FloatArray) -> Model:
    values = [min(max(v, f.lower), f.upper) for f, v in zip(found.free, found.values + step, strict=True)]
    return with_values(found.model, found.free, np.array(values))


def errors_of(
    shares: Callable[[Model], Mapping[str, float]], found: Mapping[str, float], nearby: Nearby
) -> Mapping[str, float] | None:
    """Standard errors of shares that were found; None where nothing is nearby, or a model there cannot be played."""
    if not any(nearby):
        return None
    try:
        played = [[shares(model) for model in models] for models in nearby]
    except SimulationError:
        return None
    return {
        name: max(math.sqrt(sum((one[name] - value) ** 2 for one in models)) for models in played)
        for name, value in found.items()
    }
