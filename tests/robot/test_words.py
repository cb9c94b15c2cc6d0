"""Words of friction in models' files: each trap is named, and what the table says of readers is what they do."""

import json
from pathlib import Path

import jsonschema
import mujoco
import pytest

import harness
from harness.app.words import words
from harness.cli.main import run
from harness.core.errors import InputError
from harness.engines.models import folder
from harness.results import generate
from harness.robot.words.find import words_in
from harness.robot.words.motion import installed, model, speeds
from harness.robot.words.table import Form, table

Trap = tuple[Form, dict[str, str], str, str]
"""Format, texts in the slots of a test model, the word that is wrong, a part of what to write."""
DAMPED = 'springdamper="0.5 1"'
POSITION = '<actuator><position joint="j" {}/></actuator>'
TIP = '<link name="tip">{}</link><joint name="end" type="fixed"><parent link="arm"/><child link="tip"/>{}</joint>'
CLASS = '<default><default class="soft"><joint damping="1"/></default></default>'
TRAPS: list[Trap] = [
    ("mjcf", {"joint": 'friction="1"'}, "friction", "frictionloss"),
    ("mjcf", {"joint": 'frictionlos="1"'}, "frictionlos", "frictionloss"),
    ("mjcf", {"joint": 'damping="0,5"'}, "damping", "0.5"),
    ("mjcf", {"joint": 'damping="0.5 Nms"'}, "damping", "number alone"),
    ("mjcf", {"joint": 'frictionloss="1 2"'}, "frictionloss", "frictionloss"),
    ("mjcf", {"joint": 'damping="-1"'}, "damping", "damping"),
    (
        "mjcf",
        {"joint": 'frictionloss="1"', "top": '<option><flag frictionloss="disable"/></option>'},
        "frictionloss",
        "flag",
    ),
    ("mjcf", {"joint": 'damping="1"', "top": '<option><flag damper="disable"/></option>'}, "damping", "flag"),
    (
        "mjcf",
        {"end": POSITION.format('kp="2"'), "top": '<option><flag actuation="disable"/></option>'},
        "kp",
        "flag",
    ),
    ("mjcf", {"top": CLASS}, "damping", 'class="soft"'),
    ("mjcf", {"joint": f'damping="3" {DAMPED}'}, "damping", "springdamper"),
    ("mjcf", {"end": '<actuator><general joint="j" gainprm="2" biasprm="0 -2 0"/></actuator>'}, "biasprm", "affine"),
    ("mjcf", {"joint": 'solreffriction="0.004 1"'}, "solreffriction", "frictionloss"),
    ("mjcf", {"end": '<tendon><fixed><joint joint="j" coef="1" damping="1"/></fixed></tendon>'}, "damping", "<joint"),
    ("mjcf", {"end": '<actuator><motor joint="j" frictionloss="1"/></actuator>'}, "frictionloss", "<joint"),
    ("mjcf", {"end": POSITION.format('kp="2" kd="1"')}, "kd", "kp"),
    ("mjcf", {"joint": 'damping_ratio="1"'}, "damping_ratio", "damp"),
    ("urdf", {"joint": '<joint_properties damping="1" friction="1"/>'}, "damping", "<dynamics"),
    ("urdf", {"end": '<dynamics damping="1" friction="1"/>'}, "damping", "<joint>"),
    ("urdf", {"joint": '<dynamics friction="0"><damping>1</damping></dynamics>'}, "damping", "damping="),
    ("urdf", {"joint": '<dynamics frictionloss="1"/>'}, "frictionloss", "friction="),
    ("urdf", {"joint": '<dynamics damping="0" armature="0.5"/>'}, "armature", "drake:rotor_inertia"),
    ("urdf", {"joint": '<dynamics dampening="1" friction="0"/>'}, "dampening", "damping="),
    ("urdf", {"joint": '<dynamics damping="0,5" friction="0"/>'}, "damping", "0.5"),
    ("urdf", {"joint": '<dynamics damping="0.5 Nms/rad" friction="0"/>'}, "damping", "number alone"),
    ("urdf", {"joint": '<dynamics damping="${d}" friction="0"/>'}, "damping", "xacro"),
    ("urdf", {"joint": '<dynamics damping="-1" friction="0"/>'}, "damping", "damping="),
    ("urdf", {"joint": '<limit effort="9" velocity="9" damping="1"/>'}, "damping", "<dynamics"),
    ("urdf", {"joint": '<friction value="1"/>'}, "friction", "friction="),
    ("urdf", {"end": '<gazebo reference="nobody"><mu1>0.5</mu1></gazebo>'}, "mu1", "name one"),
    ("urdf", {"end": TIP.format("", '<dynamics damping="1" friction="1"/>')}, "damping", "moves"),
    (
        "urdf",
        {"end": TIP.format("<contact><lateral_friction>0.5</lateral_friction></contact>", "")},
        "lateral_friction",
        "value=",
    ),
    ("urdf", {"end": TIP.format('<contact_coefficients mu="0.5" kp="1" kd="1"/>', "")}, "mu", "lateral_friction"),
    (
        "urdf",
        {"end": TIP.format("<surface><friction><ode><mu>0.5</mu></ode></friction></surface>", "")},
        "mu",
        '<gazebo reference="tip"><mu1>0.5</mu1></gazebo>',
    ),
    ("sdf", {"joint": "<dynamics><damping>1</damping></dynamics>"}, "damping", "<axis>"),
    ("sdf", {"axis": '<dynamics damping="1"/>'}, "damping", "<damping>"),
    ("sdf", {"axis": "<dynamics><frictionloss>1</frictionloss></dynamics>"}, "frictionloss", "<friction>"),
    ("sdf", {"axis": "<dynamics><damping>0,5</damping></dynamics>"}, "damping", "0.5"),
    ("sdf", {"axis": "<dynamics><damping>0.5 Nms</damping></dynamics>"}, "damping", "number alone"),
    ("sdf", {"axis": "<damping>1</damping>"}, "damping", "<dynamics>"),
    ("sdf", {"axis": "<dynamics><damping>-1</damping></dynamics>"}, "damping", "<damping>"),
    ("sdf", {"axis": "<dynamics><viscous_damping>1</viscous_damping></dynamics>"}, "viscous_damping", "<damping>"),
    ("sdf", {"joint": "<joint_properties><friction>1</friction></joint_properties>"}, "friction", "<axis>"),
]


