"""What a reader makes of a word, by motion: a hinge whose file has it is let go level, and its speed looked at later.

(I + a) q'' = G cos q - c q' - f sgn q' - k q from rest at 0, in the engine as it reads the file; the value with which
the exact motion is as much slower as this one is against that of a file without the word, over the value that was
written, tells: 1 read, 0 dropped, 57.3 per degree.
"""

import tempfile
from collections.abc import Callable, Mapping, Sequence
from functools import cache
from importlib.metadata import PackageNotFoundError, version
from importlib.util import find_spec
from pathlib import Path
from typing import Any, Final

import numpy as np

from harness.core.apart import Found, read_apart
from harness.core.arrays import FloatArray
from harness.core.errors import InputError, SimulationError
from harness.engines.models import folder
from harness.engines.pybullet import pybullet
from harness.robot.words.table import Form, Kind, Reader, Taken, Word

ARM, MASS, OWN = 0.5, 1.0, 0.75
"""m, kg, kg m^2: of what hangs on the hinge; its inertia about it is 1."""
_GRAVITY, _DT, _STEPS = 9.81, 1e-3, 300
_SECONDS = 120
_RATIOS: Final = np.concatenate((np.linspace(-0.5, 2.0, 251), np.geomspace(2.02, 100.0, 100)))
_NONE, _ONE, _DEGREE = 0.05, 0.15, 180.0 / np.pi
_LINKS = '<mass value="1"/><inertia ixx="{i}" iyy="{i}" izz="{i}" ixy="0" ixz="0" iyz="0"/></inertial>'
_SDF_LINK = (
    "<mass>1</mass><inertia><ixx>{i}</ixx><iyy>{i}</iyy><izz>{i}</izz><ixy>0</ixy><ixz>0</ixz><iyz>0</iyz></inertia>"
    "</inertial></link>"
)
_FIXED = '<joint name="fix" type="fixed"><parent>world</parent><child>base</child></joint>'
_MODELS: Final[dict[Form, str]] = {
    "mjcf": (
        '<mujoco model="probe"><option timestep="0.001"/>{top}<worldbody><body name="base">'
        '<geom type="sphere" size="0.1" mass="1"/><body name="arm"><joint name="j" type="hinge" axis="0 1 0" {joint}/>'
        '<inertial pos="0.5 0 0" mass="1" diaginertia="0.75 0.75 0.75"/></body></body></worldbody>{end}</mujoco>'
    ),
    "urdf": (
        f'<robot name="probe"><link name="base"><inertial>{_LINKS.format(i=1)}</link><link name="arm"><inertial>'
        f'<origin xyz="0.5 0 0"/>{_LINKS.format(i=OWN)}</link><joint name="j" type="continuous"><parent link="base"/>'
        '<child link="arm"/><axis xyz="0 1 0"/>{joint}</joint>{end}</robot>'
    ),
    "sdf": (
        f'<sdf version="1.6"><model name="probe"><link name="base"><inertial>{_SDF_LINK.format(i=1)}<link name="arm">'
        f"<inertial><pose>0.5 0 0 0 0 0</pose>{_SDF_LINK.format(i=OWN)}{_FIXED}"
        '<joint name="j" type="revolute"><parent>base</parent><child>arm</child><axis><xyz>0 1 0</xyz>'
        "<limit><lower>-9</lower><upper>9</upper></limit>{axis}</axis>{joint}</joint></model></sdf>"
    ),
}


def model(form: Form, **slots: str) -> str:
    """A test model of a format, with texts in its slots: joint (in MJCF attributes), axis, top, end."""
    return _MODELS[form].format(**dict.fromkeys(("top", "joint", "axis", "end"), "") | slots)


def _mujoco(form: Form, path: Path) -> float:
    import mujoco

    own = mujoco.MjModel.from_xml_path(str(path))
    own.opt.timestep = _DT
    data = mujoco.MjData(own)
    mujoco.mj_step(own, data, _STEPS)
    return float(data.qvel[0])


