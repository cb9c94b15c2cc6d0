"""A curve through values at evenly spaced knots, for laws that are a table: the natural cubic spline.

The spline through given values is linear in them, so that its partials by the values are the spline's own weights.
Source: C. de Boor, A Practical Guide to Splines, 1978, chapter IV.
"""

from typing import Final

import numpy as np

from harness.core.arrays import FloatArray
from harness.core.jit import compiled
from harness.model.law import D_PARAMETER

KNOTS: Final = 12
"""Knots of a table; as many as a law may have parameters but two."""


def bending(knots: int) -> FloatArray:
    """Matrix (knots, knots) from values at knots to second derivatives there, knots one apart, none at both ends."""
    left, right = np.eye(knots), np.zeros((knots, knots))
    for i in range(1, knots - 1):
        left[i, i - 1 : i + 2] = 1.0, 4.0, 1.0
        right[i, i - 1 : i + 2] = 6.0, -12.0, 6.0
    return np.asarray(np.linalg.solve(left, right), dtype=np.float64)


BENDING: Final = bending(KNOTS)


def _curve(u: float, first: int, theta: FloatArray, o: int, out: FloatArray) -> tuple[float, float]:
    """Value and slope of the spline at u, counted in knots from 0; beyond its ends it keeps its last value.

    Its values at the knots from ``first`` on stand in theta from o on, those before are 0. Writes the partials by them.
    """
    side = 1.0
    # nan too: it must not become a place in memory
    if not u >= 0.0:
        u, side = 0.0, 0.0
    elif u > KNOTS - 1.0:
        u, side = KNOTS - 1.0, 0.0
    i = min(int(u), KNOTS - 2)
    b = u - i
    a = 1.0 - b
    bend_a, bend_b = a * (a * a - 1.0) / 6.0, b * (b * b - 1.0) / 6.0
    slope_a, slope_b = (1.0 - 3.0 * a * a) / 6.0, (3.0 * b * b - 1.0) / 6.0
    value, slope = 0.0, 0.0
    for j in range(first, KNOTS):
        weight = bend_a * BENDING[i, j] + bend_b * BENDING[i + 1, j]
        rate = slope_a * BENDING[i, j] + slope_b * BENDING[i + 1, j]
        if j == i:
            weight += a
            rate -= 1.0
        elif j == i + 1:
            weight += b
            rate += 1.0
        y = theta[o + j - first]
        value += weight * y
        slope += rate * y
        out[D_PARAMETER + j - first] = weight
    return value, side * slope


curve = compiled(_curve, lean=True)
