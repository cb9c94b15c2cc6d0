"""What is pasted is what the model then has, and nothing else of the file changes; other engines have their units."""

import ast
import re
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from chains import chain, urdf
from hypothesis import given
from hypothesis import strategies as st
from lxml import etree

from harness.core.errors import InputError
from harness.engines.models import folder
from harness.robot.arm import load_arm
from harness.robot.paste import JointPaste, copies, elsewhere, tags
from harness.robot.words.motion import model, speeds
from harness.robot.words.table import table

ARM = folder() / "arm"
OURS = JointPaste("shoulder", 1.25, 0.375, 0.0625, 0.002)


def _without(text: str, *names: str) -> list[tuple[str, dict[str, str]]]:
    """Every element in order with its attributes, but for these."""
    root = etree.fromstring(text.encode())
    return [(e.tag, {k: v for k, v in e.attrib.items() if k not in names}) for e in root.iter() if e.tag != "dynamics"]


@pytest.mark.parametrize("suffix", ["xml", "urdf"])
def test_the_copy_compiles_has_the_friction_and_is_otherwise_the_same(tmp_path: Path, suffix: str) -> None:
    path = ARM / f"arm.{suffix}"
    (name, text) = next(iter(copies(path, OURS).items()))
    assert name == path.name
    (tmp_path / name).write_text(text)
    before, after = load_arm(path), load_arm(tmp_path / name)
    assert after.frictionloss.tolist() == [before.frictionloss[0], 1.25, before.frictionloss[2]]
    assert after.damping.tolist() == [before.damping[0], 0.375, before.damping[2]]
    assert after.armature[1] == (0.0625 if suffix == "xml" else 0.0)
    changed = [i for i, (a, b) in enumerate(zip(path.read_text().split("\n"), text.split("\n"), strict=True)) if a != b]
    assert len(changed) == 1


def test_friction_in_mjcf_is_as_stiff_as_the_robots_own_step_allows(tmp_path: Path) -> None:
    (tmp_path / "arm.xml").write_text(copies(ARM / "arm.xml", OURS)["arm.xml"])
    model = load_arm(tmp_path / "arm.xml").model
    assert model.dof_solref[1].tolist() == [-1.0, pytest.approx(-1.9 * 0.9999 / 0.002)]
    assert model.dof_solimp[1, :2].tolist() == [0.9999, 0.9999]


@pytest.mark.parametrize("seed", range(8))
def test_random_models_keep_all_else(tmp_path: Path, seed: int) -> None:
    for name, text in (("a.xml", chain(seed)), ("a.urdf", urdf(seed))):
        (tmp_path / name).write_text(text)
        joint = load_arm(tmp_path / name).joints[-1]
        paste = JointPaste(joint, 2.0, 3.0, 0.5, 0.001)
        after = copies(tmp_path / name, paste)[name]
        words = tuple(paste.mjcf_words) if name == "a.xml" else ()
        assert _without(after, *words) == _without(text, *words)
        (tmp_path / name).write_text(after)
        assert load_arm(tmp_path / name).frictionloss[-1] == 2.0


TRICKY = [
    ("<joint name='j' axis='0 0 1'/>", "single quotes"),
    ('<!-- <joint name="j"/> --><joint name="j" axis="0 0 1"/>', "a comment before it"),
    ('<joint\n  axis="0 0 1"\n  frictionloss = "7"\n  name="j"\n/>', "over lines, with a value to change"),
    ('<joint name="j" axis="0 0 1" user="1"></joint>', "an end tag"),
    ('<site name="a&gt;b"/><joint name="j" axis="0 0 1"/>', "signs that are escaped"),
]


@pytest.mark.parametrize(("joint", "what"), TRICKY)
def test_the_element_is_found_however_it_is_written(tmp_path: Path, joint: str, what: str) -> None:
    inertial = '<inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/>'
    gears = '<tendon><fixed><joint joint="j" coef="1"/></fixed></tendon>'
    size = '<size nuser_jnt="1"/>'
    file = tmp_path / "a.xml"
    file.write_text(f"<mujoco>{size}<worldbody><body>{joint}{inertial}</body></worldbody>{gears}</mujoco>")
    text = copies(file, JointPaste("j", 1.5, 0.5, 0.25, 0.002))["a.xml"]
    file.write_text(text)
    arm = load_arm(file)
    assert (arm.frictionloss[0], arm.damping[0], arm.armature[0]) == (1.5, 0.5, 0.25), what
    assert text.count("frictionloss") == 1


def test_a_joint_without_dynamics_is_given_some(tmp_path: Path) -> None:
    file = tmp_path / "a.urdf"
    file.write_text(urdf(1).replace('<dynamics damping="0.4" friction="0.6"/>', ""))
    (tmp_path / "a.urdf").write_text(copies(file, JointPaste("j1", 1.5, 0.5, 0.0, 0.002))["a.urdf"])
    assert load_arm(file).frictionloss[0] == 1.5


def test_the_file_that_has_the_joint_is_the_one_that_is_copied(tmp_path: Path) -> None:
    (tmp_path / "part.xml").write_text((ARM / "arm.xml").read_text())
    (tmp_path / "scene.xml").write_text('<mujoco><include file="part.xml"/></mujoco>')
    assert set(copies(tmp_path / "scene.xml", OURS)) == {"part.xml"}


def test_what_is_said_to_pybullet_and_what_a_format_leaves_out() -> None:
    assert OURS.urdf.startswith('<dynamics damping="0.375" friction="1.25"/>')
    assert "targetVelocity=0, force=1.25" in OURS.urdf
    assert OURS.cannot_say("mjcf", ("stribeck",)) == ("mjcf: no stribeck of shoulder",)
    assert len(OURS.cannot_say("urdf")) == 2
    with pytest.raises(InputError, match="f_k"):
        JointPaste("j", -1.0, 0.0, 0.0, 0.002)


