"""A robot's rigid model, from MJCF or URDF, by MuJoCo's compiler: what torque its joints need without friction."""

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import mujoco
import numpy as np

from harness.core.arrays import FloatArray

GRAVITY = (0.0, 0.0, -9.81)


@dataclass(frozen=True, slots=True)
class Arm:
    """An open or closed chain as MuJoCo compiled it, its joint friction and damping taken out.

    file : of the model. model : mujoco's. joints : names of hinges and slides in the order of the model's degrees of
    freedom (nv,). armature (nv,) : rotor inertia seen at the joint, kg m^2 or kg. frictionloss, damping (nv,) : as the
    file has them, N m or N and N m s/rad or N s/m.
    """

    file: str
    model: Any
    joints: tuple[str, ...]
    armature: FloatArray
    frictionloss: FloatArray
    damping: FloatArray

    def inverse(self, q: FloatArray, v: FloatArray, a: FloatArray) -> FloatArray:
        """Torque (n, nv) that the rigid model needs: inertia with armature, Coriolis, gravity, springs of joints.

        q, v, a : (n, nv), rad or m, and per s and s^2; nothing of friction or damping is in it.
        """
        model, data = self.model, mujoco.MjData(self.model)
        found = np.empty_like(q)
        for i in range(q.shape[0]):
            data.qpos[:], data.qvel[:], data.qacc[:] = q[i], v[i], a[i]
            mujoco.mj_inverse(model, data)
            found[i] = data.qfrc_inverse
        return found


def load_arm(path: Path, gravity: tuple[float, float, float] | None = None) -> Arm:
    """An arm from .xml (MJCF or URDF) or .urdf; gravity : m/s^2 in the frame of the base, None for the file's own.

    Raises InputError when there is no such file, MuJoCo cannot compile it (its message in one line), or a joint is
    neither hinge nor slide (named).
    """
    raise NotImplementedError
