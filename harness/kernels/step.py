"""One step of Dormand and Prince's embedded pair, order 5(4), of the state and its sensitivities.

The state goes first and leaves its partials of every stage; the sensitivities follow, column by column, with all their
slopes in registers. Source: J. R. Dormand, P. J. Prince, J. Comp. Appl. Math. 6 (1980) 19-26, table 2 (the pair known
as DOPRI5).
"""

import math

import numpy as np

from harness.core.arrays import FloatArray
from harness.core.jit import lean
from harness.kernels.layout import N_STATE
from harness.kernels.rhs import rhs
from harness.kernels.work import ACROSS, STAGES, Work

C = np.array([0.0, 1 / 5, 3 / 10, 4 / 5, 8 / 9, 1.0, 1.0])
A = np.array(
    [
        [0.0, 0.0, 0.0, 0.0, 0.0, 0.0],
        [1 / 5, 0.0, 0.0, 0.0, 0.0, 0.0],
        [3 / 40, 9 / 40, 0.0, 0.0, 0.0, 0.0],
        [44 / 45, -56 / 15, 32 / 9, 0.0, 0.0, 0.0],
        [19372 / 6561, -25360 / 2187, 64448 / 6561, -212 / 729, 0.0, 0.0],
        [9017 / 3168, -355 / 33, 46732 / 5247, 49 / 176, -5103 / 18656, 0.0],
        [35 / 384, 0.0, 500 / 1113, 125 / 192, -2187 / 6784, 11 / 84],
    ]
)
# fifth-order minus embedded fourth-order weights
E = np.array([71 / 57600, 0.0, -71 / 16695, 71 / 1920, -17253 / 339200, 22 / 525, -1 / 40])
_ROUNDING = 1e-14
"""Part of the state below which an error is rounding and no reason for a shorter step."""


@lean
def slope(stage: int, t: float, z: FloatArray, s: FloatArray, mode: int, u: float, w: Work) -> None:
    """Derivatives of state and sensitivities into ks[stage] (n,) and kss[stage] (n, q): S' = J S + F_theta."""
    rhs(stage, t, z, mode, u, w)
    columns, jac, by_theta, kss = w.columns, w.jac, w.by_theta, w.kss
    n = w.spec[N_STATE]
    for i in range(n):
        for q in range(w.count[ACROSS]):
            total = by_theta[i, columns[q]] if columns[q] >= 0 else 0.0
            for j in range(n):
                total += jac[i, j] * s[j, q]
            kss[stage, i, q] = total


@lean
def advance(t: float, h: float, mode: int, u0: float, u_rate: float, w: Work) -> float:
    """The state alone from (t, z) by h into z1, with ks[0] the slopes at t. Returns its error, 1 being allowed.

    u0 + u_rate tau is the drive within the step. Afterwards ks[6] are the slopes at t + h, and jacs and pushes hold the
    partials of each stage's slopes by the state and by what the columns belong to.
    """
    n, q_count = w.spec[N_STATE], w.count[ACROSS]
    z, z1, ks, columns = w.z, w.z1, w.ks, w.columns
    jac, by_theta, jacs, pushes = w.jac, w.by_theta, w.jacs, w.pushes
    for stage in range(1, STAGES):
        for i in range(n):
            total = 0.0
            for r in range(stage):
                total += A[stage, r] * ks[r, i]
            z1[i] = z[i] + h * total
        tau = C[stage] * h
        rhs(stage, t + tau, z1, mode, u0 + u_rate * tau, w)
        for i in range(n):
            for j in range(n):
                jacs[stage, i, j] = jac[i, j]
        # nothing that is fitted moves the displacement but through the speed
        for i in range(1, n):
            for q in range(q_count):
                pushes[stage, i, q] = by_theta[i, columns[q]] if columns[q] >= 0 else 0.0
    error = 0.0
    for i in range(n):
        total = 0.0
        for r in range(STAGES):
            total += E[r] * ks[r, i]
        if not math.isfinite(total):
            return math.inf
        error = max(error, abs(h * total) / (w.scale[i] + _ROUNDING * abs(z1[i])))
    return error


@lean
def judged(n: int, w: Work) -> float:
    """Largest error of the columns of the sensitivities, 1 being allowed; off : by column, of the scales of its states.

    Every loop over columns is plain arithmetic side by side, so that the compiler takes several at once.
    """
    s1, kss, scale, off, size_s = w.s1, w.kss, w.scale, w.off, w.size_s
    # a column that is 0 until now is as large as its slope lets it become
    for q in range(w.count[ACROSS]):
        size = max(size_s[q], w.h_max * abs(kss[STAGES - 1, 1, q]) / scale[1])
        for i in range(n):
            size = max(size, abs(s1[i, q]) / scale[i])
        off[q] = off[q] / (w.sensitivity_error * size) if off[q] > 0.0 else 0.0
    error = 0.0
    for q in range(w.count[ACROSS]):
        error = max(error, off[q])
    return error


