"""The right side of the equation of motion with all its partial derivatives, in any contact mode.

Every parameter belongs to one term, so its partials are assigned and never summed: nothing needs zeroing in the inner
loop. Views and arrays inside arrays are avoided: they cost more than the laws they would serve.
"""

import math

from harness.core.arrays import FloatArray, IntArray
from harness.core.jit import compiled
from harness.kernels.dispatch import internal, modulation, smooth
from harness.kernels.layout import (
    BREAK_AWAY_AT,
    BRISTLE,
    COULOMB,
    FRICTION,
    FRICTION_AT,
    LISTS,
    N_INTERNAL,
    N_MODULATION,
    N_SMOOTH,
    N_STATE,
    PENDULUM,
    REGULARISED,
    RESTORING,
    SPRING,
    STRIBECK_AT,
)
from harness.model.law import (
    COLUMNS,
    D_INTERNAL,
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

FREE = 2
"""Contact mode of a friction law without stick (bristle, regularised): no event, no constraint."""

_TINY = 1e-300


def _net_force(
    stage: int,
    t: float,
    z: FloatArray,
    spec: IntArray,
    theta: FloatArray,
    u: float,
    ks: FloatArray,
    jac: FloatArray,
    by_theta: FloatArray,
    row: FloatArray,
    rows: FloatArray,
) -> tuple[float, float]:
    """Force without dry friction and its partial by time (the drive excepted).

    Fills row 1 of jac (n, n) and by_theta (n, P) with the partials of the force over m, and the rows from 2 on of
    ks[stage], jac and by_theta with rates of the internal states and their partials.
    """
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
    at = LISTS + 3 * spec[N_MODULATION]
    for _ in range(spec[N_SMOOTH]):
        o = spec[at + 1]
        for j in range(COLUMNS):
            row[j] = 0.0
        smooth(spec[at], x, v, t, theta, o, row)
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
            for j in range(INTERNAL_COLUMNS):
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


net_force = compiled(_net_force, lean=True, inline=True)


def _modulated(
    t: float, x: float, v: float, spec: IntArray, theta: FloatArray, row: FloatArray
) -> tuple[float, float, float]:
    """Product of the modulations of friction with partials by x and t; never below 0."""
    product, by_x, by_t = 1.0, 0.0, 0.0
    at = LISTS
    for _ in range(spec[N_MODULATION]):
        for j in range(COLUMNS):
            row[j] = 0.0
        modulation(spec[at], x, v, t, theta, spec[at + 1], row)
        factor = row[VALUE]
        by_x = by_x * factor + product * row[D_X]
        by_t = by_t * factor + product * row[D_T]
        product *= factor
        at += 3
    if product <= 0.0:
        return 0.0, 0.0, 0.0
    return product, by_x, by_t


modulated = compiled(_modulated, lean=True, inline=True)


def _by_modulation(
    t: float,
    x: float,
    v: float,
    spec: IntArray,
    theta: FloatArray,
    product: float,
    weight: float,
    i: int,
    by_theta: FloatArray,
    row: FloatArray,
) -> None:
    """Set by_theta[i] of the parameters of modulations to weight times the partials of their product."""
    at = LISTS
    for _ in range(spec[N_MODULATION]):
        o = spec[at + 1]
        for j in range(COLUMNS):
            row[j] = 0.0
        modulation(spec[at], x, v, t, theta, o, row)
        others = product / row[VALUE] if product > 0.0 else 0.0
        for j in range(min(spec[at + 2], MAX_PARAMETERS)):
            by_theta[i, o + j] = weight * others * row[D_PARAMETER + j]
        at += 3


by_modulation = compiled(_by_modulation, lean=True)


def _level_partials(
    t: float,
    x: float,
    v: float,
    spec: IntArray,
    theta: FloatArray,
    product: float,
    weight: float,
    i: int,
    by_theta: FloatArray,
    row: FloatArray,
) -> None:
    """Set by_theta[i] to weight times the partials of the friction level by every parameter it depends on."""
    curve, at = theta[KINETIC], spec[STRIBECK_AT]
    if at >= 0:
        v_s = theta[at + 1]
        e = math.exp(-((v / v_s) ** 2))
        excess_ = theta[at] - curve
        by_theta[i, KINETIC] = weight * product * (1.0 - e)
        by_theta[i, at] = weight * product * e
        by_theta[i, at + 1] = weight * product * 2.0 * excess_ * e * v * v / (v_s * v_s * v_s)
        curve += excess_ * e
    else:
        by_theta[i, KINETIC] = weight * product
    if spec[N_MODULATION] > 0:
        by_modulation(t, x, v, spec, theta, product, weight * curve, i, by_theta, row)


level_partials = compiled(_level_partials, lean=True, inline=True)


def _rhs(
    stage: int,
    t: float,
    z: FloatArray,
    mode: int,
    spec: IntArray,
    theta: FloatArray,
    u: float,
    ks: FloatArray,
    jac: FloatArray,
    by_theta: FloatArray,
    row: FloatArray,
    rows: FloatArray,
) -> None:
    """Fill ks[stage] (n,) with dz/dt, jac (n, n) with its partials by z and by_theta (n, P) by theta.

    mode: -1, 0, 1 (slip, stick, slip) or FREE. row (COLUMNS,) and rows (3, INTERNAL_COLUMNS) are scratch; row 0 of
    by_theta stays as it is (zero).
    """
    n = spec[N_STATE]
    force, _ = net_force(stage, t, z, spec, theta, u, ks, jac, by_theta, row, rows)
    if mode == 0:
        ks[stage, 0] = 0.0
        ks[stage, 1] = 0.0
        for j in range(n):
            jac[0, j] = 0.0
            jac[1, j] = 0.0
        for j in range(theta.size):
            by_theta[1, j] = 0.0
        return
    x, v, over_m = z[0], z[1], 1.0 / theta[MASS]
    ks[stage, 0] = v
    jac[0, 0] = 0.0
    jac[0, 1] = 1.0
    for j in range(2, n):
        jac[0, j] = 0.0
    product, by_x, _ = modulated(t, x, v, spec, theta, row)
    curve, curve_by_v = theta[KINETIC], 0.0
    at = spec[STRIBECK_AT]
    if at >= 0:
        v_s = theta[at + 1]
        bump = (theta[at] - curve) * math.exp(-((v / v_s) ** 2))
        curve += bump
        curve_by_v = -2.0 * bump * v / (v_s * v_s)
    level, level_x, level_v = curve * product, curve * by_x, curve_by_v * product
    law, at = spec[FRICTION], spec[FRICTION_AT]
    friction = 0.0
    if law == COULOMB:
        friction = mode * level
        jac[1, 0] -= mode * level_x * over_m
        jac[1, 1] -= mode * level_v * over_m
        level_partials(t, x, v, spec, theta, product, -mode * over_m, 1, by_theta, row)
    elif law == BRISTLE:
        s0, s1, b = theta[at], theta[at + 1], z[2]
        level = max(level, _TINY)
        speed = abs(v)
        sign = 1.0 if v >= 0.0 else -1.0
        pull = s0 * speed * b / level
        rate = v - pull
        friction = s0 * b + s1 * rate
        rate_v = 1.0 - s0 * sign * b / level + pull * level_v / level
        rate_x = pull * level_x / level
        rate_b = -s0 * speed / level
        ks[stage, 2] = rate
        for j in range(3, n):
            jac[2, j] = 0.0
        jac[1, 0] -= s1 * rate_x * over_m
        jac[1, 1] -= s1 * rate_v * over_m
        jac[1, 2] = -(s0 + s1 * rate_b) * over_m
        jac[2, 0], jac[2, 1], jac[2, 2] = rate_x, rate_v, rate_b
        level_partials(t, x, v, spec, theta, product, -s1 * pull / level * over_m, 1, by_theta, row)
        level_partials(t, x, v, spec, theta, product, pull / level, 2, by_theta, row)
        by_theta[1, at] = -(b - s1 * speed * b / level) * over_m
        by_theta[1, at + 1] = -rate * over_m
        by_theta[2, at] = -speed * b / level
    elif law == REGULARISED:
        v_r, lead = theta[at], theta[at + 1]
        ratio = (v + lead * force * over_m) / v_r
        if abs(ratio) < 1.0:
            slope = level / v_r
            friction = level * ratio
            keep = 1.0 - slope * lead * over_m
            for j in range(n):
                jac[1, j] *= keep
            for j in range(theta.size):
                by_theta[1, j] *= keep
            jac[1, 0] -= level_x * ratio * over_m
            jac[1, 1] -= (level_v * ratio + slope) * over_m
            by_theta[1, MASS] += slope * lead * force * over_m * over_m * over_m
            by_theta[1, at] = friction / v_r * over_m
            by_theta[1, at + 1] = -slope * force * over_m * over_m
            level_partials(t, x, v, spec, theta, product, -ratio * over_m, 1, by_theta, row)
        else:
            sign = 1.0 if ratio > 0.0 else -1.0
            friction = sign * level
            jac[1, 0] -= sign * level_x * over_m
            jac[1, 1] -= sign * level_v * over_m
            by_theta[1, at] = 0.0
            by_theta[1, at + 1] = 0.0
            level_partials(t, x, v, spec, theta, product, -sign * over_m, 1, by_theta, row)
    ks[stage, 1] = (force - friction) * over_m
    by_theta[1, MASS] -= ks[stage, 1] * over_m


rhs = compiled(_rhs, lean=True)


def _excess(
    t: float,
    z: FloatArray,
    spec: IntArray,
    theta: FloatArray,
    u: float,
    ks: FloatArray,
    jac: FloatArray,
    by_theta: FloatArray,
    row: FloatArray,
    rows: FloatArray,
) -> tuple[float, float, float, float, float]:
    """Net force on a slider at rest, its partial by time, break-away level, and that level's partials by x and t.

    Fills by_theta[1] (P,) with the partials of the force over m, jac[1] with those by the state; ks has one stage.
    """
    force, by_t = net_force(0, t, z, spec, theta, u, ks, jac, by_theta, row, rows)
    product, product_x, product_t = modulated(t, z[0], 0.0, spec, theta, row)
    f_s = theta[spec[BREAK_AWAY_AT]]
    return force, by_t, f_s * product, f_s * product_x, f_s * product_t


excess = compiled(_excess, lean=True)
