"""A slider of this room alone: it shares no line with the kernels of the diagnosis, nor with the other plant.

Fixed steps of Runge and Kutta's fourth order with reversals found inside a step; forces that a controller holds, that
an amplifier follows or that a stiff arm pushes with. An effect is an array of numbers, each 0 where there is none.
"""

import math
from typing import Final, cast

import numpy as np

from harness.core.arrays import FloatArray
from harness.core.jit import compiled, lean

# places in the numbers of an effect
(DRAG, DRAG_V, DRAG_FORM, STRIBECK, STRIBECK_V, STRIBECK_FORM, STICK, STICK_T, STICK_FORM, BRISTLE, BRISTLE_FORM, STOP,
 STOP_X, STOP_FORM, PLAY, PLAY_X, HARD, HARD_X, HARD_FORM, SIDES, SIDES_V, SIDES_FORM, COG, COG_L, COG_P, ARM, ARM_1,
 ARM_2, LOAD, LOAD_X, SLOPE, SLOPE_X, WARM, WARM_T, WARM_FORM, SOFT, SOFT_T, SWAY, SWAY_W, HUM, HUM_W, PULSE, PULSE_T,
 PULSE_L, MODE, MODE_W, MODE_Z, UNKNOWN, UNKNOWN_FORM, UNKNOWN_X, UNKNOWN_V, UNKNOWN_T, FAST, LATE, LATE_FORM, CLIP,
 WANDER, WANDER_T, GEAR, GEAR_U, SAG, LIMIT, DEAD, RAMP, TOOL, WEAK, FILTER, MARK, TILT,
 SIZE) = range(70)  # fmt: skip
# places in the state: motion, bristle, two arms, what is attached, work against friction, hysteresis, elements
X, V, Z, Y1, Y2, X2, V2, WORK, LOOP, ELEMENTS = range(10)
_MANY: Final = 4
"""Elements of the bristles, each an elastic spring that slips at its own force."""
STATES: Final = ELEMENTS + _MANY
TABLE: Final = 257
"""Points of a law of no name, over twice its range."""
HELD, FREE = cast(bool, np.bool_(True)), cast(bool, np.bool_(False))
"""Whether friction holds it: Numba compiles a function anew for every word True or False that it is given."""


@lean
def _read(table: FloatArray, s: float) -> float:
    """A table over -2 to 2, flat beyond, by the cubic of Catmull and Rom."""
    n = table.size - 1
    at = min(max((s + 2.0) * 0.25 * n, 1.0), n - 2.0)
    i = min(int(at), n - 2)
    r = at - i
    a, b, c, d = table[i - 1], table[i], table[i + 1], table[i + 2]
    return float(b + 0.5 * r * (c - a + r * (2.0 * a - 5.0 * b + 4.0 * c - d + r * (3.0 * (b - c) + d - a))))


@lean
def dry(x: float, v: float, t: float, work: float, b: FloatArray, p: FloatArray, tables: FloatArray) -> float:
    """Level of dry friction while sliding, N."""
    level = b[3]
    if p[STRIBECK] != 0.0:
        s = abs(v) / p[STRIBECK_V]
        if p[STRIBECK_FORM] == 0.0:
            level += p[STRIBECK] / (1.0 + s * s)
        elif p[STRIBECK_FORM] == 1.0:
            level += p[STRIBECK] * math.exp(-s)
        else:
            level += p[STRIBECK] * math.exp(-math.sqrt(s))
    if p[SLOPE] != 0.0:
        level += p[SLOPE] * math.tanh(x / p[SLOPE_X])
    if p[LOAD] != 0.0:
        level += p[LOAD] * (math.sqrt(1.0 + (x / p[LOAD_X]) ** 2) - 1.0)
    if p[WARM] != 0.0:
        level -= p[WARM] * (1.0 - math.exp(-(t if p[WARM_FORM] == 0.0 else work) / p[WARM_T]))
    if p[SWAY] != 0.0:
        level += p[SWAY] * math.tanh(2.0 * math.sin(p[SWAY_W] * t))
    if p[UNKNOWN] != 0.0 and p[UNKNOWN_FORM] == 5.0:
        level += p[UNKNOWN] * _read(tables[0], x / p[UNKNOWN_X])
    return float(max(level, 0.0))


