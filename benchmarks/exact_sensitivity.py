"""Derivatives of the free decay to its parameters, in closed form.

Inside a half-cycle x is a smooth function of the parameters, of the turning point X_i it starts from and of its start
time t_i. Both follow their own recursions, so the jump of the derivatives at a reversal (the event time moves: the
saltation) comes out by itself. Columns: omega_n, zeta, x_k, x_0, v_0, t_0. The break-away level x_s decides only
whether the slider sticks: its derivative is zero and it has no column.
"""

import math

import numpy as np

from harness.core.arrays import FloatArray, read_only
from harness.core.jit import compiled
from harness.exact.decay import Decay, check_outputs, check_times
from harness.exact.segments import CENTRE, DIRECTION, POSITION, SPEED, START, discriminant, flow, half_cycles

PARAMETERS = ("omega_n", "zeta", "x_k", "x_0", "v_0", "t_0")

OMEGA_N, ZETA, X_K, X_0, V_0, T_0 = range(6)
_COUNT = 6


@compiled
def sine_slope(tau: float, sigma: float, disc: float, cos_like: float, sin_like: float) -> float:
    """dS/d(disc) at a fixed sigma, s^3: (tau C - S) / (2 disc), or its series where that cancels."""
    square = tau * tau * disc
    if abs(square) > 1.0:
        return (tau * cos_like - sin_like) / (2.0 * disc)
    total, term = 0.0, -1.0 / 6.0
    for n in range(1, 10):
        # sin(z)/z = sum (-square)^n / (2n+1)!, differentiated term by term
        total += n * term
        term *= -square / ((2 * n + 2) * (2 * n + 3))
    return math.exp(-sigma * tau) * tau * tau * tau * total


@compiled
def state_partials(
    tau: float, omega_n: float, zeta: float, y0: float, dy0: float
) -> tuple[float, float, float, float, float, float, float, float, float]:
    """The state ``tau`` after a half-cycle began at y0, y0' about its centre, and its partials to omega_n and zeta.

    Returns y, y', y_omega, y'_omega, y_zeta, y'_zeta, C, S, y''; the partials to y0 and y0' follow from C and S.
    """
    sigma = zeta * omega_n
    disc = discriminant(omega_n, zeta)
    omega2 = omega_n * omega_n
    c, s = flow(tau, omega_n, sigma, disc)
    slope = sine_slope(tau, sigma, disc, c, s)
    push, pull = dy0 + sigma * y0, omega2 * y0 + sigma * dy0
    y = y0 * c + push * s
    dy = dy0 * c - pull * s
    ddy = -2.0 * sigma * dy - omega2 * y
    # sigma_p, disc_p for p = omega_n, then zeta
    disc_w = 2.0 * omega_n * ((1.0 - zeta) * (1.0 + zeta))
    disc_z = -2.0 * zeta * omega2
    c_w, s_w = -tau * (zeta * c + 0.5 * disc_w * s), disc_w * slope - zeta * tau * s
    c_z, s_z = -tau * (omega_n * c + 0.5 * disc_z * s), disc_z * slope - omega_n * tau * s
    y_w = y0 * c_w + push * s_w + zeta * y0 * s
    y_z = y0 * c_z + push * s_z + omega_n * y0 * s
    dy_w = dy0 * c_w - pull * s_w - (2.0 * omega_n * y0 + zeta * dy0) * s
    dy_z = dy0 * c_z - pull * s_z - omega_n * dy0 * s
    return y, dy, y_w, dy_w, y_z, dy_z, c, s, ddy


