"""Covariance of fitted numbers when the model leaves more than noise: a misfit says one thing for half a swing.

The curvature alone, and the curvature times chi-square per point, count every sample of a misfit as a word of its own.
Here the scores are summed over blocks as long as half a swing, and their scatter is taken as it is: the sandwich
estimator with clusters (Liang and Zeger 1986, Biometrika 73, 13).
"""

import math

import numpy as np

from harness.core.arrays import FloatArray
from harness.diagnosis.fit.model_fit import Fit
from harness.diagnosis.problem import Problem


def clustered_covariance(found: Fit, problem: Problem, omega: float) -> FloatArray:
    """Covariance (q, q) of the fitted numbers by blocks of half a swing; omega of the swing, rad/s.

    Of a free decay: residuals stand channel after channel, each with a row for every time. Too few blocks for the
    numbers fitted give infinite variances.
    """
    t, q = problem.t, len(found.free)
    block = ((t - t[0]) * omega / math.pi).astype(np.int64)
    count = half_swings(problem, omega)
    if count <= q + 1:
        return np.full((q, q), math.inf)
    scores = np.zeros((count, q))
    for i in range(len(problem.channels)):
        rows = slice(i * t.size, (i + 1) * t.size)
        each = found.jacobian[rows] * found.residual[rows, None]
        scores += np.column_stack([np.bincount(block, each[:, j], count) for j in range(q)])
    bread = found.covariance()
    # the fit has taken q numbers' worth of the blocks
    return np.asarray(bread @ (scores.T @ scores) @ bread * (count / (count - q)), dtype=np.float64)


def half_swings(problem: Problem, omega: float) -> int:
    """Blocks of a recording, one begun among them; omega of the swing, rad/s."""
    return int((problem.t[-1] - problem.t[0]) * omega / math.pi) + 1
