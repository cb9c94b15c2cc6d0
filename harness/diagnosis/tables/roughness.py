"""How rough tables are: integrals of squared second derivatives, knots of a curve one apart."""

import numpy as np

from harness.core.arrays import FloatArray
from harness.model.spline import BENDING, KNOTS, SIDE, weight

_FINE = 40
"""Places between two knots at which a plane's integrals are summed."""


def roughness(counts: list[int]) -> FloatArray:
    """Rows whose squares add up to the roughness of all tables, of so many values each."""
    parts = [_of_plane() if count == SIDE * SIDE else _of_curve(count) for count in counts]
    found, row, at = np.zeros((sum(p.shape[0] for p in parts), sum(counts))), 0, 0
    for part in parts:
        found[row : row + part.shape[0], at : at + part.shape[1]] = part
        row, at = row + part.shape[0], at + part.shape[1]
    return found


def _of_curve(count: int) -> FloatArray:
    """Rows (KNOTS, count) of a curve; one of fewer values than knots begins with a value that is 0."""
    mass = np.diag(np.full(KNOTS, 2.0 / 3.0)) + np.diag(np.full(KNOTS - 1, 1.0 / 6.0), 1)
    mass += np.diag(np.full(KNOTS - 1, 1.0 / 6.0), -1)
    return np.asarray((np.linalg.cholesky(mass).T @ BENDING)[:, KNOTS - count :], dtype=np.float64)


def _of_plane() -> FloatArray:
    """Rows (3 SIDE^2, SIDE^2) of a plane: second derivatives along both sides, and twice the mixed one.

    In the units of curves of KNOTS knots, and a mean along the other side, so that a plane without one is a curve.
    """
    places = (np.arange((SIDE - 1) * _FINE) + 0.5) / _FINE
    pairs = np.array([[weight(float(u), j) for j in range(SIDE)] for u in places])
    value, slope = pairs[:, :, 0] / np.sqrt(_FINE), pairs[:, :, 1] / np.sqrt(_FINE)
    bend = np.gradient(pairs[:, :, 1], 1.0 / _FINE, axis=0) / np.sqrt(_FINE)
    g, s, r = (_root(y.T @ y) for y in (value, slope, bend))
    ratio = (SIDE - 1.0) / (KNOTS - 1.0)
    unit = ratio / np.sqrt(KNOTS - 1.0)
    return np.asarray(unit * np.vstack((np.kron(r, g), np.sqrt(2.0) * np.kron(s, s), np.kron(g, r))))


def _root(square: FloatArray) -> FloatArray:
    """A matrix whose square is a symmetric one."""
    values, vectors = np.linalg.eigh(square)
    return np.asarray(np.sqrt(np.maximum(values, 0.0))[:, None] * vectors.T, dtype=np.float64)
