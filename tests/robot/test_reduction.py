"""One joint's own equation is that of the whole arm with the others still."""

import math
from pathlib import Path

import numpy as np
import pytest
from chains import chain, urdf

from harness.engines.models import folder
from harness.robot.arm import load_arm
from harness.robot.reduction import reduced

ARM = folder() / "arm"


@pytest.mark.parametrize("seed", range(25))
def test_the_reduced_equation_is_the_whole_arms_at_random_states(tmp_path: Path, seed: int) -> None:
    """1000 states over random chains: 40 of each, of every joint in turn."""
    file = tmp_path / "chain.xml"
    file.write_text(chain(seed))
    random = np.random.default_rng(seed)
    arm = load_arm(file, gravity=tuple(random.normal(size=3) * 9.81))
    for i, joint in enumerate(arm.joints):
        q, held = np.tile(random.normal(size=len(arm.joints)), (40, 1)), np.zeros((40, len(arm.joints)))
        q[:, i] = random.uniform(-7.0, 7.0, 40)
        v, a = held.copy(), held.copy()
        v[:, i], a[:, i] = 5.0 * random.normal(size=(2, 40))
        own = reduced(arm, joint, dict(zip(arm.joints, q[0].tolist(), strict=True)))
        whole = arm.inverse(q, v, a)[:, i]
        scale = float(np.max(np.abs(whole))) + own.moved
        assert np.max(np.abs(whole - own.torque(q[:, i], a[:, i]))) <= 1e-8 * scale


@pytest.mark.parametrize("seed", range(6))
def test_a_urdf_needs_the_torque_that_pybullet_says(tmp_path: Path, seed: int) -> None:
    pybullet = pytest.importorskip("pybullet")
    file = tmp_path / "chain.urdf"
    file.write_text(urdf(seed))
    arm = load_arm(file)
    client = pybullet.connect(pybullet.DIRECT)
    bare = tmp_path / "bare.urdf"
    shapes = '<geometry><mesh filename="package://nowhere/mesh.dae"/></geometry>'
    bare.write_text(
        urdf(seed)
        .replace(f"<visual>{shapes}</visual><collision>{shapes}</collision>", "")
        .replace('<transmission name="t"><joint name="j1"/></transmission>', "")
    )
    body = pybullet.loadURDF(
        str(bare), useFixedBase=True, flags=pybullet.URDF_USE_INERTIA_FROM_FILE, physicsClientId=client
    )
    pybullet.setGravity(0, 0, -9.81, physicsClientId=client)
    q, v, a = np.random.default_rng(seed).normal(size=(3, 20, len(arm.joints)))
    ours = arm.inverse(q, v, a)
    for i in range(20):
        theirs = pybullet.calculateInverseDynamics(
            body, q[i].tolist(), v[i].tolist(), a[i].tolist(), physicsClientId=client
        )
        assert np.allclose(ours[i], theirs, rtol=1e-6, atol=1e-6 * np.max(np.abs(ours)))
    pybullet.disconnect(client)


def test_our_arm_is_the_same_in_both_formats() -> None:
    one, other = load_arm(ARM / "arm.xml"), load_arm(ARM / "arm.urdf")
    assert one.joints == other.joints
    q, v, a = np.random.default_rng(1).normal(size=(3, 200, 3))
    assert np.max(np.abs(one.inverse(q, v, a) - other.inverse(q, v, a))) < 1e-9
    assert np.array_equal(one.frictionloss, other.frictionloss)
    assert np.array_equal(one.damping, other.damping)
    assert [a_range.tolist() for a_range in one.model.jnt_range] == [r.tolist() for r in other.model.jnt_range]


def test_a_bob_on_a_rod_is_the_textbook_pendulum(tmp_path: Path) -> None:
    """m L^2, m g L, and it hangs where the rod points down: the model's zero is 0.4 rad off that."""
    file = tmp_path / "bob.xml"
    turned = f"{0.5 * math.sin(0.4)} 0 {-0.5 * math.cos(0.4)}"
    file.write_text(
        f'<mujoco><worldbody><body pos="1 2 3"><joint name="j" axis="0 1 0" armature="0.1"/>'
        f'<inertial pos="{turned}" mass="2" diaginertia="1e-9 1e-9 1e-9"/></body></worldbody></mujoco>'
    )
    own = reduced(load_arm(file), "j")
    assert own.inertia == pytest.approx(2 * 0.5**2, rel=1e-6)
    assert own.armature == pytest.approx(0.1)
    assert own.gravity == pytest.approx(2 * 9.81 * 0.5)
    assert own.q_eq == pytest.approx(0.4)
    assert "0.1 kg m^2 of its rotor" in own.sentence
    assert "rest angle 0.4 rad" in own.sentence


def test_gravity_brings_the_joint_back_to_where_it_is_said_to_hang() -> None:
    arm = load_arm(ARM / "arm.xml", gravity=(3.0, -2.0, -8.0))
    for joint in arm.joints:
        own = reduced(arm, joint, {"base": 0.3, "shoulder": -0.7, "elbow": 1.1})
        near = own.q_eq + np.array([-0.01, 0.0, 0.01])
        assert np.sign(own.load(near)).tolist()[::2] == [-1.0, 1.0]
        assert abs(own.load(near)[1]) < 1e-12


def test_an_axis_along_gravity_is_not_pulled_and_a_tilted_one_is() -> None:
    assert reduced(load_arm(ARM / "arm.xml"), "base").upright
    tilted = reduced(load_arm(ARM / "arm.xml", gravity=(0.1, 0.0, -9.81)), "base", {"shoulder": 1.0})
    assert not tilted.upright
    assert tilted.gravity > 0.0
    assert reduced(load_arm(ARM / "arm.xml", gravity=(0.0, 0.0, 0.0)), "shoulder").upright


def test_inertia_does_not_depend_on_the_joints_own_angle() -> None:
    arm = load_arm(ARM / "arm.xml")
    found = [reduced(arm, "shoulder", {"shoulder": q, "elbow": 0.8}).inertia for q in np.linspace(-3, 3, 20)]
    assert np.ptp(found) < 1e-12


def test_what_an_actuator_has_of_a_rotor_counts_with_the_square_of_its_gear(tmp_path: Path) -> None:
    file = tmp_path / "geared.xml"
    body = '<body><joint name="j" axis="0 0 1"/><inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/></body>'
    act = '<actuator><motor joint="j" gear="3" armature="0.25"/></actuator>'
    file.write_text(f"<mujoco><worldbody>{body}</worldbody>{act}</mujoco>")
    own = reduced(load_arm(file), "j")
    assert own.inertia == pytest.approx(1.0)
    assert own.armature == pytest.approx(9 * 0.25)