def test_there_are_forty() -> None:
    assert len(TRAPS) >= 40


def without(slots: dict[str, str]) -> dict[str, str]:
    """What a trap's file has besides the word that is wrong, as far as that moves the hinge."""
    return {
        slot: DAMPED if DAMPED in text else TIP.format("", "") if text.startswith('<link name="tip">') else ""
        for slot, text in slots.items()
    }


@pytest.mark.parametrize("form", ["mjcf", "urdf", "sdf"])
def test_each_trap_is_named_and_readers_do_with_it_what_is_said(form: Form, tmp_path: Path) -> None:
    own = [trap for trap in TRAPS if trap[0] == form]
    readers = [one.name for one in table().of(form) if installed(one)]
    texts = [model(form, **of) for _, slots, _, _ in own for of in (slots, without(slots))]
    moved = iter(speeds(form, [(reader, text) for text in texts for reader in readers]))
    said, done = [], []
    for i, (_, _, name, fix) in enumerate(own):
        path = tmp_path / f"{i}.{form}"
        path.write_text(texts[2 * i])
        of = words_in(path)
        assert of.form == form
        one = next(one for one in of.found if one.name == name and one.problem)
        assert fix in one.fix
        now, plain = [next(moved) for _ in readers], [next(moved) for _ in readers]
        for reader, v, v0 in zip(readers, now, plain, strict=True):
            assert v0 is not None
            fate = one.taken(reader).fate
            did = "refused" if v is None else "dropped" if abs(v - v0) < 2e-3 else "taken"
            said.append((i, name, one.value, reader, fate if fate in ("refused", "dropped") else "taken"))
            done.append((i, name, one.value, reader, did))
    assert [one for one in said if one not in done] == []


@pytest.mark.parametrize("form", ["mjcf", "urdf", "sdf"])
def test_what_the_table_says_of_a_reader_is_what_moves_in_it(form: Form, tmp_path: Path) -> None:
    """Every word that has a probe, in every reader that is here, with the file that has them all."""
    for word in table().words[form]:
        if word.probe is None:
            continue
        path = tmp_path / f"{word.name}.{form}"
        path.write_text(model(form, **{word.probe.slot: word.probe.text}))
        (found,) = (
            one
            for one in words(path).words
            if (one.name == word.name and float(one.value.split()[-1]) != 0.0) or one.name == "biasprm"
        )
        for reader, taken in found.readers.items():
            assert (reader, taken.fate) == (reader, word.taken(reader).fate)
            if taken.evidence == "motion" and taken.fate == "read":
                assert taken.measured == pytest.approx(1.0, abs=0.12)


@pytest.mark.usefixtures("pybullet")
def test_pybullet_adds_a_damping_and_a_motor_of_its_own() -> None:
    plain, exact = speeds("urdf", [("pybullet", model("urdf")), ("mujoco", model("urdf"))])
    assert plain is not None
    assert exact is not None
    assert plain < 0.995 * exact
    assert {one.reader for one in table().defaults if "damping" in one.kinds} >= {"pybullet", "isaac"}


USD = """#usda 1.0
def Xform "robot"
{
    def PhysicsRevoluteJoint "elbow" (prepend apiSchemas = ["PhysicsDriveAPI:angular"])
    {
        float drive:angular:physics:damping = 2  # N m s/deg
        %s
    }
}
"""


