"""SDF is read as the model that it is: against the same arm written otherwise, and against PyBullet's own reader."""

from pathlib import Path

import numpy as np
import pytest

import harness
from harness.core.errors import InputError
from harness.robot.arm import load_arm
from harness.robot.paste import JointPaste, copies

pybullet_data = pytest.importorskip("pybullet_data")
KUKA = Path(pybullet_data.getDataPath()) / "kuka_iiwa"
TWO = """<sdf version="{version}"><world name="w"><model name="two"><pose>0 0 1 0 0 0.4</pose>
  <frame name="bench"><pose>0.1 0 0 0 0 0</pose></frame>
  <link name="base"><inertial><mass>1</mass></inertial></link>
  <link name="upper"><pose relative_to="bench">0 0 0.2 0.3 0 0</pose>
    <inertial><pose>0.1 0.02 0 0 0 0</pose><mass>2</mass>
      <inertia><ixx>0.01</ixx><iyy>0.02</iyy><izz>0.02</izz><ixy>0.001</ixy></inertia></inertial></link>
  <joint name="ground" type="fixed"><parent>world</parent><child>base</child></joint>
  <joint name="shoulder" type="revolute"><pose>0.05 0 0 0 0.2 0</pose><parent>base</parent><child>upper</child>
    <axis><xyz{expressed}>0 1 0</xyz><limit><lower>-1</lower><upper>2</upper><effort>20</effort></limit>
      <dynamics><damping>0.3</damping><friction>0.4</friction></dynamics></axis></joint>
</model></world></sdf>
"""


def test_an_arm_is_the_same_as_sdf_and_as_urdf() -> None:
    sdf, urdf = (load_arm(KUKA / f"model.{suffix}") for suffix in ("sdf", "urdf"))
    assert sdf.joints == urdf.joints
    q, v, a = np.random.default_rng(1).standard_normal((3, 10, 7))
    # the two files round their numbers otherwise
    assert sdf.inverse(q, v, a) == pytest.approx(urdf.inverse(q, v, a), abs=2e-4)
    assert sdf.damping == pytest.approx(urdf.damping)
    assert any("lbr_iiwa_link_0 is held" in note for note in sdf.notes)


@pytest.mark.parametrize(("version", "expressed"), [("1.7", ""), ("1.7", ' expressed_in="bench"'), ("1.4", "")])
def test_frames_and_axes_are_where_the_version_has_them(tmp_path: Path, version: str, expressed: str) -> None:
    file = tmp_path / "two.sdf"
    file.write_text(TWO.format(version=version, expressed=expressed))
    arm = load_arm(file)
    assert arm.joints == ("shoulder",)
    assert (arm.damping[0], arm.frictionloss[0]) == pytest.approx((0.3, 0.4))
    assert arm.model.jnt_range[0] == pytest.approx((-1.0, 2.0))
    own = expressed == "" and version == "1.7"
    turn = _about_x(0.3) @ _about_y(0.2) if own else np.eye(3)
    axis = _about_z(0.4) @ turn @ [0.0, 1.0, 0.0]
    centre = _about_z(0.4) @ _about_x(0.3) @ [0.05, 0.02, 0.0]
    # what holds it against gravity
    held = axis @ np.cross(centre, [0.0, 0.0, 2.0 * 9.81])
    assert arm.inverse(*np.zeros((3, 1, 1)))[0, 0] == pytest.approx(held)


def _about_x(r: float) -> np.ndarray:
    return np.array([[1.0, 0.0, 0.0], [0.0, np.cos(r), -np.sin(r)], [0.0, np.sin(r), np.cos(r)]])


def _about_y(r: float) -> np.ndarray:
    return np.array([[np.cos(r), 0.0, np.sin(r)], [0.0, 1.0, 0.0], [-np.sin(r), 0.0, np.cos(r)]])


def _about_z(r: float) -> np.ndarray:
    return np.array([[np.cos(r), -np.sin(r), 0.0], [np.sin(r), np.cos(r), 0.0], [0.0, 0.0, 1.0]])


def test_what_is_pasted_is_in_a_urdf_beside(tmp_path: Path) -> None:
    file = tmp_path / "two.sdf"
    file.write_text(TWO.format(version="1.7", expressed=""))
    ((name, text),) = copies(file, JointPaste("shoulder", 0.5, 0.6, 0.0, 0.002)).items()
    assert name == "two.urdf"
    (tmp_path / name).write_text(text)
    again = load_arm(tmp_path / name)
    assert (again.frictionloss[0], again.damping[0]) == pytest.approx((0.5, 0.6))
    assert again.inverse(*np.ones((3, 1, 1))) == pytest.approx(load_arm(file).inverse(*np.ones((3, 1, 1))))


def test_what_urdf_cannot_say_is_refused_with_what_can(tmp_path: Path) -> None:
    file = tmp_path / "bad.sdf"
    whole = TWO.format(version="1.7", expressed="")
    axis = "<damping>0.3</damping>"
    for bad, said in (
        (whole.replace(axis, axis + "<spring_stiffness>2</spring_stiffness>"), "a spring"),
        (whole.replace("<child>base</child>", "<child>upper</child>"), "loop"),
        (whole.replace('relative_to="bench"', 'relative_to="desk"'), "desk"),
        (whole.replace("0 0 0.2 0.3 0 0", "0 0 zero 0.3 0 0"), "number"),
        (whole.replace('type="revolute"', 'type="screw"'), "screw"),
        ('<sdf version="1.7"><world name="w"/></sdf>', "0 models"),
        (whole.replace("</model>", "<include><uri>model://camera</uri></include></model>"), "gz sdf -p"),
    ):
        file.write_text(bad)
        with pytest.raises(InputError, match=said):
            load_arm(file)


