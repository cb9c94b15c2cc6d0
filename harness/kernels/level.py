"""The level of dry friction: the curve f_k(v) times the modulations, and the break-away level, with partials."""

from harness.core.jit import compiled
from harness.kernels.dispatch import modulation, speed_level
from harness.kernels.layout import BREAK_AWAY_AT, LEVEL, LEVEL_AT, LEVEL_SIZE, LISTS, N_MODULATION
from harness.kernels.work import Work
from harness.model.law import D_LEVEL, D_PARAMETER, D_T, D_V, D_X, KINETIC, MAX_PARAMETERS, VALUE


def _modulated(t: float, x: float, v: float, w: Work) -> tuple[float, float, float]:
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


modulated = compiled(_modulated, lean=True)


def _by_modulation(t: float, x: float, v: float, product: float, weight: float, i: int, w: Work) -> None:
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


by_modulation = compiled(_by_modulation, lean=True)


def _curve(v: float, w: Work) -> tuple[float, float]:
    """f_k(v) before modulation, and its slope; leaves both with the partials in w.level."""
    row, at = w.level, w.spec[LEVEL_AT]
    if at < 0:
        row[VALUE], row[D_V], row[D_LEVEL] = w.theta[KINETIC], 0.0, 1.0
    else:
        for j in range(D_PARAMETER + min(w.spec[LEVEL_SIZE], MAX_PARAMETERS)):
            row[j] = 0.0
        speed_level(w.spec[LEVEL], v, w.theta, at, row)
    return row[VALUE], row[D_V]


curve = compiled(_curve, lean=True)


def _level_partials(t: float, x: float, v: float, product: float, weight: float, i: int, w: Work) -> None:
    """Set by_theta[i] to weight times the partials of the friction level that ``curve`` has just been asked for."""
    row, by_theta = w.level, w.by_theta
    at = w.spec[LEVEL_AT]
    by_theta[i, KINETIC] = weight * product * row[D_LEVEL]
    if at >= 0:
        for j in range(min(w.spec[LEVEL_SIZE], MAX_PARAMETERS)):
            by_theta[i, at + j] = weight * product * row[D_PARAMETER + j]
    if w.spec[N_MODULATION] > 0:
        by_modulation(t, x, v, product, weight * row[VALUE], i, w)


level_partials = compiled(_level_partials, lean=True)


def _break_away_at(w: Work) -> int:
    """Place in theta of the break-away level: never below the friction that sets in at v = 0."""
    at, level = w.spec[BREAK_AWAY_AT], w.spec[LEVEL_AT]
    sliding = level if level >= 0 else KINETIC
    return sliding if w.theta[sliding] > w.theta[at] else at


break_away_at = compiled(_break_away_at, lean=True)
