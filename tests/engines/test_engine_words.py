"""Every documented word of friction moves the motion, or stands on the list of warnings in docs/fidelity.md."""

import json
import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from engine_cases import GENTLE, TABLE, decay, engine

from harness.core.events import Mode
from harness.core.scenario import Hold, Scenario
from harness.core.slider import Slider
from harness.engines import registry
from harness.engines.base import Engine, Task
from harness.exact.decay import free_decay

HAVE = {name for name, _ in TABLE}


def only(name: str) -> pytest.MarkDecorator:
    return pytest.mark.skipif(name not in HAVE, reason=f"{name} is not installed")


@pytest.mark.parametrize(("name", "route"), TABLE)
@pytest.mark.parametrize("preset", ["as-shipped", "tuned"])
def test_the_level_of_friction_counts_at_the_start_and_when_it_is_given_anew(
    name: str, route: str, preset: str
) -> None:
    more = Slider(GENTLE.m, GENTLE.c, GENTLE.k, 2.0 * GENTLE.f_k)
    tasks = [Task(decay(one, 0.1, 0.3), route, preset, 1e-3) for one in (GENTLE, more)]  # type: ignore[arg-type]
    runs = [engine(name).simulate(task) for task in tasks]
    assert np.abs(runs[0].x - runs[1].x).max() > 1e-3
    # held at 0.3 N by f_s = 0.4, then pushed past it: with f_s still in force it would slide at 0.5 - 0.4
    slider = Slider(1.0, 0.0, 1e-9, 0.2, 0.4)
    pushed = Scenario("hold", slider, 0.0, 0.0, 0.2, Hold(0.5))
    trace = engine(name).simulate(Task(pushed, route, preset, 1e-3))  # type: ignore[arg-type]
    assert trace.v[-1] == pytest.approx(0.2 * (0.5 - 0.2), rel=0.05)


WORDS: list[tuple[str, str, dict[str, Any], dict[str, Any]]] = [
    ("mujoco", "joint", {}, {"solreffriction": (0.05, 1.0)}),
    ("mujoco", "joint", {}, {"solimpfriction": (0.5, 0.6, 0.001, 0.5, 2.0)}),
    ("mujoco", "joint", {}, {"noslip_iterations": 50}),
    ("mujoco", "contact", {}, {"solref": (0.05, 1.0)}),
    ("mujoco", "contact", {}, {"cone": "elliptic"}),
    ("mujoco", "contact", {"cone": "elliptic"}, {"impratio": 100.0}),
    ("mujoco", "contact", {"cone": "elliptic"}, {"solreffriction": (0.05, 1.0)}),
    ("mjx", "joint", {}, {"solreffriction": (0.05, 1.0)}),
    ("mjx", "joint", {}, {"precision": 64}),
    ("warp", "joint", {}, {"solreffriction": (0.05, 1.0)}),
    ("warp", "joint", {}, {"noslip_iterations": 50}),
    ("pybullet", "contact", {}, {"frictionAnchor": True}),
    ("rapier", "joint", {}, {"num_solver_iterations": 1}),
    ("rapier", "contact", {}, {"friction_model": "COULOMB"}),
    ("physx", "joint", {}, {"solverType": "PGS"}),
    ("physx", "joint", {}, {"solverPositionIterationCount": 16}),
    ("physx", "joint", {}, {"solverVelocityIterationCount": 0}),
    ("physx", "joint", {}, {"own_spring": False}),
    ("physx", "joint", {"own_spring": False}, {"own_viscous": True}),
    ("physx", "joint", {"own_spring": False}, {"enableExternalForcesEveryIteration": False}),
    ("drake", "contact", {}, {"contact_approximation": "kTamsi"}),
    ("drake", "contact", {}, {"contact_approximation": "kSimilar"}),
    ("drake", "contact", {}, {"contact_approximation": "kSap"}),
    ("drake", "contact", {}, {"stiction_tolerance": 1e-3}),
]