def _pybullet(form: Form, path: Path) -> float:
    client = pybullet.connect(pybullet.DIRECT)
    try:
        pybullet.setPhysicsEngineParameter(enableFileCaching=0, fixedTimeStep=_DT, physicsClientId=client)
        pybullet.setGravity(0.0, 0.0, -_GRAVITY, physicsClientId=client)
        if form == "urdf":
            flags = pybullet.URDF_USE_INERTIA_FROM_FILE
            body = pybullet.loadURDF(str(path), useFixedBase=True, flags=flags, physicsClientId=client)
        else:
            path.write_text(path.read_text(encoding="utf-8").replace(_FIXED, ""), encoding="utf-8")
            (body,) = (pybullet.loadSDF if form == "sdf" else pybullet.loadMJCF)(str(path), physicsClientId=client)
        joints = range(pybullet.getNumJoints(body, physicsClientId=client))
        kinds = [pybullet.getJointInfo(body, i, physicsClientId=client)[2] for i in joints]
        hinge = kinds.index(pybullet.JOINT_REVOLUTE)
        pybullet.setJointMotorControl2(body, hinge, pybullet.VELOCITY_CONTROL, force=0, physicsClientId=client)
        if form != "urdf":  # masses are made of shapes, and no base is fixed
            for link, inertia in ((-1, 1.0), (joints[-1], OWN)):
                pybullet.changeDynamics(
                    body, link, mass=MASS, localInertiaDiagonal=[inertia] * 3, physicsClientId=client
                )
            origin = [0.0, 0.0, 0.0]
            pybullet.createConstraint(
                body, -1, -1, -1, pybullet.JOINT_FIXED, origin, origin, origin, physicsClientId=client
            )
        for _ in range(_STEPS):
            pybullet.stepSimulation(physicsClientId=client)
        return float(pybullet.getJointState(body, hinge, physicsClientId=client)[1])
    except pybullet.error as error:
        raise SimulationError(str(error)) from None
    finally:
        pybullet.disconnect(client)


def _dart(form: Form, path: Path) -> float:
    import dartpy

    world = dartpy.simulation.World()
    if form == "mjcf":
        world = dartpy.utils.MjcfParser.readWorld(str(path))
        skeleton = world.getSkeleton(0)
        inertia = dartpy.dynamics.Inertia(MASS, [ARM, 0.0, 0.0], OWN * np.eye(3))
        skeleton.getBodyNodes()[-1].setInertia(inertia)  # it reads none
    else:
        loader = dartpy.utils.DartLoader()
        skeleton = (loader.parseSkeleton if form == "urdf" else dartpy.utils.SdfParser.readSkeleton)(str(path))
        if skeleton is None:
            raise SimulationError("the file is not loaded")
        world.addSkeleton(skeleton)
        if skeleton.getNumDofs() > 1:
            skeleton.getJoint(0).setActuatorType(dartpy.dynamics.ActuatorType.LOCKED)
    world.setTimeStep(_DT)
    world.setGravity([0.0, 0.0, -_GRAVITY])
    for _ in range(_STEPS):
        world.step()
    return float(skeleton.getDofs()[-1].getVelocity())


def _rapier(form: Form, path: Path) -> float:
    import rapier3d
    from rapier3d.loaders import mjcf, urdf

    world = rapier3d.PhysicsWorld(gravity=(0.0, 0.0, -_GRAVITY))
    world.integration_parameters.dt = _DT
    options = {"make_roots_fixed": True, "create_colliders_from_collision_shapes": False}
    sets = (world.rigid_bodies, world.colliders, world.multibody_joints)
    if form == "mjcf":
        robot, _ = mjcf.MjcfRobot.from_file(str(path), mjcf.MjcfLoaderOptions(**options))
        last = robot.insert_using_multibody_joints(*sets, world.impulse_joints).bodies[-1].body
    else:
        robot, _ = urdf.UrdfRobot.from_file(str(path), urdf.UrdfLoaderOptions(**options))
        last = robot.insert_using_multibody_joints(*sets).links[-1].body
    body = world.rigid_bodies[last]
    body.activation = rapier3d.RigidBodyActivation.cannot_sleep()
    for _ in range(_STEPS):
        world.step()
    return float(body.angvel.y)


def _drake(form: Form, path: Path) -> float:
    from pydrake.multibody.parsing import Parser
    from pydrake.multibody.plant import MultibodyPlant
    from pydrake.systems.analysis import Simulator

    plant = MultibodyPlant(_DT)
    Parser(plant).AddModels(str(path))
    if form == "urdf":
        plant.WeldFrames(plant.world_frame(), plant.GetFrameByName("base"))
    plant.Finalize()
    simulator = Simulator(plant)
    context = simulator.get_mutable_context()
    plant.get_actuation_input_port().FixValue(context, np.zeros(plant.num_actuated_dofs()))
    simulator.AdvanceTo(_DT * _STEPS)
    return float(plant.GetJointByName("j").get_angular_rate(context))


_RUN: Final[dict[str, Callable[[Form, Path], float]]] = {
    "mujoco": _mujoco,
    "pybullet": _pybullet,
    "dart": _dart,
    "rapier": _rapier,
    "drake": _drake,
}
_MODULES: Final = {
    "mujoco": "mujoco",
    "pybullet": "pybullet",
    "dart": "dartpy",
    "rapier": "rapier3d",
    "drake": "pydrake",
}


