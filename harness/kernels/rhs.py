"""The right side of the equation of motion with all its partial derivatives, in any contact mode."""

import math

import numpy as np

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
    t: float,
    z: FloatArray,
    spec: IntArray,
    theta: FloatArray,
    u: float,
    by_state: FloatArray,
    by_theta: FloatArray,
    rates: FloatArray,
    rates_by_state: FloatArray,
    rates_by_theta: FloatArray,
    row: FloatArray,
    rows: FloatArray,
) -> tuple[float, float]:
    """Force without dry friction, and its partial by time (the drive excepted); fills the partials.

    by_state (n,), by_theta (P,): partials of the force. rates (n,), rates_by_state (n, n), rates_by_theta (n, P): of the
    internal states, rows 2.. only. row (COLUMNS,), rows (3, INTERNAL_COLUMNS): scratch.
    """
    n = spec[N_STATE]
    x, v = z[0], z[1]
    by_state[:] = 0.0
    by_theta[:] = 0.0
    c, k = theta[VISCOUS], theta[STIFFNESS]
    force = u - c * v
    by_time = 0.0
    by_state[1] = -c
    by_theta[VISCOUS] = -v
    if spec[RESTORING] == SPRING:
        force -= k * x
        by_state[0] = -k
        by_theta[STIFFNESS] = -x
    elif spec[RESTORING] == PENDULUM:
        force -= k * math.sin(x)
        by_state[0] = -k * math.cos(x)
        by_theta[STIFFNESS] = -math.sin(x)
    at = LISTS + 2 * spec[N_MODULATION]
    for _ in range(spec[N_SMOOTH]):
        o = spec[at + 1]
        row[:] = 0.0
        smooth(spec[at], x, v, t, theta, o, row)
        force -= row[VALUE]
        by_state[0] -= row[D_X]
        by_state[1] -= row[D_V]
        by_time -= row[D_T]
        by_theta[MASS] -= row[D_MASS]
        by_theta[STIFFNESS] -= row[D_STIFFNESS]
        for j in range(min(MAX_PARAMETERS, theta.size - o)):
            by_theta[o + j] -= row[D_PARAMETER + j]
        at += 2
    for _ in range(spec[N_INTERNAL]):
        o, s = spec[at + 1], spec[at + 2]
        rows[:] = 0.0
        width = spec[at + 3]
        w1 = z[s + 1] if width > 1 else 0.0
        internal(spec[at], x, v, z[s], w1, theta, o, rows)
        force -= rows[0, VALUE]
        by_state[0] -= rows[0, D_X]
        by_state[1] -= rows[0, D_V]
        by_theta[MASS] -= rows[0, D_MASS]
        for j in range(min(MAX_PARAMETERS, theta.size - o)):
            by_theta[o + j] -= rows[0, D_PARAMETER + j]
        for j in range(width):
            by_state[s + j] -= rows[0, D_INTERNAL + j]
        for i in range(width):
            rates[s + i] = rows[1 + i, VALUE]
            for j in range(n):
                rates_by_state[s + i, j] = 0.0
            rates_by_state[s + i, 0] = rows[1 + i, D_X]
            rates_by_state[s + i, 1] = rows[1 + i, D_V]
            for j in range(width):
                rates_by_state[s + i, s + j] = rows[1 + i, D_INTERNAL + j]
            for j in range(theta.size):
                rates_by_theta[s + i, j] = 0.0
            for j in range(min(MAX_PARAMETERS, theta.size - o)):
                rates_by_theta[s + i, o + j] = rows[1 + i, D_PARAMETER + j]
        at += 4
    return force, by_time


net_force = compiled(_net_force)


