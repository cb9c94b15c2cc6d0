"""An arm of this room alone: hinges in a row, each with the friction of ``plant``, under a controller on its encoders.

Its rigid body is Newton's and Euler's recursion in the frame of the base, and shares no line with the engine by which
the diagnosis has the arm's torque. Fixed steps of Runge and Kutta's fourth order, reversals found inside a step.
"""

import math
from typing import Final, cast

import numpy as np

from harness.core.arrays import BoolArray, FloatArray
from harness.core.jit import compiled, lean
from harness.proof.paths.plant import (
    BRISTLE,
    BRISTLE_FORM,
    ELEMENTS,
    GEAR,
    GEAR_U,
    HELD,
    STATES,
    WORK,
    V,
    X,
    _rates,
    combined,
    dry,
    moved,
    put,
)

# a body: where its joint is in the one before, axis, mass, centre of mass, inertia about it, rotor
AT, AXIS, MASS, CENTRE, TURNING, ROTOR, BODY = 0, 3, 6, 7, 10, 13, 14
G: Final = 9.81
_MANY: Final = 4
_SECANTS: Final = 4
_SLOW: Final = 1e-6
"""rad/s: what is slower when the first joint turns turns too."""
_FIRST = cast(int, np.int64(0))
"""As any other joint's number, for which Numba need not compile anew."""


@lean
def _cross(a: FloatArray, b: FloatArray, out: FloatArray) -> None:
    """out += a x b."""
    out[0] += a[1] * b[2] - a[2] * b[1]
    out[1] += a[2] * b[0] - a[0] * b[2]
    out[2] += a[0] * b[1] - a[1] * b[0]


@lean
def _turned(frame: FloatArray, v: FloatArray, out: FloatArray) -> None:
    for i in range(3):
        out[i] = frame[i, 0] * v[0] + frame[i, 1] * v[1] + frame[i, 2] * v[2]


@lean
def _place(bodies: FloatArray, q: FloatArray, frames: FloatArray, arms: FloatArray) -> None:
    """Frames (m + 1, 3, 3) of base and bodies; arms (m, 3, 3): from joint to joint, axis, to the centre, all turned."""
    for i in range(len(bodies)):
        before, frame, body = frames[i], frames[i + 1], bodies[i]
        for part in range(2):
            _turned(before, body[AT + 3 * part : AT + 3 * part + 3], arms[i, part])
        angle = q[i] if i < q.size else 0.0
        c, s, axis = math.cos(angle), math.sin(angle), body[AXIS : AXIS + 3]
        for r in range(3):
            along = before[r, 0] * axis[0] + before[r, 1] * axis[1] + before[r, 2] * axis[2]
            for k in range(3):
                k1, k2 = (k + 1) % 3, (k + 2) % 3
                # Rodrigues' turn about an axis that both frames share
                side = before[r, k1] * axis[k2] - before[r, k2] * axis[k1]
                frame[r, k] = c * before[r, k] + s * side + (1.0 - c) * along * axis[k]
        _turned(frame, body[CENTRE : CENTRE + 3], arms[i, 2])


@lean
def _torques(
    bodies: FloatArray, v: FloatArray, a: FloatArray, up: FloatArray, first: int, frames: FloatArray, arms: FloatArray,
    w: FloatArray, out: FloatArray,
) -> None:  # fmt: skip
    """Torques (n,) of speeds and accelerations at a place; up : what the base is accelerated by. w : room, (m, 3, 3).

    first : the first joint that moves; the base's acceleration is that of its body.
    """
    n, motion = v.size, w[len(bodies)]
    spin, change = motion[0], motion[1]
    spin[:] = 0.0
    change[:] = 0.0
    fx, fy, fz = up[0], up[1], up[2]
    for i in range(first, len(bodies)):
        to, axis, centre, body, frame = arms[i, 0], arms[i, 1], arms[i, 2], bodies[i], frames[i + 1]
        force, moment, turns = w[i, 0], w[i, 1], w[i, 2]
        force[0], force[1], force[2] = fx, fy, fz
        turns[:] = 0.0
        _cross(spin, to, turns)
        _cross(change, to, force)
        _cross(spin, turns, force)
        fx, fy, fz = force[0], force[1], force[2]
        if i < n:
            for k in range(3):
                turns[k] = axis[k] * v[i]
            _cross(spin, turns, change)
            for k in range(3):
                change[k] += axis[k] * a[i]
                spin[k] += turns[k]
        turns[:] = 0.0
        _cross(spin, centre, turns)
        _cross(change, centre, force)
        _cross(spin, turns, force)
        for k in range(3):
            force[k] *= body[MASS]
        # about the centre, in the body's own axes
        moment[:] = 0.0
        turns[:] = 0.0
        for k in range(3):
            by, turn = 0.0, 0.0
            for r in range(3):
                by += frame[r, k] * change[r]
                turn += frame[r, k] * spin[r]
            for r in range(3):
                moment[r] += body[TURNING + k] * by * frame[r, k]
                turns[r] += body[TURNING + k] * turn * frame[r, k]
        _cross(spin, turns, moment)
        _cross(centre, force, moment)
    for i in range(len(bodies) - 1, first - 1, -1):
        if i + 1 < len(bodies):
            _cross(arms[i + 1, 0], w[i + 1, 0], w[i, 1])
            for k in range(3):
                w[i, 0, k] += w[i + 1, 0, k]
                w[i, 1, k] += w[i + 1, 1, k]
        if i < n:
            axis = arms[i, 1]
            out[i] = axis[0] * w[i, 1, 0] + axis[1] * w[i, 1, 1] + axis[2] * w[i, 1, 2] + bodies[i, ROTOR] * a[i]


