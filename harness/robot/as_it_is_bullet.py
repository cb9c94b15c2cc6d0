"""A joint of the user's URDF as it is in PyBullet: loaded as it stands, the other joints held by strong motors."""

import math
from dataclasses import dataclass
from importlib.metadata import version
from pathlib import Path

import numpy as np
from lxml import etree

from harness.core.apart import Found, read_apart
from harness.core.errors import InputError
from harness.engines.pybullet import PybulletEngine, pybullet
from harness.robot.apart import ACCEPTED
from harness.robot.as_it_is import HELD, HELD_FOR, AsItIs, Gravity
from harness.robot.bare import bare_model
from harness.robot.bullet import opened

_SECONDS = 60
_COAST_STEPS, _GROWN = 400, 10.0
"""Steps for which a joint is looked at that was let go at 1 rad/s or m/s, and what it then never has."""


@dataclass(frozen=True, slots=True)
class InBullet:
    """creep : rad/s or m/s along the load. diverges : steps after which a joint let go was ten times as fast."""

    version: str
    dt: float
    creep: float | None
    diverges: int | None


def in_bullet(path: Path, joint: str, own: AsItIs, gravity: Gravity, preset: str, dt: float) -> InBullet:
    """The file in PyBullet. own : what MuJoCo makes of it. dt : of the tuned preset, s. Raises InputError."""
    _, about = read_apart(
        f"{__name__}:columns_of", path, ACCEPTED, seconds=_SECONDS, kept=True, joint=joint,
        gravity=(0.0, 0.0, -9.81) if gravity is None else gravity, friction=own.friction, load=own.load,
        pose=own.pose, tuned=preset == "tuned", dt=dt if preset == "tuned" else PybulletEngine.shipped_dt,
    )  # fmt: skip
    return InBullet(**about)


def columns_of(
    path: Path,
    joint: str,
    gravity: list[float],
    friction: float,
    load: float | None,
    pose: float | None,
    tuned: bool,
    dt: float,
) -> Found:
    """The reader."""
    text = etree.tostring(bare_model(path).root)
    with opened(text, dt, lambda said: InputError(str(path), said, ACCEPTED)) as (client, body, numbers):
        own = numbers[joint]
        for i in numbers.values():
            if tuned:
                pybullet.changeDynamics(body, i, linearDamping=0, angularDamping=0, physicsClientId=client)
            force = friction if i == own else HELD
            pybullet.setJointMotorControl2(
                body, i, pybullet.VELOCITY_CONTROL, targetVelocity=0, force=force, physicsClientId=client
            )

        def stepped(torque: float) -> tuple[float, float]:
            if torque:
                pybullet.setJointMotorControl2(body, own, pybullet.TORQUE_CONTROL, force=torque, physicsClientId=client)
            pybullet.stepSimulation(physicsClientId=client)
            q, v = pybullet.getJointState(body, own, physicsClientId=client)[:2]
            return float(q), float(v)

        creep = None
        if load is not None:
            pybullet.setGravity(*(gravity if pose is not None else (0, 0, 0)), physicsClientId=client)
            pybullet.resetJointState(body, own, pose or 0.0, 0.0, physicsClientId=client)
            steps = max(4, round(HELD_FOR / dt))
            places = [stepped(load if pose is None else 0.0)[0] for _ in range(steps)]
            creep = abs(places[-1] - places[steps // 2]) / (dt * (steps - 1 - steps // 2))
        pybullet.setGravity(0, 0, 0, physicsClientId=client)
        pybullet.setJointMotorControl2(body, own, pybullet.VELOCITY_CONTROL, force=0, physicsClientId=client)
        pybullet.resetJointState(body, own, 0.0, 1.0, physicsClientId=client)
        speeds = (abs(stepped(0.0)[1]) for _ in range(_COAST_STEPS))
        diverges = next((n for n, v in enumerate(speeds, 1) if not v < _GROWN), None)
    finite = None if creep is None or not math.isfinite(creep) else creep
    return {"none": np.zeros(0)}, {"version": version("pybullet"), "dt": dt, "creep": finite, "diverges": diverges}
