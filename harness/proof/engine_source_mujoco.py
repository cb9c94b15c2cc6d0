"""A slider in MuJoCo: spring, damper and frictionloss of a joint, friction as stiff as the step allows."""

from typing import final

import mujoco

from harness.proof.engine_source_motion import Body, Task

IMPEDANCE = 0.9999
XML = """
<mujoco>
  <option timestep="{dt!r}" integrator="Euler" gravity="0 0 0" tolerance="1e-14"><flag contact="disable"/></option>
  <worldbody>
    <body>
      <inertial pos="0 0 0" mass="{m!r}" diaginertia="1 1 1"/>
      <joint name="slide" type="slide" axis="1 0 0" stiffness="{k!r}" damping="{c!r}" frictionloss="{f_k!r}"
             solreffriction="-1 {rate!r}" solimpfriction="{d} {d} .001"/>
    </body>
  </worldbody>
</mujoco>
"""


@final
class MujocoBody(Body):
    """One joint; the force is applied as qfrc_applied, the limit of friction is the joint's frictionloss."""

    def __init__(self, task: Task) -> None:
        model = task.model
        # the rate at which a slip is stopped is the largest that the step bears; a frictionless joint would have no
        # friction constraint whose limit could be set later
        xml = XML.format(
            dt=task.dt,
            m=model.m,
            k=model.k,
            c=model.c,
            f_k=max(model.friction.level.f_k, 1e-300),
            rate=-1.9 * IMPEDANCE / task.dt,
            d=IMPEDANCE,
        )
        self.model = mujoco.MjModel.from_xml_string(xml)
        self.data = mujoco.MjData(self.model)
        self.data.qpos[0], self.data.qvel[0] = task.x0, task.first_speed
        self._push, self._limit = self.data.qfrc_applied, self.model.dof_frictionloss
        self._q, self._v = self.data.qpos, self.data.qvel

    def step(self, push: float, limit: float) -> tuple[float, float]:
        """See Body.step."""
        self._push[0], self._limit[0] = push, limit
        mujoco.mj_step(self.model, self.data)
        return float(self._q[0]), float(self._v[0])

    def close(self) -> None:
        """See Body.close."""
