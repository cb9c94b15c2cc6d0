"""Words without effect: what takes it is another word of the file, and MuJoCo moves alike without the word."""

import math
from pathlib import Path

import mujoco
import numpy as np
import pytest

from harness.app.words import statement, words
from harness.robot.words.find import words_in
from harness.robot.words.motion import installed, model, speeds
from harness.robot.words.table import Form, table
from harness.robot.words.values import Found

ARM = """<mujoco>{}<worldbody><body name="b" {}><joint name="j" {}/><geom size=".1" pos=".5 0 0" mass="1"/></body>
</worldbody>{}</mujoco>"""
BOX = """<mujoco><option gravity="2 0 -9.81" {option}>{flag}</option><default>{default}</default><worldbody>
<geom name="floor" type="plane" size="9 9 1" {floor}/>
<body name="box" pos="0 0 .05"><freejoint/><geom name="g" type="box" size=".1 .1 .05" mass="1" {box}/></body>
</worldbody><contact>{pair}</contact></mujoco>"""
PAIR = '<pair geom1="floor" geom2="g" {}/>'
POSITION = '<actuator><position joint="j" {}/></actuator>'
GENERAL = '<actuator><general joint="j" gainprm="20" {}/></actuator>'
CLASSES = '<default><default class="arm"><joint damping="1"/></default>{}</default>'


def box(**slots: str) -> str:
    return BOX.format(**dict.fromkeys(("option", "flag", "default", "floor", "box", "pair"), "") | slots)


LOST = [
    (ARM.format(CLASSES.format('<default class="free"/>'), 'childclass="arm"', 'class="free"', ""), 'damping="1"'),
    (ARM.format(CLASSES.format(""), "", "", ""), 'damping="1"'),
    (ARM.format('<default><joint damping="5"/></default>', "", 'damping="1"', ""), 'damping="5"'),
    (ARM.format('<default><joint damping="5"/>' + CLASSES[9:].format(""), "", 'class="arm"', ""), 'damping="5"'),
    (ARM.format('<default><joint springdamper=".5 1"/></default>', "", 'damping="3"', ""), 'damping="3"'),
    (ARM.format('<option><flag spring="disable"/></option>', "", 'stiffness="9"', ""), 'stiffness="9"'),
    (ARM.format("", "", 'solreffriction=".004 1"', ""), 'solreffriction=".004 1"'),
    (ARM.format('<option actuatorgroupdisable="1 2"/>', "", "", POSITION.format('kp="9" group="2"')), 'kp="9"'),
    (ARM.format("", "", "", POSITION.format('kp="9" gear="0"')), 'kp="9"'),
    (ARM.format("", "", "", GENERAL.format('biasprm="0 -20 0"')), 'biasprm="0 -20 0"'),
    (box(floor='friction=".3"', pair=PAIR.format('friction=".2"')), 'friction=".3"'),
    (box(floor='friction=".9"', box='friction=".1" priority="1"'), 'friction=".9"'),
    (box(floor='friction="1.5"', box='friction=".1"'), 'friction=".1"'),
    (box(box='friction=".1"'), 'friction=".1"'),
    (box(floor='friction=".9"', box='condim="1" priority="1"'), 'friction=".9"'),
    (box(pair=PAIR.format('condim="1" friction=".9"')), 'friction=".9"'),
    (box(pair=PAIR.format('solreffriction=".01 1"')), 'solreffriction=".01 1"'),
    (box(default='<geom contype="0" conaffinity="0"/>', box='friction=".9"'), 'friction=".9"'),
    (box(option='o_friction=".1"', flag='<flag override="enable"/>', floor='friction=".9"'), 'friction=".9"'),
]
"""A file, and a word of it that does nothing."""
READ = [
    (ARM.format(CLASSES.format(""), 'childclass="arm"', "", ""), 'damping="1"'),
    (
        ARM.format('<default><general biastype="affine"/></default>', "", "", GENERAL.format('biasprm="0 -20 0"')),
        "biasprm",
    ),
    (ARM.format('<default><position kp="1"/></default>', "", "", GENERAL.format('biasprm="0 -20 0"')), "biasprm"),
    (ARM.format('<default><position kp="5"/></default>', "", "", POSITION.format("")), 'kp="5"'),
    (ARM.format('<default><joint frictionloss="1"/></default>', "", 'solreffriction=".004 1"', ""), "solreffriction"),
    (box(floor='friction=".1"', box='friction=".9"'), 'friction=".9"'),
    (box(floor='friction=".9"', box='friction=".1" priority="1"'), 'friction=".1"'),
    (box(option='cone="elliptic"', pair=PAIR.format('solreffriction=".01 1"')), "solreffriction"),
    (box(default='<geom friction=".1"/>'), 'friction=".1"'),
    (box(floor='condim="1"', box='friction=".1" priority="1"'), 'friction=".1"'),
]
"""A file, and a word of it that acts."""