def _modulated(
    t: float, z: FloatArray, spec: IntArray, theta: FloatArray, by_theta: FloatArray, row: FloatArray
) -> tuple[float, float, float]:
    """Product of the modulations of friction with partials by x and t; never below 0. Fills by_theta (P,)."""
    product, by_x, by_t = 1.0, 0.0, 0.0
    by_theta[:] = 0.0
    at = LISTS
    for _ in range(spec[N_MODULATION]):
        o = spec[at + 1]
        row[:] = 0.0
        modulation(spec[at], z[0], z[1], t, theta, o, row)
        factor = row[VALUE]
        by_x = by_x * factor + product * row[D_X]
        by_t = by_t * factor + product * row[D_T]
        for j in range(theta.size):
            by_theta[j] *= factor
        for j in range(min(MAX_PARAMETERS, theta.size - o)):
            by_theta[o + j] += product * row[D_PARAMETER + j]
        product *= factor
        at += 2
    if product <= 0.0:
        by_theta[:] = 0.0
        return 0.0, 0.0, 0.0
    return product, by_x, by_t


modulated = compiled(_modulated)


def _level(
    t: float, z: FloatArray, spec: IntArray, theta: FloatArray, by_theta: FloatArray, row: FloatArray
) -> tuple[float, float, float]:
    """Friction while sliding: level curve times modulations, with partials by x and v. Fills by_theta (P,)."""
    product, by_x, _ = modulated(t, z, spec, theta, by_theta, row)
    curve, curve_by_v = theta[KINETIC], 0.0
    at = spec[STRIBECK_AT]
    by_kinetic = 1.0
    if at >= 0:
        f_s, v_s, v = theta[at], theta[at + 1], z[1]
        e = math.exp(-((v / v_s) ** 2))
        excess = f_s - theta[KINETIC]
        curve += excess * e
        curve_by_v = -2.0 * excess * e * v / (v_s * v_s)
        by_kinetic = 1.0 - e
        for j in range(theta.size):
            by_theta[j] *= curve
        by_theta[at] += product * e
        by_theta[at + 1] += product * 2.0 * excess * e * v * v / (v_s * v_s * v_s)
    else:
        for j in range(theta.size):
            by_theta[j] *= curve
    by_theta[KINETIC] += product * by_kinetic
    return curve * product, curve * by_x, curve_by_v * product


level = compiled(_level)


