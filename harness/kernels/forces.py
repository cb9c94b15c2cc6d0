"""The forces on the slider apart from dry friction, and the rates of the internal states, with partial derivatives.

Every parameter belongs to one term, so its partials are assigned and never summed: nothing needs zeroing in the inner
loop. Views and arrays inside arrays are avoided: they cost more than the laws they would serve.
"""

import math

from harness.core.arrays import FloatArray
from harness.core.jit import compiled
from harness.kernels.dispatch import internal, smooth
from harness.kernels.layout import LISTS, N_INTERNAL, N_MODULATION, N_SMOOTH, N_STATE, PENDULUM, RESTORING, SPRING
from harness.kernels.work import Work
from harness.model.law import (
    D_INTERNAL,
    D_MASS,
    D_PARAMETER,
    D_STIFFNESS,
    D_T,
    D_V,
    D_X,
    INTERNAL_COLUMNS,
    MASS,
    MAX_PARAMETERS,
    STIFFNESS,
    VALUE,
    VISCOUS,
)

_BARELY = 1e-300


def _net_force(stage: int, t: float, z: FloatArray, side: int, u: float, w: Work) -> tuple[float, float]:
    """Force without dry friction and its partial by time (the drive excepted).

    side: sign of the speed that laws with a corner at v = 0 are to see, 0 for that of v itself.
    Fills row 1 of jac (n, n) and by_theta (n, P) with the partials of the force over m, and the rows from 2 on of
    ks[stage], jac and by_theta with rates of the internal states and their partials.
    """
    spec, theta, ks, jac, by_theta = w.spec, w.theta, w.ks, w.jac, w.by_theta
    row, rows = w.row, w.rows
    n = spec[N_STATE]
    x, v = z[0], z[1]
    c, k, over_m = theta[VISCOUS], theta[STIFFNESS], 1.0 / theta[MASS]
    force = u - c * v
    by_x, by_v, by_t, by_m, by_k = 0.0, -c, 0.0, 0.0, 0.0
    if spec[RESTORING] == SPRING:
        force -= k * x
        by_x = -k
        by_k = -x
    elif spec[RESTORING] == PENDULUM:
        force -= k * math.sin(x)
        by_x = -k * math.cos(x)
        by_k = -math.sin(x)
    # a stage of a step that ends at a reversal may lie a hair beyond it, where |v| has its other slope
    v_law = v if side == 0 or v * side > 0.0 else side * _BARELY
    at = LISTS + 3 * spec[N_MODULATION]
    for _ in range(spec[N_SMOOTH]):
        o = spec[at + 1]
        for j in range(D_PARAMETER + min(spec[at + 2], MAX_PARAMETERS)):
            row[j] = 0.0
        smooth(spec[at], x, v_law, t, theta, o, row)
        force -= row[VALUE]
        by_x -= row[D_X]
        by_v -= row[D_V]
        by_t -= row[D_T]
        by_m -= row[D_MASS]
        by_k -= row[D_STIFFNESS]
        for j in range(min(spec[at + 2], MAX_PARAMETERS)):
            by_theta[1, o + j] = -row[D_PARAMETER + j] * over_m
        at += 3
    for j in range(2, n):
        jac[1, j] = 0.0
    for _ in range(spec[N_INTERNAL]):
        o, s, width = spec[at + 1], spec[at + 3], spec[at + 4]
        for i in range(3):
            for j in range(D_PARAMETER + min(spec[at + 2], MAX_PARAMETERS)):
                rows[i, j] = 0.0
            for j in range(D_INTERNAL, INTERNAL_COLUMNS):
                rows[i, j] = 0.0
        w1 = z[s + 1] if width > 1 else 0.0
        internal(spec[at], x, v, z[s], w1, theta, o, rows)
        force -= rows[0, VALUE]
        by_x -= rows[0, D_X]
        by_v -= rows[0, D_V]
        by_m -= rows[0, D_MASS]
        for j in range(min(spec[at + 2], MAX_PARAMETERS)):
            by_theta[1, o + j] = -rows[0, D_PARAMETER + j] * over_m
        for i in range(width):
            jac[1, s + i] = -rows[0, D_INTERNAL + i] * over_m
            ks[stage, s + i] = rows[1 + i, VALUE]
            for j in range(n):
                jac[s + i, j] = 0.0
            jac[s + i, 0] = rows[1 + i, D_X]
            jac[s + i, 1] = rows[1 + i, D_V]
            for j in range(width):
                jac[s + i, s + j] = rows[1 + i, D_INTERNAL + j]
            for j in range(min(spec[at + 2], MAX_PARAMETERS)):
                by_theta[s + i, o + j] = rows[1 + i, D_PARAMETER + j]
        at += 5
    jac[1, 0] = by_x * over_m
    jac[1, 1] = by_v * over_m
    by_theta[1, MASS] = by_m * over_m
    by_theta[1, VISCOUS] = -v * over_m
    by_theta[1, STIFFNESS] = by_k * over_m
    return force, by_t


net_force = compiled(_net_force, lean=True)