def moved(text: str) -> np.ndarray:
    own = mujoco.MjModel.from_xml_string(text)
    data = mujoco.MjData(own)
    data.qvel[:] = 0.1
    mujoco.mj_step(own, data, 300)
    return np.concatenate((data.qpos, data.qvel))


def found(folder: Path, text: str, said: str) -> Found:
    path = folder / "a.xml"
    path.write_text(text)
    name, _, value = said.partition("=")
    return next(one for one in words_in(path).found if one.name == name and value.strip('"') in ("", one.value))


@pytest.mark.parametrize(("text", "said"), LOST)
def test_a_word_that_does_nothing_is_named(tmp_path: Path, text: str, said: str) -> None:
    assert np.array_equal(moved(text), moved(text.replace(said, "")))
    one = found(tmp_path, text, said)
    assert one.taken("mujoco").fate == "dropped"
    assert one.problem or one.note


@pytest.mark.parametrize(("text", "said"), READ)
def test_a_word_that_acts_is_left_alone(tmp_path: Path, text: str, said: str) -> None:
    one = found(tmp_path, text, said)
    assert not np.array_equal(moved(text), moved(text.replace(f'{one.name}="{one.value}"', "")))
    assert one.taken("mujoco").fate == "read"
    assert not one.problem


URDF = """<robot name="r"><link name="a"/><link name="b"><inertial><mass value="1"/><origin xyz=".3 0 0"/>
<inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link><joint name="j" type="{}"><parent link="a"/>
<child link="b"/><axis xyz="0 1 0"/><dynamics damping="0.1" friction="0.2"/></joint>{}</robot>"""


def test_a_flag_of_mujocos_in_a_urdf_takes_its_friction_there_alone(tmp_path: Path) -> None:
    text = URDF.format("continuous", '<mujoco><option><flag frictionloss="disable"/></option></mujoco>')
    assert np.array_equal(moved(text), moved(text.replace('friction="0.2"', "")))
    path = tmp_path / "a.urdf"
    path.write_text(text)
    fates = {one.name: (one.taken("mujoco").fate, one.taken("gazebo").fate) for one in words_in(path).found}
    assert fates["friction"] == ("dropped", "read")
    assert fates["damping"] == ("read", "read")


def test_a_floating_joint_has_no_damping_where_it_is_made_a_fixed_one(tmp_path: Path) -> None:
    pybullet = pytest.importorskip("pybullet")
    path = tmp_path / "a.urdf"
    path.write_text(URDF.format("floating", ""))
    client = pybullet.connect(pybullet.DIRECT)
    try:
        body = pybullet.loadURDF(str(path), useFixedBase=True, physicsClientId=client)
        assert pybullet.getJointInfo(body, 0, physicsClientId=client)[2] == pybullet.JOINT_FIXED
    finally:
        pybullet.disconnect(client)
    (damping,) = [one for one in words_in(path).found if one.name == "damping"]
    assert (damping.taken("pybullet").fate, damping.taken("mujoco").fate) == ("dropped", "read")
    assert "PyBullet makes a floating joint a fixed one" in damping.note


