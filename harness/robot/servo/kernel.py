"""The free run of a joint under its servo, compiled: from goals and a first state to positions.

    (inertia + armature) q'' = tau - gravity(q) - c q' - friction
    tau = stall V (1 - concave |duty|^p) duty - brake q',  |tau| <= most
    duty = clip(kp e - kd q', +-limit),  e = goal - q, less beside a dead band

Friction is Coulomb's, more at rest (Stribeck 1902, in the form of Bo and Pavelescu 1982), and grows with the torques
that the gears carry (Duclusaud et al. 2024, arXiv 2410.08650). A step is semi-implicit: damping at its end, friction at
most what stops the joint. With backlash the rotor is a body of its own that meets the link at either end of the play
and does not bounce; sensor and servo are on the link's side, where the encoders of such servos are.
"""

import math

from harness.core.arrays import FloatArray
from harness.core.jit import compiled

NAMES = (
    *("stall", "kp", "kd", "limit", "brake", "armature", "c", "f_k", "f_s", "v_s"),
    *(
        "load_motor",
        "load_external",
        "load_rest",
        "delay",
        "dead",
        "play",
        "zero",
        "sine",
        "cosine",
        "ramp",
        "most",
        "concave",
        "exponent",
        "concave_power",
        "dead_power",
        "haste",
    ),
)
"""Numbers of a run in the order of the kernel's array; their units are in harness.robot.servo.plant."""
STEP = 2e-3
"""Longest step, s."""
_TOUCHES = 0.999
"""Of the play, from which rotor and link touch."""


def _dry(theta: FloatArray, v: float, motor: float, outer: float) -> float:
    """Largest torque of dry friction, N m, under the motor's torque and that of the load."""
    carried = abs(theta[11] * outer - theta[10] * motor)
    dry = theta[7] + carried
    if theta[8] != 0.0 or theta[12] != 0.0:
        dry += (theta[8] + theta[12] * abs(motor)) * math.exp(-((abs(v) / theta[9]) ** theta[22]))
    return float(max(dry, 0.0))


dry_friction = compiled(_dry)


def _slowed(v: float, most: float) -> float:
    """A speed after friction that takes at most so much of it."""
    return max(v - most, 0.0) + min(v + most, 0.0)


slowed = compiled(_slowed)


def _acting(error: float, dead: float, power: float) -> float:
    """What of an error of position, rad, acts beside a dead band: what is beyond it, or with a power, the more abrupt
    the higher, in the end all of it."""
    if dead == 0.0 or power == 0.0:
        return slowed(error, dead)
    grown = math.pow(abs(error) / dead, power)
    return error * grown / (1.0 + grown)


acting = compiled(_acting)


def _held(t: FloatArray, goal: FloatArray, at: int, begin: float, end: float) -> tuple[float, int]:
    """Mean of goals (n,), held from their times t (n,), s, over a span; and the last of them. at : the first."""
    total, done = 0.0, begin
    while at + 1 < t.size and t[at + 1] < end:
        if t[at + 1] > done:
            total += goal[at] * (t[at + 1] - done)
            done = t[at + 1]
        at += 1
    return (total + goal[at] * (end - done)) / (end - begin), at


held = compiled(_held)


def _wanted(theta: FloatArray, h: float, goal: float, reached: float, pace: float) -> tuple[float, float]:
    """Where the servo's own goal is a step later, rad, and its speed: at most ``ramp``, taken up and left by ``haste``.

    Each is 0 where it bounds nothing, and one of them bounds it. It stops in whole steps.
    """
    ramp, haste, off = theta[19], theta[25], goal - reached
    if haste == 0.0:
        return min(max(goal, reached - ramp * h), reached + ramp * h), 0.0
    fast = haste * (math.sqrt(h * h + 2.0 * abs(off) / haste) - h)
    fast = math.copysign(min(fast, ramp) if ramp > 0.0 else fast, off)
    pace += min(max(fast - pace, -haste * h), haste * h)
    return reached + h * pace, pace


wanted = compiled(_wanted)


def _asked(
    theta: FloatArray,
    t: FloatArray,
    goal: FloatArray,
    at: int,
    begin: float,
    end: float,
    reached: float,
    pace: float,
) -> tuple[float, float, int]:
    """The servo's own goal after a span of goals (n,) of times t (n,), s, with its speed and the last of those.

    Where nothing bounds its speed, their mean; else each counts from its own time on: a run is smooth in their delay.
    """
    if theta[19] == 0.0 and theta[25] == 0.0:
        mean, at = held(t, goal, at, begin, end)
        return mean, 0.0, at
    done = begin
    while at + 1 < t.size and t[at + 1] < end:
        if t[at + 1] > done:
            reached, pace = wanted(theta, t[at + 1] - done, goal[at], reached, pace)
            done = t[at + 1]
        at += 1
    reached, pace = wanted(theta, end - done, goal[at], reached, pace)
    return reached, pace, at


