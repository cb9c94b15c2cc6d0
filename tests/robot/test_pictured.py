"""A robot as it looks: shapes of its own model where it has them, links from joint to joint where not."""

from pathlib import Path

import mujoco
import numpy as np
import pytest

from harness.core.robot.bodies import Bodies
from harness.engines.models import folder
from harness.robot.arm import load_arm
from harness.robot.pictured import moved, pictured

FILE = folder() / "arm" / "arm.xml"
TETRAHEDRON = "v 0 0 0\nv .2 0 0\nv 0 .2 0\nv 0 0 .2\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n"


def _drawn(file: Path, joint: str = "elbow") -> Bodies:
    arm = load_arm(file)
    t = np.linspace(0.0, 1.0, 60)
    return pictured(file, arm, t, {name: np.sin(3.0 * t) for name in arm.joints}, joint)


def test_our_arm_has_its_own_shapes_and_colours_in_both_formats() -> None:
    for name in ("arm.xml", "arm.urdf"):
        found = _drawn(FILE.with_name(name))
        assert len(found.shapes) == 12
        assert {"box", "cylinder"} <= {shape.kind for shape in found.shapes}
        assert (232, 120, 41) in {shape.color for shape in found.shapes}


def test_bodies_go_where_the_log_has_them() -> None:
    found = _drawn(FILE)
    model = mujoco.MjModel.from_xml_path(str(FILE))
    data = mujoco.MjData(model)
    for i in (0, found.t.size // 2, found.t.size - 1):
        data.qpos[:] = np.sin(3.0 * found.t[i])
        mujoco.mj_kinematics(model, data)
        assert np.allclose(found.places[i], data.xpos)
        assert np.allclose(found.turns[i], data.xquat)
    assert found.names == ("world", "turret", "upper_arm", "forearm")


def test_a_robot_without_shapes_is_drawn_from_joint_to_joint(tmp_path: Path) -> None:
    """Two rods of .4 and .3 m, meshes nowhere: a capsule of that length each, and an axle at every joint."""
    link = (
        '<link name="{}"><inertial><origin xyz="{} 0 0"/><mass value="1"/>'
        '<inertia ixx=".1" iyy=".1" izz=".1" ixy="0" ixz="0" iyz="0"/></inertial>'
        '<visual><geometry><mesh filename="package://nowhere/a.stl"/></geometry></visual></link>'
    )
    joint = (
        '<joint name="{}" type="continuous"><parent link="{}"/><child link="{}"/>'
        '<origin xyz="{} 0 0"/><axis xyz="0 1 0"/></joint>'
    )
    file = tmp_path / "rods.urdf"
    parts = [link.format("l1", 0.2), link.format("l2", 0.15), joint.format("j1", "l0", "l1", 0.0)]
    file.write_text(f'<robot name="r"><link name="l0"/>{"".join(parts)}{joint.format("j2", "l1", "l2", 0.4)}</robot>')
    found = _drawn(file, "j2")
    rods = [shape for shape in found.shapes if shape.kind == "capsule"]
    assert sorted(2.0 * float(rod.size[1]) for rod in rods) == pytest.approx([0.3, 0.4])
    axles = [shape for shape in found.shapes if shape.kind == "cylinder"]
    assert len(axles) == 2
    assert len({axle.color for axle in axles}) == 2


def test_meshes_that_are_there_are_drawn_and_those_that_are_not_are_no_harm(tmp_path: Path) -> None:
    (tmp_path / "meshes").mkdir()
    (tmp_path / "meshes" / "there.obj").write_text(TETRAHEDRON)
    file = tmp_path / "arm.xml"
    text = (
        '<mujoco><compiler meshdir="meshes"/><asset><mesh file="there.obj"/><mesh name="b" file="gone.stl"/></asset>'
        '<worldbody><body><inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/><joint name="j"/>'
        '<geom type="mesh" mesh="there" rgba="1 0 0 1"/><geom type="mesh" mesh="b"/></body></worldbody></mujoco>'
    )
    file.write_text(text)
    (mesh,) = _drawn(file, "j").shapes
    assert mesh.kind == "mesh"
    assert mesh.color == (255, 0, 0)
    assert mesh.corners is not None
    assert np.ptp(mesh.corners, axis=0) == pytest.approx([0.2, 0.2, 0.2], abs=0.1)
    (tmp_path / "meshes" / "there.obj").write_text("no mesh at all")
    assert {shape.kind for shape in _drawn(file, "j").shapes} <= {"capsule", "cylinder"}


def test_what_moves_nowhere_is_drawn_once() -> None:
    found = moved(FILE, load_arm(FILE), "elbow", None)
    assert found.t.shape == (1,)
    assert found.places.shape == (1, 4, 3)
