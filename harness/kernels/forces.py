"""The forces on the slider apart from dry friction, and the rates of the internal states, with partial derivatives.

Every parameter belongs to one term, so its partials are assigned and never summed: nothing needs zeroing in the inner
loop. Views and arrays inside arrays are avoided: they cost more than the laws they would serve.

The level of dry friction: the curve f_k(v) times the modulations, and the break-away level, with partials.
"""

import math

from harness.core.arrays import FloatArray
from harness.core.jit import lean
from harness.kernels.dispatch import internal, modulation, smooth, speed_level
from harness.kernels.layout import (
    BREAK_AWAY_AT,
    LEVEL,
    LEVEL_AT,
    LEVEL_SIZE,
    LISTS,
    N_INTERNAL,
    N_MODULATION,
    N_SMOOTH,
    N_STATE,
    PENDULUM,
    RESTORING,
    SPRING,
)
from harness.kernels.work import Work
from harness.model.law import (
    D_INTERNAL,
    D_LEVEL,
    D_MASS,
    D_PARAMETER,
    D_STIFFNESS,
    D_T,
    D_V,
    D_X,
    INTERNAL_COLUMNS,
    KINETIC,
    MASS,
    MAX_PARAMETERS,
    STIFFNESS,
    VALUE,
    VISCOUS,
)


@lean
def modulated(t: float, x: float, v: float, w: Work) -> tuple[float, float, float]:
    """Product of the modulations of friction with its partials by x and t; 0 where any of them is not above 0."""
    spec, row = w.spec, w.row
    product, by_x, by_t = 1.0, 0.0, 0.0
    at = LISTS
    for _ in range(spec[N_MODULATION]):
        for j in range(D_PARAMETER + min(spec[at + 2], MAX_PARAMETERS)):
            row[j] = 0.0
        modulation(spec[at], x, v, t, w.theta, spec[at + 1], row)
        factor = row[VALUE]
        if factor <= 0.0:
            return 0.0, 0.0, 0.0
        by_x = by_x * factor + product * row[D_X]
        by_t = by_t * factor + product * row[D_T]
        product *= factor
        at += 3
    return product, by_x, by_t


@lean
def by_modulation(t: float, x: float, v: float, product: float, weight: float, i: int, w: Work) -> None:
    """Set by_theta[i] of the parameters of modulations to weight times the partials of their product."""
    spec, row, by_theta = w.spec, w.row, w.by_theta
    at = LISTS
    for _ in range(spec[N_MODULATION]):
        o = spec[at + 1]
        for j in range(D_PARAMETER + min(spec[at + 2], MAX_PARAMETERS)):
            row[j] = 0.0
        modulation(spec[at], x, v, t, w.theta, o, row)
        others = product / row[VALUE] if product > 0.0 else 0.0
        for j in range(min(spec[at + 2], MAX_PARAMETERS)):
            by_theta[i, o + j] = weight * others * row[D_PARAMETER + j]
        at += 3


@lean
def curve(v: float, w: Work) -> tuple[float, float]:
    """f_k(v) before modulation, and its slope; leaves both with the partials in w.level."""
    row, at = w.level, w.spec[LEVEL_AT]
    if at < 0:
        row[VALUE], row[D_V], row[D_LEVEL] = w.theta[KINETIC], 0.0, 1.0
    else:
        for j in range(D_PARAMETER + min(w.spec[LEVEL_SIZE], MAX_PARAMETERS)):
            row[j] = 0.0
        speed_level(w.spec[LEVEL], v, w.theta, at, row)
    return row[VALUE], row[D_V]


@lean
def level_partials(t: float, x: float, v: float, product: float, weight: float, i: int, w: Work) -> None:
    """Set by_theta[i] to weight times the partials of the friction level that ``curve`` has just been asked for."""
    row, by_theta = w.level, w.by_theta
    at = w.spec[LEVEL_AT]
    by_theta[i, KINETIC] = weight * product * row[D_LEVEL]
    if at >= 0:
        for j in range(min(w.spec[LEVEL_SIZE], MAX_PARAMETERS)):
            by_theta[i, at + j] = weight * product * row[D_PARAMETER + j]
    if w.spec[N_MODULATION] > 0:
        by_modulation(t, x, v, product, weight * row[VALUE], i, w)


@lean
def break_away_at(w: Work) -> int:
    """Place in theta of the break-away level: never below the friction that sets in at v = 0."""
    at, level = w.spec[BREAK_AWAY_AT], w.spec[LEVEL_AT]
    sliding = level if level >= 0 else KINETIC
    return sliding if w.theta[sliding] > w.theta[at] else at


_BARELY = 1e-300


@lean
def net_force(stage: int, t: float, z: FloatArray, side: int, u: float, w: Work) -> tuple[float, float]:
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