def _rhs(
    t: float,
    z: FloatArray,
    mode: int,
    spec: IntArray,
    theta: FloatArray,
    u: float,
    dz: FloatArray,
    jac: FloatArray,
    by_theta: FloatArray,
    work: FloatArray,
    rows: FloatArray,
) -> None:
    """Fill dz (n,), jac (n, n) = d dz/d z and by_theta (n, P) = d dz/d theta.

    mode: -1, 0, 1 (slip, stick, slip) or FREE. work (4, max(n, P, COLUMNS)) and rows (3, INTERNAL_COLUMNS) are scratch.
    """
    n, p = spec[N_STATE], theta.size
    force_by_state, force_by_theta = work[0, :n], work[1, :p]
    level_by_theta, row = work[2, :p], work[3]
    force, _ = net_force(
        t, z, spec, theta, u, force_by_state, force_by_theta, dz, jac, by_theta, row, rows
    )
    m, v = theta[MASS], z[1]
    for j in range(n):
        jac[0, j] = 0.0
        jac[1, j] = 0.0
    for j in range(p):
        by_theta[0, j] = 0.0
        by_theta[1, j] = 0.0
    if mode == 0:
        dz[0] = 0.0
        dz[1] = 0.0
        return
    dz[0] = v
    jac[0, 1] = 1.0
    law = spec[FRICTION]
    at = spec[FRICTION_AT]
    lv, lv_x, lv_v = level(t, z, spec, theta, level_by_theta, row)
    if law == COULOMB:
        dz[1] = (force - mode * lv) / m
        for j in range(n):
            jac[1, j] = force_by_state[j] / m
        jac[1, 0] -= mode * lv_x / m
        jac[1, 1] -= mode * lv_v / m
        for j in range(p):
            by_theta[1, j] = (force_by_theta[j] - mode * level_by_theta[j]) / m
    elif law == BRISTLE:
        s0, s1, b = theta[at], theta[at + 1], z[2]
        lv = max(lv, _TINY)
        speed = abs(v)
        sign = 1.0 if v >= 0.0 else -1.0
        rate = v - s0 * speed * b / lv
        friction = s0 * b + s1 * rate
        rate_v = 1.0 - s0 * sign * b / lv + s0 * speed * b * lv_v / (lv * lv)
        rate_x = s0 * speed * b * lv_x / (lv * lv)
        rate_b = -s0 * speed / lv
        dz[1] = (force - friction) / m
        dz[2] = rate
        for j in range(n):
            jac[1, j] = force_by_state[j] / m
            jac[2, j] = 0.0
        jac[1, 0] -= s1 * rate_x / m
        jac[1, 1] -= s1 * rate_v / m
        jac[1, 2] -= (s0 + s1 * rate_b) / m
        jac[2, 0], jac[2, 1], jac[2, 2] = rate_x, rate_v, rate_b
        for j in range(p):
            d = s0 * speed * b * level_by_theta[j] / (lv * lv)
            by_theta[2, j] = d
            by_theta[1, j] = (force_by_theta[j] - s1 * d) / m
        by_theta[2, at] += -speed * b / lv
        by_theta[1, at] -= (b - s1 * speed * b / lv) / m
        by_theta[1, at + 1] -= rate / m
    elif law == REGULARISED:
        v_r, lead = theta[at], theta[at + 1]
        ratio = (v + lead * force / m) / v_r
        if abs(ratio) < 1.0:
            slope = lv / v_r
            dz[1] = (force - lv * ratio) / m
            for j in range(n):
                jac[1, j] = force_by_state[j] * (1.0 - slope * lead / m) / m
            jac[1, 0] -= lv_x * ratio / m
            jac[1, 1] -= (lv_v * ratio + slope) / m
            for j in range(p):
                by_theta[1, j] = (force_by_theta[j] * (1.0 - slope * lead / m) - level_by_theta[j] * ratio) / m
            by_theta[1, MASS] += slope * lead * force / (m * m * m)
            by_theta[1, at] += lv * ratio / v_r / m
            by_theta[1, at + 1] -= slope * force / (m * m)
        else:
            sign = 1.0 if ratio > 0.0 else -1.0
            dz[1] = (force - sign * lv) / m
            for j in range(n):
                jac[1, j] = force_by_state[j] / m
            jac[1, 0] -= sign * lv_x / m
            jac[1, 1] -= sign * lv_v / m
            for j in range(p):
                by_theta[1, j] = (force_by_theta[j] - sign * level_by_theta[j]) / m
    else:
        dz[1] = force / m
        for j in range(n):
            jac[1, j] = force_by_state[j] / m
        for j in range(p):
            by_theta[1, j] = force_by_theta[j] / m
    by_theta[1, MASS] -= dz[1] / m


rhs = compiled(_rhs)


def _excess(
    t: float,
    z: FloatArray,
    spec: IntArray,
    theta: FloatArray,
    u: float,
    work: FloatArray,
    rows: FloatArray,
    spare: FloatArray,
) -> tuple[float, float]:
    """Net force on a slider at rest, and its break-away level. spare (n, 1 + n + P) takes partials that are not used."""
    n, p = spec[N_STATE], theta.size
    force, _ = net_force(
        t, z, spec, theta, u, work[0, :n], work[1, :p], spare[:, 0], spare[:, 1 : 1 + n], spare[:, 1 + n :], work[3], rows
    )
    product, _, _ = modulated(t, z, spec, theta, work[2, :p], work[3])
    return force, theta[spec[BREAK_AWAY_AT]] * product


excess = compiled(_excess)


def scratch(n: int, p: int) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Scratch arrays for n states and p parameters: work, rows, spare."""
    return np.zeros((4, max(n, p, COLUMNS))), np.zeros((3, INTERNAL_COLUMNS)), np.zeros((n, 1 + n + p))
