"""The right side of the equation of motion with all its partial derivatives, in any contact mode.

Contact modes: 0 stick; +-1 sliding friction that sticks at v = 0; +-2 a law without stick (bristle, regularised);
+-3 a bristle that has reached its full deflection under a constant level, where it is sliding friction and no longer
stiff. The sign is that of the speed.
"""

from typing import Final

from harness.core.arrays import FloatArray
from harness.core.jit import lean
from harness.kernels.dispatch import bristle_law, smoothed_law
from harness.kernels.forces import break_away_at, curve, level_partials, modulated, net_force
from harness.kernels.layout import BRISTLE, FRICTION, FRICTION_AT, FRICTION_LAW, FRICTION_SIZE, N_STATE, REGULARISED
from harness.kernels.work import PLACES, ROW_BRISTLE, ROW_V, SPARE, Work, plain
from harness.model.law import (
    D_FREE,
    D_INTERNAL,
    D_LEVEL,
    D_PARAMETER,
    D_V,
    INTERNAL_COLUMNS,
    MASS,
    MAX_PARAMETERS,
    VALUE,
)

_STUCK: Final = plain(0)
STICKS: Final = plain(1)
FREE: Final = plain(2)
SATURATED: Final = plain(3)


@lean
def bristle(stage: int, t: float, z: FloatArray, side: int, product: float, by_x: float, w: Work) -> float:
    """Friction of a bristle, by its law; sets the bristle's rate and adds the partials of both."""
    ks, jac, by_theta, rows = w.ks, w.jac, w.by_theta, w.rows
    at, over_m = w.spec[FRICTION_AT], 1.0 / w.theta[MASS]
    x, v = z[0], z[1]
    f_k, slope = curve(v, w)
    level, level_x, level_v = f_k * product, f_k * by_x, slope * product
    for i in range(2):
        for j in range(D_PARAMETER + min(w.spec[FRICTION_SIZE], MAX_PARAMETERS)):
            rows[i, j] = 0.0
        for j in range(D_INTERNAL, INTERNAL_COLUMNS):
            rows[i, j] = 0.0
    # without load the bristle lets go
    if level > 0.0:
        bristle_law(w.spec[FRICTION_LAW], v, side, z[2], level, w.theta, at, rows)
    ks[stage, 2] = rows[1, VALUE]
    jac[1, 0] -= rows[0, D_LEVEL] * level_x * over_m
    jac[1, 1] -= (rows[0, D_V] + rows[0, D_LEVEL] * level_v) * over_m
    jac[1, 2] = -rows[0, D_INTERNAL] * over_m
    jac[2, 0] = rows[1, D_LEVEL] * level_x
    jac[2, 1] = rows[1, D_V] + rows[1, D_LEVEL] * level_v
    jac[2, 2] = rows[1, D_INTERNAL]
    for j in range(3, w.spec[N_STATE]):
        jac[2, j] = 0.0
    for j in range(min(w.spec[FRICTION_SIZE], MAX_PARAMETERS)):
        by_theta[1, at + j] = -rows[0, D_PARAMETER + j] * over_m
        by_theta[2, at + j] = rows[1, D_PARAMETER + j]
    level_partials(t, x, v, product, -rows[0, D_LEVEL] * over_m, ROW_V, w)
    level_partials(t, x, v, product, rows[1, D_LEVEL], ROW_BRISTLE, w)
    friction: float = rows[0, VALUE]
    return friction


@lean
def regularised(t: float, z: FloatArray, force: float, product: float, by_x: float, w: Work) -> float:
    """Friction without stick, by its law of the speed and of a0 = force/m; adds its partials."""
    jac, by_theta, row = w.jac, w.by_theta, w.row
    at, over_m = w.spec[FRICTION_AT], 1.0 / w.theta[MASS]
    x, v = z[0], z[1]
    f_k, by_v = curve(v, w)
    level_x, level_v = f_k * by_x, by_v * product
    for j in range(D_PARAMETER + min(w.spec[FRICTION_SIZE], MAX_PARAMETERS)):
        row[j] = 0.0
    smoothed_law(w.spec[FRICTION_LAW], v, force * over_m, f_k * product, w.theta, at, row)
    friction: float = row[VALUE]
    by_free, by_level = row[D_FREE], row[D_LEVEL]
    if by_free != 0.0:
        keep = 1.0 - by_free * over_m
        for j in range(w.spec[N_STATE]):
            jac[1, j] *= keep
        for j in range(w.count[PLACES]):
            by_theta[1, j] *= keep
        by_theta[1, MASS] += by_free * force * over_m * over_m * over_m
    jac[1, 0] -= by_level * level_x * over_m
    jac[1, 1] -= (by_level * level_v + row[D_V]) * over_m
    for j in range(min(w.spec[FRICTION_SIZE], MAX_PARAMETERS)):
        by_theta[1, at + j] = -row[D_PARAMETER + j] * over_m
    level_partials(t, x, v, product, -by_level * over_m, ROW_V, w)
    return friction


@lean
def rhs(stage: int, t: float, z: FloatArray, mode: int, u: float, w: Work) -> None:
    """Fill ks[stage] (n,) with dz/dt, jac (n, n) with its partials by z and by_theta (n, P) by theta.

    Row 0 of by_theta stays as it is (zero).
    """
    spec, theta, ks, jac, by_theta = w.spec, w.theta, w.ks, w.jac, w.by_theta
    n = spec[N_STATE]
    side = 1 if mode > 0 else (-1 if mode < 0 else 0)
    force, _ = net_force(stage, t, z, side, u, w)
    for j in range(n):
        jac[0, j] = 0.0
    if mode == 0:
        ks[stage, 0] = 0.0
        ks[stage, 1] = 0.0
        for j in range(n):
            jac[1, j] = 0.0
        for j in range(w.count[PLACES]):
            by_theta[1, j] = 0.0
        return
    x, v, over_m = z[0], z[1], 1.0 / theta[MASS]
    ks[stage, 0] = v
    jac[0, 1] = 1.0
    product, by_x, _ = modulated(t, x, v, w)
    if abs(mode) == FREE and spec[FRICTION] == BRISTLE:
        friction = bristle(stage, t, z, side, product, by_x, w)
    elif spec[FRICTION] == REGULARISED:
        friction = regularised(t, z, force, product, by_x, w)
    else:
        level, by_v = curve(v, w)
        friction = side * level * product
        jac[1, 0] -= side * level * by_x * over_m
        jac[1, 1] -= side * by_v * product * over_m
        level_partials(t, x, v, product, -side * over_m, ROW_V, w)
        if spec[FRICTION] == BRISTLE:
            at = spec[FRICTION_AT]
            ks[stage, 2] = 0.0
            for j in range(n):
                jac[2, j] = 0.0
            for j in range(w.count[PLACES]):
                by_theta[2, j] = 0.0
            for j in range(spec[FRICTION_SIZE]):
                by_theta[1, at + j] = 0.0
    ks[stage, 1] = (force - friction) * over_m
    by_theta[1, MASS] -= ks[stage, 1] * over_m


@lean
def excess(t: float, z: FloatArray, u: float, w: Work) -> tuple[float, float, float, float, float]:
    """Net force on a slider at rest, its partial by time, the break-away level, and that level's partials by x and t.

    Leaves in row 1 of jac and by_theta the partials of the force over m, in ks[SPARE] the rates of internal states.
    """
    force, by_t = net_force(SPARE, t, z, _STUCK, u, w)
    product, product_x, product_t = modulated(t, z[0], 0.0, w)
    f_s = w.theta[break_away_at(w)]
    return force, by_t, f_s * product, f_s * product_x, f_s * product_t
