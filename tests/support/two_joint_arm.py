"""An arm of two links that swing, and its motion with the torque that moves it, friction among it."""

import mujoco
import numpy as np

from harness.core.arrays import FloatArray

ARM = """
<mujoco><option gravity="0 0 -9.81"/><worldbody>
  <body name="upper"><joint name="shoulder" axis="0 1 0"/>
    <geom type="capsule" fromto="0 0 0 .4 0 0" size=".04" mass="2"/>
    <body name="lower" pos=".4 0 0"><joint name="elbow" axis="0 1 0"/>
      <geom type="capsule" fromto="0 0 0 .3 0 0" size=".03" mass="1"/></body>
  </body>
</worldbody></mujoco>
"""


def moved(samples: int, rate: float, f_k: tuple[float, float], c: tuple[float, float]) -> tuple[FloatArray, ...]:
    """t, q, v and the torque by inverse dynamics with Coulomb and viscous friction, all but t (samples, 2)."""
    model = mujoco.MjModel.from_xml_string(ARM)
    data = mujoco.MjData(model)
    t = np.arange(samples) / rate
    w = 2.0 * np.pi * np.array([[0.23, 0.71], [0.31, 0.83]])
    size, turn = np.array([[0.7, 0.2], [0.9, 0.25]]), np.array([[0.0, 1.0], [0.5, 2.0]])
    angle = w * t[:, None, None] + turn
    q, v, a = (
        np.sum(f, axis=2) for f in (size * np.sin(angle), size * w * np.cos(angle), -size * w**2 * np.sin(angle))
    )
    torque = np.zeros_like(q)
    for i in range(samples):
        data.qpos[:], data.qvel[:], data.qacc[:] = q[i], v[i], a[i]
        mujoco.mj_inverse(model, data)
        torque[i] = data.qfrc_inverse
    return t, q, v, torque + np.sign(v) * f_k + v * c