@compiled
def rigid(bodies: FloatArray, up: FloatArray, q: FloatArray, v: FloatArray, a: FloatArray) -> FloatArray:
    """Torques (m, n) of a rigid arm along a motion, each (m, n); up : gravity's opposite at the base, m/s^2."""
    many = len(bodies)
    frames, arms, w = np.zeros((many + 1, 3, 3)), np.empty((many, 3, 3)), np.empty((many + 1, 3, 3))
    out = np.empty_like(q)
    for k in range(3):
        frames[0, k, k] = 1.0
    for i in range(len(q)):
        _place(bodies, q[i], frames, arms)
        _torques(bodies, v[i], a[i], up, _FIRST, frames, arms, w, out[i])
    return out


def masses(bodies: FloatArray, q: FloatArray) -> FloatArray:
    """Inertia (n, n) at a place (n,)."""
    n = q.size
    found = rigid(bodies, np.zeros(3), np.tile(q, (n, 1)), np.zeros((n, n)), np.eye(n))
    return 0.5 * (found + found.T)


@lean
def _solved(matrix: FloatArray, right: FloatArray, out: FloatArray) -> None:
    """Of a positive definite matrix (n, n), in place, by Cholesky's root."""
    n = right.size
    for i in range(n):
        for j in range(i + 1):
            total = matrix[i, j]
            for k in range(j):
                total -= matrix[i, k] * matrix[j, k]
            matrix[i, j] = math.sqrt(total) if i == j else total / matrix[j, j]
    for i in range(n):
        out[i] = right[i]
        for k in range(i):
            out[i] -= matrix[i, k] * out[k]
        out[i] /= matrix[i, i]
    for i in range(n - 1, -1, -1):
        for k in range(i + 1, n):
            out[i] -= matrix[k, i] * out[k]
        out[i] /= matrix[i, i]


@compiled
def _slowed(
    s: FloatArray, t: float, u: FloatArray, side: FloatArray, rest: FloatArray, x0: FloatArray, bodies: FloatArray,
    up: FloatArray, b: FloatArray, p: FloatArray, tables: FloatArray, room: FloatArray, mass: FloatArray,
    out: FloatArray, need: FloatArray,
) -> None:  # fmt: skip
    """Rates (n, STATES) of a state; need (n,) : what friction has to hold at joints that rest (side 0).

    rest : angles that the joints' own positions count from. room (3, m + 1, 3, 3), the first the base's frame, and mass
    (n + 4, n) : to work in.
    """
    n = len(s)
    frames, arms, w = room[0], room[1], room[2]
    inertia, free, gain = mass[:n], mass[n], mass[n + 1]
    none, one, still = mass[n + 2], mass[n + 3], np.zeros(3)
    none[:] = 0.0
    for j in range(n):
        free[j], gain[j], one[j] = rest[j] + s[j, X], s[j, V], 0.0
    _place(bodies, free, frames, arms)
    _torques(bodies, gain, none, up, _FIRST, frames, arms, w, need)
    for j in range(n):
        one[j] = 1.0
        # what joints before it feel is by symmetry what it feels of them
        _torques(bodies, none, one, still, j, frames, arms, w, inertia[j])
        one[j] = 0.0
        for k in range(j):
            inertia[j, k] = inertia[k, j]
    for j in range(n):
        net = _rates(s[j], t, u[j], side[j], HELD, x0[j], b[j], p[j], tables, out[j])
        if p[j, BRISTLE] == 0.0:
            net -= side[j] * dry(s[j, X], s[j, V], t, s[j, WORK], b[j], p[j], tables)
        free[j] = net - need[j]
        need[j] = free[j]
    bound = inertia.copy()
    for j in range(n):
        if side[j] == 0.0 and p[j, BRISTLE] == 0.0:
            bound[j, :] = 0.0
            bound[:, j] = 0.0
            bound[j, j] = 1.0
            free[j] = 0.0
    _solved(bound, free, gain)
    for j in range(n):
        out[j, X], out[j, V] = s[j, V], gain[j]
        for k in range(n):
            need[j] -= inertia[j, k] * gain[k]


