"""The answer tried out: a joint of the user's model, as it was and as it is to be, against the log in both engines.

In short windows that begin at the smoothed log, so that no error of long ago is what is seen. The joint is driven by
the torque that was logged; the others go where the log has them, whatever it takes.
"""

import copy
from collections.abc import Mapping
from dataclasses import dataclass
from importlib.metadata import version
from pathlib import Path

import mujoco
import numpy as np

from harness.core.arrays import FloatArray
from harness.core.errors import SimulationError
from harness.core.robot import JointLog
from harness.engines.mujoco.presets import warned
from harness.robot.arm import Arm, load_arm
from harness.robot.bare import bare_model
from harness.robot.paste import JointPaste, written
from harness.robot.replay.as_urdf import of_file, of_model
from harness.robot.replay.drive import WINDOW, Drive, drive_of
from harness.robot.whole_arm.perturb import with_load

MUJOCO, PYBULLET = "mujoco", "pybullet"
_PER_SECOND = 200.0
"""Samples that are kept."""
Motion = tuple[FloatArray, FloatArray]
_LED = 1e4
"""Rotor inertia, kg m^2, with which a joint goes where it is led, whatever the others do."""
_OFF = (
    mujoco.mjtDisableBit.mjDSBL_CONTACT.value
    | mujoco.mjtDisableBit.mjDSBL_LIMIT.value
    | mujoco.mjtDisableBit.mjDSBL_EQUALITY.value
)
_LEFT_OUT = mujoco.mjtDisableBit.mjDSBL_CONSTRAINT.value | mujoco.mjtDisableBit.mjDSBL_DAMPER.value


def replay(arm: Arm, drive: Drive) -> Motion:
    """Position and speed (n,) of the joint with the friction, damping and words that the model has for it.

    nan outside of the windows.
    """
    at, others = drive.at, drive.others
    # the joint's own friction is back, and what the torque of the log stands for is out
    model = copy.copy(arm.model)
    model.opt.disableflags = (model.opt.disableflags & ~_LEFT_OUT) | _OFF
    model.actuator_gainprm[:] = model.actuator_biasprm[:] = 0.0
    model.tendon_frictionloss[:] = model.tendon_damping[:] = model.tendon_stiffness[:] = 0.0
    model.dof_frictionloss[at], model.dof_damping[at] = arm.frictionloss[at], arm.damping[at]
    model.dof_armature[others] = _LED
    data = mujoco.MjData(model)
    place, speed, applied = data.qpos, data.qvel, data.qfrc_applied
    led_q, led_v, led_by = drive.q[:, others], drive.v[:, others], _LED * drive.a[:, others]
    q, v = np.full(drive.t.size, np.nan), np.full(drive.t.size, np.nan)
    with warned():
        for first, last in drive.windows:
            mujoco.mj_resetData(model, data)
            place[at], speed[at] = q[first], v[first] = drive.q[first, at], drive.v[first, at]
            for k in range(first, last):
                place[others], speed[others], applied[others] = led_q[k], led_v[k], led_by[k]
                applied[at] = drive.u[k]
                mujoco.mj_step(model, data)
                q[k + 1], v[k + 1] = place[at], speed[at]
    return q, v


@dataclass(frozen=True, slots=True)
class Replayed:
    """A joint in one engine against its log.

    dt, window : s. windows : how many. before, after : rms of position (x, rad or m) and speed (v) by the model as it
    is and with what is pasted. t, logged, q_before, q_after (m,) : s, rad or m; nan between windows. left_out :
    what the engine has no word for.
    """

    engine: str
    version: str
    dt: float
    window: float
    windows: int
    before: Mapping[str, float]
    after: Mapping[str, float]
    t: FloatArray
    logged: FloatArray
    q_before: FloatArray
    q_after: FloatArray
    left_out: tuple[str, ...] = ()


def replayed(
    path: Path,
    arm: Arm,
    log: JointLog,
    paste: JointPaste,
    held: Mapping[str, float],
    gravity: tuple[float, float, float] | None = None,
    offset: float = 0.0,
    payload: float = 0.0,
    engine: str = MUJOCO,
) -> Replayed | None:
    """What an engine makes of a joint with the friction of its model's file and with what is pasted into it.

    path, gravity : what ``arm`` was read from and with. held : where joints stand that are not logged. offset : of the
    logged torque, N m or N, which no model has. payload : kg at the last body. engine : mujoco or pybullet. None where
    no element of the file has the joint's name. Raises InputError as ``load_arm`` does, SimulationError when the engine
    is not there or does not load the model.
    """
    found = written(path, paste)
    if found is None:
        return None
    edited = {found[0].resolve(): found[1]}
    pasted = load_arm(path, gravity, edited)
    both = (arm, pasted) if payload == 0.0 else (with_load(arm, payload), with_load(pasted, payload))
    drive = drive_of(arm, log, paste.joint, held, offset)
    unsaid: tuple[str, ...] = ()
    if engine == MUJOCO:
        motions, its = [replay(one, drive) for one in both], mujoco.__version__
    else:
        try:
            from harness.robot.replay import in_pybullet
        except ImportError as error:
            raise SimulationError(f"engine {PYBULLET}: not installed ({error})") from error
        slides, motions, its = arm.slides(paste.joint), [], version(PYBULLET)
        if slides and arm.armature[drive.at] > 0.0:
            unsaid = (f"the rotor of {paste.joint}, a slide, is not replayed: PyBullet has no word for it",)
        for one, texts in zip(both, ({}, edited), strict=True):
            rotor = 0.0 if slides else float(one.armature[drive.at])
            root = bare_model(path, texts).root
            # the file itself where it is a URDF and nothing hangs on it, else one made of the compiled model
            if root.tag == "robot" and payload == 0.0:
                text, zero = of_file(root, paste.joint, rotor), np.zeros(arm.model.nv)
            else:
                text, zero = of_model(one, paste.joint, rotor), np.array(one.model.qpos0)
            motions.append(in_pybullet.replay(one, drive, text, zero))
    (q_before, v_before), (q_after, v_after) = motions
    kept = slice(None, None, max(1, round(1.0 / (_PER_SECOND * drive.dt))))
    return Replayed(
        engine, its, drive.dt, WINDOW, len(drive.windows), drive.errors(q_before, v_before),
        drive.errors(q_after, v_after), drive.t[kept], drive.q[kept, drive.at], q_before[kept], q_after[kept], unsaid,
    )  # fmt: skip
