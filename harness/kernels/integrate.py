"""The event-driven integrator: slip, stick, reversals, break-away and knocks, with sensitivities through every event.

Between events the state and its sensitivities S' = J S + F_theta are stepped together. At an event the sensitivities
jump by the saltation condition s+ = s- + (f- - f+) dt*/dp, where t* is the time of the event.
"""

import math

import numpy as np

from harness.core.arrays import FloatArray, IntArray, ModeArray
from harness.core.jit import compiled
from harness.kernels.interpolate import coefficients, interpolate, interpolate_sensitivities
from harness.kernels.layout import (
    BREAK_AWAY_AT,
    CHANGES_IN_TIME,
    COULOMB,
    FRICTION,
    LISTS,
    N_INTERNAL,
    N_KNOCK,
    N_MODULATION,
    N_SMOOTH,
    N_STATE,
)
from harness.kernels.rhs import FREE, by_modulation, excess, rhs
from harness.kernels.step import STAGES, slope, step
from harness.model.law import COLUMNS, INTERNAL_COLUMNS, MASS

DONE, TOO_MANY_STEPS, DIVERGED, TOO_MANY_EVENTS = range(4)
REVERSAL, STICK, BREAK_AWAY, KNOCK = range(4)
EVENT_COLUMNS = 5  # t, kind, x, a before, a after

_SAFETY, _SHRINK, _GROW = 0.9, 0.15, 4.0
_POLISH = 4


def _break_away_jump(
    t: float,
    z: FloatArray,
    s: FloatArray,
    sign: float,
    spec: IntArray,
    theta: FloatArray,
    columns: IntArray,
    u: float,
    u_rate: float,
    a_after: float,
    kb: FloatArray,
    jac: FloatArray,
    by_theta: FloatArray,
    row: FloatArray,
    rows: FloatArray,
    spare: FloatArray,
) -> None:
    """Saltation at break-away: g = sign F(t, z, theta) - F_s(t, x, theta) = 0 sets the time of the event."""
    n, m = spec[N_STATE], theta[MASS]
    _, by_t, limit, limit_x, limit_t = excess(t, z, spec, theta, u, kb, jac, by_theta, row, rows)
    g_t = sign * (u_rate + by_t) - limit_t
    for i in range(2, n):
        g_t += sign * m * jac[1, i] * kb[0, i]
    if g_t == 0.0:
        return
    at = spec[BREAK_AWAY_AT]
    f_s = theta[at]
    for q in range(columns.size):
        total = sign * m * by_theta[1, columns[q]] if columns[q] >= 0 else 0.0
        total += (sign * m * jac[1, 0] - limit_x) * s[0, q]
        for i in range(2, n):
            total += sign * m * jac[1, i] * s[i, q]
        if columns[q] == at and f_s > 0.0:
            total -= limit / f_s
        spare[q] = total
    # the level's own dependence on the modulations, which share no parameter with the force
    if spec[N_MODULATION] > 0:
        product = limit / f_s if f_s > 0.0 else 0.0
        by_modulation(t, z[0], 0.0, spec, theta, product, f_s, 1, by_theta, row)
        first = spec[LISTS + 1]
        for q in range(columns.size):
            for g in range(spec[N_MODULATION]):
                first = spec[LISTS + 3 * g + 1]
                if first <= columns[q] < first + spec[LISTS + 3 * g + 2]:
                    spare[q] -= by_theta[1, columns[q]]
    for q in range(columns.size):
        s[1, q] += a_after * spare[q] / g_t


break_away_jump = compiled(_break_away_jump, lean=True)


