"""Arms of known friction that follow sums of sines under a controller, and what is logged of them.

The controller computes at 1 kHz (or at the engine's step), from encoder counts, a torque that acts one tick later and
is held until the next: inverse dynamics of the way asked for, part of the friction, position and speed errors. So a
joint sticks at its reversals, and swings a little as it comes loose.

sticking : friction by Dahl's law, a bristle of 2e-5 rad, its motion by MuJoCo at 0.1 ms.
mujoco : frictionloss and damping of MuJoCo as shipped, at 2 ms, with the integrator drawn.
pybullet : a velocity motor of no speed as dry friction, jointDamping, at 1/240 s.
"""

import copy
import math
from collections.abc import Callable
from dataclasses import dataclass, replace

import mujoco
import numpy as np

from benchmarks.robot_calibrate.plant import JOINTS, Motion, Plant, seven_joints
from harness.core.arrays import FloatArray
from harness.core.robot import JointLog
from harness.robot.arm import Arm
from harness.robot.replay.as_urdf import of_model
from harness.robot.whole_arm.perturb import loaded_bodies, with_load

BRISTLE = 2e-5
"""rad."""
SECONDS = 20.0
_TICK, _STEP = 1e-3, 1e-4
_MUJOCO, _BULLET = 2e-3, 1.0 / 240.0
_STABLE = 0.3
_START = 1.0
"""s before the log begins, in which the arm comes onto its way."""
KINDS = ("sticking", "mujoco", "pybullet")


