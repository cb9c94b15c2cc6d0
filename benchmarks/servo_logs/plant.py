"""Joints of an SO-101 under STS3215 servos, many at once: a plant in plain numpy that shares no code with the harness.

What is inside the servo is as it is there: an encoder of 4096 steps, a loop at 1 kHz with the duty in steps of 1/1000,
a goal in steps that arrives late, a supply that sags. Between two ticks of the loop the joint is carried by Heun's
method in two steps with friction of the sign of the speed; a joint whose speed turns round stops, and moves on only
when what pulls it is more than break-away.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
STEP = 2.0 * np.pi / 4096
TICK, PARTS = 1e-3, 2


@dataclass(frozen=True)
class Joints:
    """Many joints; each array (m,). inertia, armature : kg m^2. gravity : N m at its most, rest : rad, where it hangs.
    stall : N m/V, brake : N m s/rad, volts, sag : V, V lost at full duty. gain : duty/rad. delay : s. f_k, f_s : N m at
    speed and at rest, v_s : rad/s, c : N m s/rad, load : friction over what the gears carry. noise : rad.
    """

    inertia: Array
    armature: Array
    gravity: Array
    rest: Array
    stall: Array
    brake: Array
    volts: Array
    sag: Array
    gain: Array
    delay: Array
    f_k: Array
    f_s: Array
    v_s: Array
    c: Array
    load: Array
    noise: Array


def drawn(count: int, rng: np.random.Generator) -> Joints:
    """Joints about as an arm has them; a third has friction that grows with load, a third more friction at rest."""

    def one(low: float, high: float) -> Array:
        return np.exp(rng.uniform(np.log(low), np.log(high), count))

    f_k = one(0.02, 0.12)
    kind = rng.integers(0, 3, count)
    scale = one(0.85, 1.15)
    return Joints(
        inertia=one(0.004, 0.05),
        armature=one(0.02, 0.04),
        gravity=one(0.15, 1.2),
        rest=rng.uniform(-np.pi, np.pi, count),
        stall=0.4527 * scale,
        brake=0.5486 * scale,
        volts=np.full(count, 7.4),
        sag=rng.uniform(0.0, 0.4, count),
        gain=np.full(count, 0.166 * 16.0),
        delay=rng.uniform(0.002, 0.03, count),
        f_k=f_k,
        f_s=f_k * np.where(kind == 1, rng.uniform(1.2, 1.6, count), 1.0),
        v_s=rng.uniform(0.05, 0.3, count),
        c=one(0.02, 0.08),
        load=np.where(kind == 2, rng.uniform(0.05, 0.2, count), 0.0),
        noise=STEP * rng.uniform(0.5, 1.5, count),
    )


def goals(t: Array, count: int, rng: np.random.Generator) -> Array:
    """Goals (n, count) as somebody leads an arm: from place to place, with rests, and some sums of sines between."""
    found = np.empty((t.size, count))
    for m in range(count):
        edges, places = [0.0], [rng.uniform(-0.8, 0.8)]
        while edges[-1] < t[-1]:
            move = rng.uniform(0.5, 2.0)
            edges += [edges[-1] + move, edges[-1] + move + rng.choice([0.0, rng.uniform(0.2, 1.0)])]
            places += [rng.uniform(-0.9, 0.9)] * 2
        at = np.searchsorted(edges, t, side="right") - 1
        ends = np.minimum(at + 1, len(edges) - 1)
        span = np.maximum(np.take(edges, ends) - np.take(edges, at), 1e-9)
        s = np.clip((t - np.take(edges, at)) / span, 0.0, 1.0)
        smooth = s**3 * (10.0 - 15.0 * s + 6.0 * s**2)
        found[:, m] = np.take(places, at) + smooth * (np.take(places, ends) - np.take(places, at))
        found[:, m] += 0.1 * np.sin(2.0 * np.pi * rng.uniform(0.3, 1.0) * t + rng.uniform(0.0, 6.0))
    return found


def moved(joints: Joints, t: Array, goal: Array, rng: np.random.Generator) -> tuple[Array, Array]:
    """Positions (n, m) as logged at t (n,), s, and as they were; goals (n, m) are sent at these times."""
    sent = np.round(goal / STEP) * STEP
    ticks = int(np.ceil(t[-1] / TICK)) + 1
    q, v = sent[0].copy(), np.zeros(goal.shape[1])
    found, log, column = np.empty_like(goal), 0, np.arange(goal.shape[1])
    whole, h = joints.inertia + joints.armature, TICK / PARTS
    for tick in range(ticks):
        now = tick * TICK
        while log < t.size and t[log] <= now + 1e-9:
            found[log] = q - v * (now - t[log])
            log += 1
        at = np.clip(np.searchsorted(t, now - joints.delay, side="right") - 1, 0, None)
        error = sent[at, column] - np.round(q / STEP) * STEP
        duty = np.clip(np.round(1000.0 * joints.gain * error) / 1000.0, -0.97, 0.97)
        volts = joints.volts - joints.sag * np.abs(duty)
        for _ in range(PARTS):
            q, v = _carried(joints, whole, joints.stall * volts * duty, q, v, h)
    logged = np.round((found + joints.noise * rng.standard_normal(found.shape)) / STEP) * STEP
    return logged, found


def _carried(joints: Joints, whole: Array, drive: Array, q: Array, v: Array, h: float) -> tuple[Array, Array]:
    """Positions and speeds a small step later."""

    def force(q: Array, v: Array, side: Array) -> Array:
        motor = drive - joints.brake * v
        pull = motor - joints.gravity * np.sin(q - joints.rest)
        carried = joints.load * np.abs(joints.gravity * np.sin(q - joints.rest) + motor)
        dry = joints.f_k + (joints.f_s - joints.f_k) * np.exp(-((v / joints.v_s) ** 2)) + carried
        return (
            np.where(side == 0.0, np.sign(pull) * np.maximum(np.abs(pull) - dry, 0.0), pull - side * dry) - joints.c * v
        )

    side = np.sign(v)
    first = force(q, v, side) / whole
    guess = v + h * first
    side = np.where(side == 0.0, np.sign(guess), side)
    second = force(q + h * v, guess, side) / whole
    new = v + 0.5 * h * (first + second)
    new = np.where(new * side < 0.0, 0.0, new)
    return q + 0.5 * h * (v + new), new