def moved_by(engine: Engine, route: str, base: dict[str, Any], word: dict[str, Any]) -> float:
    """How far a word takes a decay or a hold from what it is without the word, m."""
    moved = 0.0
    for scenario in (decay(GENTLE, 0.1, 0.5), Scenario("hold", GENTLE, 0.0, 0.0, 0.2, Hold(0.15))):
        first, second = (Task(scenario, route, "as-shipped", settings=one) for one in (base, base | word))  # type: ignore[arg-type]
        plain, other = engine.simulate(first), engine.simulate(second)
        assert not any(line.startswith(tuple(word)) for line in other.source.ignored)
        moved = max(moved, float(np.abs(other.x - plain.x).max()))
    return moved


@pytest.mark.parametrize(
    ("name", "route", "base", "word"), [pytest.param(*row, marks=only(row[0])) for row in WORDS], ids=str
)
def test_a_word_of_friction_moves_the_motion(name: str, route: str, base: dict[str, Any], word: dict[str, Any]) -> None:
    assert moved_by(engine(name), route, base, word) > 1e-9


def rapier_box(locks: str) -> tuple[Any, Any, list[Any]]:
    """A box of 1 kg with mu = 0.5 on a floor, one millisecond a step: world, body, collider handles."""
    import rapier3d

    world = rapier3d.PhysicsWorld(gravity=(0.0, 0.0, -9.81))
    world.integration_parameters.dt = 1e-3
    floor = world.add_body(rapier3d.RigidBodyBuilder(rapier3d.RigidBodyType.FIXED).translation((0.0, 0.0, -1.0)))
    locked = rapier3d.LockedAxes.ROTATION_LOCKED
    if locks == "y":
        locked = locked | rapier3d.LockedAxes.TRANSLATION_LOCKED_Y
    made = rapier3d.RigidBodyBuilder(rapier3d.RigidBodyType.DYNAMIC).translation((0.0, 0.0, 0.06))
    box = world.add_body(made.locked_axes(locked).can_sleep(False))
    shapes = [rapier3d.Collider.cuboid(5.0, 5.0, 1.0), rapier3d.Collider.cuboid(0.1, 0.12, 0.06).mass(1.0)]
    handles = [world.add_collider(shape.friction(0.5), body) for shape, body in zip(shapes, (floor, box), strict=True)]
    return world, world.rigid_bodies[box], handles


def pushed(world: Any, body: Any, force: float, steps: int) -> float:
    """Speed after so many steps under a force, m/s."""
    for _ in range(steps):
        body.reset_forces(True)
        body.add_force((force, 0.0, 0.0), True)
        world.step()
    return float(body.linvel.x)


@only("rapier")
def test_warning_list_a_lock_of_y_takes_rapiers_friction_along_x_away() -> None:
    world, body, _ = rapier_box("")
    assert pushed(world, body, 3.0, 100) == pytest.approx(0.0, abs=1e-6)
    world, body, _ = rapier_box("y")
    assert pushed(world, body, 3.0, 100) == pytest.approx(0.3, rel=1e-3)


@only("rapier")
@pytest.mark.parametrize(("recycling", "speed"), [(True, 0.0), (False, 0.1 * (3.0 - 0.1 * 9.81))])
def test_warning_list_a_lasting_contact_of_rapier_keeps_its_coefficient(recycling: bool, speed: float) -> None:
    world, body, handles = rapier_box("")
    assert world.integration_parameters.contact_recycling
    world.integration_parameters.contact_recycling = recycling
    pushed(world, body, 3.0, 50)
    for handle in handles:
        world.colliders[handle].friction = 0.1
    assert pushed(world, body, 3.0, 100) == pytest.approx(speed, abs=2e-3)


@only("drake")
def test_warning_list_drakes_joints_have_no_word_of_friction() -> None:
    from pydrake.multibody.tree import PrismaticJoint

    assert not [name for name in dir(PrismaticJoint) if "friction" in name.lower()]