@pytest.mark.parametrize(("kind", "fate"), [("revolute", "dropped"), ("universal", "read")])
def test_a_second_axis_is_that_of_a_joint_with_two(tmp_path: Path, kind: str, fate: str) -> None:
    path = tmp_path / "a.sdf"
    axes = "<axis><xyz>0 1 0</xyz></axis><axis2><xyz>1 0 0</xyz><dynamics><damping>1</damping></dynamics></axis2>"
    joint = f'<joint name="j" type="{kind}"><parent>a</parent><child>b</child>{axes}</joint>'
    path.write_text(f'<sdf version="1.9"><model name="m"><link name="a"/><link name="b"/>{joint}</model></sdf>')
    (damping,) = words_in(path).found
    assert damping.taken("gazebo").fate == fate


VALUES = ("0,5", "0.5 N", "0.5N", ".5,1", "abc", "", "${d}", "nan", "inf", "0.5 1")
DAMPING: dict[Form, tuple[str, str]] = {
    "mjcf": ("joint", 'damping="{}"'),
    "urdf": ("joint", '<dynamics damping="{}" friction="0"/>'),
    "sdf": ("axis", "<dynamics><damping>{}</damping></dynamics>"),
}


@pytest.mark.parametrize("form", ["mjcf", "urdf", "sdf"])
def test_what_is_said_of_a_value_that_is_none_is_what_each_reader_does(form: Form, tmp_path: Path) -> None:
    slot, attribute = DAMPING[form]
    readers = [one.name for one in table().of(form) if installed(one)]
    texts = {value: model(form, **{slot: attribute.format(value)}) for value in ("0", "0.5", *VALUES)}
    rows = iter(speeds(form, [(reader, text) for text in texts.values() for reader in readers]))
    by_value = {value: dict(zip(readers, rows, strict=False)) for value in texts}
    for value in VALUES[: -1 if form == "mjcf" else None]:  # where two numbers are a polynomial
        path = tmp_path / f"a.{form}"
        path.write_text(texts[value])
        result = next(one for one in words(path).words if one.name == "damping")
        for reader in readers:
            v, none, half = (by_value[key][reader] for key in (value, "0", "0.5"))
            said = result.readers[reader]
            did: tuple[str, ...]
            if v is None:
                did = ("refused",)
            elif not math.isfinite(v) or abs(v) < 1e-9:
                did = ("meaning",)
            elif none is not None and abs(v - none) < 1e-6:
                did = ("dropped",)
            else:
                did = ("meaning",)
                assert v == pytest.approx(half, abs=1e-6)
            assert (value, reader, said.fate) == (value, reader, said.fate if said.fate in did else did)


def test_what_is_included_stands_where_its_include_does(tmp_path: Path) -> None:
    (tmp_path / "joint.xml").write_text('<mujocoinclude><joint name="j" damping="1" frictionlos="2"/></mujocoinclude>')
    path = tmp_path / "a.xml"
    path.write_text('<mujoco><worldbody><body><include file="joint.xml"/><geom size=".1"/></body></worldbody></mujoco>')
    damping, misspelt = words_in(path).found
    assert (damping.problem, damping.file.name) == ("", "joint.xml")
    assert misspelt.problem
    assert [one.problem for one in words_in(tmp_path / "joint.xml").found if one.name == "damping"] == [""]


MASS = '<inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>'


@pytest.mark.parametrize(
    "text",
    [
        '<mujoco><body><joint class="arm" damping="1"/><geom size=".1"/></body></mujoco>',
        '<mujoco><actuator><position joint="elbow" kp="2"/></actuator></mujoco>',
        '<mujoco><default><default class="arm"><joint damping="1"/></default></default><asset/></mujoco>',
    ],
)
def test_a_part_that_others_include_may_name_what_they_have(tmp_path: Path, text: str) -> None:
    path = tmp_path / "part.xml"
    path.write_text(text)
    assert [one.problem for one in words_in(path).found] == [""]


