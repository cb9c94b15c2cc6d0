"""A second source of recordings: MuJoCo and PyBullet at converged settings, the effect a hidden force.

The plant says what is hidden; spring, damper and dry friction are the engine's, the rest is pushed with. The step of
both, v+ = v + h a(x), x+ = x + h v+, is read as the leapfrog it is: the run begins with the speed of half a step
earlier, and the speed at a step is the mean of those before and after it (Hairer, Lubich and Wanner, Acta Numerica 12,
2003).
"""

import logging
import math
import tempfile
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, contextmanager
from functools import partial
from pathlib import Path
from typing import Literal

import numpy as np
from scipy.interpolate import CubicHermiteSpline

from harness.core.arrays import FloatArray
from harness.core.errors import InputError, SimulationError
from harness.core.quiet import quiet
from harness.proof.plant.cases import MOST_TRIES, Case, accepted, draw, fitted, measured
from harness.proof.plant.effects import ALIENS, KINDS
from harness.proof.plant.integrate import Machine, PlantRun, driven
from harness.proof.plant.model import PlantModel

log = logging.getLogger(__name__)
EngineName = Literal["mujoco", "pybullet"]
ENGINES: tuple[EngineName, ...] = ("mujoco", "pybullet")

STATEFUL = ("presliding", "viscoelastic", "attached-mode", "static-friction", "alien-heating", "alien-rattle")
"""What no force of position, speed and time says: states of their own, a level that rises when at rest."""
ENGINE_KINDS = tuple(kind for kind in (*KINDS, *ALIENS) if kind not in STATEFUL)
"""Names that an engine can hide."""
FINENESS = 2.5e-4
"""Step times the fastest frequency: the motion is within 5e-5 of its length there, a tenth of the least noise."""
MOST_STEPS = 2_000_000


def draw_engine(
    kind: str | tuple[str, ...], rng: np.random.Generator, engine: EngineName = "mujoco", *, noise: str = "white"
) -> Case:
    """A random case whose motion an engine made: a name of ENGINE_KINDS, "control", or a pair of names.

    Concealed and decidable as the plant's own draws are, and by the same test. Raises InputError for a name that an
    engine cannot hide and for another engine, SimulationError when nothing came out.
    """
    kinds = () if kind == "control" else (kind,) if isinstance(kind, str) else kind
    for name in kinds:
        if name not in ENGINE_KINDS:
            raise InputError("kind", name, f"control or one of {', '.join(ENGINE_KINDS)}")
    if engine not in ENGINES:
        raise InputError("engine", engine, f"one of {', '.join(ENGINES)}")
    motion = partial(engine_motion, engine=engine)
    for _ in range(MOST_TRIES):
        plan = draw(kind, rng, noise=noise)
        # what the plant made is thrown away: its noise too is drawn anew
        again = measured(plan.base, plan.effects, plan.setting, plan.channels, plan.noise, rng, motion, engine)
        case = accepted(fitted(again))
        if case is not None:
            return case
    raise SimulationError(f"{engine}: no concealed and decidable draw of {' + '.join(kinds)} in {MOST_TRIES} tries")


