"""One arm clean, with one effect in one joint, and with one error of the model: what was put in, what was found."""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from benchmarks.robot_calibrate.limit import Limit, Path
from benchmarks.robot_calibrate.plant import JOINTS, Friction, Motion, Plant, seven_joints
from harness.core.arrays import FloatArray
from harness.robot.arm import Arm
from harness.robot.whole_arm.columns import (
    ASYMMETRIC,
    DELAY,
    DRIFT,
    INERTIA,
    LOAD,
    MOTOR,
    PAYLOAD,
    POSITION,
    POWER,
    QUADRATIC,
    RIPPLE,
    STRIBECK,
    ZERO,
)
from harness.robot.whole_arm.perturb import moving_bodies, with_load, with_mass, with_zeros
from harness.robot.whole_arm.result import WholeArm
from harness.robot.whole_arm.turning import BACKLASH, PRESLIDING, STATIC, bristles
from harness.robot.whole_arm.whole import whole_arm

LOWPASS, SECONDS, RATE = 15.0, 20.0, 1000.0
NOISE = 0.01
GRAVITY_JOINTS = (1, 3, 5)
MEMORY = 0.01
"""s: of the torque's noise in every second draw; the others' is white at the log's rate."""


@dataclass(frozen=True, slots=True)
class Clean:
    """errors, claimed, bounds (7, 2) : of Coulomb and viscous friction, shares of the true value.

    left_out : evidence of the best candidate not named. named : what was.
    """

    errors: FloatArray
    left_out: float
    claimed: FloatArray
    bounds: FloatArray
    named: tuple[tuple[str, str | None], ...]


@dataclass(frozen=True, slots=True)
class Found:
    """put_in : its name. limit : what a likelihood could gain. named : by its own name, or its pair's. listed : as one
    of several. besides : other names.
    """

    put_in: str
    limit: float
    named: bool
    listed: bool
    besides: tuple[tuple[str, str | None], ...]


@dataclass(frozen=True, slots=True)
class Draw:
    """The three arms of one draw; None for those that were not asked for."""

    clean: Clean | None
    effect: Found | None
    error: Found | None


KINDS = ("clean", "effect", "error")


Aim = tuple[float, float]
"""Of an effect's limit, from and to: its size is chosen so that it lies there, evenly in its logarithm."""


def draw(seed: int, number: int, kinds: Sequence[str] = KINDS, noise: float = NOISE, aim: Aim | None = None) -> Draw:
    """The draw of this number; noise : of the torque, a share of its rms. aim : for effects whose size is their own."""
    rng = np.random.default_rng((seed, number))
    arm = seven_joints()
    plant = replace(Plant.drawn(rng, arm), memory=MEMORY if number % 2 else 0.0, noise=noise)
    motion = Motion.drawn(rng)
    own = dict(zip(KINDS, rng.integers(2**63, size=len(KINDS)), strict=True))
    clean, effect, error = (np.random.default_rng(int(own[kind])) for kind in KINDS)
    return Draw(
        _clean(plant, motion, arm, clean) if "clean" in kinds else None,
        _effect(plant, motion, arm, effect, aim) if "effect" in kinds else None,
        _error(plant, motion, arm, error) if "error" in kinds else None,
    )


def _seen(plant: Plant, motion: Motion, arm: Arm, rng: np.random.Generator) -> WholeArm:
    return whole_arm(plant.log(rng, motion, SECONDS, RATE), arm, lowpass=LOWPASS)


def _clean(plant: Plant, motion: Motion, arm: Arm, rng: np.random.Generator) -> Clean:
    found = _seen(plant, motion, arm, rng)
    truth = np.stack((plant.coulomb, plant.viscous), axis=1)
    values = np.array([[j.coulomb.value, j.viscous.value] for j in found.joints], dtype=np.float64)
    claimed = np.array([[j.coulomb.stderr, j.viscous.stderr] for j in found.joints], dtype=np.float64)
    path = Path.of(plant, motion, SECONDS, RATE)
    bounds = [Limit(path, LOWPASS, j).bounds[:2] for j in range(JOINTS)]
    return Clean((values - truth) / truth, found.left_out, claimed / truth, np.array(bounds) / truth, found.named)


def _effect(plant: Plant, motion: Motion, arm: Arm, rng: np.random.Generator, aim: Aim | None) -> Found:
    name = str(rng.choice([one for one in EFFECTS if aim is None or one not in _AS_LARGE_AS_FRICTION]))
    joint = int(rng.choice(GRAVITY_JOINTS if name in (LOAD, BACKLASH) else range(JOINTS)))
    effect = EFFECTS[name](rng, float(plant.coulomb[joint]))
    limit = Limit(Path.of(plant, motion, SECONDS, RATE), LOWPASS, joint)
    gain = limit.gain(effect(limit.t, limit.q, limit.v, limit.gravity))
    if aim is not None:
        wanted = float(np.exp(rng.uniform(*np.log(aim))))
        effect, gain = _scaled(effect, math.sqrt(wanted / gain)), wanted
    found = _seen(replace(plant, effects={joint: effect}), motion, arm, rng)
    own = (name, f"joint{joint + 1}")
    listed = any(name in e.rivals for e in found.joints[joint].effects)
    listed |= any(name in e.rivals for e in found.model if e.joint in (None, own[1]))
    return Found(name, gain, own in found.named, listed, tuple(n for n in found.named if n != own))


def _scaled(effect: Friction, by: float) -> Friction:
    """The same shape at another size: what a likelihood could gain goes with the square."""
    return lambda t, q, v, g: by * effect(t, q, v, g)