@only("physx")
@pytest.mark.parametrize("solver", ["TGS", "PGS"])
def test_physx_breaks_away_at_its_static_effort_and_slides_at_its_dynamic_one(solver: str) -> None:
    physx, slider = engine("physx"), Slider(1.0, 0.0, 1e-9, 3.0, 4.0)
    settings = {"own_spring": False, "solverType": solver}
    for load, acceleration in ((3.96, 0.0), (4.04, 4.04 - 3.0)):
        scenario = Scenario("hold", slider, 0.0, 0.0, 0.2, Hold(load))
        trace = physx.simulate(Task(scenario, "joint", "as-shipped", 1e-3, settings))
        assert trace.v[-1] == pytest.approx(acceleration * 0.2, abs=0.01)
        stuck = acceleration == 0.0
        assert trace.mode is not None
        assert np.all(trace.mode[2:] == (Mode.STICK if stuck else Mode.SLIP_POSITIVE))


def said_by(python: str, program: str) -> tuple[dict[str, Any], str]:
    """The JSON that a program of benchmarks/words prints last in an interpreter."""
    file = Path(__file__).parents[2] / "benchmarks" / "words" / program
    root = os.pathsep.join([str(Path(__file__).parents[2]), *filter(None, [os.environ.get("PYTHONPATH")])])
    environment = os.environ | {"PYTHONPATH": root, "PYTHONWARNINGS": "ignore"}
    done = subprocess.run([python, str(file)], capture_output=True, text=True, check=True, env=environment)
    return json.loads(done.stdout.splitlines()[-1]), done.stdout + done.stderr


@only("physx")
def test_warning_list_physx_drops_friction_outside_an_articulation_and_a_static_effort_below_the_dynamic_one() -> None:
    found, log = said_by(sys.executable, "physx_words.py")
    assert found["inside"] == pytest.approx(0.0, abs=1e-6)
    assert found["outside"] == pytest.approx(2.0 * 0.1, rel=1e-3)
    assert found["kept"] == [3.0, 3.0, 0.0]
    assert "Properties from PhysxJointAxisAPI will be ignored" in log
    assert "Static friction effort must be greater than or equal to dynamic" in log


SAPIEN = os.environ.get("HARNESS_SAPIEN_PYTHON", "")


@pytest.mark.skipif(not SAPIEN, reason="HARNESS_SAPIEN_PYTHON names no interpreter that has sapien")
def test_warning_list_sapiens_joints_rub_when_nobody_says_so() -> None:
    found, _ = said_by(SAPIEN, "sapien_words.py")
    assert found["version"] == "3.0.3"
    assert found["default"] == pytest.approx(0.05)
    plain, none = np.array(found["plain"]), np.array(found["none"])
    # what is lost without friction is a link's linear damping of 0.05 1/s
    assert none[1:] / none[:-1] == pytest.approx(np.exp(-0.5 * 0.05 * np.pi / 10.0), abs=1e-3)
    # no friction force: the same share of every half-cycle, however large
    assert plain[1:] / plain[:-1] == pytest.approx(0.94, abs=0.005)


NEWTON = os.environ.get("HARNESS_NEWTON_PYTHON", "")


with_newton = pytest.mark.skipif(not NEWTON, reason="HARNESS_NEWTON_PYTHON names no interpreter that has newton")


@with_newton
@pytest.mark.parametrize("route", ["joint", "law"])
def test_newton_tuned_follows_the_exact_decay(route: str) -> None:
    trace = registry.load(f"newton@{NEWTON}").simulate(Task(decay(), route, "tuned", 1e-3))  # type: ignore[arg-type]
    assert np.abs(trace.x - free_decay(decay(), trace.t).x).max() < 2e-3


@with_newton
def test_newtons_two_mujocos_give_the_same_motion() -> None:
    scenario = decay(duration=0.5)
    both = [
        registry.load(f"newton@{NEWTON}").simulate(
            Task(scenario, "joint", "as-shipped", 1 / 60, {"use_mujoco_cpu": on})
        )
        for on in (True, False)
    ]
    assert both[1].x == pytest.approx(both[0].x, abs=2e-6)
    assert not np.array_equal(both[1].x, both[0].x)