class Task:
    """One plant in the numbers that an engine is given.

    dt : step, s. x0 : m. first_speed : half a step before the start, m/s. Raises SimulationError for what no engine is
    told: friction or branches with states of their own, break-away above the level at rest, another spring.
    """

    def __init__(self, model: PlantModel, duration: float) -> None:
        friction = model.friction
        level = friction.level
        if model.branches or friction.states or (level.f_s != level.f_k and level.v_s is None):
            raise SimulationError("engine source: states of their own and break-away are not for an engine")
        if model.restoring != "spring" or model.release > 0.0:
            raise SimulationError("engine source: a slider on its spring, free from the start")
        self.model, self.machine = model, Machine(model)
        rates = [model.omega_n, *(force.rate for force in model.forces)]
        if model.drive is not None:
            rates.append(model.drive.rate)
        self.dt = FINENESS / max(rates)
        self.steps = math.ceil(duration / self.dt) + 1
        if self.steps > MOST_STEPS:
            raise SimulationError(f"engine source: {self.steps} steps, {MOST_STEPS} at most")
        self.x0 = model.x0
        start = [model.x0, model.v0, 0.0]
        d = self.machine.direction(0.0, start)
        self.first_acceleration = self.machine.motion(0.0, start, d)[0] if d != 0.0 else 0.0
        self.first_speed = model.v0 - 0.5 * self.dt * self.first_acceleration

    def pulses(self) -> FloatArray:
        """Forces (N) of the knocks, shape (steps,): each spread over two steps so that both moments are right."""
        push = np.zeros(self.steps + 1)
        for knock in self.model.knocks:
            i = int(knock.time / self.dt)
            if i < self.steps:
                # the speed of step i is the mean over it: only what comes after the knock counts
                late = knock.time / self.dt - i
                push[i] += (1.0 - late) * knock.impulse / self.dt
                push[i + 1] += late * knock.impulse / self.dt
        return push[: self.steps]


Step = Callable[[float, float], tuple[float, float]]
"""Push the slider with a force (N) for one step, friction limited (N); position (m) and speed (m/s) after it."""
IMPEDANCE = 0.9999
MJCF = """
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


@contextmanager
def _mujoco(task: Task) -> Iterator[Step]:
    """Spring, damper and frictionloss of a joint, friction as stiff as the step allows; pushed by qfrc_applied."""
    import mujoco

    said = task.model
    # the rate at which a slip is stopped is the largest that the step bears; a frictionless joint would have no
    # friction constraint whose limit could be set later
    f_k, rate = max(said.friction.level.f_k, 1e-300), -1.9 * IMPEDANCE / task.dt
    model = mujoco.MjModel.from_xml_string(
        MJCF.format(dt=task.dt, m=said.m, k=said.k, c=said.c, f_k=f_k, rate=rate, d=IMPEDANCE)
    )
    data = mujoco.MjData(model)
    data.qpos[0], data.qvel[0] = task.x0, task.first_speed
    pushed, limited, q, v = data.qfrc_applied, model.dof_frictionloss, data.qpos, data.qvel

    def step(push: float, limit: float) -> tuple[float, float]:
        pushed[0], limited[0] = push, limit
        mujoco.mj_step(model, data)
        return float(q[0]), float(v[0])

    yield step


URDF = """
<robot name="slider">
  <link name="world"/>
  <link name="slider">
    <inertial><mass value="{m!r}"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial>
  </link>
  <joint name="slide" type="prismatic">
    <parent link="world"/><child link="slider"/><axis xyz="1 0 0"/>
    <limit lower="-1e9" upper="1e9" effort="1e12" velocity="1e9"/>
  </joint>
