"""Logs of a simulated arm of seven joints whose friction is known, for tests of friction from a whole arm."""

from dataclasses import replace
from functools import cache

import numpy as np

from benchmarks.robot_calibrate.plant import JOINTS, Friction, Motion, Plant, seven_joints
from harness.core.arrays import FloatArray
from harness.core.robot import JointLog
from harness.robot.arm import Arm

SECONDS, RATE, LOWPASS = 12.0, 250.0, 15.0
NAMES = tuple(f"joint{i + 1}" for i in range(JOINTS))


@cache
def arm() -> Arm:
    """The arm as its model has it."""
    return seven_joints()


def machine(seed: int = 3, quiet: bool = True) -> tuple[Plant, Motion]:
    """A machine and its motion; ``quiet`` : torque noise of a thousandth, an encoder of 2^20 counts."""
    rng = np.random.default_rng(seed)
    plant, motion = Plant.drawn(rng, arm()), Motion.drawn(rng)
    return (replace(plant, noise=1e-3, counts=2**20) if quiet else plant), motion


def log_of(plant: Plant, motion: Motion, seed: int = 5) -> JointLog:
    """What is recorded of it."""
    return plant.log(np.random.default_rng(seed), motion, SECONDS, RATE)


def with_effect(plant: Plant, joint: int, effect: Friction) -> Plant:
    """The machine with one more effect in a joint's friction."""
    return replace(plant, effects={joint: effect})


def of_joints(log: JointLog, names: tuple[str, ...], t: FloatArray | None = None) -> JointLog:
    """The log with joints in this order, and other stamps where they are given."""
    return JointLog(
        log.t if t is None else t,
        {name: log.position[name] for name in names},
        effort={name: log.effort[name] for name in names if name in log.effort},
        file=log.file,
    )