@compiled
def _step(
    s: FloatArray, t: float, h: float, u: FloatArray, side: FloatArray, rest: FloatArray, bodies: FloatArray,
    up: FloatArray, b: FloatArray, p: FloatArray, tables: FloatArray, room: FloatArray, mass: FloatArray, w: FloatArray,
    need: FloatArray,
) -> None:  # fmt: skip
    """One step of a state, into w[5]. w : room to work in, (6, n, STATES)."""
    n, x0 = len(s), _column(s, X)
    for stage in range(4):
        # at the beginning, twice halfway, and at the end
        into = 0.0 if stage == 0 else (h if stage == 3 else 0.5 * h)
        for j in range(n):
            if stage == 0:
                put(s[j], w[4, j])
            else:
                moved(s[j], into, w[stage - 1, j], w[4, j])
        _slowed(w[4], t + into, u, side, rest, x0, bodies, up, b, p, tables, room, mass, w[stage], need)
    for j in range(n):
        combined(s[j], h, w[0, j], w[1, j], w[2, j], w[3, j], w[5, j])


@compiled
def _column(s: FloatArray, at: int) -> FloatArray:
    """What all joints have at one place of their state (n, STATES), (n,)."""
    found = np.empty(len(s))
    for j in range(len(s)):
        found[j] = s[j, at]
    return found


@compiled
def _turned_back(w: FloatArray, side: FloatArray, p: FloatArray, slow: float) -> BoolArray:
    """Joints (n,) that a step carries beyond a reversal, or to one but for a speed."""
    found = np.empty(side.size, dtype=np.bool_)
    for j in range(side.size):
        found[j] = w[5, j, V] * side[j] < slow and side[j] != 0.0 and p[j, BRISTLE] == 0.0
    return found


@compiled
def _held_again(s: FloatArray, w: FloatArray, side: FloatArray, p: FloatArray) -> bool:
    """Whether some joints that came loose would be held again before they have moved: they stay at rest, in place."""
    back, found = _turned_back(w, side, p, 0.0), False
    for j in range(len(s)):
        if back[j] and s[j, V] == 0.0:
            side[j], found = 0.0, True
    return found


@compiled
def _let_go(
    s: FloatArray, t: float, u: FloatArray, side: FloatArray, rest: FloatArray, bodies: FloatArray, up: FloatArray,
    b: FloatArray, p: FloatArray, tables: FloatArray, room: FloatArray, mass: FloatArray, w: FloatArray,
    need: FloatArray,
) -> None:  # fmt: skip
    """Give joints that friction cannot hold a direction, in place, the one that is pulled most beyond it first."""
    for _ in range(len(s) + 1):
        _slowed(s, t, u, side, rest, _column(s, X), bodies, up, b, p, tables, room, mass, w[0], need)
        worst, which = 0.0, -1
        for j in range(len(s)):
            if side[j] == 0.0 and p[j, BRISTLE] == 0.0:
                over = abs(need[j]) - dry(s[j, X], 0.0, t, s[j, WORK], b[j], p[j], tables)
                if over > worst:
                    worst, which = over, j
        if which < 0:
            return
        side[which] = math.copysign(1.0, need[which])