LINKS = (
    f'<link name="a"/><link name="b">{MASS}</link><joint name="j" type="continuous"><parent link="a"/>'
    '<child link="b"/>{}</joint>'
)


def urdf(folder: Path, inside: str = "", beside: str = "") -> Found:
    path = folder / "a.urdf"
    path.write_text(
        f'<robot name="r" xmlns:xacro="http://www.ros.org/wiki/xacro">{beside}{LINKS.format(inside)}</robot>'
    )
    return words_in(path).found[0]


def test_mjcf_in_a_urdf_is_read_by_mujoco_alone(tmp_path: Path) -> None:
    one = urdf(tmp_path, beside='<mujoco><option impratio="10"/></mujoco>')
    assert mujoco.MjModel.from_xml_path(str(tmp_path / "a.urdf")).opt.impratio == 10.0
    fates = {reader.name: one.taken(reader.name).fate for reader in table().of("urdf")}
    assert (one.problem, fates["mujoco"], fates["pybullet"], fates["drake"]) == ("", "read", "dropped", "dropped")


MACRO = f"""<xacro:macro name="m">{LINKS.format('<dynamics damping="1"/>')}</xacro:macro>"""


@pytest.mark.parametrize(
    ("inside", "beside", "name", "said"),
    [
        ('<contact><lateral_friction value=".4"/></contact>', "", "lateral_friction", "<link>"),
        ("", '<gazebo reference="j"><mu1>.4</mu1></gazebo>', "mu1", "link"),
        ("", "<gazebo><mu1>.4</mu1></gazebo>", "mu1", "reference"),
        ("", '<gazebo reference="b"><springStiffness>4</springStiffness></gazebo>', "springStiffness", "joint"),
        ("", MACRO, "damping", "xacro"),
    ],
)
def test_a_word_that_is_of_something_else_is_named(
    tmp_path: Path, inside: str, beside: str, name: str, said: str
) -> None:
    one = urdf(tmp_path, inside, beside)
    assert (one.name, bool(one.problem)) == (name, True)
    assert said in one.fix
    assert {one.taken(reader.name).fate for reader in table().of("urdf")} == {"dropped"}


def test_contact_words_are_called_by_their_elements(tmp_path: Path) -> None:
    one = urdf(tmp_path, beside='<link name="c"><contact><rolling_friction value=".1"/></contact></link>')
    assert (one.name, one.value, one.problem) == ("rolling_friction", ".1", "")


REFUSED = [
    (ARM.format("", "", 'class="nope" damping="1"', ""), "damping"),
    (ARM.format("", "", "", POSITION.replace('"j"', '"nope"').format('kp="2"')), "kp"),
    (ARM.format("", "", 'springdamper="0 1"', ""), "springdamper"),
    (ARM.format("", "", "", POSITION.format('kp="2" dampratio="-1"')), "dampratio"),
    (ARM.format("", "", "", POSITION.format('kp="2" kv="1" dampratio="1"')), "kv"),
    (box(box='condim="2"'), "condim"),
    (ARM.format('<option><flag passive="disable"/></option>', "", "", ""), "passive"),
]


@pytest.mark.parametrize(("text", "name"), REFUSED)
def test_a_word_for_which_mujoco_refuses_the_file_is_said_to_be_refused(tmp_path: Path, text: str, name: str) -> None:
    with pytest.raises(ValueError, match="Error"):
        mujoco.MjModel.from_xml_string(text)
    assert found(tmp_path, text, name).taken("mujoco").fate == "refused"