HAND = """<link name="palm"><pose{palm}</pose><inertial><pose>0 0 0.1 0 0 0</pose><mass>0.5</mass></inertial></link>
<link name="{of}finger"><pose{finger}</pose><inertial><mass>0.2</mass></inertial></link>
<joint name="{of}grip" type="revolute"><parent>{of}palm</parent><child>{of}finger</child>
  <axis><xyz{axis}>0 1 0</xyz><dynamics><damping>0.1</damping></dynamics></axis></joint>"""


@pytest.mark.parametrize("version", ["1.8", "1.4"])
def test_a_model_within_a_model_is_where_its_frame_is(tmp_path: Path, version: str) -> None:
    """A hand as a model of its own, turned, against the same links and joints in the arm's model."""
    wrist = "<joint name='wrist' type='revolute'><parent>upper</parent><child>{}palm</child><axis><xyz>1 0 0</xyz>"
    ends, at = "</axis></joint></model></world>", "0.3 0.1 0.2 0.5 -0.2 0.7"
    inner = HAND.format(of="", palm=">0 0 0.1 0 0 0.3", finger=' relative_to="palm">0 0.05 0 0.4 0 0', axis="")
    hand = f"<model name='hand'><pose relative_to='upper'>{at}</pose>{inner}</model>"
    own = ' expressed_in="hand"' if version == "1.4" else ""
    outer = HAND.replace('"palm"', '"hand::palm"').format(
        of="hand::",
        palm=' relative_to="hand">0 0 0.1 0 0 0.3',
        finger=' relative_to="hand::palm">0 0.05 0 0.4 0 0',
        axis=own,
    )
    frame = f"<frame name='hand'><pose relative_to='upper'>{at}</pose></frame>"
    arms = []
    for more in (hand, frame + outer):
        whole = TWO.format(version=version, expressed="").replace(
            "</model></world>", more + wrist.format("hand::") + ends
        )
        (tmp_path / "hand.sdf").write_text(whole)
        arms.append(load_arm(tmp_path / "hand.sdf"))
    assert arms[0].joints == ("shoulder", "wrist", "hand::grip")
    q, v, a = np.random.default_rng(2).standard_normal((3, 10, 3))
    assert arms[0].inverse(q, v, a) == pytest.approx(arms[1].inverse(q, v, a), abs=1e-9)
    assert arms[0].damping == pytest.approx((0.3, 0.0, 0.1))


def test_a_link_that_says_nothing_of_its_mass_has_that_of_the_format(tmp_path: Path) -> None:
    """One kilogramme and one kg m^2, in whatever reads an SDF."""
    bare = """<sdf version="1.9"><model name="m"><link name="base"/><link name="wheel"><pose>0 0 1 0 0 0</pose></link>
      <joint name="ground" type="fixed"><parent>world</parent><child>base</child></joint>
      <joint name="axle" type="revolute"><pose>0 0 -0.5 0 0 0</pose><parent>base</parent><child>wheel</child>
      <axis><xyz>1 0 0</xyz></axis></joint></model></sdf>"""
    (tmp_path / "m.sdf").write_text(bare)
    arm = load_arm(tmp_path / "m.sdf")
    still, quarter = np.zeros((1, 1)), np.full((1, 1), np.pi / 2.0)
    assert arm.inverse(quarter, still, still)[0, 0] == pytest.approx(-0.5 * 9.81)
    assert arm.inverse(still, still, still + 1.0)[0, 0] == pytest.approx(1.0 + 0.5**2)
    (tmp_path / "m.sdf").write_text(bare.replace("</pose></link>", "</pose><inertial auto='true'/></link>"))
    with pytest.raises(InputError, match="expand-auto-inertials"):
        load_arm(tmp_path / "m.sdf")


def test_friction_of_its_joint_is_diagnosed_and_divided(tmp_path: Path) -> None:
    file = tmp_path / "two.sdf"
    file.write_text(TWO.format(version="1.7", expressed=""))
    t, w = np.arange(2000) / 200.0, 2.0 * np.pi * np.array([[0.13], [0.41]])
    size = np.array([[0.8], [0.3]])
    q, v, a = (
        np.sum(y, axis=0) for y in (size * np.sin(w * t), size * w * np.cos(w * t), -size * w**2 * np.sin(w * t))
    )
    torque = load_arm(file).inverse(q[:, None], v[:, None], a[:, None])[:, 0] + 0.5 * np.sign(v) + 0.2 * v
    torque += 0.003 * np.random.default_rng(0).standard_normal(t.size)
    rows = np.column_stack((t, q, torque))
    np.savetxt(tmp_path / "log.csv", rows, delimiter=",", header="t,shoulder.position,shoulder.effort", comments="")
    result = harness.diagnose_joint(tmp_path / "log.csv", file, engines=["mujoco"])
    assert result.baseline.parameters["f_k"].value == pytest.approx(0.5, rel=0.01)
    assert result.attribution is not None
    assert result.attribution.missing_physics == pytest.approx(0.0, abs=0.05)
