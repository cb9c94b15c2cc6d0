"""Interpolation inside a step: quintic Hermite in x (from x, v, a at both ends), cubic in internal states.

The speed is the derivative of the quintic, so that x and v belong together; order 6 in x, 5 in v, 4 in internal states.
"""

from harness.core.jit import compiled
from harness.kernels.work import ACROSS, STAGES, Work


def _coefficients(h: float, n: int, w: Work) -> None:
    """Fill w.cz (n, 6), powers of tau/h, from the ends and the slopes there of a step h."""
    z, z1, ks, c = w.z, w.z1, w.ks, w.cz
    last = STAGES - 1
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


coefficients = compiled(_coefficients, lean=True)


def _interpolate(r: float, h: float, n: int, w: Work) -> None:
    """Fill w.zi (n,) at the share r (0 to 1) of a step h."""
    c, z = w.cz, w.zi
    z[0] = c[0, 0] + r * (c[0, 1] + r * (c[0, 2] + r * (c[0, 3] + r * (c[0, 4] + r * c[0, 5]))))
    z[1] = (c[0, 1] + r * (2.0 * c[0, 2] + r * (3.0 * c[0, 3] + r * (4.0 * c[0, 4] + r * 5.0 * c[0, 5])))) / h
    for i in range(2, n):
        z[i] = c[i, 0] + r * (c[i, 1] + r * (c[i, 2] + r * c[i, 3]))


interpolate = compiled(_interpolate, lean=True)


def _interpolate_sensitivities(r: float, h: float, n: int, w: Work) -> None:
    """Fill w.si (n, q) at the share r of a step h with the same polynomials in Hermite form."""
    s, s1, kss, out = w.s, w.s1, w.kss, w.si
    last = STAGES - 1
    r2 = r * r
    r3, g = r2 * r, 1.0 - r
    # weights of (value, slope, curvature) at either end, and their derivatives by r
    b0 = 1.0 - r3 * (10.0 - 15.0 * r + 6.0 * r2)
    b1 = r - r3 * (6.0 - 8.0 * r + 3.0 * r2)
    b2 = 0.5 * r2 * g * g * g
    b4 = -r3 * (4.0 - 7.0 * r + 3.0 * r2)
    b5 = 0.5 * r3 * g * g
    d0 = -30.0 * r2 * g * g
    d1 = 1.0 - r2 * (18.0 - 32.0 * r + 15.0 * r2)
    d2 = 0.5 * r * g * g * (2.0 - 5.0 * r)
    d4 = -r2 * (12.0 - 28.0 * r + 15.0 * r2)
    d5 = 0.5 * r2 * g * (3.0 - 5.0 * r)
    h2 = h * h
    for q in range(w.count[ACROSS]):
        p, p1, v, v1 = s[0, q], s1[0, q], h * s[1, q], h * s1[1, q]
        g0, g1 = h2 * kss[0, 1, q], h2 * kss[last, 1, q]
        out[0, q] = p1 + b0 * (p - p1) + b1 * v + b4 * v1 + b2 * g0 + b5 * g1
        out[1, q] = (d0 * (p - p1) + d1 * v + d4 * v1 + d2 * g0 + d5 * g1) / h
    for i in range(2, n):
        for q in range(w.count[ACROSS]):
            k0, k1, d = h * kss[0, i, q], h * kss[last, i, q], s1[i, q] - s[i, q]
            out[i, q] = s[i, q] + r * (k0 + r * (3.0 * d - 2.0 * k0 - k1 + r * (k0 + k1 - 2.0 * d)))


interpolate_sensitivities = compiled(_interpolate_sensitivities, lean=True)