def test_a_contact_has_no_friction_below_zero(tmp_path: Path) -> None:
    below, none = (box(floor=f'friction="{mu}"', box=f'friction="{mu}"') for mu in ("-.5", "0"))
    assert np.allclose(moved(below), moved(none))
    one = found(tmp_path, below, "friction")
    assert (one.taken("mujoco").fate, "no more than 0" in one.problem) == ("dropped", True)
    assert not found(tmp_path, none, "friction").problem


@pytest.mark.parametrize("inside", ["<dynamics/>", "<dynamics></dynamics>"])
def test_dynamics_with_neither_word_is_refused_by_parsers_of_urdf(tmp_path: Path, inside: str) -> None:
    one = urdf(tmp_path, inside)
    text = (tmp_path / "a.urdf").read_text()
    readers = [reader for reader in ("mujoco", "pybullet", "dart") if installed(table().readers[reader])]
    did = speeds("urdf", [(reader, text) for reader in readers])
    assert one.problem == "has neither damping nor friction"
    assert [one.taken(reader).fate == "refused" for reader in readers] == [v is None for v in did]


SURFACE = "<surface><friction><ode><mu>.4</mu></ode></friction></surface>"


@pytest.mark.parametrize(
    ("model", "name", "said"),
    [
        (f'<link name="a"><collision name="c">{SURFACE}</collision></link>', "mu", ""),
        (f'<link name="a">{SURFACE}</link>', "mu", "<collision>"),
        (
            '<static>true</static><joint name="j" type="revolute"><axis><dynamics><damping>1</damping></dynamics>'
            "</axis></joint>",
            "damping",
            "<static>",
        ),
    ],
)
def test_an_sdf_has_its_surfaces_in_collisions_and_moves_where_it_is_not_static(
    tmp_path: Path, model: str, name: str, said: str
) -> None:
    path = tmp_path / "a.sdf"
    path.write_text(f'<sdf version="1.7"><model name="m">{model}</model></sdf>')
    (one,) = words_in(path).found
    assert (one.name, bool(one.problem)) == (name, bool(said))
    assert said in one.fix


USD = '#usda 1.0\ndef {} "elbow" (\n    prepend apiSchemas = [{}]\n)\n{{\n    float {}\n}}\n'


@pytest.mark.parametrize(
    ("prim", "schemas", "line", "said"),
    [
        ("PhysicsRevoluteJoint", '"PhysicsDriveAPI:angular"', "drive:angular:physics:damping = 2", ""),
        ("PhysicsRevoluteJoint", "", "drive:angular:physics:damping = 2", '"PhysicsDriveAPI:angular"'),
        ("PhysicsRevoluteJoint", '"PhysicsDriveAPI:linear"', "drive:linear:physics:damping = 2", "drive:angular"),
        ("PhysicsRevoluteJoint", "", "drive:angular:physics:damping.timeSamples = { 0: 2 }", "physics:damping = "),
        ("PhysicsRevoluteJoint", "", "physics:damping = 2", "newton:damping = 2"),
        ("PhysicsRevoluteJoint", "", "physxJoint:armature = 2", '"PhysxJointAPI"'),
        ("Material", "", "physics:dynamicFriction = .4", '"PhysicsMaterialAPI"'),
        ("Material", '"PhysicsMaterialAPI"', "physics:dynamicFriction = .4", ""),
    ],
)
def test_a_drive_of_a_usd_has_an_axis_of_its_joint_and_is_applied(
    tmp_path: Path, prim: str, schemas: str, line: str, said: str
) -> None:
    path = tmp_path / "a.usda"
    path.write_text(USD.format(prim, schemas, line))
    (one,) = words_in(path).found
    assert bool(one.problem) == bool(said)
    assert said in one.fix


def test_models_that_are_named_and_not_read_are_told(tmp_path: Path) -> None:
    path = tmp_path / "a.sdf"
    path.write_text('<sdf version="1.7"><world name="w"><include><uri>model://arm</uri></include></world></sdf>')
    result = words(path)
    assert result.unread == ["model://arm"]
    assert "not read: model://arm" in statement(result)
