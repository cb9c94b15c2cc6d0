"""A slider under a harmonic force, piece by piece between its stops and reversals.

Each piece is linear: a forced response plus the free motion of ``flow``. Break-away from a stop has a closed form; the
end of a slip is the first zero of the speed, bracketed on a grid finer than either motion and bisected to the last bit.
"""

import math
from typing import TypeAlias

from harness.core.arrays import FloatArray, IntArray
from harness.core.jit import compiled
from harness.exact.segments import CENTRE, DIRECTION, POSITION, SPEED, START, discriminant, flow

# omega_n, zeta, x_k, x_s, push = amplitude/k (m), drive (rad/s), phase of the force, amplitude (m) and phase of the
# forced response
System: TypeAlias = tuple[float, float, float, float, float, float, float, float, float]

_STEPS = 32  # of the bracketing grid, a half period of the faster motion
_REFINED = 20  # halvings of its first step, where a slip from rest begins slowly


@compiled
def moving(
    system: System, start: float, x0: float, v0: float, direction: float, t: float
) -> tuple[float, float, float]:
    """x, v, a at time ``t`` (s) of a slip in ``direction`` that began at ``start`` (s) with x0, v0."""
    omega_n, zeta, x_k, _, _, drive, _, forced, phase = system
    sigma = zeta * omega_n
    centre = -direction * x_k
    angle = drive * start + phase
    y0 = x0 - centre - forced * math.cos(angle)
    dy0 = v0 + forced * drive * math.sin(angle)
    c, s = flow(t - start, omega_n, sigma, discriminant(omega_n, zeta))
    y = y0 * c + (dy0 + sigma * y0) * s
    dy = dy0 * c - (omega_n * omega_n * y0 + sigma * dy0) * s
    ddy = -2.0 * sigma * dy - omega_n * omega_n * y
    angle = drive * t + phase
    ripple, slope = forced * math.cos(angle), -forced * drive * math.sin(angle)
    return centre + ripple + y, slope + dy, ddy - drive * drive * ripple


@compiled
def pull(system: System, t: float, x: float) -> float:
    """Force of drive and spring on a slider at rest at x, divided by k, m."""
    return system[4] * math.cos(system[5] * t + system[6]) - x


@compiled
def zero(
    system: System, start: float, x0: float, v0: float, direction: float, which: int, low: float, high: float
) -> float:
    """Where v (which = 1) or a (which = 2) times direction changes sign between two times (s), to the last bit."""
    sign_low = moving(system, start, x0, v0, direction, low)[which] > 0.0
    while True:
        middle = 0.5 * (low + high)
        if not low < middle < high:
            return high
        if (moving(system, start, x0, v0, direction, middle)[which] > 0.0) == sign_low:
            low = middle
        else:
            high = middle


@compiled
def slip_end(system: System, start: float, x0: float, v0: float, direction: float, until: float) -> float:
    """The first time after ``start`` (s) at which the slip comes to rest; inf when not up to ``until``."""
    step = math.pi / (_STEPS * max(system[0], system[5]))
    low, tau = start, step * 2.0**-_REFINED
    climbing = True
    while low < until:
        high = start + tau
        _, v, a = moving(system, start, x0, v0, direction, high)
        if v * direction <= 0.0:
            if low == start and v0 == 0.0:
                return high  # it stops before it has begun
            return zero(system, start, x0, v0, direction, 1, low, high)
        if a * direction > 0.0 and not climbing:
            # slowest in between: did it come to rest there?
            dip = zero(system, start, x0, v0, direction, 2, low, high)
            if moving(system, start, x0, v0, direction, dip)[1] * direction <= 0.0:
                return zero(system, start, x0, v0, direction, 1, low, dip)
        climbing = a * direction > 0.0
        low = high
        tau = 2.0 * tau if tau < step else tau + step
    return math.inf


@compiled
def stop_end(system: System, start: float, x: float) -> tuple[float, float]:
    """When (s, inf for never) and in which direction a slider at rest at x breaks away."""
    _, _, _, x_s, push, drive, phase, _, _ = system
    best, direction = math.inf, 0.0
    for sign in (1.0, -1.0):
        if push <= 0.0:
            break
        level = sign * (x + sign * x_s) / push
        if level >= 1.0:
            continue
        # sign cos(angle) rises through the level at angle = -acos(level), half a turn later for sign < 0
        angle = -math.acos(max(level, -1.0)) + (0.0 if sign > 0.0 else math.pi)
        turns = (angle - (drive * start + phase)) / (2.0 * math.pi)
        time = start + (turns - math.floor(turns)) * 2.0 * math.pi / drive
        if time < best:
            best, direction = time, sign
    return best, direction


@compiled
def departure(system: System, t: float, x: float) -> float:
    """Direction in which a slider that came to rest at x moves on; 0 when it stops."""
    force = pull(system, t, x)
    if abs(force) <= system[3]:
        return 0.0
    return 1.0 if force > 0.0 else -1.0


@compiled
def walk_forced(system: System, begin: float, x: float, v: float, until: float, table: FloatArray) -> int:
    """Write the slips and stops from ``begin`` up to ``until`` (s) into ``table`` (rows, 5); return how many.

    Columns as in ``segments``. Returns rows + 1 when the table is too short.
    """
    count = 0
    direction = departure(system, begin, x) if v == 0.0 else (1.0 if v > 0.0 else -1.0)
    while begin < until:
        if count == table.shape[0]:
            return count + 1
        table[count, START], table[count, POSITION], table[count, SPEED] = begin, x, v
        table[count, CENTRE], table[count, DIRECTION] = -direction * system[2], direction
        count += 1
        if direction == 0.0:
            begin, direction = stop_end(system, begin, x)
        else:
            end = slip_end(system, begin, x, v, direction, until)
            if end >= until:
                break
            x = moving(system, begin, x, v, direction, end)[0]
            begin, v = end, 0.0
            direction = departure(system, begin, x)
    return count


@compiled
def state_at(system: System, row: FloatArray, t: float) -> tuple[float, float, float]:
    """x, v, a at ``t`` (s) in the piece that a row of the table describes."""
    if row[DIRECTION] == 0.0:
        return row[POSITION], 0.0, 0.0
    return moving(system, row[START], row[POSITION], row[SPEED], row[DIRECTION], t)


@compiled
def settle(
    system: System, x: float, v: float, tolerance: float, cycles: int, table: FloatArray
) -> tuple[int, float, float, float]:
    """Repeat the period from t = 0 until the state at its end moves by less than ``tolerance`` (m).

    Returns the number of cycles, x, v at a whole period, and the last change in m; inf when the table is too short.
    """
    period = 2.0 * math.pi / system[5]
    change = math.inf
    for cycle in range(cycles):
        count = walk_forced(system, 0.0, x, v, period, table)
        if count > table.shape[0]:
            return cycle, x, v, math.inf
        at, speed, _ = state_at(system, table[count - 1], period)
        change = abs(at - x) + abs(speed - v) / system[0]
        x, v = at, speed
        if change <= tolerance:
            return cycle + 1, x, v, change
    return cycles, x, v, change


@compiled
def fill_forced(
    system: System, table: FloatArray, index: IntArray, t: FloatArray, x: FloatArray, v: FloatArray, a: FloatArray
) -> None:
    """x, v, a at the times ``t`` (s), each in the piece ``index`` of the table."""
    for j in range(t.size):
        x[j], v[j], a[j] = state_at(system, table[index[j]], t[j])
