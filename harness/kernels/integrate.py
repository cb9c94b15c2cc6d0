"""The event-driven integrator: slip, stick, reversals, break-away and knocks, with sensitivities through every event.

Between events the state and its sensitivities S' = J S + F_theta are stepped together; harness.kernels.events says
how they jump at one.
"""

import math

from harness.core.arrays import FloatArray, ModeArray
from harness.core.jit import lean
from harness.kernels.events import (
    break_away_jump,
    break_away_share,
    coefficients,
    interpolate,
    interpolate_sensitivities,
    knock_jump,
    to_reversal,
    turning_share,
)
from harness.kernels.layout import (
    BRISTLE,
    CHANGES_IN_TIME,
    COULOMB,
    FRICTION,
    FRICTION_AT,
    LEVEL_AT,
    LISTS,
    N_INTERNAL,
    N_KNOCK,
    N_MODULATION,
    N_SMOOTH,
    N_STATE,
)
from harness.kernels.rhs import FREE, SATURATED, STICKS, excess, rhs
from harness.kernels.step import slope, step
from harness.kernels.work import ACROSS, FIRST, SPARE, STAGES, Work
from harness.model.law import KINETIC, MASS

DONE, TOO_MANY_STEPS, DIVERGED, TOO_MANY_EVENTS = range(4)
REVERSAL, STICK, BREAK_AWAY, KNOCK = range(4)
EVENT_COLUMNS = 5  # t, kind, x, a before, a after

_SAFETY, _SHRINK, _GROW = 0.9, 0.15, 4.0
_SHORTEST = 1e-14  # of the longest step
_SATURATION = 1e-13


@lean
def mode_at_rest(t: float, u: float, w: Work) -> int:
    """Contact mode of a slider with v = 0: which way it will move, or stick."""
    force, _, limit, _, _ = excess(t, w.z, u, w)
    if w.spec[FRICTION] == COULOMB:
        return 0 if abs(force) <= limit else (STICKS if force > 0.0 else -STICKS)
    rhs(SPARE, t, w.z, FREE, u, w)
    return -FREE if w.ks[SPARE, 1] < 0.0 else FREE


@lean
def mode_moving(v: float, w: Work) -> int:
    """Contact mode of a slider with v other than 0."""
    kind = STICKS if w.spec[FRICTION] == COULOMB else FREE
    return kind if v > 0.0 else -kind


@lean
def saturates(mode: int, w: Work) -> bool:
    """Whether a bristle under a constant level has reached its full deflection; then it is put there exactly."""
    spec, theta = w.spec, w.theta
    if abs(mode) != FREE or spec[FRICTION] != BRISTLE or spec[LEVEL_AT] >= 0 or spec[N_MODULATION] > 0:
        return False
    at = spec[FRICTION_AT]
    full = theta[KINETIC] / theta[at]
    if full <= 0.0:
        return False
    side = 1.0 if mode > 0 else -1.0
    if abs(side * w.z[2] - full) > max(_SATURATION * full, 3.0 * w.scale[2]):
        return False
    w.z[2] = side * full
    for q in range(w.count[ACROSS]):
        place = w.columns[q]
        by_f_k = side / theta[at] if place == KINETIC else 0.0
        w.s[2, q] = -side * full / theta[at] if place == at else by_f_k
    return True


