"""What happens at an event: where it lies in a step, and how the sensitivities jump there.

At an event the sensitivities jump by the saltation condition s+ = s- + (f- - f+) dt*/dp, where t* is its time.

Interpolation inside a step: quintic Hermite in x (from x, v, a at both ends), cubic in internal states.

The speed is the derivative of the quintic, so that x and v belong together; order 6 in x, 5 in v, 4 in internal states.
"""

from harness.core.jit import lean
from harness.kernels.forces import break_away_at, by_modulation
from harness.kernels.layout import N_MODULATION, N_STATE
from harness.kernels.rhs import excess, rhs
from harness.kernels.step import advance, step
from harness.kernels.work import ACROSS, PLACES, ROW_V, SPARE, STAGES, Work
from harness.model.law import MASS


@lean
def coefficients(h: float, n: int, w: Work) -> None:
    """Fill w.cz (n, 6), powers of tau/h, from the ends and the slopes there of a step h."""
    z, z1, ks, c = w.z, w.z1, w.ks, w.cz
    last = STAGES - 1
    p1, p2 = h * z[1], 0.5 * h * h * ks[0, 1]
    d = z1[0] - z[0] - p1 - p2
    e = h * z1[1] - p1 - 2.0 * p2
    f = h * h * ks[last, 1] - 2.0 * p2
    c[0, 0], c[0, 1], c[0, 2] = z[0], p1, p2
    c[0, 3] = 10.0 * d - 4.0 * e + 0.5 * f
    c[0, 4] = -15.0 * d + 7.0 * e - f
    c[0, 5] = 6.0 * d - 3.0 * e + 0.5 * f
    for i in range(2, n):
        k0, k1 = h * ks[0, i], h * ks[last, i]
        d = z1[i] - z[i]
        c[i, 0], c[i, 1] = z[i], k0
        c[i, 2] = 3.0 * d - 2.0 * k0 - k1
        c[i, 3] = k0 + k1 - 2.0 * d


@lean
def interpolate(r: float, h: float, n: int, w: Work) -> None:
    """Fill w.zi (n,) at the share r (0 to 1) of a step h."""
    c, z = w.cz, w.zi
    z[0] = c[0, 0] + r * (c[0, 1] + r * (c[0, 2] + r * (c[0, 3] + r * (c[0, 4] + r * c[0, 5]))))
    z[1] = (c[0, 1] + r * (2.0 * c[0, 2] + r * (3.0 * c[0, 3] + r * (4.0 * c[0, 4] + r * 5.0 * c[0, 5])))) / h
    for i in range(2, n):
        z[i] = c[i, 0] + r * (c[i, 1] + r * (c[i, 2] + r * c[i, 3]))


@lean
def interpolate_sensitivities(r: float, h: float, n: int, w: Work) -> None:
    """Fill w.si (n, q) at the share r of a step h with the same polynomials in Hermite form."""
    s, s1, kss, out = w.s, w.s1, w.kss, w.si
    last = STAGES - 1
    r2 = r * r
    r3, g = r2 * r, 1.0 - r
    # weights of (value, slope, curvature) at either end, and their derivatives by r
    b0 = 1.0 - r3 * (10.0 - 15.0 * r + 6.0 * r2)
    b1 = r - r3 * (6.0 - 8.0 * r + 3.0 * r2)
    b2 = 0.5 * r2 * g * g * g
    b4 = -r3 * (4.0 - 7.0 * r + 3.0 * r2)
    b5 = 0.5 * r3 * g * g
    d0 = -30.0 * r2 * g * g
    d1 = 1.0 - r2 * (18.0 - 32.0 * r + 15.0 * r2)
    d2 = 0.5 * r * g * g * (2.0 - 5.0 * r)
    d4 = -r2 * (12.0 - 28.0 * r + 15.0 * r2)
    d5 = 0.5 * r2 * g * (3.0 - 5.0 * r)
    h2 = h * h
    for q in range(w.count[ACROSS]):
        p, p1, v, v1 = s[0, q], s1[0, q], h * s[1, q], h * s1[1, q]
        g0, g1 = h2 * kss[0, 1, q], h2 * kss[last, 1, q]
        out[0, q] = p1 + b0 * (p - p1) + b1 * v + b4 * v1 + b2 * g0 + b5 * g1
        out[1, q] = (d0 * (p - p1) + d1 * v + d4 * v1 + d2 * g0 + d5 * g1) / h
    for i in range(2, n):
        for q in range(w.count[ACROSS]):
            k0, k1, d = h * kss[0, i, q], h * kss[last, i, q], s1[i, q] - s[i, q]
            out[i, q] = s[i, q] + r * (k0 + r * (3.0 * d - 2.0 * k0 - k1 + r * (k0 + k1 - 2.0 * d)))


_POLISH = 4
_LAST_CHANGE = 1e-8
"""Of a step: what Newton's method still misses after so small a change is its square."""
_HALVINGS = 60