@lean
def wet(  # noqa: PLR0912  (one law after the other)
    x: float, v: float, t: float, b: FloatArray, p: FloatArray, tables: FloatArray
) -> float:  # fmt: skip
    """All forces on the left that are functions of place, speed and time, but inertia and dry friction, N."""
    k = b[2]
    f = b[1] * v + (k * math.sin(x) if b[4] > 0.0 else k * x)
    if p[DRAG] != 0.0:
        s = abs(v) / p[DRAG_V]
        if p[DRAG_FORM] == 0.0:
            f += p[DRAG] * v * s / (1.0 + s)
        elif p[DRAG_FORM] == 1.0:
            f += p[DRAG] * v * s**0.687
        else:
            f += p[DRAG] * math.copysign(p[DRAG_V] * s**0.7, v)
    if p[HARD] != 0.0:
        s = x / p[HARD_X]
        if p[HARD_FORM] == 0.0:
            f += p[HARD] * (math.sinh(s) - s)
        elif p[HARD_FORM] == 1.0:
            f += p[HARD] * (math.atan(s) - s)
        elif p[HARD_FORM] == 2.0:
            s = 0.5 * min(max(s, -1.8), 1.8)
            f += p[HARD] * ((1.0 - s) ** -2 - (1.0 + s) ** -2 - 4.0 * s)
        else:
            s = 0.5 * max(s, -1.8)
            f += p[HARD] * (1.0 - (1.0 + s) ** -1.4 - 1.4 * s)
    if p[PLAY] != 0.0:
        f -= p[PLAY] * math.tanh(x / p[PLAY_X])
    if p[SOFT] != 0.0:
        f -= p[SOFT] * (1.0 - math.exp(-t / p[SOFT_T])) * (math.sin(x) if b[4] > 0.0 else x)
    if p[COG] != 0.0:
        phase = 2.0 * math.pi * x / p[COG_L] + p[COG_P]
        f += p[COG] * (math.cos(phase) + 0.3 * math.sin(2.0 * phase))
    if p[SIDES] != 0.0:
        f += p[SIDES] * (v * math.tanh(v / p[SIDES_V]) if p[SIDES_FORM] == 0.0 else max(v, 0.0) ** 2 / p[SIDES_V])
    if p[HUM] != 0.0:
        f -= p[HUM] * math.tanh(1.5 * math.sin(p[HUM_W] * t)) / 0.9
    if p[PULSE] != 0.0 and 0.0 <= t - p[PULSE_T] <= p[PULSE_L]:
        f -= p[PULSE] * math.sin(math.pi * (t - p[PULSE_T]) / p[PULSE_L])
    if p[STOP] != 0.0 and abs(x) > p[STOP_X]:
        deep = p[STOP] * (abs(x) - p[STOP_X]) ** 1.5
        if p[STOP_FORM] == 1.0:
            deep *= max(1.0 + 0.4 * math.copysign(v, x * v) / p[FAST], 0.0)
        f += math.copysign(deep, x)
    if p[UNKNOWN] != 0.0:
        if p[UNKNOWN_FORM] == 0.0:
            f += p[UNKNOWN] * _read(tables[0], x / p[UNKNOWN_X])
        elif p[UNKNOWN_FORM] == 1.0:
            f += p[UNKNOWN] * (_read(tables[1], v / p[UNKNOWN_V]) - _read(tables[1], 0.0))
        elif p[UNKNOWN_FORM] == 2.0:
            f += p[UNKNOWN] * _read(tables[0], x / p[UNKNOWN_X]) * _read(tables[1], v / p[UNKNOWN_V])
        elif p[UNKNOWN_FORM] == 3.0:
            f += p[UNKNOWN] * _read(tables[2], 4.0 * t / p[UNKNOWN_T] - 2.0)
    return float(f)


