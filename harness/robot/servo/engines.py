"""A joint under its servo in MuJoCo and PyBullet, by the words that are pasted, against its log.

The joint is alone there: a weight on a hinge with the inertia and gravity of all it moves, in the mean over the log.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass
from importlib.metadata import version

import mujoco
import numpy as np

from harness.core.arrays import FloatArray
from harness.core.errors import SimulationError
from harness.core.quiet import quiet
from harness.engines.pybullet import log as bullet_log
from harness.engines.pybullet import pybullet
from harness.robot.bullet import opened
from harness.robot.servo.paste import ServoPaste
from harness.robot.servo.plant import Run

_G = 9.81
_SHARE = 0.1
"""Of the inertia, at the weight that gravity pulls on."""
_FASTEST = 1e9


@dataclass(frozen=True, slots=True)
class Simulated:
    """Positions (n,) at the log's times, by one engine."""

    engine: str
    version: str
    dt: float
    q: FloatArray


@dataclass(frozen=True, slots=True)
class Weight:
    """A body on a hinge about y. mass : kg. x, z : of its middle, m. about : kg m^2, about that."""

    mass: float
    x: float
    z: float
    about: float

    @classmethod
    def of(cls, run: Run) -> "Weight":
        """With the inertia and gravity of what a joint moves."""
        inertia, sine, cosine = (float(value) for value in np.mean(run.load, axis=0))
        pull = math.hypot(sine, cosine)
        mass = max(pull**2 / (_SHARE * inertia * _G**2), 1e-6)
        reach, rest = pull / (mass * _G), math.atan2(-cosine, sine)
        return cls(mass, reach * math.sin(rest), -reach * math.cos(rest), inertia - mass * reach**2)


def in_mujoco(run: Run, words: ServoPaste, zero: float) -> Simulated:
    """The joint by MuJoCo's own servo, at the step of the words. zero : added to the model's angle, rad."""
    w, joint = Weight.of(run), words.joint
    text = f"""<mujoco><compiler angle="radian"/><option timestep="{joint.dt}" gravity="0 0 -{_G}"
      integrator="implicitfast"/><worldbody><body><joint name="{joint.joint}" axis="0 1 0"/>
      <inertial pos="{w.x} 0 {w.z}" mass="{w.mass}" diaginertia="{w.about} {w.about} {w.about}"/></body></worldbody>
      <actuator/></mujoco>"""
    spec = mujoco.MjSpec.from_string(text)
    own = spec.joint(joint.joint)
    own.frictionloss, own.armature = joint.f_k, joint.armature
    own.damping = np.array([joint.c, 0.0, 0.0]) if np.size(own.damping) > 1 else joint.c
    stiff = {name: [float(x) for x in value.split()] for name, value in joint.mjcf_words.items() if name in _STIFF}
    own.solref_friction, own.solimp_friction = stiff["solreffriction"], stiff["solimpfriction"]
    servo = spec.add_actuator(name="servo", target=joint.joint, trntype=mujoco.mjtTrn.mjTRN_JOINT)
    servo.set_to_position(kp=words.kp)
    if not math.isinf(words.most):
        servo.forcelimited, servo.forcerange = True, [-words.most, words.most]
    model = spec.compile()
    data = mujoco.MjData(model)

    def stepped(goal: float, on: bool) -> float:
        data.ctrl[0] = goal - zero
        model.actuator_gainprm[0, 0], model.actuator_biasprm[0, 1] = (words.kp, -words.kp) if on else (0.0, 0.0)
        mujoco.mj_step(model, data)
        return float(data.qpos[0]) + zero

    data.qpos[0], data.qvel[0] = run.start(0)[0] - zero, run.start(0)[1]
    return Simulated("mujoco", version("mujoco"), joint.dt, _followed(run, words, stepped))


_STIFF = ("solreffriction", "solimpfriction")


def in_pybullet(run: Run, words: ServoPaste, zero: float) -> Simulated:
    """The joint in PyBullet, its servo's torque computed every step. Raises SimulationError."""
    w, joint = Weight.of(run), words.joint
    about = w.about + joint.armature
    text = f"""<robot name="joint"><link name="base"/><link name="link"><inertial><origin xyz="{w.x} 0 {w.z}"/>
      <mass value="{w.mass}"/><inertia ixx="{about}" iyy="{about}" izz="{about}" ixy="0" ixz="0" iyz="0"/></inertial>
      </link><joint name="joint" type="continuous"><parent link="base"/><child link="link"/><axis xyz="0 1 0"/></joint>
      </robot>"""

    def refused(said: str) -> SimulationError:
        return SimulationError(f"{run.file}: {said}")

    with quiet(bullet_log), opened(text.encode(), joint.dt, refused) as (client, body, numbers):
        own = numbers["joint"]
        pybullet.setGravity(0, 0, -_G, physicsClientId=client)
        pybullet.changeDynamics(body, own, maxJointVelocity=_FASTEST, physicsClientId=client)
        pybullet.changeDynamics(
            body, own, linearDamping=0, angularDamping=0, jointDamping=joint.c, physicsClientId=client
        )
        pybullet.setJointMotorControl2(
            body, own, pybullet.VELOCITY_CONTROL, targetVelocity=0, force=joint.f_k, physicsClientId=client
        )
        q, v = run.start(0)
        pybullet.resetJointState(body, own, q - zero, v, physicsClientId=client)

        def stepped(goal: float, on: bool) -> float:
            error = goal - zero - float(pybullet.getJointState(body, own, physicsClientId=client)[0])
            torque = min(max(words.kp * error, -words.most), words.most) if on else 0.0
            pybullet.setJointMotorControl2(body, own, pybullet.TORQUE_CONTROL, force=torque, physicsClientId=client)
            pybullet.stepSimulation(physicsClientId=client)
            return float(pybullet.getJointState(body, own, physicsClientId=client)[0]) + zero

        found = _followed(run, words, stepped)
    return Simulated("pybullet", version("pybullet"), joint.dt, found)


def _followed(run: Run, words: ServoPaste, stepped: Callable[[float, bool], float]) -> FloatArray:
    """Positions (n,) at the log's times; a goal acts when its delay is over, and is held."""
    steps = np.arange(run.t[0], run.t[-1], words.joint.dt)
    sent = np.clip(np.searchsorted(run.t, steps - words.delay, side="right") - 1, 0, None)
    on = run.on[np.clip(np.searchsorted(run.t, steps, side="right") - 1, 0, None)]
    places = [run.start(0)[0], *(stepped(float(run.goal[k]), bool(o)) for k, o in zip(sent, on, strict=True))]
    return np.asarray(np.interp(run.t, np.append(steps, steps[-1] + words.joint.dt), places))
