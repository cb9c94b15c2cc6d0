"""Models as others write them: bases that float, loops, couplings, inertias of no body, files in parts."""

import re
from pathlib import Path

import mujoco
import numpy as np
import pytest
from chains import chain, urdf

from harness.app.run.joint import JointRun, run_joint
from harness.cli.main import run
from harness.core.errors import InputError
from harness.engines.models import folder
from harness.robot.arm import Arm, load_arm
from harness.robot.reduction import reduced
from harness.robot.repair import of_a_body

LINK = '<inertial pos="0 .1 -.2" mass="1" diaginertia=".1 .1 .1"/>'
G = 9.81
FILE = folder() / "arm" / "arm.xml"


def mjcf(world: str, more: str = "") -> str:
    return f"<mujoco>{more}<worldbody>{world}</worldbody></mujoco>"


def loaded(folder: Path, text: str, name: str = "a.xml") -> Arm:
    (folder / name).write_text(text)
    return load_arm(folder / name)


def same_torque(one: Arm, other: Arm) -> None:
    assert one.joints == other.joints
    q, v, a = np.random.default_rng(1).normal(size=(3, 40, len(one.joints)))
    assert one.inverse(q, v, a) == pytest.approx(other.inverse(q, v, a), abs=1e-12)


@pytest.mark.parametrize("free", ["<freejoint/>", '<joint type="free"/>', '<joint type="ball"/>'])
def test_a_floating_base_is_held_and_a_loose_body_is_left_out(tmp_path: Path, free: str) -> None:
    arms = chain(4).replace("<worldbody>", '<worldbody><body name="trunk" pos="1 2 3" quat="1 2 0 0">{}')
    arms = arms.replace("</worldbody>", "</body></worldbody>")
    box = f'<body name="box">{free}<geom type="mesh" mesh="gone" mass="3"/></body>'
    floating = loaded(tmp_path, arms.replace("{}", free + LINK).replace("<worldbody>", f"<worldbody>{box}"))
    same_torque(floating, loaded(tmp_path, arms.replace("{}", "")))
    (note,) = floating.notes
    assert "trunk is held" in note


def test_a_joint_whose_class_makes_it_a_ball_is_held(tmp_path: Path) -> None:
    hinge, ball = f'<body><joint name="a" type="hinge"/>{LINK}', '<body childclass="socket"><joint/>'
    defaults = '<default><default class="socket"><joint type="ball"/></default></default>'
    arm = loaded(tmp_path, mjcf(f"{ball}{LINK}{hinge}</body></body>", defaults))
    assert arm.joints == ("a",)
    assert arm.model.nq == arm.model.nv == 1
    assert any("is held" in note for note in arm.notes)