@lean
def _rates(
    s: FloatArray, t: float, u: float, side: float, held: bool, x0: float, b: FloatArray, p: FloatArray,
    tables: FloatArray, out: FloatArray,
) -> float:  # fmt: skip
    """Rates of a state, and the net force without dry friction, N. x0 : where the elements stood when they were set."""
    x, v = s[X], s[V]
    f = wet(x, v, t, b, p, tables)
    m = b[0]
    out[:] = 0.0
    if p[ARM] != 0.0:
        f += p[ARM] * (s[Y1] + 0.5 * s[Y2])
        out[Y1], out[Y2] = v - s[Y1] / p[ARM_1], v - s[Y2] / p[ARM_2]
    if p[MODE] != 0.0:
        w, slip = p[MODE_W], v - s[V2]
        pull = p[MODE] * m * (w * w * (x - s[X2]) + 2.0 * p[MODE_Z] * w * slip * (0.5 + abs(slip) / p[FAST]))
        f += pull
        out[X2], out[V2] = s[V2], pull / (p[MODE] * m)
    if p[UNKNOWN] != 0.0 and p[UNKNOWN_FORM] == 4.0:
        f += p[UNKNOWN] * s[LOOP]
        z, n = s[LOOP], p[UNKNOWN_T]
        out[LOOP] = (v - 0.6 * abs(v) * abs(z) ** (n - 1.0) * z - 0.4 * v * abs(z) ** n) / p[UNKNOWN_X]
    level = dry(x, v, t, s[WORK], b, p, tables)
    if p[BRISTLE] != 0.0:
        stiff = level / p[BRISTLE]
        if p[BRISTLE_FORM] == 0.0:
            for i in range(_MANY):
                most = level / _MANY
                f += min(max(s[ELEMENTS + i] + stiff * (i + 1.0) / _MANY * (x - x0), -most), most)
        elif p[BRISTLE_FORM] == 1.0:
            # Dahl's, with the square
            share = 1.0 - math.copysign(s[Z] / p[BRISTLE], s[Z] * v)
            out[Z] = v * math.copysign(share * share, share)
            f += stiff * s[Z]
        else:
            # elasto-plastic: elastic up to a third of the way, sliding at all of it (Dupont and others 2002)
            way, give = abs(s[Z]) / p[BRISTLE], 0.0
            if s[Z] * v > 0.0:
                r = min(max((way - 0.33) / 0.67, 0.0), 1.0)
                give = r * r * (3.0 - 2.0 * r)
            out[Z] = v * (1.0 - give * way)
            f += stiff * s[Z] + 0.2 * math.sqrt(stiff * m) * out[Z]
        side = 0.0
    out[WORK] = level * abs(v)
    if not held:
        out[X], out[V] = v, (u - f - side * level) / m
    return float(u - f)


@lean
def put(values: FloatArray, out: FloatArray) -> None:
    """A state put in another's place. Sums of whole arrays, and this by a slice, are compiled ten times as long."""
    for i in range(values.size):
        out[i] = values[i]


@lean
def moved(s: FloatArray, h: float, rates: FloatArray, out: FloatArray) -> None:
    """A state carried on by h at these rates."""
    for i in range(s.size):
        out[i] = s[i] + h * rates[i]


@lean
def combined(s: FloatArray, h: float, k1: FloatArray, k2: FloatArray, k3: FloatArray, k4: FloatArray,
             out: FloatArray) -> None:  # fmt: skip
    """A state carried on by h, by the slopes of Runge and Kutta's fourth order."""
    for i in range(s.size):
        out[i] = s[i] + h / 6.0 * (k1[i] + 2.0 * k2[i] + 2.0 * k3[i] + k4[i])


@lean
def _step(
    s: FloatArray, t: float, h: float, u: float, rate: float, side: float, held: bool, b: FloatArray, p: FloatArray,
    tables: FloatArray, w: FloatArray,
) -> None:  # fmt: skip
    """One step of a state, into w[5]. w : room to work in, (6, STATES)."""
    x0 = s[X]
    _rates(s, t, u, side, held, x0, b, p, tables, w[0])
    moved(s, 0.5 * h, w[0], w[4])
    _rates(w[4], t + 0.5 * h, u + 0.5 * h * rate, side, held, x0, b, p, tables, w[1])
    moved(s, 0.5 * h, w[1], w[4])
    _rates(w[4], t + 0.5 * h, u + 0.5 * h * rate, side, held, x0, b, p, tables, w[2])
    moved(s, h, w[2], w[4])
    _rates(w[4], t + h, u + h * rate, side, held, x0, b, p, tables, w[3])
    combined(s, h, w[0], w[1], w[2], w[3], w[5])


