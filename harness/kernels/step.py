"""One step of Dormand and Prince's embedded pair, order 5(4), of the state and its sensitivities.

Source: J. R. Dormand, P. J. Prince, J. Comp. Appl. Math. 6 (1980) 19-26, table 2 (the pair known as DOPRI5).
"""

import math

import numpy as np

from harness.core.arrays import FloatArray
from harness.core.jit import compiled
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


def _slope(stage: int, t: float, z: FloatArray, s: FloatArray, mode: int, u: float, w: Work) -> None:
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


slope = compiled(_slope, lean=True)


def _step(t: float, h: float, mode: int, u0: float, u_rate: float, w: Work) -> float:
    """Step from (t, z, s) by h into z1, s1; ks[0], kss[0] hold the slopes at t. Returns the error, 1 being allowed.

    u0 + u_rate tau is the drive within the step. The error of the sensitivities matters where a law has a corner, which
    the state hardly feels. Afterwards ks[6], kss[6] are the slopes at t + h.
    """
    n, q_count = w.spec[N_STATE], w.count[ACROSS]
    z, s, z1, s1, ks, kss = w.z, w.s, w.z1, w.s1, w.ks, w.kss
    for stage in range(1, STAGES):
        for i in range(n):
            total = 0.0
            for r in range(stage):
                total += A[stage, r] * ks[r, i]
            z1[i] = z[i] + h * total
            for q in range(q_count):
                s1[i, q] = s[i, q]
            for r in range(stage):
                weight = h * A[stage, r]
                for q in range(q_count):
                    s1[i, q] += weight * kss[r, i, q]
        tau = C[stage] * h
        slope(stage, t + tau, z1, s1, mode, u0 + u_rate * tau, w)
    error = 0.0
    for i in range(n):
        total = 0.0
        for r in range(STAGES):
            total += E[r] * ks[r, i]
        if not math.isfinite(total):
            return math.inf
        error = max(error, abs(h * total) / (w.scale[i] + _ROUNDING * abs(z1[i])))
    for q in range(q_count):
        worst, size = 0.0, w.size_s[q]
        for i in range(n):
            total = 0.0
            for r in range(STAGES):
                total += E[r] * kss[r, i, q]
            worst = max(worst, abs(h * total) / w.scale[i])
            size = max(size, abs(s1[i, q]) / w.scale[i])
        # a column that is 0 until now is as large as its slope lets it become
        size = max(size, w.h_max * abs(kss[STAGES - 1, 1, q]) / w.scale[1])
        if worst > 0.0:
            error = max(error, worst / (w.sensitivity_error * size))
    return error


step = compiled(_step, lean=True)
