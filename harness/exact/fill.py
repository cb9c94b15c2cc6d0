"""Samples of the free decay, written into arrays the caller owns.

On a uniform grid the motion is advanced by a table of C and S at multiples of dt, which the compiler turns into vector
instructions; every block starts again from the closed form, so errors do not accumulate.
"""

import math

import numpy as np

from harness.core.arrays import FloatArray
from harness.core.jit import compiled
from harness.exact.flow import discriminant, flow
from harness.exact.segments import CENTRE, DIRECTION, POSITION, SPEED, START, half_cycles

_LONGEST_BLOCK = 512
_SHORTEST_BLOCK = 16


def _hold(x: FloatArray, v: FloatArray, a: FloatArray, first: int, last: int, position: float) -> None:
    """Rest at ``position`` in samples first <= j < last."""
    x[first:last] = position
    v[first:last] = 0.0
    a[first:last] = 0.0


hold = compiled(_hold)


def _advance_block(
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


advance_block = compiled(_advance_block, fastmath=True)


def _first_index_at(time: float, t0: float, dt: float, n: int) -> int:
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


first_index_at = compiled(_first_index_at)


def _fill_uniform(
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


fill_uniform = compiled(_fill_uniform)