@given(st.lists(st.sampled_from(["<a>", "</a>", '<b x="1>2"/>', "<!-- <a> -->", "text", "<c y='&lt;'>", "</c>"])))
def test_tags_of_any_well_formed_text_are_those_that_a_parser_finds(parts: list[str]) -> None:
    text = f"<r>{''.join(parts)}</r>"
    try:
        root = etree.fromstring(text)
    except etree.XMLSyntaxError:
        return
    found = [(tag.way[-1], dict(tag.attributes)) for tag in tags(text)]
    assert found == [(e.tag, dict(e.attrib)) for e in root.iter() if isinstance(e.tag, str)]


def test_the_calls_for_pybullet_hold_the_joint_where_its_file_alone_does_not() -> None:
    """Friction of 4 N m bears the arm's 3.4; PyBullet's reading of the file lets it fall."""
    pybullet = pytest.importorskip("pybullet")
    fell = []
    for lines in ((), JointPaste("shoulder", 4.0, 0.25, 0.0, 0.002).calls):
        client = pybullet.connect(pybullet.DIRECT)
        body = pybullet.loadURDF(str(ARM / "arm.urdf"), useFixedBase=True)
        pybullet.setGravity(0, 0, -9.81)
        for joint in range(pybullet.getNumJoints(body)):
            pybullet.setJointMotorControl2(body, joint, pybullet.VELOCITY_CONTROL, force=100.0 if joint != 1 else 0.0)
        pybullet.resetJointState(body, 1, 0.8)
        exec("\n".join(lines), {"p": pybullet, "body": body})
        for _ in range(120):
            pybullet.stepSimulation()
        fell.append(abs(pybullet.getJointState(body, 1)[0] - 0.8))
        pybullet.disconnect(client)
    assert fell[0] > 0.1
    assert fell[1] < 1e-3


ELBOW, RAIL = JointPaste("elbow", 0.75, 0.5, 0.0625, 0.002), JointPaste("rail", 3.0, 1.25, 0.0, 0.002)
TEXTS = elsewhere([ELBOW, RAIL], lambda name: name == "rail")


def test_nothing_is_written_for_no_joint() -> None:
    assert elsewhere([], lambda _: False) == {}
    assert set(TEXTS) == {"isaac", "newton", "sdf", "genesis", "drake", "ros2"}


def test_physx_has_a_hinges_viscous_friction_per_degree() -> None:
    found = dict(re.findall(r"physxJointAxis:(\w+:\w+) = (\S+)", TEXTS["isaac"]))
    assert float(found["angular:viscousFrictionCoefficient"]) * 180.0 / np.pi == pytest.approx(0.5)
    assert float(found["linear:viscousFrictionCoefficient"]) == 1.25
    assert float(found["angular:dynamicFrictionEffort"]) == float(found["angular:staticFrictionEffort"]) == 0.75
    words = {one.name for one in table().words["usd"]}
    assert {f"physxJointAxis:*:{name.split(':')[1]}" for name in found} <= words


def test_isaac_lab_has_actuators_in_radians() -> None:
    made: dict[str, Any] = {}

    def actuator(**given: Any) -> dict[str, Any]:
        return given

    text = TEXTS["isaac"].replace("from isaaclab.actuators import ImplicitActuatorCfg", "")
    exec(text, {"ImplicitActuatorCfg": actuator}, made)
    elbow = made["actuators"]["elbow"]
    assert (elbow["friction"], elbow["dynamic_friction"], elbow["viscous_friction"]) == (0.75, 0.75, 0.5)
    assert elbow["armature"] == 0.0625


def test_newton_and_genesis_are_called_with_the_numbers() -> None:
    builder = SimpleNamespace(
        joint_label=["robot/rail", "robot/elbow"],
        joint_qd_start=[0, 1],
        joint_friction=[0.0, 0.0],
        joint_damping=[0.0, 0.0],
        joint_armature=[0.0, 0.0],
    )
    exec(TEXTS["newton"], {"builder": builder})
    assert (builder.joint_friction, builder.joint_damping, builder.joint_armature) == (
        [3, 0.75],
        [1.25, 0.5],
        [0, 0.0625],
    )
    calls = [ast.unparse(node) for node in ast.walk(ast.parse(TEXTS["genesis"])) if isinstance(node, ast.Call)]
    assert {"robot.set_dofs_frictionloss([0.75], dof)", "robot.set_dofs_damping([1.25], dof)"} <= set(calls)
    ast.parse(TEXTS["drake"])


def test_sdf_is_read_by_dart_as_it_is_said() -> None:
    pytest.importorskip("dartpy")
    comment, dynamics = elsewhere([ELBOW], lambda _: False)["sdf"].splitlines()
    assert "DART" in comment.partition("dropped by")[0]
    own, plain = speeds("sdf", [("dart", model("sdf", axis=dynamics)), ("dart", model("sdf"))])
    assert plain is not None
    assert own is not None
    assert own < plain - 0.2


def test_a_controllers_parameters_are_yaml() -> None:
    yaml = pytest.importorskip("yaml")
    own = yaml.safe_load(TEXTS["ros2"])["friction_compensation"]["ros__parameters"]
    assert own["joints"] == ["elbow", "rail"]
    assert own["elbow"] == {"coulomb": 0.75, "viscous": 0.5, "tanh_width": 0.05}