@compiled
def _advance(
    s: FloatArray, side: FloatArray, t: float, h: float, u: FloatArray, rest: FloatArray, bodies: FloatArray,
    up: FloatArray, b: FloatArray, p: FloatArray, tables: FloatArray, room: FloatArray, mass: FloatArray, w: FloatArray,
    need: FloatArray,
) -> None:  # fmt: skip
    """Carry a state on by h, through reversals and rest."""
    n, left, tries = len(s), h, 0
    while left > 1e-12 * h and tries < 200:
        tries += 1
        _let_go(s, t, u, side, rest, bodies, up, b, p, tables, room, mass, w, need)
        done, low, high = left, 0.0, left
        _step(s, t, done, u, side, rest, bodies, up, b, p, tables, room, mass, w, need)
        if _held_again(s, w, side, p):
            _step(s, t, done, u, side, rest, bodies, up, b, p, tables, room, mass, w, need)
        from_v, to_v = _column(s, V), _column(w[5], V)
        for _ in range(_SECANTS):
            # where the first joint turns, by straight lines between speeds before and after
            first = np.inf
            for j in range(n):
                if to_v[j] * side[j] < 0.0 and p[j, BRISTLE] == 0.0:
                    first = min(first, low + (high - low) * from_v[j] / (from_v[j] - to_v[j]))
            if first == np.inf:
                break
            done = max(first, 1e-4 * left)
            _step(s, t, done, u, side, rest, bodies, up, b, p, tables, room, mass, w, need)
            if np.any(_turned_back(w, side, p, 0.0)):
                high, to_v = done, _column(w[5], V)
            else:
                low, from_v = done, _column(w[5], V)
        if done < left:
            stops = _turned_back(w, side, p, _SLOW)
            for j in range(n):
                if stops[j]:
                    w[5, j, V], side[j] = 0.0, 0.0
        _slip(s, w[5], t, b, p, tables)
        for j in range(n):
            put(w[5, j], s[j])
        t, left = t + done, left - done


@compiled
def _slip(s: FloatArray, to: FloatArray, t: float, b: FloatArray, p: FloatArray, tables: FloatArray) -> None:
    """Move the elements of bristles along with a step, each as far as it holds, in place."""
    for j in range(len(s)):
        if p[j, BRISTLE] != 0.0 and p[j, BRISTLE_FORM] == 0.0:
            most = dry(to[j, X], to[j, V], t, s[j, WORK], b[j], p[j], tables) / _MANY
            for e in range(_MANY):
                one = s[j, ELEMENTS + e] + most * (e + 1.0) / p[j, BRISTLE] * (to[j, X] - s[j, X])
                to[j, ELEMENTS + e] = min(max(one, -most), most)


@compiled
def controlled(
    goal: FloatArray, speed: FloatArray, ahead: FloatArray, count: float, gains: FloatArray, dt: float, fine: int,
    rest: FloatArray, bodies: FloatArray, up: FloatArray, b: FloatArray, p: FloatArray, tables: FloatArray,
) -> FloatArray:  # fmt: skip
    """Motion (m, n, 4): place, speed, acceleration, held torque, of loops on encoder counts along a goal (m, n).

    ahead (m, n) : torque that is fed forward. gains (n, 4) : kp, kd, ki, share of the speed's filter that is new each
    tick. rest (n,) : angles that places count from. b, p (n, ..) : as ``plant`` has them, of each joint.
    """
    m, n = goal.shape
    rows, s, w = np.empty((m, n, 4)), np.zeros((n, STATES)), np.empty((6, n, STATES))
    side, room, need, now = np.zeros(n), np.zeros((3, len(bodies) + 1, 3, 3)), np.empty(n), b.copy()
    mass, pace, total = np.zeros((n + 4, n)), np.zeros(n), np.zeros(n)
    u, before, h = np.zeros(n), np.empty(n), dt / fine
    for k in range(3):
        room[0, 0, k, k] = 1.0
    for j in range(n):
        s[j, X] = goal[0, j]
        before[j] = math.floor(s[j, X] / count + 0.5) * count
    for i in range(m):
        for j in range(n):
            seen = math.floor(s[j, X] / count + 0.5) * count
            off = goal[i, j] - seen
            pace[j] += gains[j, 3] * ((seen - before[j]) / dt - pace[j])
            before[j] = seen
            total[j] += off * dt
            u[j] = gains[j, 0] * off + gains[j, 1] * (speed[i, j] - pace[j]) + gains[j, 2] * total[j] + ahead[i, j]
            if p[j, GEAR] != 0.0:
                # what the teeth carry beyond their preload
                now[j, 3] = b[j, 3] + p[j, GEAR] * (math.sqrt(u[j] ** 2 + p[j, GEAR_U] ** 2) - p[j, GEAR_U])
        _let_go(s, i * dt, u, side, rest, bodies, up, now, p, tables, room, mass, w, need)
        for j in range(n):
            rows[i, j, 0], rows[i, j, 1], rows[i, j, 2], rows[i, j, 3] = s[j, X], s[j, V], w[0, j, V], u[j]
        for k in range(fine):
            _advance(s, side, i * dt + k * h, h, u, rest, bodies, up, now, p, tables, room, mass, w, need)
    return rows
