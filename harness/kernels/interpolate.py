"""Interpolation inside a step: quintic Hermite in x (from x, v, a at both ends), cubic in internal states.

The speed is the derivative of the quintic, so that x and v belong together; order 6 in x, 5 in v, 4 in internal states.
"""

from harness.core.arrays import FloatArray
from harness.core.jit import compiled


def _coefficients(h: float, z: FloatArray, z1: FloatArray, ks: FloatArray, n: int, c: FloatArray) -> None:
    """Fill c (n, 6), powers of tau/h, from the ends z, z1 (n,) and slopes ks[0], ks[-1] of a step h."""
    last = ks.shape[0] - 1
    p1, p2 = h * z[1], 0.5 * h * h * ks[0, 1]
    d = z1[0] - z[0] - p1 - p2
    e = h * z1[1] - p1 - 2.0 * p2
    f = h * h * ks[last, 1] - 2.0 * p2
    c[0, 0], c[0, 1], c[0, 2] = z[0], p1, p2
    c[0, 3] = 10.0 * d - 4.0 * e + 0.5 * f
    c[0, 4] = -15.0 * d + 7.0 * e - f
    c[0, 5] = 6.0 * d - 3.0 * e + 0.5 * f
    for i in range(2, n):
        k0, k1 = h * ks[0, i], h * ks[last, i]
        d = z1[i] - z[i]
        c[i, 0], c[i, 1] = z[i], k0
        c[i, 2] = 3.0 * d - 2.0 * k0 - k1
        c[i, 3] = k0 + k1 - 2.0 * d


coefficients = compiled(_coefficients)


def _interpolate(share: float, h: float, c: FloatArray, n: int, z: FloatArray) -> None:
    """Fill z (n,) at the share (0 to 1) of a step h."""
    r = share
    z[0] = c[0, 0] + r * (c[0, 1] + r * (c[0, 2] + r * (c[0, 3] + r * (c[0, 4] + r * c[0, 5]))))
    z[1] = (c[0, 1] + r * (2.0 * c[0, 2] + r * (3.0 * c[0, 3] + r * (4.0 * c[0, 4] + r * 5.0 * c[0, 5])))) / h
    for i in range(2, n):
        z[i] = c[i, 0] + r * (c[i, 1] + r * (c[i, 2] + r * c[i, 3]))


interpolate = compiled(_interpolate)