asked = compiled(_asked)


def _driven(theta: FloatArray, error: float, v: float, volts: float) -> tuple[float, float]:
    """The motor's torque as drive - drag v, N m and N m s/rad, at an error of position, rad."""
    kp, kd, limit, most = theta[1], theta[2], theta[3], theta[20]
    duty = kp * error - kd * v
    gain = theta[0] * volts * (1.0 - theta[21] * min(abs(duty), limit) ** theta[23])
    drive, drag = gain * kp * error, theta[4] + gain * kd
    if abs(duty) > limit:
        drive, drag = gain * (limit if duty > 0.0 else -limit), theta[4]
    torque = drive - drag * v
    if most > 0.0 and abs(torque) > most:
        drive, drag = (most if torque > 0.0 else -most), 0.0
    return drive, drag


driven = compiled(_driven)


def _moved(
    theta: FloatArray, h: float, link: float, q: float, v: float, motor: float, drive: float, drag: float, outer: float
) -> tuple[float, float]:
    """Position and speed a step later, rotor and link one body."""
    total = link + theta[5] + h * drag
    dry = dry_friction(theta, v, motor, outer)
    v = slowed(((link + theta[5]) * v + h * (drive + outer)) / total, h * dry / total)
    return q + h * v, v


moved = compiled(_moved)


def _moved_apart(
    theta: FloatArray,
    h: float,
    link: float,
    state: FloatArray,
    motor: float,
    drive: float,
    drag: float,
    outer: float,
) -> None:
    """State (4,): position and speed of link and rotor, a step later, with play between them; gears are the rotor's."""
    rotor, play = theta[5], 0.5 * theta[15]
    q, v, angle, spin = state[0], state[1], state[2], state[3]
    taken = h * dry_friction(theta, spin, motor, outer)
    total = rotor + h * drag
    alone, free, apart = (rotor * spin + h * drive) / total, v + h * outer / link, angle - q
    if abs(apart) >= _TOUCHES * play and (alone - free) * apart >= 0.0:
        total += link  # pressed together
        v = slowed((rotor * spin + link * v + h * (drive + outer)) / total, taken / total)
        spin = v
    else:
        spin, v = slowed(alone, taken / total), free
    q += h * v
    angle += h * spin
    if abs(angle - q) > play:
        angle = q + (play if angle > q else -play)
        v = (rotor * spin + link * v) / (rotor + link)
        spin = v
    state[0], state[1], state[2], state[3] = q, v, angle, spin


moved_apart = compiled(_moved_apart)


def _free_run(
    theta: FloatArray,
    t: FloatArray,
    goal: FloatArray,
    volts: FloatArray,
    on: FloatArray,
    load: FloatArray,
    begin: int,
    state: FloatArray,
    out: FloatArray,
) -> None:
    """Positions out (m,) at the samples from ``begin`` on; state (4,) : position and speed of link and rotor there.

    t, goal, volts, on (n,) : s, rad, V, 1 where the servo drives; each is held to the next sample. load (n, 3) :
    inertia without the rotor, kg m^2, and gravity's torque as sine and cosine of the angle, N m. A goal acts ``delay``
    later, as its mean over a step or from its own time on, so that the run is smooth in it.
    """
    delay, dead, play, zero = theta[13], theta[14], theta[15], theta[16]
    state[0] -= zero
    state[2] -= zero
    out[0] = state[0] + zero
    at = begin
    while at > 0 and t[at] > t[begin] - delay:
        at -= 1
    reached, pace = goal[at], 0.0
    for i in range(1, out.size):
        k = begin + i - 1
        steps = max(math.ceil((t[k + 1] - t[k]) / STEP - 1e-9), 1)
        h = (t[k + 1] - t[k]) / steps
        sine, cosine = load[k, 1] + theta[17], load[k, 2] + theta[18]
        for j in range(steps):
            now = t[k] + j * h - delay
            reached, pace, at = asked(theta, t, goal, at, now, now + h, reached, pace)
            q, v = state[0], state[1]
            drive, drag = 0.0, 0.0
            if on[k] != 0.0:
                drive, drag = driven(theta, acting(reached - zero - q, dead, theta[24]), v, volts[k])
            motor, outer = drive - drag * v, -(sine * math.sin(q) + cosine * math.cos(q))
            if play == 0.0:
                state[0], state[1] = moved(theta, h, load[k, 0], q, v, motor, drive, drag + theta[6], outer)
            else:
                moved_apart(theta, h, load[k, 0], state, motor, drive, drag + theta[6], outer)
        out[i] = state[0] + zero


free_run = compiled(_free_run)
