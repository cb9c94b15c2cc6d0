"""A joint of a model in PyBullet, driven by its log's torque; the other joints are led along the log."""

import mujoco
import numpy as np

from harness.core.arrays import FloatArray
from harness.core.errors import SimulationError
from harness.core.quiet import quiet
from harness.engines.pybullet import log, pybullet
from harness.robot.arm import Arm
from harness.robot.bullet import opened
from harness.robot.replay.as_urdf import ForBullet
from harness.robot.replay.drive import Drive

_LED = 1e9
"""N m with which a joint goes where it is led."""
_SOLVER = {"numSolverIterations": 100, "solverResidualThreshold": 1e-10}
_FASTEST = 1e9


def replay(arm: Arm, drive: Drive, text: ForBullet, zero: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Position and speed (n,) of the joint with the friction and damping that the model has for it.

    text : its URDF. zero (nv,) : positions at which that counts zero. nan outside of the windows.
    """
    at, name = drive.at, arm.joints[drive.at]
    q, v = np.full(drive.t.size, np.nan), np.full(drive.t.size, np.nan)
    u = drive.u + arm.armature[at] * _turning_with_parent(arm, drive)
    spring, slack = float(arm.model.jnt_stiffness[at]), float(arm.model.qpos_spring[at])
    weightless = arm.model.opt.disableflags & mujoco.mjtDisableBit.mjDSBL_GRAVITY.value

    def refused(said: str) -> SimulationError:
        return SimulationError(f"{arm.file}: {said}")

    with quiet(log), opened(text.text, drive.dt, refused, **_SOLVER) as (client, body, numbers):
        gravity = [0.0, 0.0, 0.0] if weightless else arm.model.opt.gravity.tolist()
        pybullet.setGravity(*gravity, physicsClientId=client)
        own, others = numbers[name], [numbers[arm.joints[i]] for i in drive.others]
        damping, friction = float(arm.damping[at]), float(arm.frictionloss[at])
        inertia = {} if text.inertia is None else {"localInertiaDiagonal": text.inertia.tolist()}
        for i in numbers.values():
            # jointDamping has no effect in a call that sets maxJointVelocity too
            pybullet.changeDynamics(body, i, maxJointVelocity=_FASTEST, physicsClientId=client)
            pybullet.changeDynamics(
                body, i, linearDamping=0, angularDamping=0, jointDamping=damping if i == own else 0.0,
                physicsClientId=client, **(inertia if i == own else {}),
            )  # fmt: skip
            pybullet.setJointMotorControl2(body, i, pybullet.VELOCITY_CONTROL, force=0.0, physicsClientId=client)
        pybullet.setJointMotorControl2(
            body, own, pybullet.VELOCITY_CONTROL, targetVelocity=0, force=friction, physicsClientId=client
        )
        led = [_LED] * len(others)
        for first, last in drive.windows:
            for i, joint in [*zip(drive.others, others, strict=True), (at, own)]:
                start = float(drive.q[first, i] - zero[i])
                pybullet.resetJointState(body, joint, start, float(drive.v[first, i]), physicsClientId=client)
            q[first], v[first] = drive.q[first, at], drive.v[first, at]
            for k in range(first, last):
                if others:
                    speed = ((drive.q[k + 1] - drive.q[k]) / drive.dt)[drive.others]
                    pybullet.setJointMotorControlArray(
                        body, others, pybullet.VELOCITY_CONTROL, targetVelocities=speed.tolist(), forces=led,
                        physicsClientId=client,
                    )  # fmt: skip
                torque = float(u[k] - spring * (q[k] - slack))
                pybullet.setJointMotorControl2(body, own, pybullet.TORQUE_CONTROL, force=torque, physicsClientId=client)
                pybullet.stepSimulation(physicsClientId=client)
                angle, speed_now = pybullet.getJointState(body, own, physicsClientId=client)[:2]
                q[k + 1], v[k + 1] = angle + zero[at], speed_now
    return q, v


def _turning_with_parent(arm: Arm, drive: Drive) -> FloatArray:
    """Acceleration (n,) about the joint's axis of what carries it.

    A rotor that is part of the joint's link is carried along by it; one behind a gear is not.
    """
    model = arm.model
    if arm.armature[drive.at] == 0.0 or model.jnt_type[drive.at] == mujoco.mjtJoint.mjJNT_SLIDE.value:
        return np.zeros(drive.t.size)
    data, body = mujoco.MjData(model), int(model.jnt_bodyid[drive.at])
    after = [i for i in range(drive.at, model.nv) if int(model.dof_bodyid[i]) == body]
    speed = np.empty(drive.t.size)
    for k in range(drive.t.size):
        data.qpos[:], data.qvel[:] = drive.q[k], drive.v[k]
        data.qvel[after] = 0.0
        mujoco.mj_kinematics(model, data)
        mujoco.mj_comPos(model, data)
        mujoco.mj_comVel(model, data)
        speed[k] = float(data.cvel[body, :3] @ data.xaxis[drive.at])
    return np.gradient(speed, drive.dt)