@pytest.mark.parametrize(
    ("line", "name", "fix"),
    [
        ("float physxJointAxis:angular:viscousFriction = 1", "viscousFriction", "viscousFrictionCoefficient"),
        ("float newton:armatur = 1", "armatur", "newton:armature"),
        ("custom float urdf:damping = 1", "urdf:damping", "damping"),
        ("float newton:friction = -1", "newton:friction", "newton:friction"),
    ],
)
def test_a_usd_as_text_is_read_and_its_units_are_told(tmp_path: Path, line: str, name: str, fix: str) -> None:
    path = tmp_path / "robot.usda"
    path.write_text(USD % line)
    drive, own = words(path).words
    assert (drive.place, drive.line, drive.problem) == ("elbow", 6, "")
    assert {taken.fate for taken in drive.readers.values()} == {"unit"}
    assert name in own.name
    assert own.problem
    assert fix in own.fix


SHIPPED = (
    *("kuka_iiwa/model.urdf", "franka_panda/panda.urdf", "husky/husky.urdf", "mjcf/ant.xml", "cartpole.urdf"),
    *("racecar/racecar.urdf", "kuka_iiwa/kuka_world.sdf", "a1/a1.urdf", "xarm/xarm6_robot.urdf"),
)


def test_files_that_packages_ship_are_read_and_only_what_is_wrong_is_named() -> None:
    data = pytest.importorskip("pybullet_data").getDataPath()
    wrong = {}
    for name in SHIPPED:
        wrong[name] = [one for one in words_in(Path(data, name)).found if one.problem]
    assert not any(wrong.values())
    wheels = words_in(Path(data, "r2d2.urdf")).found
    assert {(one.place, "joint_properties" in one.problem) for one in wheels} == {
        (f"joint {side}_wheel_joint", True) for side in ("right_front", "right_back", "left_front", "left_back")
    }


GEOMS = """<mujoco><default>{}</default><worldbody><geom type="plane" size="1 1 1" {}/>
<body><freejoint/><geom size="0.1" friction="0.5 0.1 0.1" {}/></body></worldbody></mujoco>"""


@pytest.mark.parametrize("default", ["", '<geom condim="1"/>', '<geom condim="6"/>'])
@pytest.mark.parametrize(
    ("floor", "ball"), [("", 'condim="1"'), ('condim="1"', 'condim="1"'), ("", ""), ('condim="4"', "")]
)
def test_a_contact_has_the_larger_condim_of_two_geoms(tmp_path: Path, default: str, floor: str, ball: str) -> None:
    path = tmp_path / "a.xml"
    path.write_text(GEOMS.format(default, floor, ball))
    own = mujoco.MjModel.from_xml_path(str(path))
    friction = next(one for one in words_in(path).found if one.value == "0.5 0.1 0.1")
    assert bool(friction.problem) == (own.geom_condim.max() == 1)


def test_a_library_of_classes_is_no_mistake(tmp_path: Path) -> None:
    path = tmp_path / "part.xml"
    path.write_text(f"<mujocoinclude>{CLASS}</mujocoinclude>")
    part = words_in(path)
    assert (part.form, [one.problem for one in part.found]) == ("mjcf", [""])


@pytest.mark.parametrize(
    ("name", "text", "said"),
    [
        ("a.urdf", '<!DOCTYPE r [<!ENTITY x "y">]><robot name="r"/>', "document type"),
        ("a.xml", "<scene/>", "<scene>"),
        ("a.xml", '<mujoco><include file="../b.xml"/></mujoco>', "outside the model's folder"),
        ("a.usd", "PXR-USDC", "usdcat a.usd -o a.usda"),
        ("a.sdf", "no file", "no XML"),
    ],
)
def test_what_is_no_model_is_refused_in_one_line(tmp_path: Path, name: str, text: str, said: str) -> None:
    path = tmp_path / name
    path.write_text(text)
    with pytest.raises(InputError, match=said):
        words_in(path)


def test_the_command_says_it_and_ends_by_what_it_found(tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    right, wrong = folder() / "arm" / "arm.urdf", tmp_path / "wrong.urdf"
    wrong.write_text(right.read_text().replace("<dynamics", "<joint_properties"))
    assert run(["words", str(right)]) == 0
    assert "none is wrong" in capfd.readouterr().out
    assert str(harness.words(right)).startswith(harness.words(right).statement)
    assert run(["words", str(right), "--engine", "mujoco", "--out", str(tmp_path / "out")]) == 0
    assert (tmp_path / "out" / "report.html").exists()
    result = json.loads((tmp_path / "out" / "result.json").read_text())
    jsonschema.validate(result, json.loads((generate.FOLDER / "harness.words-1.json").read_text(encoding="utf-8")))
    assert [one["value"] for one in result["words"]] == ["0.12", "0.45", "0.25", "0.8", "0.08", "0.3"]
    capfd.readouterr()
    assert run(["words", str(right), "--engine", "drake", "--quiet"]) == 1
    assert run(["words", str(wrong), "--json", "-"]) == 1
    assert json.loads(capfd.readouterr().out)["wrong"] == 6
    assert run(["words", str(right), "--engine", "unity"]) == 2
    assert "mujoco, mjx" in capfd.readouterr().err
