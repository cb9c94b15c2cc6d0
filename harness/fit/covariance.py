"""Covariance of fitted numbers from the curvature of a sum of squares."""

import math

import numpy as np

from harness.core.arrays import FloatArray

_SEEN = 1e-13
"""Share of the largest eigenvalue, columns scaled to one, below which a direction is rounding."""


def inverse_of(normal: FloatArray) -> FloatArray:
    """Pseudo-inverse (q, q) of normal equations J'J (q, q), each column brought to its own unit first.

    Numbers that do not show, and directions that rounding alone tells apart, get no variance.
    """
    scale = np.sqrt(np.maximum(np.diag(normal), 0.0))
    scale[scale == 0.0] = 1.0
    units = np.outer(scale, scale)
    return np.asarray(np.linalg.pinv(normal / units, rcond=_SEEN, hermitian=True) / units, dtype=np.float64)


def covariance_of(partials: FloatArray) -> FloatArray:
    """Covariance (q, q) of numbers with these partials (n, q) of a residual of unit variance, n values.

    As ``inverse_of`` of their normal equations; from their triangle, which keeps twice as many digits where two numbers
    hardly part.
    """
    scale = np.sqrt(np.sum(partials**2, axis=0))
    scale[scale == 0.0] = 1.0
    triangle = np.linalg.qr(partials / scale, mode="r")
    inverse = np.linalg.pinv(triangle, rcond=math.sqrt(_SEEN)) / scale[:, None]
    return np.asarray(inverse @ inverse.T, dtype=np.float64)
