"""Samples of the free decay, written into arrays the caller owns.

On a uniform grid the motion is advanced by a table of C and S at multiples of dt, which the compiler turns into vector
instructions; every block starts again from the closed form, so errors do not accumulate.

Samples of the free decay at arbitrary times, written into arrays the caller owns.

Where there are many samples, C and S come from a table on a fine grid and a short Taylor step from its nearest point,
arithmetic alone, which the compiler turns into vector instructions; elsewhere they come from the closed form.
"""

import math

import numpy as np

from harness.core.arrays import FloatArray, IntArray
from harness.core.jit import compiled, fast
from harness.exact.segments import CENTRE, DIRECTION, POSITION, SPEED, START, discriminant, flow, half_cycles

_LONGEST_BLOCK = 512
_SHORTEST_BLOCK = 16


@compiled
def hold(x: FloatArray, v: FloatArray, a: FloatArray, first: int, last: int, position: float) -> None:
    """Rest at ``position`` in samples first <= j < last."""
    x[first:last] = position
    v[first:last] = 0.0
    a[first:last] = 0.0


@fast
def advance_block(
    x: FloatArray,
    v: FloatArray,
    a: FloatArray,
    first: int,
    count: int,
    centre: float,
    state: tuple[float, float, float],
    drift: tuple[float, float, float],
    cos_like: FloatArray,
    sin_like: FloatArray,
) -> None:
    """Advance (y, y', y'') given at sample ``first`` over ``count`` samples; drift holds f' + sigma f of each."""
    y, dy, ddy = state
    py, pdy, pddy = drift
    xs, vs, accs = x[first : first + count], v[first : first + count], a[first : first + count]
    for j in range(count):
        c, s = cos_like[j], sin_like[j]
        xs[j] = centre + (y * c + py * s)
        vs[j] = dy * c + pdy * s
        accs[j] = ddy * c + pddy * s


@compiled
def first_index_at(time: float, t0: float, dt: float, n: int) -> int:
    """The first sample of the grid t0 + j dt, 0 <= j <= n, that does not lie before ``time``."""
    guess = math.ceil((time - t0) / dt)
    if not guess > 0.0:
        j = 0
    elif guess > n:
        j = n
    else:
        j = int(guess)
    while j > 0 and t0 + (j - 1) * dt >= time:
        j -= 1
    while j < n and t0 + j * dt < time:
        j += 1
    return j


@compiled
def fill_uniform(
    omega_n: float,
    zeta: float,
    x_k: float,
    x_s: float,
    x0: float,
    v0: float,
    t0: float,
    dt: float,
    x: FloatArray,
    v: FloatArray,
    a: FloatArray,
) -> None:
    """The kernel of ``decay.fill_uniform``: x (m), v (m/s), a (m/s^2) at t0 + j dt."""
    n = x.size
    sigma = zeta * omega_n
    disc = discriminant(omega_n, zeta)
    omega2 = omega_n * omega_n
    table = half_cycles(omega_n, zeta, x_k, x_s, x0, v0, t0 + n * dt)
    size = min(_LONGEST_BLOCK, max(_SHORTEST_BLOCK, int(math.sqrt(n))))
    cos_like, sin_like = np.empty(size), np.empty(size)
    for j in range(size):
        cos_like[j], sin_like[j] = flow(j * dt, omega_n, sigma, disc)
    first = first_index_at(0.0, t0, dt, n)
    hold(x, v, a, 0, first, x0)
    for i in range(table.shape[0]):
        last = first_index_at(table[i + 1, START], t0, dt, n) if i + 1 < table.shape[0] else n
        if table[i, DIRECTION] == 0.0:
            hold(x, v, a, first, last, table[i, POSITION])
            first = last
            continue
        begin, centre, speed = table[i, START], table[i, CENTRE], table[i, SPEED]
        y0 = table[i, POSITION] - centre
        while first < last:
            count = min(size, last - first)
            c, s = flow(max(t0 + first * dt - begin, 0.0), omega_n, sigma, disc)
            y = y0 * c + (speed + sigma * y0) * s
            dy = speed * c - (omega2 * y0 + sigma * speed) * s
            ddy = -2.0 * sigma * dy - omega2 * y
            jerk = -2.0 * sigma * ddy - omega2 * dy
            drift = (dy + sigma * y, ddy + sigma * dy, jerk + sigma * ddy)
            advance_block(x, v, a, first, count, centre, (y, dy, ddy), drift, cos_like, sin_like)
            first += count


_GRID = 16.0  # table points a time of 1/omega_n: the step is at most 1/32 of it, and its eighth power over 8! is 2e-17
_LONGEST = 128
_CHUNK = 256
_ORDER = 8  # coefficients of the Taylor step


@compiled
def disorder(t: FloatArray) -> int:
    """Index of the first time that is not a number or lies before the one ahead of it; -1 when there is none."""
    wrong = 0 if t.size and not math.isfinite(t[0]) else -1
    for j in range(1, t.size):
        if not t[j] >= t[j - 1]:
            return j if wrong < 0 else wrong
    return wrong


@compiled
def taylor(value: float, slope: float, omega_n: float, sigma: float, out: FloatArray) -> None:
    """Coefficients of the solution of y'' + 2 sigma y' + omega_n^2 y = 0 with this value and slope at 0."""
    out[0], out[1] = value, slope
    for k in range(out.size - 2):
        out[k + 2] = -(2.0 * sigma * (k + 1) * out[k + 1] + omega_n * omega_n * out[k]) / ((k + 1) * (k + 2))