def test_a_base_may_be_said_to_be_fixed_and_not_to_be_free(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    run_of = ["run", "--robot", str(FILE), "--joint", "elbow", "--engine", "mujoco", "--quiet"]
    assert run([*run_of, "--base", "fixed", "--out", str(tmp_path / "out")]) == 0
    assert run([*run_of, "--base", "free", "--out", str(tmp_path / "other")]) == 2
    assert "--base fixed" in capsys.readouterr().err
    assert run(["run", "--base", "fixed"]) == 2


def test_a_floating_joint_of_a_urdf_is_held(tmp_path: Path) -> None:
    kinds = re.compile('(name="j1" type=)"[a-z]+"')
    floating, fixed = (loaded(tmp_path, kinds.sub(rf'\1"{kind}"', urdf(1)), "a.urdf") for kind in ("floating", "fixed"))
    same_torque(floating, fixed)
    assert "l1 is held" in floating.notes[0]


def pendulums(*more: str) -> str:
    """Three hinges one on the other, each link with two sites at its end, and one beside them."""
    text, close = "", ""
    for i in range(3):
        site = f'<site name="s{i}" pos="0 0 -1"/>'
        text += f'<body name="b{i}" pos="0 0 -1"><joint name="q{i}" axis="0 1 0"/>{LINK}{site}'
        close += "</body>"
    beside = f'<body name="c"><joint name="p" axis="0 1 0"/>{LINK}<site name="sc"/></body>'
    hand = '<body name="hand" mocap="true"/>'
    return mjcf(text + close + beside + hand, "".join(more))


LOOPS = [
    ('<connect name="loop" body1="b0" body2="b2" anchor="0 0 0"/>', {"q1", "q2"}),
    ('<connect name="loop" site1="s1" site2="sc"/>', {"q0", "q1", "p"}),
    ('<weld name="loop" body1="b1"/>', {"q0", "q1"}),
    ('<weld name="loop" body1="b1" active="false"/>', set()),
    ('<joint name="loop" joint1="q0" joint2="q1" polycoef="0 1 .5 0 0"/>', {"q0", "q1"}),
]


@pytest.mark.parametrize(("equality", "joints"), LOOPS)
def test_joints_of_a_loop_are_refused_and_the_others_are_as_without_it(
    tmp_path: Path, equality: str, joints: set[str]
) -> None:
    looped, plain = loaded(tmp_path, pendulums(f"<equality>{equality}</equality>")), loaded(tmp_path, pendulums())
    assert set(looped.coupled) == joints
    same_torque(looped, plain)
    for name in plain.joints:
        if name in joints:
            with pytest.raises(InputError, match="loop"):
                reduced(looped, name)
        else:
            assert reduced(looped, name) == reduced(plain, name)


def test_the_hand_of_a_simulation_is_left_out_and_said(tmp_path: Path) -> None:
    arm = loaded(tmp_path, pendulums('<equality><weld body1="hand" body2="b2"/></equality>'))
    assert not arm.coupled
    assert "hand" in arm.notes[0]


TENDONS = [
    ('<fixed name="t" stiffness="5"><joint joint="q1" coef="1"/></fixed>', {"q1"}),
    ('<spatial name="t" stiffness="5"><site site="s0"/><site site="s2"/></spatial>', {"q1", "q2"}),
    ('<spatial name="t"><site site="s0"/><site site="s2"/></spatial>', set()),
]


@pytest.mark.parametrize(("tendon", "joints"), TENDONS)
def test_joints_that_a_tendon_pulls_are_refused(tmp_path: Path, tendon: str, joints: set[str]) -> None:
    arm = loaded(tmp_path, pendulums(f"<tendon>{tendon}</tendon>"))
    assert set(arm.coupled) == joints
    for name in joints:
        with pytest.raises(InputError, match="the tendon t pulls it"):
            reduced(arm, name)


def test_a_tendon_may_be_wound_around_a_shape_without_a_mass(tmp_path: Path) -> None:
    pulley = '<geom name="pulley" type="cylinder" size=".05 .02" mass="0"/><joint name="q1"'
    wound = '<tendon><spatial><site site="s0"/><geom geom="pulley"/><site site="s2"/></spatial></tendon>'
    arm = loaded(tmp_path, pendulums(wound).replace('<joint name="q1"', pulley, 1))
    same_torque(arm, loaded(tmp_path, pendulums("")))


def test_what_xacro_made_may_still_define_its_properties(tmp_path: Path) -> None:
    defined = (
        '<xacro:property xmlns:xacro="http://www.ros.org/wiki/xacro" name="long" value="${1 / 2}"/><link name="l1"'
    )
    same_torque(
        loaded(tmp_path, urdf(1).replace('<link name="l1"', defined, 1), "a.urdf"), loaded(tmp_path, urdf(1), "b.urdf")
    )


FINGERS = (
    '<body name="palm" euler="0 30 0"><body><joint name="left" type="slide" axis="1 0 0" armature=".3"/>'
    '<inertial pos="0 0 0" mass=".2" diaginertia="1 1 1"/></body><body><joint name="right" type="slide" axis="1 0 0"'
    ' stiffness="2" springref=".5" armature=".1"/><inertial pos="0 0 0" mass=".5" diaginertia="1 1 1"/></body></body>'
)
RATIOS = [
    '<equality><joint joint1="right" joint2="left" polycoef=".1 -2 0 0 0"/></equality>',
    '<tendon><fixed name="t"><joint joint="right" coef="1"/><joint joint="left" coef="2"/></fixed></tendon>'
    '<equality><tendon tendon1="t" polycoef=".1 0 0 0 0"/></equality>',
]


@pytest.mark.parametrize("more", RATIOS)
def test_a_joint_moves_another_by_a_ratio(tmp_path: Path, more: str) -> None:
    """m + r^2 M, weights that pull against each other, and the other's spring seen through the ratio."""
    arm = loaded(tmp_path, mjcf(FINGERS, more))
    found = reduced(arm, "left")
    assert found.moved == pytest.approx(0.2 + 0.3 + 4.0 * (0.5 + 0.1))
    assert found.armature == 0.3
    assert found.ratios["right"] == pytest.approx(-2.0)
    assert found.spring == pytest.approx(4.0 * 2.0)
    pull = G * np.sin(np.radians(30.0)) * (0.2 - 2.0 * 0.5)
    assert found.constant - found.spring * found.q_ref == pytest.approx(-pull - 2.0 * 2.0 * (0.1 - 0.5))
    assert "right" in found.sentence
    other = reduced(arm, "right")
    assert other.moved == pytest.approx(found.moved / 4.0)
    with pytest.raises(InputError, match="it moves right by a ratio"):
        run_joint(JointRun(tmp_path / "a.xml", "left"), tmp_path / "out")


def test_torque_of_a_coupled_joint_is_that_of_both_where_mujoco_moves_them(tmp_path: Path) -> None:
    """A stiff coupling in MuJoCo's forward dynamics against the torque of the pair."""
    more = '<equality><joint joint1="q1" joint2="q0" polycoef="0 -1 0 0 0" solref=".0004 1" solimp=".9999 .9999 .1"/>'
    text = pendulums(more + "</equality>")
    arm = loaded(tmp_path, text)
    model = mujoco.MjModel.from_xml_string(text)
    data = mujoco.MjData(model)
    q, v = np.array([0.3, -0.3, 0.4, 0.2]), np.array([0.7, -0.7, 0.1, 0.3])
    data.qpos[:], data.qvel[:] = q, v
    data.qfrc_applied[0] = 5.0
    mujoco.mj_forward(model, data)
    torque = arm.inverse(q[None], v[None], data.qacc[None])[0]
    assert torque == pytest.approx([5.0, -5.0, 0.0, 0.0], abs=0.02)
    # the log need not have the joint that follows
    unseen = arm.inverse(q[None] * [1, 0, 1, 1], v[None] * [1, 0, 1, 1], data.qacc[None] * [1, 0, 1, 1])[0]
    assert unseen == pytest.approx(torque, abs=0.02)


def test_a_pair_that_is_no_pendulum_is_refused(tmp_path: Path) -> None:
    arm = loaded(tmp_path, pendulums('<equality><joint joint1="q1" joint2="q0" polycoef="0 2 0 0 0"/></equality>'))
    with pytest.raises(InputError, match="what it moves changes as q1 moves with it"):
        reduced(arm, "q0")


def test_a_mimic_joint_moves_with_its_leader(tmp_path: Path) -> None:
    tail = '<dynamics damping="0.4" friction="0.6"/></joint></robot>'
    arm = loaded(tmp_path, urdf(2).replace(tail, '<mimic joint="j2" multiplier="-.5"/></joint></robot>'), "a.urdf")
    plain = loaded(tmp_path, urdf(2), "b.urdf")
    q, v, a = np.random.default_rng(1).normal(size=(3, 40, len(arm.joints)))
    leads = arm.index("j2")
    for y in (q, v, a):
        y[:, -1] = -0.5 * y[:, leads]
    both = plain.inverse(q, v, a)
    assert arm.inverse(q, v, a)[:, leads] == pytest.approx(both[:, leads] - 0.5 * both[:, -1])


WRONG = {
    "negative": ("0.02 0.03 0.02", "0 0 0.05"),
    "more than the others": ("0.01 0.01 0.09", "0 0 0"),
    "none about one axis": ("0.01 0.01 0", "0 0 0"),
}


@pytest.mark.parametrize("kind", WRONG)
def test_an_inertia_of_no_body_is_made_one_of_the_same_axes(tmp_path: Path, kind: str) -> None:
    own, mixed = ([float(x) for x in part.split()] for part in WRONG[kind])
    tensor = np.diag(own) + np.array([[0, mixed[0], mixed[1]], [mixed[0], 0, mixed[2]], [mixed[1], mixed[2], 0]])
    nearest = of_a_body(tensor)
    moments, before = np.linalg.eigvalsh(nearest), np.linalg.eigvalsh(tensor)
    assert moments[0] > 0.0
    assert moments[0] + moments[1] >= moments[2]
    assert moments[2] == pytest.approx(before[2])
    assert np.linalg.norm(nearest @ tensor - tensor @ nearest) < 1e-15
    numbers = dict(zip(("ixx", "iyy", "izz", "ixy", "ixz", "iyz"), (*own, *mixed), strict=True))
    written = " ".join(f'{name}="{value}"' for name, value in numbers.items())
    arm = loaded(tmp_path, re.sub(r'ixx="0.02"[^/]*', written, urdf(1), count=1), "a.urdf")
    assert "inertia of l1 is that of no body" in arm.notes[0]
    assert not loaded(tmp_path, urdf(1), "a.urdf").notes
    assert of_a_body(np.diag([0.1, 0.2, 0.25])).tolist() == np.diag([0.1, 0.2, 0.25]).tolist()


def test_a_link_without_a_mass_counts_as_next_to_nothing(tmp_path: Path) -> None:
    light = re.sub(r'<link name="l2"><inertial>.*?</inertial>', '<link name="l2">', urdf(1))
    arm = loaded(tmp_path, re.sub(r'<link name="l3"><inertial>.*?</inertial>', '<link name="l3">', light), "a.urdf")
    heavy = mjcf(f'<body name="base"><joint name="j"/>{LINK}<body name="light"><joint name="k"/></body></body>')
    other = loaded(tmp_path, heavy)
    assert "light" in other.notes[0]
    assert abs(other.inverse(np.ones((1, 2)), np.ones((1, 2)), np.ones((1, 2)))[0, 1]) < 1e-7
    assert arm.joints == loaded(tmp_path, urdf(1), "a.urdf").joints


def test_an_attached_model_is_as_if_it_stood_there(tmp_path: Path) -> None:
    (tmp_path / "parts").mkdir()
    joint = '<joint name="{}" axis="0 1 0" range="0 1"/>'
    hand = f'<body name="hand" pos="0 0 -1">{joint.format("{}finger")}{LINK}<geom size=".1" mass="{{}}"/></body>'
    (tmp_path / "parts" / "hand.xml").write_text(
        mjcf(hand.format("", 2), '<compiler angle="radian"/><default><joint armature=".2"/></default>')
    )
    asset = '<asset><model name="h" file="parts/hand.xml"/></asset>'
    arm = f'<body name="arm">{joint.format("elbow")}{LINK}{{}}</body>'
    attach = '<frame pos="0 0 .5"><attach model="h" body="hand" prefix="left_"/></frame>'
    attached = loaded(tmp_path, mjcf(arm.format(attach), asset))
    inside = hand.format("left_", 2).replace('axis="0 1 0"', 'axis="0 1 0" armature=".2"')
    same_torque(attached, loaded(tmp_path, mjcf(arm.format(f'<frame pos="0 0 .5">{inside}</frame>'))))


@pytest.mark.parametrize(
    ("part", "said"),
    [
        ('<origin xyz="0 0" rpy="0 0 0"/>', 'joint elbow: xyz="0 0" in its <origin>; expected three numbers'),
        ('<origin xyz="0 0 0" rpy="0 $(yaw) 0"/>', "joint elbow: rpy="),
        ('<axis xyz="0 1 0"/><axis xyz="0 0 1"/>', "joint elbow: several <axis>; expected one"),
        ('<child link="gone"/>', "joint elbow: no link 'gone'; expected one of a, b"),
        ('<origin xyz="${l1} 0 0" rpy="0 0 0"/>', "xacro arm.urdf > robot.urdf"),
        ('<xacro:insert_block xmlns:xacro="http://www.ros.org/wiki/xacro" name="b"/>', "xacro arm.urdf > robot.urdf"),
    ],
)
def test_a_urdf_is_refused_with_the_joint_that_is_wrong(tmp_path: Path, part: str, said: str) -> None:
    file = tmp_path / "arm.urdf"
    file.write_text(
        '<robot name="r"><link name="a"/><link name="b"><inertial><mass value="1"/>'
        '<inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>'
        f'<joint name="elbow" type="continuous"><parent link="a"/><child link="b"/>{part}</joint></robot>'
    )
    with pytest.raises(InputError) as refused:
        load_arm(file)
    assert said in str(refused.value)