@dataclass(frozen=True, slots=True)
class Controller:
    """forward : share of dry friction that is fed forward. stiff, damped (7, 7) : N m/rad, N m s/rad. counts : of the
    encoder, a turn. filtered : s, of the speed that is differenced from them."""

    arm: Arm
    motion: Motion
    forward: float
    coulomb: FloatArray
    stiff: FloatArray
    damped: FloatArray
    counts: int
    filtered: float

    @classmethod
    def drawn(cls, rng: np.random.Generator, plant: Plant, motion: Motion, bandwidth: float) -> "Controller":
        """Of a bandwidth, rad/s, over what each joint moves."""
        arm = plant.arm
        inertia = _mass_matrix(arm, motion.middle)
        omega = bandwidth * rng.uniform(0.7, 1.3)
        return cls(
            arm,
            motion,
            float(rng.uniform(0.0, 0.8)),
            plant.coulomb,
            inertia * omega**2,
            inertia * 1.4 * omega,
            int(2 ** rng.integers(16, 21)),
            2e-3,
        )

    def wanted(self, t: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Positions, speeds, and torques fed forward, (n, 7)."""
        q, v, a = self.motion.at(t)
        torque = self.arm.inverse(q, v, a) + self.forward * self.coulomb * np.tanh(v / 0.01)
        return q, v, torque


def _mass_matrix(arm: Arm, q: FloatArray) -> FloatArray:
    data, found = mujoco.MjData(arm.model), np.zeros((JOINTS, JOINTS))
    data.qpos[:] = q
    mujoco.mj_forward(arm.model, data)
    mujoco.mj_fullM(arm.model, data, found)
    return found


Advance = Callable[[FloatArray], tuple[FloatArray, FloatArray]]
"""One tick under a torque (7,); position and speed after it."""


def _driven(control: Controller, tick: float, first: FloatArray, advance: Advance) -> tuple[FloatArray, ...]:
    """t (n,), counted positions and torques (n, 7) at every tick: what the bus says of one."""
    size = round((SECONDS + _START) / tick) + 1
    t: FloatArray = np.arange(size, dtype=np.float64) * tick
    want_q, want_v, ahead = control.wanted(t)
    step = 2.0 * math.pi / control.counts
    kept = math.exp(-tick / control.filtered)
    q, last, speed = first, np.round(first / step) * step, want_v[0]
    torque = ahead[0]
    positions, torques = np.empty((size, JOINTS)), np.empty((size, JOINTS))
    for k in range(size):
        seen = np.round(q / step) * step
        speed = kept * speed + (1.0 - kept) * (seen - last) / tick if k else speed
        last = seen
        positions[k], torques[k] = seen, torque
        following = ahead[k] + control.stiff @ (want_q[k] - seen) + control.damped @ (want_v[k] - speed)
        q, _ = advance(torque)
        torque = following
    return t, positions, torques


def sticking(plant: Plant, control: Controller) -> tuple[FloatArray, ...]:
    """The plant that sticks."""
    model = copy.copy(plant.arm.model)
    model.opt.timestep = _STEP
    model.opt.integrator = mujoco.mjtIntegrator.mjINT_EULER.value
    model.opt.disableflags = mujoco.mjtDisableBit.mjDSBL_CONTACT.value | mujoco.mjtDisableBit.mjDSBL_LIMIT.value
    data = mujoco.MjData(model)
    q, v, _ = control.motion.at(np.zeros(1))
    data.qpos[:], data.qvel[:] = q[0], v[0]
    bend = BRISTLE * np.sign(v[0])
    inner = round(_TICK / _STEP)
    inertia = np.diag(_mass_matrix(plant.arm, q[0]))
    # a bristle without any damping of its own rings for as long as the joint sticks
    inside = 0.3 * np.sqrt(plant.coulomb / BRISTLE * inertia)

    def advance(torque: FloatArray) -> tuple[FloatArray, FloatArray]:
        nonlocal bend
        for _ in range(inner):
            speed = data.qvel
            to = BRISTLE * np.sign(speed)
            after = to + (bend - to) * np.exp(-np.abs(speed) * (_STEP / BRISTLE))
            rate, bend = (after - bend) / _STEP, after
            friction = plant.coulomb / BRISTLE * bend + inside * rate + plant.viscous * speed + plant.offset
            data.qfrc_applied[:] = torque - friction
            mujoco.mj_step(model, data)
        return np.array(data.qpos), np.array(data.qvel)

    return _driven(control, _TICK, q[0], advance)


def in_mujoco(plant: Plant, control: Controller, integrator: int) -> tuple[FloatArray, ...]:
    """MuJoCo's own friction and damping, as shipped."""
    model = copy.copy(plant.arm.model)
    model.opt.timestep, model.opt.integrator = _MUJOCO, integrator
    model.opt.disableflags = mujoco.mjtDisableBit.mjDSBL_CONTACT.value | mujoco.mjtDisableBit.mjDSBL_LIMIT.value
    model.dof_frictionloss[:], model.dof_damping[:] = plant.coulomb, plant.viscous
    data = mujoco.MjData(model)
    q, v, _ = control.motion.at(np.zeros(1))
    data.qpos[:], data.qvel[:] = q[0], v[0]

    def advance(torque: FloatArray) -> tuple[FloatArray, FloatArray]:
        data.qfrc_applied[:] = torque - plant.offset
        mujoco.mj_step(model, data)
        return np.array(data.qpos), np.array(data.qvel)

    return _driven(control, _MUJOCO, q[0], advance)


def in_pybullet(plant: Plant, control: Controller) -> tuple[FloatArray, ...]:
    """PyBullet's velocity motors and joint damping."""
    import tempfile
    from pathlib import Path

    import pybullet

    client = pybullet.connect(pybullet.DIRECT)
    try:
        with tempfile.TemporaryDirectory() as folder:
            file = Path(folder) / "arm.urdf"
            file.write_bytes(of_model(plant.arm, "joint1", 0.0).text)
            flags = pybullet.URDF_USE_INERTIA_FROM_FILE
            body = pybullet.loadURDF(str(file), useFixedBase=True, flags=flags, physicsClientId=client)
        names = [pybullet.getJointInfo(body, i, client)[1].decode() for i in range(pybullet.getNumJoints(body, client))]
        at = [names.index(name) for name in plant.arm.joints]
        pybullet.setPhysicsEngineParameter(
            numSolverIterations=200, solverResidualThreshold=1e-12, physicsClientId=client
        )
        pybullet.setGravity(0.0, 0.0, -9.81, client)
        pybullet.setTimeStep(_BULLET, client)
        q, v, _ = control.motion.at(np.zeros(1))
        for j, i in enumerate(at):
            pybullet.resetJointState(body, i, float(q[0, j]), float(v[0, j]), client)
        for i in range(len(names)):
            pybullet.changeDynamics(
                body, i, linearDamping=0.0, angularDamping=0.0, jointDamping=0.0, physicsClientId=client
            )
        for j, i in enumerate(at):
            pybullet.changeDynamics(body, i, jointDamping=float(plant.viscous[j]), physicsClientId=client)
            pybullet.setJointMotorControl2(
                body,
                i,
                pybullet.VELOCITY_CONTROL,
                targetVelocity=0.0,
                force=float(plant.coulomb[j]),
                physicsClientId=client,
            )

        def advance(torque: FloatArray) -> tuple[FloatArray, FloatArray]:
            for j, i in enumerate(at):
                pybullet.setJointMotorControl2(
                    body, i, pybullet.TORQUE_CONTROL, force=float(torque[j] - plant.offset[j]), physicsClientId=client
                )
            pybullet.stepSimulation(client)
            states = pybullet.getJointStates(body, at, client)
            return np.array([one[0] for one in states]), np.array([one[1] for one in states])

        return _driven(control, _BULLET, q[0], advance)
    finally:
        pybullet.disconnect(client)


@dataclass(frozen=True, slots=True)
class Clean:
    """A log, the arm as its user has it, and the friction behind it. kind : of KINDS."""

    kind: str
    log: JointLog
    arm: Arm
    plant: Plant
    said: str


def clean(
    seed: int, number: int, kind: str, kg: float = 0.0, beside: FloatArray | None = None, inwards: int = 0
) -> Clean:
    """The clean log of this number; the torque has noise of 1 % in one of two, and is rounded as a bus does.

    kg, beside (3,), m : of a load that the arm carries beside a body's centre of mass, unknown to its user; inwards :
    how many joints before its last one that is.
    """
    rng = np.random.default_rng((seed, number, KINDS.index(kind)))
    arm = seven_joints(0.0 if kind == "pybullet" else 0.1)
    plant = Plant.drawn(rng, arm)
    if kg > 0.0:
        plant = replace(plant, arm=with_load(arm, kg, beside, loaded_bodies(arm, inwards + 1)[-1]))
    motion = Motion.drawn(rng, fast=bool(rng.integers(2)))
    if kind == "pybullet":
        # its joints' damping is explicit, and runs away from twice the inertia a step on
        most = _STABLE * np.diag(_mass_matrix(arm, motion.middle)) / _BULLET
        plant = replace(plant, viscous=np.minimum(plant.viscous, most))
    bandwidth = float(np.exp(rng.uniform(math.log(10.0), math.log(40.0))))
    control = Controller.drawn(rng, plant, motion, bandwidth)
    if kind == "sticking":
        t, q, u = sticking(plant, control)
    elif kind == "mujoco":
        integrator = int(rng.choice((0, 2, 3)))
        t, q, u = in_mujoco(plant, control, integrator)
    else:
        t, q, u = in_pybullet(plant, control)
    every = int(rng.choice((1, 2, 4))) if kind == "sticking" else 1
    after = t >= _START
    t, q, u = (one[after][::every] for one in (t - _START, q, u))
    noise = 0.01 * float(rng.integers(2))
    size = np.sqrt(np.mean(u**2, axis=0))
    u = u + noise * size * rng.standard_normal(u.shape)
    bit = 2.0 ** np.ceil(np.log2(np.max(np.abs(u), axis=0))) / 2**14
    u = np.round(u / bit) * bit
    names = arm.joints
    log = JointLog(
        t - t[0],
        {n: q[:, i].copy() for i, n in enumerate(names)},
        effort={n: u[:, i].copy() for i, n in enumerate(names)},
    )
    said = f"{1.0 / t[1]:.0f} Hz, noise {noise}, {control.counts} counts, {bandwidth:.0f} rad/s"
    return Clean(kind, log, arm, plant, said)
