"""Models that are read, and those that are refused with one line that says why."""

import os
from pathlib import Path

import numpy as np
import pytest
from chains import urdf

from harness.core.errors import InputError
from harness.engines.models import folder
from harness.robot.arm import load_arm
from harness.robot.reduction import reduced

ARM = folder() / "arm"
LINK = '<inertial pos="0 0 -.2" mass="1" diaginertia=".1 .1 .1"/>'
TWO = (
    f'<body name="a"><joint name="one" axis="0 1 0"/>{LINK}'
    f'<body name="b" pos="0 0 -1"><joint name="two" axis="0 1 0"/>{LINK}</body></body>'
)


def mjcf(world: str, more: str = "") -> str:
    return f"<mujoco>{more}<worldbody>{world}</worldbody></mujoco>"


BOMB = (
    '<!DOCTYPE b [<!ENTITY a "aaaaaaaaaa"><!ENTITY b "&a;&a;&a;&a;&a;&a;&a;&a;">]>'
    '<mujoco model="&b;"><worldbody/></mujoco>'
)
MASS_OF_MESH = '<body name="a"><joint name="j"/><geom type="mesh" mesh="m"/></body>'
REFUSED = [
    ("a.xml", "<mujoco", "no XML"),
    ("a.xml", BOMB, "a document type"),
    ("a.xml", '<!DOCTYPE b SYSTEM "file:///etc/passwd"><mujoco/>', "a document type"),
    ("a.xml", "<collada/>", "XML that begins with <collada>"),
    ("a.xml", mjcf('<body><joint name="j" axis="0 0 0"/></body>'), "MuJoCo does not compile it"),
    ("a.xml", mjcf(f'<body name="box"><freejoint/>{LINK}</body>'), "no joint"),
    ("a.xml", mjcf('<geom size="1"/>'), "no joint"),
    ("a.xml", mjcf('<replicate count="99999"><body/></replicate>'), "99999 copies"),
    ("a.xml", mjcf('<body><composite prefix="rope" type="cable"/></body>'), "composite rope: it is no rigid body"),
    ("a.xml", mjcf(TWO, '<include file="../secret.xml"/>'), "a file outside the model's folder"),
    ("a.xml", mjcf(TWO, '<include file="a.xml"/>'), "a file included before"),
    ("a.xml", mjcf(TWO, '<include file="none.xml"/>'), "no such file"),
    ("a.xml", mjcf(TWO, '<asset><model name="m" file="../secret.xml"/></asset>'), "a file outside the model's folder"),
    ("a.xml", mjcf(TWO, '<asset><model name="m" file="a.xml"/></asset>'), "one that attaches another"),
    (
        "a.xml",
        mjcf(MASS_OF_MESH, '<asset><mesh name="m" file="gone.stl"/></asset>'),
        "mesh m: a moving body has the mass of gone.stl, which is not there",
    ),
    ("a.xml", mjcf(TWO, '<include xmlns="u" file="../secret.xml"/>'), "a file outside the model's folder"),
    ("a.xml", mjcf(f'<include xmlns="u" file="pipe.xml"/>{TWO}'), "no such file"),
    ("a.xml", mjcf('<replicate xmlns="u" count="99999"><body/></replicate>'), "99999 copies"),
    ("a.xml", mjcf('<body><composite xmlns="u" prefix="rope" type="cable"/></body>'), "it is no rigid body"),
    ("a.xml", mjcf(TWO.replace("axis", 'damping="nan" axis')), "a value that is no number (nan)"),
    ("a.xml", mjcf(TWO, "<whatever/>"), "<whatever> in <mujoco>, which is no MJCF"),
    ("a.urdf", urdf(1).replace('type="', 'type="sideways '), "type 'sideways "),
    ("a.urdf", '<robot name="r"><link name="l"/></robot>', "no joint"),
]  # fmt: skip


@pytest.mark.parametrize(("name", "text", "said"), REFUSED)
def test_what_is_no_arm_is_refused_in_one_line(
    tmp_path: Path, name: str, text: str, said: str, capfd: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / name).write_text(text)
    os.mkfifo(tmp_path / "pipe.xml")
    with pytest.raises(InputError) as refused:
        load_arm(tmp_path / name)
    assert said in str(refused.value)
    assert str(tmp_path / name) in str(refused.value)
    assert "\n" not in str(refused.value)
    assert capfd.readouterr() == ("", "")
    assert {file.name for file in tmp_path.iterdir()} == {name, "pipe.xml"}


def test_no_such_file_and_no_such_joint() -> None:
    with pytest.raises(InputError, match=r"nowhere\.urdf: no such file"):
        load_arm(Path("nowhere.urdf"))
    with pytest.raises(InputError, match="base, shoulder, elbow; did you mean shoulder"):
        load_arm(ARM / "arm.urdf").index("sholder")


