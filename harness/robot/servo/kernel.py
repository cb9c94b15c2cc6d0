"""The free run of a joint under its servo, compiled: from goals and a first state to positions.

    (inertia + armature) q'' = tau - gravity(q) - c q' - friction
    tau = stall V (1 - concave |duty|^p) duty - brake q',  |tau| <= most
    duty = clip(kp e - kd q', +-limit),  e = goal - q, less beside a dead band

Friction is Coulomb's, more at rest (Stribeck 1902, in the form of Bo and Pavelescu 1982), and grows with the torques
that the gears carry (Duclusaud et al. 2024, arXiv 2410.08650). A step is of second order, torques those halfway;
friction takes at most what stops the joint. With backlash the rotor is a body of its own that meets the link at either
end of the play and does not bounce; sensor and servo are on the link's side, where the encoders of such servos are.
"""

import math

from harness.core.arrays import FloatArray
from harness.core.jit import lean

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
GAUSSIAN = 2.0
"""Exponent of how friction at rest fades where nothing tells it."""
_TOUCHES = 0.999
"""Of the play, from which rotor and link touch."""


def _dry(theta: FloatArray, v: float, motor: float, outer: float) -> float:
    """Largest torque of dry friction, N m, under the motor's torque and that of the load."""
    carried = abs(theta[11] * outer - theta[10] * motor)
    dry = theta[7] + carried
    if theta[8] != 0.0 or theta[12] != 0.0:
        fast = abs(v) / theta[9]
        # the Gaussian's own square: any power costs as much as all the rest of a step
        dry += (theta[8] + theta[12] * abs(motor)) * math.exp(
            -(fast * fast if theta[22] == GAUSSIAN else fast ** theta[22])
        )
    return float(max(dry, 0.0))


dry_friction = lean(_dry)


def _slowed(v: float, most: float) -> float:
    """A speed after friction that takes at most so much of it."""
    return max(v - most, 0.0) + min(v + most, 0.0)


slowed = lean(_slowed)


def _acting(error: float, dead: float, power: float) -> float:
    """What of an error of position, rad, acts beside a dead band: what is beyond it, or with a power, the more abrupt
    the higher, in the end all of it."""
    if dead == 0.0 or power == 0.0:
        return slowed(error, dead)
    grown = math.pow(abs(error) / dead, power)
    return error * grown / (1.0 + grown)


acting = lean(_acting)


def _wanted(theta: FloatArray, h: float, goal: float, reached: float, pace: float) -> tuple[float, float]:
    """Where the servo's own goal is a step later, rad, and its speed: at most ``ramp``, taken up and left by ``haste``.

    Each is 0 where it bounds nothing. It stops in whole steps.
    """
    ramp, haste, off = theta[19], theta[25], goal - reached
    if ramp == 0.0 and haste == 0.0:
        return goal, 0.0
    if haste == 0.0:
        return min(max(goal, reached - ramp * h), reached + ramp * h), 0.0
    fast = haste * (math.sqrt(h * h + 2.0 * abs(off) / haste) - h)
    fast = math.copysign(min(fast, ramp) if ramp > 0.0 else fast, off)
    pace += min(max(fast - pace, -haste * h), haste * h)
    return reached + h * pace, pace


wanted = lean(_wanted)


def _driven(theta: FloatArray, error: float, v: float, volts: float) -> tuple[float, float]:
    """The motor's torque as drive - drag v, N m and N m s/rad, at an error of position, rad."""
    kp, kd, limit, most = theta[1], theta[2], theta[3], theta[20]
    duty = kp * error - kd * v
    gain = theta[0] * volts
    if theta[21] != 0.0:
        gain *= 1.0 - theta[21] * min(abs(duty), limit) ** theta[23]
    drive, drag = gain * kp * error, theta[4] + gain * kd
    if abs(duty) > limit:
        drive, drag = gain * (limit if duty > 0.0 else -limit), theta[4]
    torque = drive - drag * v
    if most > 0.0 and abs(torque) > most:
        drive, drag = (most if torque > 0.0 else -most), 0.0
    return drive, drag


driven = lean(_driven)


