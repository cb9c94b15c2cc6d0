"""Curves and surfaces through values at evenly spaced knots, for laws that are a table: natural cubic splines.

The spline through given values is linear in them, so that its partials by the values are the spline's own weights.
Source: C. de Boor, A Practical Guide to Splines, 1978, chapters IV and XVII (tensor products).
"""

from typing import Final

import numpy as np

from harness.core.arrays import FloatArray
from harness.core.jit import lean
from harness.model.law import D_PARAMETER

KNOTS: Final = 12
"""Knots of a table."""
SIDE: Final = 6
"""Knots of a table over a plane along each side; their square is what a law may have parameters but four."""


def bending(knots: int) -> FloatArray:
    """Matrix (knots, knots) from values at knots to second derivatives there, knots one apart, none at both ends."""
    left, right = np.eye(knots), np.zeros((knots, knots))
    for i in range(1, knots - 1):
        left[i, i - 1 : i + 2] = 1.0, 4.0, 1.0
        right[i, i - 1 : i + 2] = 6.0, -12.0, 6.0
    return np.asarray(np.linalg.solve(left, right), dtype=np.float64)


BENDING: Final = bending(KNOTS)
BENDING_SIDE: Final = bending(SIDE)


@lean
def curve(u: float, first: int, theta: FloatArray, o: int, out: FloatArray) -> tuple[float, float]:
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


@lean
def inside(u: float) -> tuple[float, float]:
    """A place along a side within its ends, and 1; 0 where it was beyond, or no number, which must be no place."""
    if not u >= 0.0:
        return 0.0, 0.0
    if u > SIDE - 1.0:
        return SIDE - 1.0, 0.0
    return u, 1.0


@lean
def weight(u: float, j: int) -> tuple[float, float]:
    """Weight of the value at knot j along a side at u, which lies within it, and its slope."""
    i = min(int(u), SIDE - 2)
    b = u - i
    a = 1.0 - b
    weight = (a * (a * a - 1.0) * BENDING_SIDE[i, j] + b * (b * b - 1.0) * BENDING_SIDE[i + 1, j]) / 6.0
    rate = ((1.0 - 3.0 * a * a) * BENDING_SIDE[i, j] + (3.0 * b * b - 1.0) * BENDING_SIDE[i + 1, j]) / 6.0
    if j == i:
        weight += a
        rate -= 1.0
    elif j == i + 1:
        weight += b
        rate += 1.0
    return weight, rate


@lean
def surface(p: float, q: float, theta: FloatArray, o: int, out: FloatArray) -> tuple[float, float, float]:
    """Value and both slopes of the surface at p, q, counted in knots from 0; beyond it keeps the value at its edge.

    Its values stand in theta from o on, those along q together. Writes the partials by them.
    """
    p, moves_p = inside(p)
    q, moves_q = inside(q)
    value, by_p, by_q = 0.0, 0.0, 0.0
    for j in range(SIDE):
        along_q, rate_q = weight(q, j)
        for i in range(SIDE):
            along_p, rate_p = weight(p, i)
            y = theta[o + SIDE * i + j]
            value += along_p * along_q * y
            by_p += rate_p * along_q * y
            by_q += along_p * rate_q * y
            out[D_PARAMETER + SIDE * i + j] = along_p * along_q
    return value, moves_p * by_p, moves_q * by_q
