"""What is pasted for other engines has the joint's numbers in their units, and moves where one is here."""

import ast
import re
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from harness.robot.paste import JointPaste, elsewhere
from harness.robot.words.motion import model, speeds
from harness.robot.words.table import table

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