def installed(reader: Reader) -> str | None:
    """The version of a reader that can be run here; None where there is none."""
    if reader.name not in _RUN or find_spec(_MODULES[reader.name]) is None:
        return None
    try:
        return version(reader.package)
    except PackageNotFoundError:
        return None


def speed(reader: str, form: Form, text: str) -> float:
    """Of the hinge after .3 s, rad/s, in a reader that is installed. Raises SimulationError where that refuses it."""
    with tempfile.TemporaryDirectory(prefix="friction-harness-") as made:
        path = Path(made) / f"probe.{'xml' if form == 'mjcf' else form}"
        path.write_text(text, encoding="utf-8")
        try:
            return _RUN[reader](form, path)
        except SimulationError:
            raise
        except Exception as error:  # of each library, in its own class
            raise SimulationError(" ".join(str(error).split()) or type(error).__name__) from None


def speeds(form: Form, asked: Sequence[tuple[str, str]]) -> list[float | None]:
    """The same for several readers and texts, in a process apart, since a library may end it; None where refused."""
    requests = [list(one) for one in asked]
    try:
        columns, about = read_apart(
            f"{__name__}:columns_of", folder(), "a text", seconds=_SECONDS, kept=True, form=form, requests=requests
        )
    except InputError:
        if len(asked) == 1:
            return [None]
        return [one for each in asked for one in speeds(form, [each])]
    return [None if refused else float(v) for v, refused in zip(columns["v"], about, strict=True)]


def columns_of(path: Path, form: Form, requests: Sequence[tuple[str, str]]) -> Found:
    """The reader of ``speeds``."""
    found: list[float] = []
    refused: list[bool] = []
    for reader, text in requests:
        try:
            found.append(speed(reader, form, text))
            refused.append(False)
        except SimulationError:
            found.append(0.0)
            refused.append(True)
    return {"v": np.array(found)}, refused


@cache
def _exact(kind: Kind, value: float, power: int = 1) -> FloatArray:
    """Speed after .3 s, rad/s, for a word of ``value`` times each of ``_RATIOS``, by Runge and Kutta.

    power : of the speed or the angle, of which damping or stiffness is that part of a polynomial.
    """
    p = value * _RATIOS
    none = np.zeros_like(p)
    a, c = (p if kind == "armature" else none), (p if kind == "damping" else none)
    k, f = (p if kind == "spring" else none), (p if kind == "friction" else none)
    load = _GRAVITY * ARM * MASS

    def slope(q: FloatArray, v: FloatArray) -> FloatArray:
        found: FloatArray = (load * np.cos(q) - c * v**power - f * np.sign(v + 1e-12) - k * q**power) / (1.0 + a)
        return np.where((v <= 0.0) & (f > load), 0.0, found)

    q, v, h = none, none, _DT
    for _ in range(_STEPS):
        a1 = slope(q, v)
        a2 = slope(q + 0.5 * h * v, v + 0.5 * h * a1)
        a3 = slope(q + 0.5 * h * v + 0.25 * h * h * a1, v + 0.5 * h * a2)
        a4 = slope(q + h * v + 0.5 * h * h * a2, v + h * a3)
        q = q + h * v + h * h * (a1 + a2 + a3) / 6.0
        v = v + h * (a1 + 2.0 * a2 + 2.0 * a3 + a4) / 6.0
    return v


def ratio(word: Word, with_it: float, without: float) -> float:
    """The value that acts over the one written, from the speeds with and without a word."""
    assert word.probe is not None
    kind: Kind = word.kind if word.kind != "servo" else "damping" if word.name == "kv" else "spring"
    exact = _exact(kind, word.probe.value, 2 if word.polynomial else 1)
    plain = float(np.interp(0.0, _RATIOS, exact))
    order = np.argsort(exact)
    return float(np.interp(with_it / without * plain, exact[order], _RATIOS[order]))


def by_motion(word: Word, reader: Reader, found: Mapping[tuple[str, str], float | None]) -> tuple[Taken, float | None]:
    """What a reader that is installed makes of a word, with the ratio; found : speeds by reader and the word's key,
    "" for none. None where it refuses the word.
    """
    said, without, with_it = word.taken(reader.name), found.get((reader.name, "")), found.get((reader.name, word.key))
    if without is None:
        return said, None
    if with_it is None:
        return Taken("refused", said.note if said.fate == "refused" else "the file is not loaded"), None
    times = ratio(word, with_it, without)
    fate: Any = "meaning"
    if abs(times) < _NONE:
        fate = "dropped"
    elif abs(times - 1.0) < _ONE:
        fate = "read"
    elif abs(times / _DEGREE - 1.0) < _ONE or abs(times * _DEGREE - 1.0) < _ONE:
        fate = "unit"
    note = said.note if fate == said.fate else f"{times:.3g} times what was written"
    return Taken(fate, note), times
