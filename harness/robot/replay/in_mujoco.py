"""A joint of a model in MuJoCo, driven by its log's torque; the other joints are led along the log."""

import copy
from typing import Any

import mujoco
import numpy as np

from harness.core.arrays import FloatArray
from harness.engines.mujoco.warned import warned
from harness.robot.arm import Arm
from harness.robot.replay.drive import Drive

_LED = 1e4
"""Rotor inertia, kg m^2, with which a joint goes where it is led, whatever the others do."""
_OFF = (
    mujoco.mjtDisableBit.mjDSBL_CONTACT.value
    | mujoco.mjtDisableBit.mjDSBL_LIMIT.value
    | mujoco.mjtDisableBit.mjDSBL_EQUALITY.value
)
_LEFT_OUT = mujoco.mjtDisableBit.mjDSBL_CONSTRAINT.value | mujoco.mjtDisableBit.mjDSBL_DAMPER.value


def version() -> str:
    """Of MuJoCo."""
    return str(mujoco.__version__)


def replay(arm: Arm, drive: Drive) -> tuple[FloatArray, FloatArray]:
    """Position and speed (n,) of the joint with the friction, damping and words that the model has for it.

    nan outside of the windows.
    """
    model, at, others = _model(arm, drive), drive.at, drive.others
    data = mujoco.MjData(model)
    q, v = np.full(drive.t.size, np.nan), np.full(drive.t.size, np.nan)
    with warned():
        for first, last in drive.windows:
            mujoco.mj_resetData(model, data)
            data.qpos[at], data.qvel[at] = q[first], v[first] = drive.q[first, at], drive.v[first, at]
            for k in range(first, last):
                data.qpos[others], data.qvel[others] = drive.q[k, others], drive.v[k, others]
                data.qfrc_applied[others] = _LED * drive.a[k, others]
                data.qfrc_applied[at] = drive.u[k]
                mujoco.mj_step(model, data)
                q[k + 1], v[k + 1] = data.qpos[at], data.qvel[at]
    return q, v


def _model(arm: Arm, drive: Drive) -> Any:
    """The model with the joint's own friction back, and without what the torque of the log stands for."""
    model = copy.copy(arm.model)
    model.opt.disableflags = (model.opt.disableflags & ~_LEFT_OUT) | _OFF
    model.actuator_gainprm[:] = model.actuator_biasprm[:] = 0.0
    model.tendon_frictionloss[:] = model.tendon_damping[:] = model.tendon_stiffness[:] = 0.0
    model.dof_frictionloss[drive.at], model.dof_damping[drive.at] = arm.frictionloss[drive.at], arm.damping[drive.at]
    model.dof_armature[drive.others] = _LED
    return model