def _turned(
    theta: FloatArray, h: float, inertia: float, v: float, drive: float, drag: float, more: float, outer: float
) -> float:
    """Speed a step later of an inertia under the motor's torque drive - drag v, a damping ``more`` and a torque that is
    given, N m.

    Second order and damped however long the step: Pade's (0, 2) of the exponential. Friction is that of the speed
    halfway, of which a first step with that at the begin tells.
    """
    x = h * (drag + more) / inertia
    whole = 1.0 + x + 0.5 * x * x
    force = h * (1.0 + 0.5 * x) / (inertia * whole)
    free, now = v / whole + force * (drive + outer), v
    v = slowed(free, force * dry_friction(theta, now, drive - drag * now, outer))
    if theta[8] != 0.0 or theta[10] != 0.0 or theta[12] != 0.0:
        now = 0.5 * (now + v)
        v = slowed(free, force * dry_friction(theta, now, drive - drag * now, outer))
    return v


turned = lean(_turned)


def _moved_apart(
    theta: FloatArray, h: float, link: float, state: FloatArray, drive: float, drag: float, outer: float
) -> None:
    """State (4,): position and speed of link and rotor, a step later, with play between them; gears are the rotor's."""
    rotor, play = theta[5], 0.5 * theta[15]
    q, v, angle, spin = state[0], state[1], state[2], state[3]
    v_before, spin_before, apart = v, spin, angle - q
    # whether they part: without friction, which holds the rotor alone
    alone, free = (rotor * spin + h * drive) / (rotor + h * (drag + theta[6])), v + h * outer / link
    if abs(apart) >= _TOUCHES * play and (alone - free) * apart >= 0.0:
        both = (rotor * spin + link * v) / (rotor + link)  # pressed together
        v = turned(theta, h, link + rotor, both, drive, drag, theta[6], outer)
        spin = v
    else:
        spin, v = turned(theta, h, rotor, spin, drive, drag, theta[6], 0.0), free
    q += 0.5 * h * (v_before + v)
    angle += 0.5 * h * (spin_before + spin)
    if abs(angle - q) > play:
        angle = q + (play if angle > q else -play)
        v = (rotor * spin + link * v) / (rotor + link)
        spin = v
    state[0], state[1], state[2], state[3] = q, v, angle, spin


moved_apart = lean(_moved_apart)


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
    later from its own time on, so that the run is smooth in it.
    """
    delay, dead, play, zero = theta[13], theta[14], theta[15], theta[16]
    state[0] -= zero
    state[2] -= zero
    out[0] = state[0] + zero
    at = begin
    while at > 0 and t[at] > t[begin] - delay:
        at -= 1
    reached, pace, bounded = goal[at], 0.0, theta[19] != 0.0 or theta[25] != 0.0
    for i in range(1, out.size):
        k = begin + i - 1
        steps = max(math.ceil((t[k + 1] - t[k]) / STEP - 1e-9), 1)
        h = (t[k + 1] - t[k]) / steps
        sine, cosine = load[k, 1] + theta[17], load[k, 2] + theta[18]
        for j in range(steps):
            done = t[k] + j * h - delay
            end = done + h
            while done < end:
                # a goal that comes within a step divides it: beside a limit its mean would drive otherwise
                while at + 1 < t.size and t[at + 1] <= done:
                    at += 1
                until = min(end, t[at + 1]) if at + 1 < t.size else end
                part, done = until - done, until
                before = reached
                reached, pace = wanted(theta, part, goal[at], reached, pace)
                sent = 0.5 * (before + reached) if bounded else reached
                v = state[1]
                half = state[0] + 0.5 * part * v
                drive, drag = 0.0, 0.0
                if on[k] != 0.0:
                    drive, drag = driven(theta, acting(sent - zero - half, dead, theta[24]), v, volts[k])
                outer = -(sine * math.sin(half) + cosine * math.cos(half))
                if play == 0.0:
                    state[1] = turned(theta, part, load[k, 0] + theta[5], v, drive, drag, theta[6], outer)
                    state[0] += 0.5 * part * (v + state[1])
                else:
                    moved_apart(theta, part, load[k, 0], state, drive, drag, outer)
        out[i] = state[0] + zero


free_run = lean(_free_run)