@lean
def carry_two(h: float, w: Work) -> float:
    """Sensitivities of displacement and speed through the step that ``advance`` made; returns their error."""
    s, s1, kss, jacs, pushes, off = w.s, w.s1, w.kss, w.jacs, w.pushes, w.off
    a10 = h * A[1, 0]
    a20, a21 = h * A[2, 0], h * A[2, 1]
    a30, a31, a32 = h * A[3, 0], h * A[3, 1], h * A[3, 2]
    a40, a41, a42, a43 = h * A[4, 0], h * A[4, 1], h * A[4, 2], h * A[4, 3]
    a50, a51, a52, a53, a54 = h * A[5, 0], h * A[5, 1], h * A[5, 2], h * A[5, 3], h * A[5, 4]
    a60, a62, a63, a64, a65 = h * A[6, 0], h * A[6, 2], h * A[6, 3], h * A[6, 4], h * A[6, 5]
    # in locals, so that the compiler need not fear that what it writes changes them, and takes several columns at once
    moves = jacs[1, 0, 1]
    k1, c1 = jacs[1, 1, 0], jacs[1, 1, 1]
    k2, c2 = jacs[2, 1, 0], jacs[2, 1, 1]
    k3, c3 = jacs[3, 1, 0], jacs[3, 1, 1]
    k4, c4 = jacs[4, 1, 0], jacs[4, 1, 1]
    k5, c5 = jacs[5, 1, 0], jacs[5, 1, 1]
    k6, c6 = jacs[6, 1, 0], jacs[6, 1, 1]
    x_scale, v_scale = w.scale[0], w.scale[1]
    for q in range(w.count[ACROSS]):
        p, v = s[0, q], s[1, q]
        x0, v0 = kss[0, 0, q], kss[0, 1, q]
        pp, vv = p + a10 * x0, v + a10 * v0
        x1 = moves * vv
        v1 = pushes[1, 1, q] + k1 * pp + c1 * vv
        pp, vv = p + a20 * x0 + a21 * x1, v + a20 * v0 + a21 * v1
        x2 = moves * vv
        v2 = pushes[2, 1, q] + k2 * pp + c2 * vv
        pp, vv = p + a30 * x0 + a31 * x1 + a32 * x2, v + a30 * v0 + a31 * v1 + a32 * v2
        x3 = moves * vv
        v3 = pushes[3, 1, q] + k3 * pp + c3 * vv
        pp = p + a40 * x0 + a41 * x1 + a42 * x2 + a43 * x3
        vv = v + a40 * v0 + a41 * v1 + a42 * v2 + a43 * v3
        x4 = moves * vv
        v4 = pushes[4, 1, q] + k4 * pp + c4 * vv
        pp = p + a50 * x0 + a51 * x1 + a52 * x2 + a53 * x3 + a54 * x4
        vv = v + a50 * v0 + a51 * v1 + a52 * v2 + a53 * v3 + a54 * v4
        x5 = moves * vv
        v5 = pushes[5, 1, q] + k5 * pp + c5 * vv
        pp = p + a60 * x0 + a62 * x2 + a63 * x3 + a64 * x4 + a65 * x5
        vv = v + a60 * v0 + a62 * v2 + a63 * v3 + a64 * v4 + a65 * v5
        x6 = moves * vv
        v6 = pushes[6, 1, q] + k6 * pp + c6 * vv
        s1[0, q], s1[1, q] = pp, vv
        kss[STAGES - 1, 0, q], kss[STAGES - 1, 1, q] = x6, v6
        x_off = E[0] * x0 + E[2] * x2 + E[3] * x3 + E[4] * x4 + E[5] * x5 + E[6] * x6
        v_off = E[0] * v0 + E[2] * v2 + E[3] * v3 + E[4] * v4 + E[5] * v5 + E[6] * v6
        off[q] = max(abs(h * x_off) / x_scale, abs(h * v_off) / v_scale)
    return judged(2, w)


@lean
def carry(h: float, w: Work) -> float:
    """Sensitivities of any number of states through the step that ``advance`` made; returns their error."""
    n, count = w.spec[N_STATE], w.count[ACROSS]
    s, s1, kss, jacs, pushes, off = w.s, w.s1, w.kss, w.jacs, w.pushes, w.off
    for stage in range(1, STAGES):
        for i in range(n):
            for q in range(count):
                s1[i, q] = s[i, q]
            for r in range(stage):
                share = h * A[stage, r]
                for q in range(count):
                    s1[i, q] += share * kss[r, i, q]
        for i in range(n):
            for q in range(count):
                kss[stage, i, q] = pushes[stage, i, q]
            for j in range(n):
                by = jacs[stage, i, j]
                for q in range(count):
                    kss[stage, i, q] += by * s1[j, q]
    for q in range(count):
        off[q] = 0.0
    for i in range(n):
        scale = w.scale[i]
        for q in range(count):
            total = 0.0
            for r in range(STAGES):
                total += E[r] * kss[r, i, q]
            off[q] = max(off[q], abs(h * total) / scale)
    return judged(n, w)


@lean
def step(t: float, h: float, mode: int, u0: float, u_rate: float, w: Work) -> float:
    """Step from (t, z, s) by h into z1, s1; ks[0], kss[0] hold the slopes at t. Returns the error, 1 being allowed.

    The error of the sensitivities matters where a law has a corner, which the state hardly feels. Afterwards ks[6],
    kss[6] are the slopes at t + h.
    """
    error = advance(t, h, mode, u0, u_rate, w)
    if w.count[ACROSS] == 0 or not math.isfinite(error):
        return error
    return max(error, carry_two(h, w) if w.spec[N_STATE] == 2 else carry(h, w))
