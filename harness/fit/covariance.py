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


def coloured_covariance(
    partials: FloatArray, residual: FloatArray, lags: int, begins: tuple[int, ...] = ()
) -> FloatArray:
    """Covariance (q, q) of numbers with these partials (n, q), colour and uneven size of a residual (n,) allowed for.

    lags : over which the two may go together. begins : of further series laid behind the first (Newey and West 1987,
    Econometrica 55, 703).
    """
    moments = partials * residual[:, None]
    middle = moments.T @ moments
    for lag in range(1, lags + 1):
        for own in np.split(moments, begins):
            across = own[lag:].T @ own[:-lag]
            middle += (1.0 - lag / (lags + 1.0)) * (across + across.T)
    size, count = partials.shape
    middle *= size / max(size - count, 1)
    bread = covariance_of(partials)
    return np.asarray(bread @ middle @ bread, dtype=np.float64)