@fast
def nearest(t: FloatArray, begin: float, step: float, index: IntArray, rest: FloatArray) -> None:
    """The table point nearest to each time, and what is left over, s."""
    rate = 1.0 / step
    for j in range(t.size):
        tau = t[j] - begin
        index[j] = int(tau * rate + 0.5)
        rest[j] = tau - index[j] * step


@fast
def step_from(c: FloatArray, s: FloatArray, rest: FloatArray, disc: float, series: FloatArray) -> None:
    """Carry C and S from the table point on by ``rest`` (s), in place, with the Taylor coefficients of both."""
    c0, c1, c2, c3 = series[0, 0], series[0, 1], series[0, 2], series[0, 3]
    c4, c5, c6, c7 = series[0, 4], series[0, 5], series[0, 6], series[0, 7]
    s1, s2, s3, s4 = series[1, 1], series[1, 2], series[1, 3], series[1, 4]
    s5, s6, s7 = series[1, 5], series[1, 6], series[1, 7]
    for j in range(rest.size):
        r = rest[j]
        by_c = c0 + r * (c1 + r * (c2 + r * (c3 + r * (c4 + r * (c5 + r * (c6 + r * c7))))))
        by_s = r * (s1 + r * (s2 + r * (s3 + r * (s4 + r * (s5 + r * (s6 + r * s7))))))
        grid_c, grid_s = c[j], s[j]
        c[j] = grid_c * by_c - disc * (grid_s * by_s)
        s[j] = grid_s * by_c + grid_c * by_s


@fast
def combine(
    x: FloatArray,
    v: FloatArray,
    a: FloatArray,
    c: FloatArray,
    s: FloatArray,
    start: tuple[float, float, float],
    omega2: float,
    sigma: float,
) -> None:
    """x, v, a from C and S; start is y, y' and the centre."""
    y0, dy0, centre = start
    push, drop = dy0 + sigma * y0, omega2 * y0 + sigma * dy0
    ddy0 = -2.0 * sigma * dy0 - omega2 * y0
    bend = omega2 * dy0 + sigma * ddy0
    for j in range(x.size):
        x[j] = centre + (y0 * c[j] + push * s[j])
        v[j] = dy0 * c[j] - drop * s[j]
        a[j] = ddy0 * c[j] - bend * s[j]


@compiled
def by_table(
    t: FloatArray,
    x: FloatArray,
    v: FloatArray,
    a: FloatArray,
    begin: float,
    start: tuple[float, float, float],
    motion: tuple[float, float, float],
    table: FloatArray,
    step: float,
    series: FloatArray,
) -> None:
    """x, v, a at times within the table after ``begin`` (s); start is y, y', centre, motion omega_n^2, sigma, disc.

    The look-up is a loop of its own: mixed with the arithmetic it would keep all of it from being vector code.
    """
    omega2, sigma, disc = motion
    index, rest = np.empty(_CHUNK, np.int64), np.empty(_CHUNK)
    c, s = np.empty(_CHUNK), np.empty(_CHUNK)
    for first in range(0, t.size, _CHUNK):
        n = min(_CHUNK, t.size - first)
        span = slice(first, first + n)
        nearest(t[span], begin, step, index, rest)
        for j in range(n):
            c[j], s[j] = table[0, index[j]], table[1, index[j]]
        step_from(c[:n], s[:n], rest[:n], disc, series)
        combine(x[span], v[span], a[span], c[:n], s[:n], start, omega2, sigma)


@compiled
def fill_at(
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
) -> None:
    """The kernel of ``decay.fill_at``: x, v, a at times ``t`` (s) that do not decrease."""
    n = t.size
    if n == 0:
        return
    sigma, omega2 = zeta * omega_n, omega_n * omega_n
    disc = discriminant(omega_n, zeta)
    rows = half_cycles(omega_n, zeta, x_k, x_s, x0, v0, t[n - 1])
    step = 1.0 / (_GRID * omega_n)
    # overdamped motion is left to the closed form: its fast root would need a finer grid
    size = 0 if disc < 0.0 else _LONGEST
    if disc > 0.0:
        size = min(size, int(math.pi / (math.sqrt(disc) * step)) + 2)
    if n < 4 * size:
        size = 0
    table, series = np.empty((2, size)), np.empty((2, _ORDER))
    for k in range(size):
        table[0, k], table[1, k] = flow(k * step, omega_n, sigma, disc)
    taylor(1.0, -sigma, omega_n, sigma, series[0])
    taylor(0.0, 1.0, omega_n, sigma, series[1])
    first = int(np.searchsorted(t, 0.0))
    hold(x, v, a, 0, first, x0)
    for i in range(rows.shape[0]):
        last = int(np.searchsorted(t, rows[i + 1, START])) if i + 1 < rows.shape[0] else n
        if rows[i, DIRECTION] == 0.0:
            hold(x, v, a, first, last, rows[i, POSITION])
            first = last
            continue
        begin, centre, speed = rows[i, START], rows[i, CENTRE], rows[i, SPEED]
        y0 = rows[i, POSITION] - centre
        if size > 0:
            upto = min(last, int(np.searchsorted(t, begin + (size - 1) * step)))
            span = slice(first, upto)
            by_table(
                t[span],
                x[span],
                v[span],
                a[span],
                begin,
                (y0, speed, centre),
                (omega2, sigma, disc),
                table,
                step,
                series,
            )
            first = max(first, upto)
        for j in range(first, last):
            c, s = flow(t[j] - begin, omega_n, sigma, disc)
            y = y0 * c + (speed + sigma * y0) * s
            dy = speed * c - (omega2 * y0 + sigma * speed) * s
            x[j], v[j], a[j] = centre + y, dy, -2.0 * sigma * dy - omega2 * y
        first = last