@lean
def turning_share(h: float, side: int, n: int, w: Work) -> float:
    """Share of a step of h at which the interpolated speed, which has the sign ``side`` before, reaches 0; 2 for never.

    A speed that dips through 0 and comes back within the step is found by the least speed inside.
    """
    high = 1.0
    if w.z1[1] * side >= 0.0:
        # from rest it may begin with a rounding error against its direction
        if w.z[1] == 0.0 or not (w.ks[0, 1] * side < 0.0 < w.ks[STAGES - 1, 1] * side):
            return 2.0
        c, low = w.cz, 0.0
        for _ in range(40):
            high = 0.5 * (low + high)
            bend = 2.0 * c[0, 2] + high * (6.0 * c[0, 3] + high * (12.0 * c[0, 4] + high * 20.0 * c[0, 5]))
            if bend * side < 0.0:
                low = high
            else:
                break
        for _ in range(40):
            middle = 0.5 * (low + high)
            bend = 2.0 * c[0, 2] + middle * (6.0 * c[0, 3] + middle * (12.0 * c[0, 4] + middle * 20.0 * c[0, 5]))
            if bend * side < 0.0:
                low = middle
            else:
                high = middle
        interpolate(high, h, n, w)
        if w.zi[1] * side >= 0.0:
            return 2.0
    # a step that begins at rest has a root there too: begin where it moves
    low = 0.5 * high
    for _ in range(_HALVINGS):
        interpolate(low, h, n, w)
        if w.zi[1] * side > 0.0:
            break
        high = low
        low *= 0.5
    for _ in range(_HALVINGS):
        middle = 0.5 * (low + high)
        interpolate(middle, h, n, w)
        if w.zi[1] * side > 0.0:
            low = middle
        else:
            high = middle
        if high - low < 1e-9:
            break
    return 0.5 * (low + high)


@lean
def to_reversal(t: float, trial: float, h: float, mode: int, u0: float, u_rate: float, w: Work) -> float:
    """Step to the reversal near ``trial`` within a step of h, by Newton's method on real steps; returns its length."""
    for _ in range(_POLISH):
        advance(t, trial, mode, u0, u_rate, w)
        slowing = w.ks[STAGES - 1, 1]
        if slowing == 0.0:
            break
        change = -w.z1[1] / slowing
        if not 0.0 < trial + change <= h:
            break
        trial += change
        if abs(change) <= _LAST_CHANGE * h:
            break
    step(t, trial, mode, u0, u_rate, w)
    w.z1[1] = 0.0
    return trial


@lean
def exceeded(t: float, r: float, h: float, u0: float, u_rate: float, w: Work) -> bool:
    """Whether the force on a slider at rest exceeds the break-away level at the share r of a step."""
    interpolate(r, h, w.spec[N_STATE], w)
    force, _, limit, _, _ = excess(t + r * h, w.zi, u0 + u_rate * r * h, w)
    return abs(force) > limit


@lean
def break_away_share(t: float, h: float, u0: float, u_rate: float, w: Work) -> float:
    """Share of a step of h in stick after which the break-away level is exceeded; 2 for never."""
    looks = 2
    for i in range(1, looks + 1):
        high = i / looks
        if exceeded(t, high, h, u0, u_rate, w):
            low = (i - 1) / looks
            for _ in range(_HALVINGS):
                middle = 0.5 * (low + high)
                if exceeded(t, middle, h, u0, u_rate, w):
                    high = middle
                else:
                    low = middle
                if high - low <= 1e-15:
                    break
            return high
    return 2.0


@lean
def break_away_jump(t: float, side: int, u: float, u_rate: float, a_after: float, w: Work) -> None:
    """Saltation at break-away: g = side F(t, z, theta) - F_s(t, x, theta) = 0 sets the time of the event."""
    spec, columns, jac, by_theta, s = w.spec, w.columns, w.jac, w.by_theta, w.s
    n, m = spec[N_STATE], w.theta[MASS]
    for j in range(w.count[PLACES]):
        by_theta[1, j] = 0.0
    _, by_t, limit, limit_x, limit_t = excess(t, w.z, u, w)
    g_t = side * (u_rate + by_t) - limit_t
    for i in range(2, n):
        g_t += side * m * jac[1, i] * w.ks[SPARE, i]
    if g_t == 0.0:
        return
    # the level shares no parameter with the force: its partials go, scaled alike, into places that are still 0
    at = break_away_at(w)
    f_s = w.theta[at]
    product = limit / f_s if f_s > 0.0 else 0.0
    by_theta[1, at] = -side * product / m
    if spec[N_MODULATION] > 0:
        by_modulation(t, w.z[0], 0.0, product, -side * f_s / m, ROW_V, w)
    for q in range(w.count[ACROSS]):
        total = side * m * by_theta[1, columns[q]] if columns[q] >= 0 else 0.0
        total += (side * m * jac[1, 0] - limit_x) * s[0, q]
        for i in range(2, n):
            total += side * m * jac[1, i] * s[i, q]
        s[1, q] += a_after * total / g_t
    # nothing else writes the place of a break-away level
    by_theta[1, at] = 0.0


@lean
def knock_jump(t: float, mode: int, u: float, o: int, v_jump: float, w: Work) -> None:
    """Saltation at a knock whose time and impulse stand at theta[o].

    ks[0] holds the slopes before it, z the state after; leaves the slopes after it in ks[SPARE]. Its time is a
    parameter of its own and moves with nothing else.
    """
    n, m, s, columns = w.spec[N_STATE], w.theta[MASS], w.s, w.columns
    rhs(SPARE, t, w.z, mode, u, w)
    for q in range(w.count[ACROSS]):
        if columns[q] == o:
            s[0, q] -= v_jump
            for i in range(1, n):
                s[i, q] += w.ks[0, i] - w.ks[SPARE, i]
        elif columns[q] == o + 1:
            s[1, q] += 1.0 / m
        elif columns[q] == MASS:
            s[1, q] -= v_jump / m