def _share(rng: np.random.Generator, coulomb: float, least: float = 0.01, most: float = 0.5) -> float:
    """N m: a share of Coulomb friction, of either sign."""
    return float(coulomb * np.exp(rng.uniform(math.log(least), math.log(most))))


def _stribeck(rng: np.random.Generator, coulomb: float) -> Friction:
    size, v_s = _share(rng, coulomb), rng.uniform(0.1, 0.4)
    return lambda t, q, v, g: size * np.sign(v) * np.exp(-((v / v_s) ** 2))


def _load(rng: np.random.Generator, coulomb: float) -> Friction:
    size = float(np.exp(rng.uniform(math.log(0.002), math.log(0.1))))
    return lambda t, q, v, g: size * np.abs(g) * np.sign(v)


def _ripple(rng: np.random.Generator, coulomb: float) -> Friction:
    size, wave, phase = _share(rng, coulomb, 0.005, 0.3), rng.uniform(4.0, 25.0), rng.uniform(0, 2 * math.pi)
    return lambda t, q, v, g: size * np.sin(wave * q + phase)


def _position(rng: np.random.Generator, coulomb: float) -> Friction:
    size, wave, phase = _share(rng, coulomb), rng.uniform(1.5, 8.0), rng.uniform(0, 2 * math.pi)
    return lambda t, q, v, g: size * np.sign(v) * np.sin(wave * q + phase)


def _asymmetric(rng: np.random.Generator, coulomb: float) -> Friction:
    size = _share(rng, coulomb) * float(rng.choice((-1.0, 1.0)))
    return lambda t, q, v, g: size * np.abs(v)


def _quadratic(rng: np.random.Generator, coulomb: float) -> Friction:
    size = _share(rng, coulomb)
    return lambda t, q, v, g: size * v * np.abs(v)


def _power(rng: np.random.Generator, coulomb: float) -> Friction:
    size, exponent = _share(rng, coulomb), rng.uniform(0.2, 0.8)
    return lambda t, q, v, g: size * np.sign(v) * np.abs(v) ** exponent


def _drift(rng: np.random.Generator, coulomb: float) -> Friction:
    size = _share(rng, coulomb) * float(rng.choice((-1.0, 1.0)))
    return lambda t, q, v, g: size * np.sign(v) * t / SECONDS


def _presliding(rng: np.random.Generator, coulomb: float) -> Friction:
    length = float(np.exp(rng.uniform(math.log(0.001), math.log(0.02))))
    return lambda t, q, v, g: coulomb * (bristles(q, length) - np.sign(v))


def _static(rng: np.random.Generator, coulomb: float) -> Friction:
    size, v_s = _share(rng, coulomb, 0.1), rng.uniform(0.03, 0.06)
    return lambda t, q, v, g: size * np.sign(v) * np.exp(-((v / v_s) ** 2))


def _backlash(rng: np.random.Generator, coulomb: float) -> Friction:
    return loose(float(np.exp(rng.uniform(math.log(0.002), math.log(0.02)))))


def loose(gap: float) -> Friction:
    """No load after a reversal until the gap, rad, is crossed."""

    def missing(t: FloatArray, q: FloatArray, v: FloatArray, g: FloatArray) -> FloatArray:
        turn = np.flatnonzero(np.sign(v[1:]) != np.sign(v[:-1])) + 1
        marks = np.zeros(q.size, dtype=np.int64)
        marks[turn] = turn
        last = np.maximum.accumulate(marks)
        return np.asarray(-g * ((np.abs(q - q[last]) < gap) & (last > 0)))

    return missing


EFFECTS: dict[str, Callable[[np.random.Generator, float], Friction]] = {
    STRIBECK: _stribeck,
    LOAD: _load,
    RIPPLE: _ripple,
    POSITION: _position,
    ASYMMETRIC: _asymmetric,
    QUADRATIC: _quadratic,
    POWER: _power,
    DRIFT: _drift,
    PRESLIDING: _presliding,
    STATIC: _static,
    BACKLASH: _backlash,
}
_AS_LARGE_AS_FRICTION = (PRESLIDING, BACKLASH)
"""How much torque is missing is no number of theirs: only over what distance."""


def _error(plant: Plant, motion: Motion, arm: Arm, rng: np.random.Generator) -> Found:
    name = str(rng.choice((INERTIA, PAYLOAD, MOTOR, DELAY, ZERO)))
    if name == INERTIA:
        wrong = arm
        for body in moving_bodies(arm):
            wrong = with_mass(wrong, body, float(rng.choice((0.9, 1.1))))
        plant = replace(plant, arm=wrong)
    elif name == PAYLOAD:
        plant = replace(plant, arm=with_load(arm, 0.5, rng.uniform(-0.05, 0.05, 3)))
    elif name == MOTOR:
        gain = np.ones(JOINTS)
        gain[rng.integers(JOINTS)] = rng.choice((0.9, 1.1))
        plant = replace(plant, gain=gain)
    elif name == ZERO:
        shift = np.zeros(JOINTS)
        shift[rng.integers(1, JOINTS)] = rng.choice((-0.03, 0.03))
        plant = replace(plant, arm=with_zeros(arm, shift))
    else:
        plant = replace(plant, late=float(rng.uniform(0.005, 0.015)))
    found = _seen(plant, motion, arm, rng)
    own = [e for e in found.model if name in e.members]
    listed = any(name in e.rivals for e in found.model)
    besides = tuple(n for n in found.named if n not in {(e.name, e.joint) for e in own})
    return Found(name, math.inf, bool(own), listed, besides)