@lean
def integrate(
    t0: float,
    w: Work,
    u_t: FloatArray,
    u_y: FloatArray,
    held: bool,
    t_out: FloatArray,
    h_stick: float,
    at_once: int,
    pace: float,
    most: int,
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
    """Integrate from t0 and write samples at t_out (those before t0 show the start); at an event, what holds after it.

    w: model, state and sensitivities at t0. u_t, u_y (k,): knots of a drive in N, linear between them or held from each
    to the next, constant outside, empty for none. h_stick: longest step while it sticks, s. at_once, pace: at no time
    more steps than at_once + pace (1/s) times what is simulated, so that a place that cannot be passed costs little,
    and never more than most. x, v, a (N,), mode_out (N,), dx, dv, da (N, q), events (m, 5): filled. Returns status,
    number of events, number of steps, last time reached.
    """
    spec, theta = w.spec, w.theta
    n, q_count, samples, knots = spec[N_STATE], w.count[ACROSS], t_out.size, u_t.size
    z, s, ks, h_max = w.z, w.s, w.ks, w.h_max
    knock_at = LISTS + 3 * (spec[N_MODULATION] + spec[N_SMOOTH]) + 5 * spec[N_INTERNAL]
    knock, knocks = 0, spec[N_KNOCK]
    rests = knots == 0 and spec[CHANGES_IN_TIME] == 0

    t, t_end = t0, t_out[samples - 1]
    i_out, n_events, n_steps = 0, 0, 0
    while i_out < samples and t_out[i_out] < t0:
        x[i_out], v[i_out], a[i_out], mode_out[i_out] = z[0], 0.0, 0.0, 0
        for q in range(q_count):
            dx[i_out, q], dv[i_out, q], da[i_out, q] = s[0, q], 0.0, 0.0
        i_out += 1
    while knock < knocks and theta[spec[knock_at + knock]] < t0:
        knock += 1

    knot = -1
    h = 0.1 * h_max
    mode = 0
    fresh, starts = True, True
    while i_out < samples:
        if n_steps >= min(at_once + pace * (t - t0), most):
            return TOO_MANY_STEPS, n_events, n_steps, t
        # the drive here, and where this step must end at the latest
        stop = t_end
        u0, u_rate = 0.0, 0.0
        if knots > 0:
            before = knot
            while knot + 1 < knots and u_t[knot + 1] <= t:
                knot += 1
            u0 = u_y[max(knot, 0)]
            if held and knot != before and before >= 0:
                # a step of the force: the slopes are others, and at rest it may move, or move the other way
                fresh = True
                if z[1] == 0.0:
                    rested = mode == 0
                    mode = mode_at_rest(t, u0, w)
                    if rested and mode != 0:
                        rhs(SPARE, t, z, mode, u0, w)
                        if n_events >= events.shape[0]:
                            return TOO_MANY_EVENTS, n_events, n_steps, t
                        events[n_events, 0], events[n_events, 1], events[n_events, 2] = t, BREAK_AWAY, z[0]
                        events[n_events, 3], events[n_events, 4] = 0.0, ks[SPARE, 1]
                        n_events += 1
                        h = 0.1 * h_max
            if not held and 0 <= knot < knots - 1:
                u_rate = (u_y[knot + 1] - u0) / (u_t[knot + 1] - u_t[knot])
                u0 += u_rate * (t - u_t[knot])
            if knot + 1 < knots and u_t[knot + 1] < stop:
                stop = u_t[knot + 1]
        at_knock = knock < knocks and theta[spec[knock_at + knock]] <= stop
        if at_knock:
            stop = theta[spec[knock_at + knock]]
        if starts:
            mode = mode_moving(z[1], w) if z[1] != 0.0 else mode_at_rest(t, u0, w)
            starts = False
            if mode == 0:
                # friction takes up whatever small speed it starts with
                for q in range(q_count):
                    s[1, q] = 0.0
        if fresh:
            slope(FIRST, t, z, s, mode, u0, w)
            for q in range(q_count):
                for i in range(n):
                    size = max(abs(s[i, q]), h_max * abs(w.kss[0, i, q])) / w.scale[i]
                    w.size_s[q] = max(w.size_s[q], size)
            fresh = False
        if (mode == 0 and rests and knock >= knocks) or (t >= t_end and not at_knock):
            # nothing can move it any more, or this is the last sample
            while i_out < samples:
                x[i_out], v[i_out], a[i_out] = z[0], z[1], ks[0, 1]
                mode_out[i_out] = 0 if mode == 0 or (z[1] == 0.0 and abs(mode) != STICKS) else (1 if mode > 0 else -1)
                for q in range(q_count):
                    dx[i_out, q], dv[i_out, q], da[i_out, q] = s[0, q], s[1, q], w.kss[0, 1, q]
                i_out += 1
            break
        remaining = stop - t
        kind = -1
        step_h, end = 0.0, t
        if remaining > 0.0:
            h = min(h, h_max if mode != 0 else h_stick)
            step_h = remaining if h >= 0.999999 * remaining else (0.5 * remaining if h > 0.6 * remaining else h)
            error = step(t, step_h, mode, u0, u_rate, w)
            n_steps += 1
            if not (error <= 1.0 and math.isfinite(w.z1[1])):
                shrink = _SAFETY * error**-0.2 if math.isfinite(error) else 0.0
                h = step_h * max(_SHRINK, shrink)
                if h < _SHORTEST * h_max:
                    return DIVERGED, n_events, n_steps, t
                continue
            grown = step_h * min(_GROW, _SAFETY * max(error, 1e-10) ** -0.2)
            # a last piece cut short by a stop says nothing about the step that suits
            h = max(h, grown) if step_h == remaining else grown
            end = stop if step_h == remaining else t + step_h
            coefficients(step_h, n, w)
            if mode != 0:
                share = turning_share(step_h, 1 if mode > 0 else -1, n, w)
                if share <= 1.0:
                    step_h = to_reversal(t, share * step_h, step_h, mode, u0, u_rate, w)
                    kind, end, at_knock = REVERSAL, t + step_h, False
                    coefficients(step_h, n, w)
            else:
                share = break_away_share(t, step_h, u0, u_rate, w)
                if share <= 1.0:
                    if share < 1.0:
                        step_h *= share
                        step(t, step_h, mode, u0, u_rate, w)
                        end, at_knock = t + step_h, False
                        coefficients(step_h, n, w)
                    kind = BREAK_AWAY
            while i_out < samples and t_out[i_out] < end:
                tau = t_out[i_out] - t
                interpolate(tau / step_h, step_h, n, w)
                x[i_out], v[i_out] = w.zi[0], w.zi[1]
                mode_out[i_out] = mode if abs(mode) <= STICKS else (1 if v[i_out] > 0.0 else -1)
                if q_count > 0:
                    interpolate_sensitivities(tau / step_h, step_h, n, w)
                    for q in range(q_count):
                        dx[i_out, q], dv[i_out, q] = w.si[0, q], w.si[1, q]
                if want_a:
                    slope(SPARE, t_out[i_out], w.zi, w.si, mode, u0 + u_rate * tau, w)
                    a[i_out] = ks[SPARE, 1]
                    for q in range(q_count):
                        da[i_out, q] = w.kss[SPARE, 1, q]
                i_out += 1
            t = end
            for i in range(n):
                z[i] = w.z1[i]
                ks[0, i] = ks[STAGES - 1, i]
                for q in range(q_count):
                    s[i, q] = w.s1[i, q]
                    w.kss[0, i, q] = w.kss[STAGES - 1, i, q]
                    w.size_s[q] = max(w.size_s[q], abs(s[i, q]) / w.scale[i])
            if saturates(mode, w):
                mode = SATURATED if mode > 0 else -SATURATED
                fresh = True
        u_end = u0 + u_rate * step_h
        a_before = ks[0, 1]
        if kind == REVERSAL:
            sticks = abs(mode) == STICKS
            if sticks:
                mode = mode_at_rest(t, u_end, w)
                kind = STICK if mode == 0 else REVERSAL
            else:
                mode = -FREE if mode > 0 else FREE
            rhs(SPARE, t, z, mode, u_end, w)
            if sticks and a_before != 0.0:
                for q in range(q_count):
                    s[1, q] *= ks[SPARE, 1] / a_before
            fresh = True
        elif kind == BREAK_AWAY:
            force, _, _, _, _ = excess(t, z, u_end, w)
            mode = STICKS if force > 0.0 else -STICKS
            rhs(SPARE, t, z, mode, u_end, w)
            break_away_jump(t, mode, u_end, u_rate, ks[SPARE, 1], w)
            a_before = 0.0
            rhs(SPARE, t, z, mode, u_end, w)
            h = 0.1 * h_max
            fresh = True
        elif at_knock and t >= stop:
            o = spec[knock_at + knock]
            knock += 1
            jump = theta[o + 1] / theta[MASS]
            z[1] += jump
            mode = mode_moving(z[1], w) if z[1] != 0.0 else mode_at_rest(t, u_end, w)
            knock_jump(t, mode, u_end, o, jump, w)
            kind = KNOCK if jump != 0.0 else -1
            h = min(h, 0.25 * h_max)
            fresh = True
        if kind >= 0:
            if n_events >= events.shape[0]:
                return TOO_MANY_EVENTS, n_events, n_steps, t
            events[n_events, 0], events[n_events, 1], events[n_events, 2] = t, kind, z[0]
            events[n_events, 3], events[n_events, 4] = a_before, ks[SPARE, 1]
            n_events += 1
    return DONE, n_events, n_steps, t