def test_missing_meshes_do_not_matter_where_the_inertia_is_given(tmp_path: Path) -> None:
    seen = '<geom type="mesh" mesh="m" material="paint"/>'
    asset = '<asset><mesh name="m" file="gone.stl"/><texture name="t" file="gone.png" type="2d"/>'
    asset += '<material name="paint" texture="t"/></asset><compiler meshdir="nowhere"/>'
    world = f'<geom type="mesh" mesh="m"/>{TWO.replace(LINK, LINK + seen)}'
    (tmp_path / "a.xml").write_text(mjcf(world, asset))
    (tmp_path / "b.xml").write_text(mjcf(TWO))
    q, v, a = np.random.default_rng(1).normal(size=(3, 50, 2))
    one, other = load_arm(tmp_path / "a.xml"), load_arm(tmp_path / "b.xml")
    assert np.array_equal(one.inverse(q, v, a), other.inverse(q, v, a))
    (tmp_path / "c.urdf").write_text(urdf(3))
    assert load_arm(tmp_path / "c.urdf").joints[0] == "j1"


NAMED = ' xmlns="u" xmlns:p="v" p:file="pipe.xml"'


@pytest.mark.parametrize(
    ("name", "text"),
    [
        (
            "a.xml",
            mjcf(TWO).replace("<mujoco", f"<mujoco{NAMED}").replace("<body", '<p:include file="pipe.xml"/><body'),
        ),
        ("a.xml", mjcf(TWO, '<asset><texture xmlns="u" name="t" type="2d" file="pipe.xml"/></asset>')),
        ("a.urdf", urdf(1).replace("<robot", f"<robot{NAMED}")),
        ("a.urdf", urdf(1).replace("<visual", '<visual xmlns="u"').replace("<inertial", "<p/><inertial")),
    ],
)
def test_a_name_space_hides_nothing_from_the_checks(tmp_path: Path, name: str, text: str) -> None:
    """The parsers of the engines know no name spaces: what stands in one is checked as if it did not."""
    (tmp_path / name).write_text(text)
    os.mkfifo(tmp_path / "pipe.xml")  # whoever opens it waits for ever
    assert len(load_arm(tmp_path / name).joints) > 1


def test_a_mesh_outside_the_folder_is_named(tmp_path: Path) -> None:
    (tmp_path / "model").mkdir()
    corners = "\n".join(f"v {x} {y} {z}" for x in (0, 1) for y in (0, 1) for z in (0, 1))
    faces = ("1 2 4", "1 4 3", "5 7 8", "5 8 6", "1 5 6", "1 6 2", "3 4 8", "3 8 7", "1 3 7", "1 7 5", "2 6 8", "2 8 4")
    (tmp_path / "cube.obj").write_text("\n".join([corners, *(f"f {face}" for face in faces)]))
    text = mjcf(MASS_OF_MESH, '<compiler meshdir=".."/><asset><mesh name="m" file="cube.obj"/></asset>')
    (tmp_path / "model" / "a.xml").write_text(text)
    (note,) = load_arm(tmp_path / "model" / "a.xml").notes
    assert str(tmp_path / "cube.obj") in note


def test_a_model_in_several_files_is_one(tmp_path: Path) -> None:
    (tmp_path / "parts").mkdir()
    (tmp_path / "parts" / "arm.xml").write_text(mjcf(TWO))
    (tmp_path / "scene.xml").write_text(
        '<mujoco><include file="parts/arm.xml"/><worldbody><light/></worldbody></mujoco>'
    )
    assert load_arm(tmp_path / "scene.xml").joints == ("one", "two")


def test_friction_damping_stops_and_contacts_are_out_of_the_torque(tmp_path: Path) -> None:
    """What the file says of them is kept beside; only inertia, gravity and the joint's spring ask for a torque."""
    rough = TWO.replace('axis="0 1 0"', 'axis="0 1 0" frictionloss="3" damping="2" range="-5 5" limited="true"')
    (tmp_path / "a.xml").write_text(
        mjcf(rough.replace("</body></body>", '<geom size="3"/></body></body><geom size="9"/>'))
    )
    (tmp_path / "b.xml").write_text(mjcf(TWO))
    q, v, a = np.random.default_rng(1).normal(size=(3, 50, 2))
    one, other = load_arm(tmp_path / "a.xml"), load_arm(tmp_path / "b.xml")
    assert np.array_equal(one.inverse(q, v, a), other.inverse(q, v, a))
    assert one.frictionloss.tolist() == [3.0, 3.0]
    assert one.damping.tolist() == [2.0, 2.0]


def test_gravity_compensation_and_a_medium_are_taken_out_and_said(tmp_path: Path) -> None:
    (tmp_path / "a.xml").write_text(mjcf(TWO.replace('name="a"', 'name="a" gravcomp="1"'), '<option density="2"/>'))
    (tmp_path / "b.xml").write_text(mjcf(TWO))
    one, other = load_arm(tmp_path / "a.xml"), load_arm(tmp_path / "b.xml")
    q, v, a = np.random.default_rng(1).normal(size=(3, 50, 2))
    assert np.array_equal(one.inverse(q, v, a), other.inverse(q, v, a))
    assert [note.split(" is ")[0] for note in one.notes] == ["gravity compensation", "the drag of a medium"]


def test_gravity_may_be_given_for_a_base_that_stands_otherwise() -> None:
    along = reduced(load_arm(ARM / "arm.urdf", gravity=(0.0, 9.81, 0.0)), "elbow")
    assert along.upright
    assert reduced(load_arm(ARM / "arm.urdf"), "elbow").gravity == pytest.approx(0.7 * 9.81 * 0.11)