def _integrate(
    t0: float,
    z0: FloatArray,
    s0: FloatArray,
    spec: IntArray,
    theta: FloatArray,
    columns: IntArray,
    u_t: FloatArray,
    u_y: FloatArray,
    t_out: FloatArray,
    scale: FloatArray,
    h_max: float,
    max_steps: int,
    want_a: bool,
    x: FloatArray,
    v: FloatArray,
    a: FloatArray,
    mode_out: ModeArray,
    dx: FloatArray,
    dv: FloatArray,
    da: FloatArray,
    events: FloatArray,
) -> tuple[int, int, int, float]:
    """Integrate from t0 and write samples at t_out >= t0 (those before show the start).

    z0 (n,), s0 (n, q): state and sensitivities at t0. columns (q,): place in theta that each column of the sensitivities
    belongs to, -1 for an initial condition. u_t, u_y (k,): knots of a piecewise linear drive in N, empty for none.
    scale (n,): error allowed per step. x, v, a (N,), mode_out (N,), dx, dv, da (N, q), events (m, 5): filled.
    Returns status, number of events, number of steps, last time reached.
    """
    n, p, q_count, samples = spec[N_STATE], theta.size, columns.size, t_out.size
    row, rows, spare = np.zeros(COLUMNS), np.zeros((3, INTERNAL_COLUMNS)), np.zeros(q_count)
    kb = np.zeros((1, n))
    jac, by_theta = np.zeros((n, n)), np.zeros((n, p))
    ks, kss = np.zeros((STAGES, n)), np.zeros((STAGES, n, q_count))
    z, s = z0.copy(), s0.copy()
    z1, s1, zi, si = np.zeros(n), np.zeros((n, q_count)), np.zeros(n), np.zeros((n, q_count))
    ki, kis = np.zeros((1, n)), np.zeros((1, n, q_count))
    cz = np.zeros((n, 6))
    knock_at = LISTS + 3 * (spec[N_MODULATION] + spec[N_SMOOTH]) + 5 * spec[N_INTERNAL]
    knock, knocks = 0, spec[N_KNOCK]
    coulomb = spec[FRICTION] == COULOMB
    driven = u_t.size > 0
    rests = not driven and spec[CHANGES_IN_TIME] == 0

    t, t_end = t0, t_out[samples - 1]
    knot = 0
    u0, u_rate = 0.0, 0.0
    i_out, n_events, n_steps = 0, 0, 0
    while i_out < samples and t_out[i_out] < t0:
        x[i_out], v[i_out], a[i_out], mode_out[i_out] = z[0], 0.0, 0.0, 0
        for q in range(q_count):
            dx[i_out, q], dv[i_out, q], da[i_out, q] = s[0, q], 0.0, 0.0
        i_out += 1
    while knock < knocks and theta[spec[knock_at + knock]] < t0:
        knock += 1

    # mode at the start, with the drive's value there
    if driven:
        while knot + 2 < u_t.size and u_t[knot + 1] <= t:
            knot += 1
        u_rate = (u_y[knot + 1] - u_y[knot]) / (u_t[knot + 1] - u_t[knot])
        u0 = u_y[knot] + u_rate * (t - u_t[knot])
    mode = FREE
    if coulomb:
        if z[1] != 0.0:
            mode = 1 if z[1] > 0.0 else -1
        else:
            force, _, limit, _, _ = excess(t, z, spec, theta, u0, kb, jac, by_theta, row, rows)
            mode = 0 if abs(force) <= limit else (1 if force > 0.0 else -1)

    h = 0.1 * h_max
    fresh = True
    while i_out < samples:
        if n_steps >= max_steps:
            return TOO_MANY_STEPS, n_events, n_steps, t
        # where this step must end at the latest
        stop, at_knock = t_end, False
        if driven:
            while knot + 2 < u_t.size and u_t[knot + 1] <= t:
                knot += 1
            u_rate = (u_y[knot + 1] - u_y[knot]) / (u_t[knot + 1] - u_t[knot])
            u0 = u_y[knot] + u_rate * (t - u_t[knot])
            if t < u_t[knot + 1] < stop:
                stop = u_t[knot + 1]
        if knock < knocks and theta[spec[knock_at + knock]] <= stop:
            stop, at_knock = theta[spec[knock_at + knock]], True
        if mode == 0 and rests and knock >= knocks:
            # nothing can move it any more
            while i_out < samples:
                x[i_out], v[i_out], a[i_out], mode_out[i_out] = z[0], 0.0, 0.0, 0
                for q in range(q_count):
                    dx[i_out, q], dv[i_out, q], da[i_out, q] = s[0, q], 0.0, 0.0
                i_out += 1
            break
        if fresh:
            slope(0, t, z, s, mode, spec, theta, columns, u0, ks, kss, jac, by_theta, row, rows)
            fresh = False
        remaining = stop - t
        if remaining > 0.0:
            h = min(h, h_max)
            step_h = remaining if h >= 0.999999 * remaining else (0.5 * remaining if h > 0.6 * remaining else h)
            error = step(
                t,
                step_h,
                z,
                s,
                mode,
                spec,
                theta,
                columns,
                u0,
                u_rate,
                scale,
                z1,
                s1,
                ks,
                kss,
                jac,
                by_theta,
                row,
                rows,
            )
            n_steps += 1
            if not math.isfinite(error) or not math.isfinite(z1[1]):
                h = 0.1 * step_h
                if h < 1e-14 * h_max:
                    return DIVERGED, n_events, n_steps, t
                continue
            if error > 1.0:
                h = step_h * max(_SHRINK, _SAFETY * error**-0.2)
                if h < 1e-14 * h_max:
                    return DIVERGED, n_events, n_steps, t
                continue
            grown = step_h * min(_GROW, _SAFETY * max(error, 1e-10) ** -0.2)
            # a last piece cut short by a stop says nothing about the step that suits
            h = max(h, grown) if step_h == remaining else grown
            end = stop if step_h == remaining else t + step_h
        else:
            step_h, end = 0.0, t
        kind = -1
        if step_h > 0.0:
            coefficients(step_h, z, z1, ks, n, cz)
            crossed = (mode == 1 and z1[1] < 0.0) or (mode == -1 and z1[1] > 0.0)
            crossed_free = mode == FREE and z[1] * z1[1] < 0.0
            if crossed or crossed_free:
                # bracket the root of the interpolated speed, then polish with real steps
                sign = 1.0 if mode == 1 or (crossed_free and z[1] > 0.0) else -1.0
                low, high = 0.5, 1.0
                for _ in range(60):
                    interpolate(low, step_h, cz, n, zi)
                    if zi[1] * sign > 0.0:
                        break
                    high = low
                    low *= 0.5
                for _ in range(60):
                    middle = 0.5 * (low + high)
                    interpolate(middle, step_h, cz, n, zi)
                    if zi[1] * sign > 0.0:
                        low = middle
                    else:
                        high = middle
                    if high - low < 1e-9:
                        break
                trial = 0.5 * (low + high) * step_h
                for _ in range(_POLISH):
                    step(
                        t, trial, z, s, mode, spec, theta, columns, u0, u_rate, scale, z1, s1, ks, kss, jac, by_theta, row, rows,
                    )  # fmt: skip
                    slowing = ks[STAGES - 1, 1]
                    if slowing == 0.0:
                        break
                    change = -z1[1] / slowing
                    if abs(change) <= 1e-15 * step_h or not 0.0 < trial + change <= step_h:
                        break
                    trial += change
                step_h, end = trial, t + trial
                z1[1] = 0.0
                kind = REVERSAL
                at_knock = False
                coefficients(step_h, z, z1, ks, n, cz)
            elif mode == 0:
                force, _, limit, _, _ = excess(end, z1, spec, theta, u0 + u_rate * step_h, kb, jac, by_theta, row, rows)
                if abs(force) > limit:
                    low, high = 0.0, step_h
                    for _ in range(100):
                        middle = 0.5 * (low + high)
                        interpolate(middle / step_h, step_h, cz, n, zi)
                        force, _, limit, _, _ = excess(
                            t + middle, zi, spec, theta, u0 + u_rate * middle, kb, jac, by_theta, row, rows
                        )
                        if abs(force) > limit:
                            high = middle
                        else:
                            low = middle
                        if high - low <= 1e-15 * step_h:
                            break
                    if high < step_h:
                        step(
                            t, high, z, s, mode, spec, theta, columns, u0, u_rate, scale, z1, s1, ks, kss, jac, by_theta, row, rows,
                        )  # fmt: skip
                        step_h, end = high, t + high
                        coefficients(step_h, z, z1, ks, n, cz)
                    kind = BREAK_AWAY
                    at_knock = False
            # samples within the step
            while i_out < samples and t_out[i_out] <= end:
                ti = t_out[i_out]
                share = (ti - t) / step_h
                interpolate(share, step_h, cz, n, zi)
                x[i_out], v[i_out] = zi[0], zi[1]
                mode_out[i_out] = mode if mode != FREE else (1 if zi[1] > 0.0 else (-1 if zi[1] < 0.0 else 0))
                if q_count > 0:
                    interpolate_sensitivities(share, step_h, s, s1, kss, n, si)
                    for q in range(q_count):
                        dx[i_out, q], dv[i_out, q] = si[0, q], si[1, q]
                if want_a:
                    slope(
                        0, ti, zi, si, mode, spec, theta, columns, u0 + u_rate * (ti - t), ki, kis, jac, by_theta, row, rows,
                    )  # fmt: skip
                    a[i_out] = ki[0, 1]
                    for q in range(q_count):
                        da[i_out, q] = kis[0, 1, q]
                i_out += 1
            u_end = u0 + u_rate * step_h
            t = end
            for i in range(n):
                z[i] = z1[i]
                ks[0, i] = ks[STAGES - 1, i]
                for q in range(q_count):
                    s[i, q] = s1[i, q]
                    kss[0, i, q] = kss[STAGES - 1, i, q]
        else:
            u_end = u0
        if kind == REVERSAL:
            a_before = ks[0, 1]
            a_after = a_before
            if mode != FREE:
                force, _, limit, _, _ = excess(t, z, spec, theta, u_end, kb, jac, by_theta, row, rows)
                mode = 0 if abs(force) <= limit else (1 if force > 0.0 else -1)
                rhs(0, t, z, mode, spec, theta, u_end, kb, jac, by_theta, row, rows)
                a_after = kb[0, 1]
                if a_before != 0.0:
                    for q in range(q_count):
                        s[1, q] *= a_after / a_before
                if mode == 0:
                    kind = STICK
                fresh = True
            if n_events >= events.shape[0]:
                return TOO_MANY_EVENTS, n_events, n_steps, t
            events[n_events, 0], events[n_events, 1], events[n_events, 2] = t, kind, z[0]
            events[n_events, 3], events[n_events, 4] = a_before, a_after
            n_events += 1
        elif kind == BREAK_AWAY:
            force, _, _, _, _ = excess(t, z, spec, theta, u_end, kb, jac, by_theta, row, rows)
            mode = 1 if force > 0.0 else -1
            rhs(0, t, z, mode, spec, theta, u_end, kb, jac, by_theta, row, rows)
            a_after = kb[0, 1]
            if q_count > 0:
                break_away_jump(
                    t,
                    z,
                    s,
                    float(mode),
                    spec,
                    theta,
                    columns,
                    u_end,
                    u_rate,
                    a_after,
                    kb,
                    jac,
                    by_theta,
                    row,
                    rows,
                    spare,
                )
            if n_events >= events.shape[0]:
                return TOO_MANY_EVENTS, n_events, n_steps, t
            events[n_events, 0], events[n_events, 1], events[n_events, 2] = t, kind, z[0]
            events[n_events, 3], events[n_events, 4] = 0.0, a_after
            n_events += 1
            h = 0.1 * h_max
            fresh = True
        if at_knock and t == stop:
            o = spec[knock_at + knock]
            knock += 1
            jump = theta[o + 1] / theta[MASS]
            a_before, v_before = ks[0, 1], z[1]
            z[1] += jump
            if mode != FREE and jump != 0.0:
                if z[1] != 0.0:
                    mode = 1 if z[1] > 0.0 else -1
            slope(0, t, z, s, mode, spec, theta, columns, u_end, ks, kss, jac, by_theta, row, rows)
            for q in range(q_count):
                if columns[q] == o:
                    s[0, q] += v_before - z[1]
                    s[1, q] += a_before - ks[0, 1]
                elif columns[q] == o + 1:
                    s[1, q] += 1.0 / theta[MASS]
                elif columns[q] == MASS:
                    s[1, q] -= jump / theta[MASS]
            if jump != 0.0:
                if n_events >= events.shape[0]:
                    return TOO_MANY_EVENTS, n_events, n_steps, t
                events[n_events, 0], events[n_events, 1], events[n_events, 2] = t, KNOCK, z[0]
                events[n_events, 3], events[n_events, 4] = a_before, ks[0, 1]
                n_events += 1
            h = min(h, 0.25 * h_max)
            fresh = True
    return DONE, n_events, n_steps, t


integrate = compiled(_integrate)
