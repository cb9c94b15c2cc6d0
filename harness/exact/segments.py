"""Half-cycle by half-cycle: where each begins, about which centre it swings, when it sticks, and how it moves inside.

With y measured from the centre of the half-cycle, y'' + 2 sigma y' + omega_n^2 y = 0 has the solutions

    y(tau) = y_0 C + (y_0' + sigma y_0) S,      C = exp(-sigma tau) cos(omega_d tau),
                                                S = exp(-sigma tau) sin(omega_d tau) / omega_d.

The same form carries y', y'' and every further derivative. C and S are smooth functions of ``disc`` = omega_d^2 =
omega_n^2 (1 - zeta^2), which is negative for an overdamped slider, so nothing is lost near zeta = 1.

Source: Liang, eqs. 2 to 6, extended to any start and any damping ratio.
"""

import math

import numpy as np

from harness.core.arrays import FloatArray
from harness.core.jit import compiled


@compiled
def flow(tau: float, omega_n: float, sigma: float, disc: float) -> tuple[float, float]:
    """C and S (s) at time ``tau`` >= 0 after the start of a half-cycle."""
    if disc > 0.0:
        omega_d = math.sqrt(disc)
        decay = math.exp(-sigma * tau)
        return decay * math.cos(omega_d * tau), decay * math.sin(omega_d * tau) / omega_d
    if disc < 0.0:
        # the slow root is sigma - kappa without its cancellation; cosh and sinh would overflow
        kappa = math.sqrt(-disc)
        slow = math.exp(-tau * omega_n * omega_n / (sigma + kappa))
        lost = -math.expm1(-2.0 * kappa * tau)
        return slow * (1.0 - 0.5 * lost), slow * lost / (2.0 * kappa)
    decay = math.exp(-sigma * tau)
    return decay, decay * tau


@compiled
def discriminant(omega_n: float, zeta: float) -> float:
    """omega_d^2 in (rad/s)^2, signed: above zero the slider oscillates."""
    return omega_n * omega_n * ((1.0 - zeta) * (1.0 + zeta))


# columns of the table of half-cycles
START, POSITION, SPEED, CENTRE, DIRECTION = range(5)


@compiled
def first_reversal(omega_n: float, zeta: float, x_k: float, x0: float, v0: float) -> tuple[float, float]:
    """Time in s and position in m where a slider that starts with speed ``v0`` != 0 first comes to rest.

    The time is inf when that never happens (zeta >= 1 without an overshoot).
    """
    sigma = zeta * omega_n
    disc = discriminant(omega_n, zeta)
    sign = 1.0 if v0 > 0.0 else -1.0
    speed = abs(v0)
    centre = -sign * x_k
    y0 = x0 - centre
    stiff = sign * omega_n * omega_n * y0
    if disc > 0.0:
        omega_d = math.sqrt(disc)
        tau = math.atan2(omega_d * speed, stiff + sigma * speed) / omega_d
    else:
        kappa = math.sqrt(-disc)
        gap = stiff + speed * omega_n * omega_n / (sigma + kappa)
        if gap <= 0.0:
            return math.inf, centre
        tau = math.log1p(2.0 * kappa * speed / gap) / (2.0 * kappa) if kappa > 0.0 else speed / gap
    cos_like, sin_like = flow(tau, omega_n, sigma, disc)
    return tau, centre + y0 * cos_like + (v0 + sigma * y0) * sin_like


@compiled
def walk(
    omega_n: float, zeta: float, x_k: float, x_s: float, x0: float, v0: float, until: float, table: FloatArray
) -> int:
    """Write the half-cycles that begin before ``until`` (s) into ``table`` (rows, 5) while rows last; return how many.

    A row is start time, position, speed, centre, direction (-1, 1; 0 at rest). The last row lasts for ever when it
    is at rest or does not end, else to its own end.
    """
    rows = table.shape[0]
    disc = discriminant(omega_n, zeta)
    half, q = math.inf, 0.0
    if disc > 0.0:
        half = math.pi / math.sqrt(disc)
        q = math.exp(-zeta * omega_n * half)
    count, begin, position = 0, 0.0, x0
    if v0 != 0.0:
        sign = 1.0 if v0 > 0.0 else -1.0
        if rows > 0:
            table[0, START], table[0, POSITION], table[0, SPEED] = 0.0, x0, v0
            table[0, CENTRE], table[0, DIRECTION] = -sign * x_k, sign
        count = 1
        begin, position = first_reversal(omega_n, zeta, x_k, x0, v0)
    first, swings = begin, 0
    while begin <= until and begin < math.inf:
        sticks = abs(position) <= x_s
        sign = 0.0 if sticks else (-1.0 if position > 0.0 else 1.0)
        centre = position if sticks else -sign * x_k
        if count < rows:
            table[count, START], table[count, POSITION], table[count, SPEED] = begin, position, 0.0
            table[count, CENTRE], table[count, DIRECTION] = centre, sign
        count += 1
        if sticks:
            break
        swings += 1
        begin = first + swings * half
        position = centre - q * (position - centre)
    return count


@compiled
def half_cycles(omega_n: float, zeta: float, x_k: float, x_s: float, x0: float, v0: float, until: float) -> FloatArray:
    """The table of half-cycles that begin up to ``until`` (s), shape (n, 5); see ``walk`` for its columns."""
    count = walk(omega_n, zeta, x_k, x_s, x0, v0, until, np.empty((0, 5)))
    table = np.empty((count, 5))
    walk(omega_n, zeta, x_k, x_s, x0, v0, until, table)
    return table