</robot>
"""
SLIDE = 0


@contextmanager
def _pybullet(task: Task) -> Iterator[Step]:
    """Dry friction is a velocity motor limited to its level, spring and damper are torques, in a world of its own."""
    try:
        with quiet(log):
            import pybullet
    except ImportError as error:
        raise SimulationError(f"engine pybullet: not installed ({error}); the proof draws recordings in it") from None
    c, k = task.model.c, task.model.k
    x, v, before = task.x0, task.first_speed, task.first_speed - task.dt * task.first_acceleration
    limited = -1.0
    client = pybullet.connect(pybullet.DIRECT)
    pybullet.setPhysicsEngineParameter(
        fixedTimeStep=task.dt, numSubSteps=0, enableFileCaching=0, physicsClientId=client
    )
    with tempfile.TemporaryDirectory() as folder, quiet(log):
        path = Path(folder) / "slider.urdf"
        path.write_text(URDF.format(m=task.model.m))
        body = pybullet.loadURDF(str(path), useFixedBase=True, physicsClientId=client)
    for link in (-1, SLIDE):
        # both default to 0.04
        pybullet.changeDynamics(
            body, link, linearDamping=0.0, angularDamping=0.0, jointDamping=0.0, maxJointVelocity=1e9,
            physicsClientId=client,
        )  # fmt: skip
    pybullet.resetJointState(body, SLIDE, x, v, physicsClientId=client)

    def step(push: float, limit: float) -> tuple[float, float]:
        nonlocal x, v, before, limited
        if limit != limited:
            pybullet.setJointMotorControl2(
                body, SLIDE, pybullet.VELOCITY_CONTROL, targetVelocity=0.0, force=limit, physicsClientId=client
            )
            limited = limit
        torque = push - k * x - c * (v + 0.5 * (v - before))
        pybullet.setJointMotorControl2(body, SLIDE, pybullet.TORQUE_CONTROL, force=torque, physicsClientId=client)
        pybullet.stepSimulation(physicsClientId=client)
        before = v
        x, v, _, _ = pybullet.getJointState(body, SLIDE, physicsClientId=client)
        return x, v

    try:
        yield step
    finally:
        pybullet.disconnect(physicsClientId=client)


BODIES: dict[EngineName, Callable[[Task], AbstractContextManager[Step]]] = {"mujoco": _mujoco, "pybullet": _pybullet}


def engine_motion(model: PlantModel, t: FloatArray, engine: EngineName) -> PlantRun:
    """The motion at the times t (s, shape (n,), from 0 on) in an engine.

    Raises SimulationError for a plant that no engine can be told and for a motion that is not finite.
    """
    task = Task(model, float(t[-1]))
    with BODIES[engine](task) as step:
        x, half = _stepped(task, step)
    dt = task.dt
    v = 0.5 * (half[:-1] + half[1:])
    v[0] = model.v0
    a = np.diff(half) / dt - task.pulses() / model.m
    at = dt * np.arange(task.steps)
    x_t, v_t, a_t = np.asarray(CubicHermiteSpline(at, x, v)(t)), np.interp(t, at, v), np.interp(t, at, a)
    if not np.all(np.isfinite(x_t)):
        raise SimulationError(f"{engine}: the motion is not finite")
    net = np.array(
        [
            task.machine.net(now, [place, speed], math.copysign(1.0, speed))
            for now, place, speed in zip(t.tolist(), x_t.tolist(), v_t.tolist(), strict=True)
        ]
    )
    still = np.abs(v_t) < 1e-5 * task.machine.units[1]
    sign = np.where(np.abs(v) < 1e-9 * task.machine.units[1], 0.0, np.sign(v))
    turns = at[1:][(sign[:-1] != 0.0) & (sign[1:] != sign[:-1])]
    u = driven(model, t, x_t, v_t)
    return PlantRun(t, x_t, v_t, a_t, u, net - model.m * a_t, still, np.zeros((t.size, 0)), turns)


def _stepped(task: Task, step: Step) -> tuple[FloatArray, FloatArray]:
    """Positions (steps,) at and speeds (steps + 1,) half a step before the steps, and after the last."""
    model, laws, dt, drive = task.model, task.machine.laws, task.dt, task.model.drive
    friction, level = model.friction, model.friction.level
    smooth = friction.switch is not None
    constant = level.v_s is None and not level.modulations
    limit = 0.0 if smooth else level.f_k
    pulses: list[float] = task.pulses().tolist()
    x, speed, before = task.x0, task.first_speed, task.first_speed - dt * task.first_acceleration
    positions, speeds = [x], [speed]
    for i, pulse in enumerate(pulses):
        # the speed now, half a step after the one that is known
        v = speed + 0.5 * (speed - before)
        now = i * dt
        d = math.copysign(1.0, v) if v != 0.0 else 0.0
        push = pulse
        for law in laws:
            push -= law(now, x, v, d)
        if drive is not None:
            push += drive.law(now, x, v)
        if smooth or not constant:
            net = push - pulse - model.c * v - model.k * x
            height = level.sliding(now, x, v, net, 0.0)
            if smooth:
                push -= friction.act(height, v, d, net / model.m, 0.0)[0]
            else:
                limit = height
        before = speed
        x, speed = step(push, limit)
        positions.append(x)
        speeds.append(speed)
    return np.array(positions[:-1]), np.array(speeds)