@with_newton
@pytest.mark.parametrize(
    "word", [{"solreffriction": (0.05, 1.0)}, {"solimpfriction": (0.5, 0.6, 0.001, 0.5, 2.0)}, {"integrator": "rk4"}]
)
def test_newtons_words_move_the_motion(word: dict[str, Any]) -> None:
    assert moved_by(registry.load(f"newton@{NEWTON}"), "joint", {}, word) > 1e-9


@with_newton
@pytest.mark.parametrize("solver", ["SolverFeatherstone", "SolverSemiImplicit", "SolverXPBD", "SolverVBD"])
def test_warning_list_newtons_other_solvers_drop_joint_friction(solver: str) -> None:
    newton = registry.load(f"newton@{NEWTON}")
    scenario = Scenario("hold", Slider(1.0, 0.0, 1e-9, 3.0), 0.0, 0.0, 0.1, Hold(1.5))
    with_friction = newton.simulate(Task(scenario, "joint", "as-shipped", 1e-3))
    without = newton.simulate(Task(scenario, "joint", "as-shipped", 1e-3, {"solver": solver}))
    assert abs(with_friction.v[-1]) < 2e-3
    assert without.v[-1] == pytest.approx(0.15, rel=0.02)
    assert any(line.startswith("friction: ") for line in without.source.ignored)


SLIDE_URDF = """<robot name="slide"><link name="rail"/><link name="box"><inertial><mass value="1"/>
<inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>
<joint name="x" type="prismatic"><parent link="rail"/><child link="box"/><axis xyz="1 0 0"/>
<limit lower="-9" upper="9" effort="99" velocity="99"/><dynamics {words}/></joint></robot>"""
SLIDE_MJCF = """<mujoco><worldbody><body><joint type="slide" axis="1 0 0" {words}/>
<geom type="box" size="0.1 0.1 0.1" mass="1"/></body></worldbody></mujoco>"""


def left_of_a_push(path: Path) -> float:
    """Speed of PyBullet's slide of 1 kg a hundred of its steps after 1 m/s, its motor off, m/s."""
    pybullet = pytest.importorskip("pybullet")
    world = pybullet.connect(pybullet.DIRECT)
    try:
        if path.suffix == ".urdf":
            body = pybullet.loadURDF(str(path), useFixedBase=True, physicsClientId=world)
        else:
            body = pybullet.loadMJCF(str(path), physicsClientId=world)[-1]
        joints = range(pybullet.getNumJoints(body, physicsClientId=world))
        kinds = [pybullet.getJointInfo(body, i, physicsClientId=world)[2] for i in joints]
        slide = kinds.index(pybullet.JOINT_PRISMATIC)
        pybullet.setJointMotorControl2(body, slide, pybullet.VELOCITY_CONTROL, force=0, physicsClientId=world)
        pybullet.resetJointState(body, slide, 0.1, 1.0, physicsClientId=world)
        for _ in range(100):
            pybullet.stepSimulation(physicsClientId=world)
        return float(pybullet.getJointState(body, slide, physicsClientId=world)[1])
    finally:
        pybullet.disconnect(world)


@pytest.mark.parametrize(
    ("file", "words", "acts"),
    [
        ("a.urdf", 'friction="5"', False),
        ("a.urdf", 'damping="5"', True),
        ("a.xml", 'frictionloss="5"', False),
        ("a.xml", 'damping="5"', False),
        ("a.xml", 'stiffness="100"', False),
    ],
)
def test_warning_list_pybullet_takes_of_a_files_joint_its_damping_in_urdf_alone(
    tmp_path: Path, file: str, words: str, acts: bool
) -> None:
    text = SLIDE_URDF if file.endswith(".urdf") else SLIDE_MJCF
    speeds = []
    for said in ('friction="0"' if file.endswith(".urdf") else "", words):
        (tmp_path / file).write_text(text.format(words=said))
        speeds.append(left_of_a_push(tmp_path / file))
    # as it ships PyBullet damps linearly by 0.04 a second itself
    assert speeds[0] == pytest.approx(0.9675, abs=1e-3)
    assert (speeds[1] < 0.5) if acts else (speeds[1] == speeds[0])