@compiled
def event_partials(omega_n: float, zeta: float, x_k: float, table: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Derivatives of every row's turning point (m) and start time (s) to the first five parameters, each (rows, 5)."""
    rows = table.shape[0]
    points, times = np.zeros((rows, 5)), np.zeros((rows, 5))
    sigma, disc = zeta * omega_n, discriminant(omega_n, zeta)
    points[0, X_0] = 1.0
    if rows < 2:
        return points, times
    # the first reversal: v = 0 there moves the time by -v_p / a and leaves the point's derivative as it stands
    sign = table[0, DIRECTION]
    y0 = table[0, POSITION] - table[0, CENTRE]
    _, _, y_w, dy_w, y_z, dy_z, c, s, accel = state_partials(table[1, START], omega_n, zeta, y0, table[0, SPEED])
    swing, drop = c + sigma * s, -omega_n * omega_n * s
    points[1, OMEGA_N], points[1, ZETA] = y_w, y_z
    points[1, X_K], points[1, X_0], points[1, V_0] = -sign + sign * swing, swing, s
    if accel != 0.0:  # zero only where the overshoot is too small for a number, and then its time is of no account
        times[1, OMEGA_N], times[1, ZETA] = -dy_w / accel, -dy_z / accel
        times[1, X_K], times[1, X_0], times[1, V_0] = -sign * drop / accel, -drop / accel, -(c - sigma * s) / accel
    if rows < 3:
        return points, times
    half = math.pi / math.sqrt(disc)
    q = math.exp(-sigma * half)
    half_w, half_z = -half / omega_n, half * zeta / ((1.0 - zeta) * (1.0 + zeta))
    q_z = -q * (omega_n * half + sigma * half_z)  # q does not depend on omega_n
    for i in range(2, rows):
        y0 = table[i - 1, POSITION] - table[i - 1, CENTRE]
        for p in range(5):
            points[i, p] = -q * points[i - 1, p]
            times[i, p] = times[i - 1, p]
        points[i, ZETA] -= q_z * y0
        points[i, X_K] -= (1.0 + q) * table[i - 1, DIRECTION]
        times[i, OMEGA_N] += half_w
        times[i, ZETA] += half_z
    return points, times


@compiled
def _fill(
    omega_n: float,
    zeta: float,
    x_k: float,
    x_s: float,
    x0: float,
    v0: float,
    t: FloatArray,
    x: FloatArray,
    v: FloatArray,
    a: FloatArray,
    dx: FloatArray,
    dv: FloatArray,
    da: FloatArray,
) -> None:
    """The kernel of ``fill_sensitivities``."""
    n = t.size
    if n == 0:
        return
    sigma, omega2 = zeta * omega_n, omega_n * omega_n
    table = half_cycles(omega_n, zeta, x_k, x_s, x0, v0, t[n - 1])
    points, times = event_partials(omega_n, zeta, x_k, table)
    first = int(np.searchsorted(t, 0.0))
    for j in range(first):
        x[j], v[j], a[j] = x0, 0.0, 0.0
        for p in range(_COUNT):
            dx[j, p], dv[j, p], da[j, p] = 0.0, 0.0, 0.0
        dx[j, X_0] = 1.0
    for i in range(table.shape[0]):
        last = int(np.searchsorted(t, table[i + 1, START])) if i + 1 < table.shape[0] else n
        direction, centre, speed = table[i, DIRECTION], table[i, CENTRE], table[i, SPEED]
        y0 = table[i, POSITION] - centre
        for j in range(first, last):
            if direction == 0.0:
                x[j], v[j], a[j] = table[i, POSITION], 0.0, 0.0
                for p in range(5):
                    dx[j, p], dv[j, p], da[j, p] = points[i, p], 0.0, 0.0
                dx[j, T_0], dv[j, T_0], da[j, T_0] = 0.0, 0.0, 0.0
                continue
            y, dy, y_w, dy_w, y_z, dy_z, c, s, ddy = state_partials(t[j] - table[i, START], omega_n, zeta, y0, speed)
            jerk = -2.0 * sigma * ddy - omega2 * dy
            x[j], v[j], a[j] = centre + y, dy, ddy
            swing, drop = c + sigma * s, -omega2 * s
            for p in range(5):
                start, moved, own, own_speed, own_accel = points[i, p], times[i, p], 0.0, 0.0, 0.0
                if p == OMEGA_N:
                    own, own_speed = y_w, dy_w
                    own_accel = -2.0 * (zeta * dy + omega_n * y)
                elif p == ZETA:
                    own, own_speed = y_z, dy_z
                    own_accel = -2.0 * omega_n * dy
                elif p == X_K:  # the centre moves by -direction
                    own, start = -direction, start + direction
                elif p == V_0 and i == 0:
                    own, own_speed = s, c - sigma * s
                rate = own + start * swing
                rate_inside = rate - own if p == X_K else rate
                rate_speed = own_speed + start * drop
                rate_accel = own_accel - 2.0 * sigma * rate_speed - omega2 * rate_inside
                dx[j, p] = rate - dy * moved
                dv[j, p] = rate_speed - ddy * moved
                da[j, p] = rate_accel - jerk * moved
            dx[j, T_0], dv[j, T_0], da[j, T_0] = -dy, -ddy, -jerk
        first = last


def fill_sensitivities(
    decay: Decay,
    t: FloatArray,
    x: FloatArray,
    v: FloatArray,
    a: FloatArray,
    dx: FloatArray,
    dv: FloatArray,
    da: FloatArray,
) -> None:
    """Write x, v, a, each (n,), and their derivatives dx, dv, da, each (n, 6), at times ``t`` (n,) in s.

    Columns as in PARAMETERS, SI units; t_0 is the time of the start (here 0): its column is minus the time derivative.
    From rest the derivative to v_0 is the one along the motion. x_s has none: it decides only whether the slider
    sticks. Times do not decrease. At a time of an event the derivative is the one after it.
    """
    n = t.size
    check_outputs((n,), t, x, v, a)
    check_outputs((n, len(PARAMETERS)), dx, dv, da)
    check_times(decay, t)
    _fill(*decay.arguments, read_only(t), x, v, a, dx, dv, da)
