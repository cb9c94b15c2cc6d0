"""One step of Dormand and Prince's embedded pair, order 5(4), of the state and its sensitivities.

Source: J. R. Dormand, P. J. Prince, J. Comp. Appl. Math. 6 (1980) 19-26, table 2 (the pair known as DOPRI5).
"""

import numpy as np

from harness.core.arrays import FloatArray, IntArray
from harness.core.jit import compiled
from harness.kernels.layout import N_STATE
from harness.kernels.rhs import rhs

STAGES = 7
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


def _slope(
    stage: int,
    t: float,
    z: FloatArray,
    s: FloatArray,
    mode: int,
    spec: IntArray,
    theta: FloatArray,
    columns: IntArray,
    u: float,
    ks: FloatArray,
    kss: FloatArray,
    jac: FloatArray,
    by_theta: FloatArray,
    row: FloatArray,
    rows: FloatArray,
) -> None:
    """Derivatives of state and sensitivities into ks[stage] (n,) and kss[stage] (n, q): S' = J S + F_theta."""
    rhs(stage, t, z, mode, spec, theta, u, ks, jac, by_theta, row, rows)
    n = spec[N_STATE]
    for i in range(n):
        for q in range(columns.size):
            total = by_theta[i, columns[q]] if columns[q] >= 0 else 0.0
            for j in range(n):
                total += jac[i, j] * s[j, q]
            kss[stage, i, q] = total


slope = compiled(_slope, lean=True)


def _step(
    t: float,
    h: float,
    z: FloatArray,
    s: FloatArray,
    mode: int,
    spec: IntArray,
    theta: FloatArray,
    columns: IntArray,
    u0: float,
    u_rate: float,
    scale: FloatArray,
    z1: FloatArray,
    s1: FloatArray,
    ks: FloatArray,
    kss: FloatArray,
    jac: FloatArray,
    by_theta: FloatArray,
    row: FloatArray,
    rows: FloatArray,
) -> float:
    """Step from (t, z, s) by h into z1, s1; ks[0], kss[0] hold the slopes at t. Returns the scaled error of z.

    u0 + u_rate tau is the drive within the step. After the call ks[6], kss[6] are the slopes at t + h.
    """
    n, q_count = spec[N_STATE], columns.size
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
        slope(stage, t + tau, z1, s1, mode, spec, theta, columns, u0 + u_rate * tau, ks, kss, jac, by_theta, row, rows)
    error = 0.0
    for i in range(n):
        total = 0.0
        for r in range(STAGES):
            total += E[r] * ks[r, i]
        error = max(error, abs(h * total) / scale[i])
    return error


step = compiled(_step, lean=True)