@lean
def _advance(
    s: FloatArray, side: float, stuck: float, t: float, h: float, u: float, rate: float, b: FloatArray, p: FloatArray,
    tables: FloatArray, w: FloatArray,
) -> tuple[float, float]:  # fmt: skip
    """Carry a state on by h, through reversals and rest; direction of sliding (0 at rest), and how long it rests."""
    left, tries, rigid = h, 0, p[BRISTLE] == 0.0
    while left > 1e-12 * h and tries < 50:
        tries += 1
        if side == 0.0 and rigid:
            s[V] = 0.0
            net = _rates(s, t, u, 0.0, HELD, s[X], b, p, tables, w[0])
            most = dry(s[X], 0.0, t, s[WORK], b, p, tables)
            if p[STICK] != 0.0:
                if p[STICK_FORM] == 0.0:
                    most += p[STICK] * (1.0 - math.exp(-stuck / p[STICK_T]))
                else:
                    most += p[STICK] / (1.0 + abs(rate) * p[STICK_T] / b[3])
            if abs(net) <= most:
                _step(s, t, left, u, rate, 0.0, HELD, b, p, tables, w)
                put(w[5], s)
                return 0.0, stuck + left
            side, stuck = math.copysign(1.0, net), 0.0
        _step(s, t, left, u, rate, side, FREE, b, p, tables, w)
        done = left
        turned = rigid and w[5, V] * side < 0.0
        if turned:
            low, high = 0.0, left
            for _ in range(40):
                done = 0.5 * (low + high)
                _step(s, t, done, u, rate, side, FREE, b, p, tables, w)
                if w[5, V] * side < 0.0:
                    high = done
                else:
                    low = done
            done = high
            _step(s, t, done, u, rate, side, FREE, b, p, tables, w)
            w[5, V], side = 0.0, 0.0
        if not rigid and p[BRISTLE_FORM] == 0.0:
            most = dry(w[5, X], w[5, V], t, s[WORK], b, p, tables) / _MANY
            for i in range(_MANY):
                one = s[ELEMENTS + i] + most * (i + 1.0) / p[BRISTLE] * (w[5, X] - s[X])
                w[5, ELEMENTS + i] = min(max(one, -most), most)
        put(w[5], s)
        t, u, left = t + done, u + rate * done, left - done
    return side, stuck


@lean
def _shown(
    s: FloatArray, side: float, t: float, u: float, b: FloatArray, p: FloatArray, tables: FloatArray, w: FloatArray,
    row: FloatArray,
) -> None:  # fmt: skip
    """Place, speed, acceleration, force and work against friction, at a sample."""
    held = side == 0.0 and p[BRISTLE] == 0.0
    net = _rates(s, t, u, side, held, s[X], b, p, tables, w[0])
    if held and abs(net) > dry(s[X], 0.0, t, s[WORK], b, p, tables) + p[STICK]:
        # let go at this very sample
        _rates(s, t, u, math.copysign(1.0, net), FREE, s[X], b, p, tables, w[0])
    row[0], row[1], row[2], row[3], row[4] = s[X], s[V], w[0, V], u, s[WORK]


@compiled
def _state(x: float, v: float) -> FloatArray:
    s = np.zeros(STATES)
    s[X], s[V], s[X2], s[V2] = x, v, x, v
    return s


@compiled
def given_force(
    u: FloatArray, held: bool, dt: float, fine: int, x: float, v: float, b: FloatArray, p: FloatArray,
    tables: FloatArray,
) -> FloatArray:  # fmt: skip
    """Motion (n, 5) under a force u (n,) that is held, or finely given: u ((n - 1) fine + 1,)."""
    n = u.size if held else (u.size - 1) // fine + 1
    rows, s, w = np.empty((n, 5)), _state(x, v), np.empty((6, STATES))
    side, stuck, h = 0.0 if v == 0.0 else math.copysign(1.0, v), 1e9, dt / fine
    for i in range(n):
        _shown(s, side, i * dt, u[i] if held else u[i * fine], b, p, tables, w, rows[i])
        if i == n - 1:
            break
        for j in range(fine):
            now, rate = u[i], 0.0
            if not held:
                now, rate = u[i * fine + j], (u[i * fine + j + 1] - u[i * fine + j]) / h
            side, stuck = _advance(s, side, stuck, i * dt + j * h, h, now, rate, b, p, tables, w)
    return rows


@compiled
def controlled(
    r: FloatArray, rv: FloatArray, ra: FloatArray, count: float, gains: FloatArray, dt: float, fine: int,
    b: FloatArray, p: FloatArray, tables: FloatArray,
) -> FloatArray:  # fmt: skip
    """Motion (n, 5) and held force of a loop on encoder counts that follows r, rv, ra (n,).

    gains : kp, kd, ki, share of the speed's filter that is new each tick, mass and friction that are fed forward, most,
    fastest.
    """
    n = r.size
    rows, s, w = np.empty((n, 5)), _state(r[0], 0.0), np.empty((6, STATES))
    side, stuck, speed, total = 0.0, 1e9, 0.0, 0.0
    before = math.floor(s[X] / count + 0.5) * count
    for i in range(n):
        seen = math.floor(s[X] / count + 0.5) * count
        speed += gains[3] * ((seen - before) / dt - speed)
        before = seen
        total += (r[i] - seen) * dt
        u = gains[0] * (r[i] - seen) + gains[1] * (rv[i] - speed) + gains[2] * total + gains[4] * ra[i]
        u += gains[5] * math.tanh(rv[i] / (0.02 * gains[7]))
        u = min(max(u, -gains[6]), gains[6])
        _shown(s, side, i * dt, u, b, p, tables, w, rows[i])
        h = dt / fine
        for j in range(fine):
            side, stuck = _advance(s, side, stuck, i * dt + j * h, h, u, 0.0, b, p, tables, w)
    return rows


