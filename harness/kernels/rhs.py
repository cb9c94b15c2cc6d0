"""The right side of the equation of motion with all its partial derivatives, in any contact mode.

Contact modes: 0 stick; +-1 sliding friction that sticks at v = 0; +-2 a law without stick (bristle, regularised);
+-3 a bristle that has reached its full deflection under a constant level, where it is sliding friction and no longer
stiff. The sign is that of the speed.
"""

from typing import Final

from harness.core.arrays import FloatArray
from harness.core.jit import compiled
from harness.kernels.forces import net_force
from harness.kernels.layout import BRISTLE, FRICTION, FRICTION_AT, N_STATE, REGULARISED
from harness.kernels.level import break_away_at, curve, level_partials, modulated
from harness.kernels.work import PLACES, ROW_BRISTLE, ROW_V, SPARE, Work, plain
from harness.model.law import MASS

_STUCK: Final = plain(0)
STICKS: Final = plain(1)
FREE: Final = plain(2)
SATURATED: Final = plain(3)


def _bristle(stage: int, t: float, z: FloatArray, side: int, product: float, by_x: float, w: Work) -> float:
    """Friction of a bristle: z' = v - sigma0 |v| z/level, f = sigma0 z + sigma1 z'; adds its partials."""
    ks, jac, by_theta = w.ks, w.jac, w.by_theta
    at, over_m = w.spec[FRICTION_AT], 1.0 / w.theta[MASS]
    s0, s1 = w.theta[at], w.theta[at + 1]
    x, v, b = z[0], z[1], z[2]
    speed = max(side * v, 0.0)
    f_k, slope = curve(v, w)
    level, level_x, level_v = f_k * product, f_k * by_x, slope * product
    for j in range(3, w.spec[N_STATE]):
        jac[2, j] = 0.0
    if level <= 0.0:
        # without load the bristle lets go
        ks[stage, 2] = 0.0
        jac[1, 2], jac[2, 0], jac[2, 1], jac[2, 2] = 0.0, 0.0, 0.0, 0.0
        level_partials(t, x, v, product, 0.0, ROW_V, w)
        level_partials(t, x, v, product, 0.0, ROW_BRISTLE, w)
        by_theta[1, at], by_theta[1, at + 1], by_theta[2, at] = 0.0, 0.0, 0.0
        return 0.0
    pull = s0 * speed * b / level
    rate = v - pull
    rate_v = 1.0 - s0 * side * b / level + pull * level_v / level
    rate_x = pull * level_x / level
    rate_b = -s0 * speed / level
    ks[stage, 2] = rate
    jac[1, 0] -= s1 * rate_x * over_m
    jac[1, 1] -= s1 * rate_v * over_m
    jac[1, 2] = -(s0 + s1 * rate_b) * over_m
    jac[2, 0], jac[2, 1], jac[2, 2] = rate_x, rate_v, rate_b
    level_partials(t, x, v, product, -s1 * pull / level * over_m, ROW_V, w)
    level_partials(t, x, v, product, pull / level, ROW_BRISTLE, w)
    by_theta[1, at] = -(b - s1 * speed * b / level) * over_m
    by_theta[1, at + 1] = -rate * over_m
    by_theta[2, at] = -speed * b / level
    friction: float = s0 * b + s1 * rate
    return friction


bristle = compiled(_bristle, lean=True)


def _regularised(t: float, z: FloatArray, force: float, product: float, by_x: float, w: Work) -> float:
    """Friction level x sat((v + lead a0)/v_r), a0 = force/m; adds its partials."""
    jac, by_theta = w.jac, w.by_theta
    at, over_m = w.spec[FRICTION_AT], 1.0 / w.theta[MASS]
    v_r, lead = w.theta[at], w.theta[at + 1]
    x, v = z[0], z[1]
    f_k, by_v = curve(v, w)
    level: float = f_k * product
    level_x, level_v = f_k * by_x, by_v * product
    ratio = (v + lead * force * over_m) / v_r
    if abs(ratio) >= 1.0:
        sign = 1.0 if ratio > 0.0 else -1.0
        jac[1, 0] -= sign * level_x * over_m
        jac[1, 1] -= sign * level_v * over_m
        level_partials(t, x, v, product, -sign * over_m, ROW_V, w)
        by_theta[1, at] = 0.0
        by_theta[1, at + 1] = 0.0
        level *= sign
        return level
    slope = level / v_r
    keep = 1.0 - slope * lead * over_m
    for j in range(w.spec[N_STATE]):
        jac[1, j] *= keep
    for j in range(w.count[PLACES]):
        by_theta[1, j] *= keep
    jac[1, 0] -= level_x * ratio * over_m
    jac[1, 1] -= (level_v * ratio + slope) * over_m
    level_partials(t, x, v, product, -ratio * over_m, ROW_V, w)
    by_theta[1, MASS] += slope * lead * force * over_m * over_m * over_m
    by_theta[1, at] = level * ratio / v_r * over_m
    by_theta[1, at + 1] = -slope * force * over_m * over_m
    level *= ratio
    return level


regularised = compiled(_regularised, lean=True)


def _rhs(stage: int, t: float, z: FloatArray, mode: int, u: float, w: Work) -> None:
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
            by_theta[1, at], by_theta[1, at + 1] = 0.0, 0.0
    ks[stage, 1] = (force - friction) * over_m
    by_theta[1, MASS] -= ks[stage, 1] * over_m


rhs = compiled(_rhs, lean=True)


def _excess(t: float, z: FloatArray, u: float, w: Work) -> tuple[float, float, float, float, float]:
    """Net force on a slider at rest, its partial by time, the break-away level, and that level's partials by x and t.

    Leaves in row 1 of jac and by_theta the partials of the force over m, in ks[SPARE] the rates of internal states.
    """
    force, by_t = net_force(SPARE, t, z, _STUCK, u, w)
    product, product_x, product_t = modulated(t, z[0], 0.0, w)
    f_s = w.theta[break_away_at(w)]
    return force, by_t, f_s * product, f_s * product_x, f_s * product_t


excess = compiled(_excess, lean=True)
