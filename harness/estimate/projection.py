"""Kernel: the amplitudes of every half-cycle, and what they leave for the decay rate and the frequency."""

import math

import numpy as np

from harness.core.arrays import FloatArray, IntArray
from harness.core.jit import compiled

_LINEAR = 3  # c1, c2 and the centre


def _solve(gram: FloatArray, size: int, inverse: FloatArray) -> None:
    """Inverse of the leading ``size`` block of a symmetric positive matrix, scaled to a unit diagonal first."""
    for i in range(_LINEAR):
        for j in range(_LINEAR):
            inverse[i, j] = 0.0
    scale = np.ones(_LINEAR)
    for i in range(size):
        scale[i] = 1.0 / math.sqrt(gram[i, i]) if gram[i, i] > 0.0 else 0.0
    a = scale[0] * scale[0] * gram[0, 0]
    b = scale[0] * scale[1] * gram[0, 1]
    d = scale[1] * scale[1] * gram[1, 1]
    if size == 2:
        det = a * d - b * b
        if det > 1e-14:
            inverse[0, 0], inverse[1, 1] = d / det * scale[0] ** 2, a / det * scale[1] ** 2
            inverse[0, 1] = inverse[1, 0] = -b / det * scale[0] * scale[1]
        return
    c = scale[0] * scale[2] * gram[0, 2]
    e = scale[1] * scale[2] * gram[1, 2]
    f = scale[2] * scale[2] * gram[2, 2]
    det = a * (d * f - e * e) - b * (b * f - c * e) + c * (b * e - c * d)
    if det > 1e-14:
        inverse[0, 0] = (d * f - e * e) / det
        inverse[1, 1] = (a * f - c * c) / det
        inverse[2, 2] = (a * d - b * b) / det
        inverse[0, 1] = inverse[1, 0] = (c * e - b * f) / det
        inverse[0, 2] = inverse[2, 0] = (b * e - c * d) / det
        inverse[1, 2] = inverse[2, 1] = (b * c - a * e) / det
        for i in range(3):
            for j in range(3):
                inverse[i, j] *= scale[i] * scale[j]


compiled_inverse = compiled(_solve)


def _times(matrix: FloatArray, column: FloatArray, out: FloatArray) -> None:
    """out (3,) = matrix (3, 3) times column (3,), written out: a library's sums are compiled much longer."""
    for i in range(_LINEAR):
        out[i] = matrix[i, 0] * column[0] + matrix[i, 1] * column[1] + matrix[i, 2] * column[2]


_compiled_times = compiled(_times)


def _normal_equations(
    t: FloatArray,
    y: FloatArray,
    start: float,
    lo: int,
    hi: int,
    sigma: float,
    omega: float,
    gram: FloatArray,
    right: FloatArray,
) -> None:
    """Products of the three basis functions with each other (3,3) and with y (3,), over samples lo to hi."""
    gram[:] = 0.0
    right[:] = 0.0
    for n in range(lo, hi):
        s = t[n] - start
        e = math.exp(-sigma * s)
        p, q = e * math.cos(omega * s), e * math.sin(omega * s)
        gram[0, 0] += p * p
        gram[0, 1] += p * q
        gram[1, 1] += q * q
        gram[0, 2] += p
        gram[1, 2] += q
        gram[2, 2] += 1.0
        right[0] += p * y[n]
        right[1] += q * y[n]
        right[2] += y[n]
    gram[1, 0], gram[2, 0], gram[2, 1] = gram[0, 1], gram[0, 2], gram[1, 2]


_compiled_equations = compiled(_normal_equations)


def _residual_products(
    t: FloatArray,
    y: FloatArray,
    start: float,
    lo: int,
    hi: int,
    sigma: float,
    omega: float,
    c: FloatArray,
    right: FloatArray,
    cross: FloatArray,
    rates: FloatArray,
    pull: FloatArray,
) -> float:
    """Sum of squares of the residual of amplitudes c (3,), and the products of it and of the basis with the slopes.

    right (3,): basis and residual. cross (3,2): basis and slopes by sigma and omega. rates (2,2): slopes among
    themselves. pull (2,): slopes and residual.
    """
    right[:] = 0.0
    cross[:] = 0.0
    rates[:] = 0.0
    pull[:] = 0.0
    squares = 0.0
    for n in range(lo, hi):
        s = t[n] - start
        e = math.exp(-sigma * s)
        p, q = e * math.cos(omega * s), e * math.sin(omega * s)
        r = y[n] - c[0] * p - c[1] * q - c[2]
        d0, d1 = -s * (c[0] * p + c[1] * q), s * (c[1] * p - c[0] * q)
        squares += r * r
        right[0] += p * r
        right[1] += q * r
        right[2] += r
        cross[0, 0] += p * d0
        cross[0, 1] += p * d1
        cross[1, 0] += q * d0
        cross[1, 1] += q * d1
        cross[2, 0] += d0
        cross[2, 1] += d1
        rates[0, 0] += d0 * d0
        rates[0, 1] += d0 * d1
        rates[1, 1] += d1 * d1
        pull[0] += d0 * r
        pull[1] += d1 * r
    rates[1, 0] = rates[0, 1]
    return squares


_compiled_products = compiled(_residual_products)


def _project(
    t: FloatArray,
    y: FloatArray,
    start: FloatArray,
    lo: IntArray,
    hi: IntArray,
    sigma: float,
    omega: float,
    size: int,
    c: FloatArray,
    inverse: FloatArray,
    slope: FloatArray,
    information: FloatArray,
    gradient: FloatArray,
) -> float:
    """Fit every half-cycle; return the sum of squares and, for sigma and omega, what is left of them after c.

    c (K,3), inverse (K,3,3): amplitudes and inverse normal matrices. slope (K,3,2): change of c with sigma and omega.
    information (2,2), gradient (2,): normal equations of sigma and omega with every c eliminated.
    """
    gram, right = np.empty((3, 3)), np.empty(3)
    cross, rates, pull = np.empty((3, 2)), np.empty((2, 2)), np.empty(2)
    step = np.empty(3)
    information[:] = 0.0
    gradient[:] = 0.0
    squares = 0.0
    for k in range(start.size):
        _compiled_equations(t, y, start[k], lo[k], hi[k], sigma, omega, gram, right)
        compiled_inverse(gram, size, inverse[k])
        _compiled_times(inverse[k], right, c[k])
        squares += _compiled_products(t, y, start[k], lo[k], hi[k], sigma, omega, c[k], right, cross, rates, pull)
        _compiled_times(inverse[k], right, step)  # what rounding left of it
        for i in range(_LINEAR):
            c[k, i] += step[i]
        for m in range(2):
            gradient[m] += pull[m]
            for i in range(_LINEAR):
                slope[k, i, m] = 0.0
                for j in range(_LINEAR):
                    slope[k, i, m] -= inverse[k, i, j] * cross[j, m]
                gradient[m] += right[i] * slope[k, i, m]
        for m in range(2):
            for j in range(2):
                information[m, j] += rates[m, j]
                for i in range(_LINEAR):
                    information[m, j] += cross[i, m] * slope[k, i, j]
    return squares


compiled_project = compiled(_project)