@compiled
def pushed(
    r: FloatArray, rv: FloatArray, stiff: float, damp: float, dt: float, fine: int, b: FloatArray, p: FloatArray,
    tables: FloatArray,
) -> FloatArray:  # fmt: skip
    """Motion (n, 5) and measured force of a slider that a stiff arm pushes along r, rv ((n - 1) fine + 1,)."""
    n, h, m = (r.size - 1) // fine + 1, dt / fine, 4
    rows, s, w = np.empty((n, 5)), _state(r[0], 0.0), np.empty((6, STATES))
    side, stuck = 0.0, 1e9
    for i in range(n):
        j = i * fine
        _shown(s, side, i * dt, stiff * (r[j] - s[X]) + damp * (rv[j] - s[V]), b, p, tables, w, rows[i])
        if i == n - 1:
            break
        for j in range(i * fine, (i + 1) * fine):
            # the arm's own force is followed as it changes within a step
            for q in range(m):
                now, way, fast = (j + q / m) * h, r[j] + q / m * (r[j + 1] - r[j]), rv[j] + q / m * (rv[j + 1] - rv[j])
                u = stiff * (way - s[X]) + damp * (fast - s[V])
                _rates(s, now, u, side, side == 0.0 and p[BRISTLE] == 0.0, s[X], b, p, tables, w[0])
                rate = stiff * (fast - s[V]) + damp * ((rv[j + 1] - rv[j]) / h - w[0, V])
                side, stuck = _advance(s, side, stuck, now, h / m, u, rate, b, p, tables, w)
    return rows


# places in the numbers of a servo: duty over rad, N m at all of it, most of it, s by which goals are late, rad of its
# encoder's step, what that shows where the joint hangs, and N m s/rad of the motor's own in c
GAIN, STALL, MOST, LATER, STEP, REST, OWN = range(7)


@compiled
def served(
    goal: FloatArray, dt: float, ticks: int, servo: FloatArray, b: FloatArray, p: FloatArray, tables: FloatArray
) -> FloatArray:
    """Motion (n, 5) and motor's torque of a joint whose servo gets goals (n,), one a sample; ticks : of its loop a
    sample. c : the gears' and the motor's own."""
    n, h, step, rest = goal.size, dt / ticks, servo[STEP], servo[REST]
    rows, s, w, now = np.empty((n, 5)), _state(goal[0] - rest, 0.0), np.empty((6, STATES)), b.copy()
    side, stuck, wanted, pace, u = 0.0, 1e9, goal[0], 0.0, 0.0
    for i in range(n):
        _shown(s, side, i * dt, u, now, p, tables, w, rows[i])
        for tick in range(ticks):
            t = i * dt + tick * h
            sent = math.floor(goal[max(math.floor((t - servo[LATER]) / dt + 1e-9), 0)] / step + 0.5) * step
            if p[RAMP] != 0.0:
                # a profile of a largest speed, taken up and left within a tenth of a second, stopping in whole ticks
                most = 1.0 / p[RAMP]
                hard, off = 10.0 * most, sent - wanted
                to = math.copysign(min(most, hard * (math.sqrt(h * h + 2.0 * abs(off) / hard) - h)), off)
                pace += min(max(to - pace, -hard * h), hard * h)
                wanted += pace * h
            else:
                wanted = sent
            error = wanted - math.floor((s[X] + rest) / step + 0.5) * step
            if p[DEAD] != 0.0:
                error *= 1.0 - math.exp(-((error / p[DEAD]) ** 2))
            duty = min(max(math.floor(1000.0 * servo[GAIN] * error + 0.5) / 1000.0, -servo[MOST]), servo[MOST])
            u = servo[STALL] * duty * (1.0 - p[SAG] * abs(duty))
            if p[LIMIT] != 0.0:
                u /= (1.0 + abs(u * p[LIMIT]) ** 6) ** (1.0 / 6.0)
            if p[GEAR] != 0.0:
                # what the teeth carry: the load's torque and the motor's, from a preload on
                carried = u - servo[OWN] * s[V] + b[2] * math.sin(s[X])
                now[3] = b[3] + p[GEAR] * (math.sqrt(carried**2 + p[GEAR_U] ** 2) - p[GEAR_U])
            for _ in range(2):
                side, stuck = _advance(s, side, stuck, t, 0.5 * h, u, 0.0, now, p, tables, w)
                t += 0.5 * h
    return rows
