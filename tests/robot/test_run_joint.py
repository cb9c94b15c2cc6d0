"""A joint in the engines, tuned and as it looks: what engines and laws make of a model."""

import json
import math
from pathlib import Path

import mujoco
import numpy as np
import pytest
from lxml import etree

from harness.app.report import rebuild
from harness.app.run.joint import JointRun, run_joint
from harness.app.sweep.tune import tune_joint
from harness.core.errors import InputError
from harness.core.robot import Bodies
from harness.engines.models import folder
from harness.fidelity import tune as room
from harness.fidelity.laws import half_implicit
from harness.results.run import JointRunResult
from harness.robot.arm import load_arm
from harness.robot.own_model import loosened, words
from harness.robot.pictured import moved, pictured
from harness.robot.reduction import reduced

FILE = folder() / "arm" / "arm.xml"
SCORES = {"mujoco": ("as-shipped", "tuned"), "pybullet": ("as-shipped", "tuned")}


@pytest.fixture(scope="module")
def elbow(tmp_path_factory: pytest.TempPathFactory) -> JointRunResult:
    return run_joint(JointRun(FILE, "elbow"), tmp_path_factory.mktemp("run") / "out")


@pytest.mark.usefixtures("pybullet")
def test_every_engine_as_shipped_and_tuned_is_scored(elbow: JointRunResult) -> None:
    found = {(score.engine, score.preset): score for score in elbow.scores}
    assert set(found) == {(name, preset) for name, presets in SCORES.items() for preset in presets}
    assert all(score.error is None for score in elbow.scores)
    shipped, tuned = found["mujoco", "as-shipped"], found["mujoco", "tuned"]
    assert shipped.creep is not None
    assert tuned.creep is not None
    assert abs(tuned.creep) < 1e-3 * shipped.creep
    assert (shipped.dt_s, tuned.dt_s) == (0.002, 0.002)
    assert found["pybullet", "as-shipped"].dt_s == pytest.approx(1 / 240)
    assert found["pybullet", "tuned"].creep == pytest.approx(0.0, abs=1e-9)


@pytest.mark.parametrize("joint", ["shoulder", "elbow"])
def test_the_creep_is_that_of_the_users_own_model_with_the_others_held(tmp_path: Path, joint: str) -> None:
    """MuJoCo with the file as it is, the other joints too heavy to move, gravity off and the load put on."""
    score = run_joint(JointRun(FILE, joint, engines=("mujoco",), presets=("as-shipped",)), tmp_path / "out")
    model = mujoco.MjModel.from_xml_path(str(FILE))
    data, i = mujoco.MjData(model), model.joint(joint).id
    model.opt.gravity[:] = 0.0
    model.actuator_gainprm[:] = model.actuator_biasprm[:] = 0.0
    model.dof_armature[[j for j in range(model.nv) if j != i]] = 1e3
    data.qfrc_applied[i] = score.load
    mujoco.mj_step(model, data, 250)
    begin = float(data.qpos[i])
    mujoco.mj_step(model, data, 100)
    creep = (float(data.qpos[i]) - begin) / (100 * model.opt.timestep)
    # the joint's damping, which the score leaves out, bears a little of the load
    assert score.scores[0].creep == pytest.approx(creep, rel=0.05)


@pytest.mark.parametrize("integrator", ["Euler", "implicitfast", "RK4", "discrete"])
def test_the_servos_damping_is_what_mujoco_makes_of_it(tmp_path: Path, integrator: str) -> None:
    """Two samples of a frictionless swing about the servo's target give the map's determinant."""
    body = '<joint name="j" axis="0 0 1" damping="0.3"/><inertial pos="0 0 0" mass="1" diaginertia="1 1 0.5"/>'
    act = '<actuator><position joint="j" kp="80" kv="2"/></actuator>'
    option = f'<option timestep="0.01" integrator="{integrator}"/>'
    file = tmp_path / "servo.xml"
    file.write_text(f"<mujoco>{option}<worldbody><body>{body}</body></worldbody>{act}</mujoco>")
    arm = load_arm(file)
    assert words(arm, "j")["integrator"] == integrator
    model = mujoco.MjModel.from_xml_path(str(file))
    columns = []
    for start in ((1.0, 0.0), (0.0, 1.0)):
        data = mujoco.MjData(model)
        data.qpos[0], data.qvel[0] = start
        mujoco.mj_step(model, data)
        columns.append((float(data.qpos[0]), float(data.qvel[0])))
    acting = -0.5 / 0.01 * math.log(np.linalg.det(np.array(columns)))
    done = run_joint(JointRun(file, "j", engines=("mujoco",)), tmp_path / "out")
    assert done.servo is not None
    assert done.servo.stiffness == pytest.approx(80.0)
    assert done.servo.damping == pytest.approx(2.3)
    found = done.servo.scores[0].false_damping
    assert found is not None
    assert found + 2.3 == pytest.approx(acting, rel=2e-3)


def test_the_law_of_half_implicit_steps_is_its_determinant() -> None:
    m, c, c_end, h = 0.7, 3.0, 2.0, 0.01
    assert half_implicit(m, c, c_end, h) == pytest.approx(-m / h * math.log((1 - h * c / m) / (1 + h * c_end / m)))


def test_a_joint_that_friction_does_not_hold_is_said(elbow: JointRunResult, tmp_path: Path) -> None:
    assert any("is below gravity's 0.7554 N m" in sentence for sentence in elbow.conclusions)
    assert elbow.load == pytest.approx(0.97 * 0.3)
    base = run_joint(JointRun(FILE.with_suffix(".urdf"), "base", engines=("pybullet",)), tmp_path / "out")
    assert base.servo is None
    assert base.load == pytest.approx(0.97 * 0.45)
    assert (tmp_path / "out" / "report.html").is_file()


def test_a_joint_without_friction_has_nothing_to_score(tmp_path: Path) -> None:
    file = tmp_path / "bare.xml"
    file.write_text(FILE.read_text().replace('frictionloss="0.3"', ""))
    done = run_joint(JointRun(file, "elbow", engines=("mujoco",)), tmp_path / "out")
    assert done.load is None
    assert done.scores == []
    assert any("no dry friction" in sentence for sentence in done.conclusions)


def test_the_copy_and_the_files_are_there(elbow: JointRunResult) -> None:
    copy = load_arm(Path(elbow.files["robot_mjcf"]))
    i = copy.index("elbow")
    assert copy.model.dof_solref[i].tolist() == [-1.0, pytest.approx(-1.9 * 0.9999 / 0.002)]
    assert elbow.reduction.gravity == pytest.approx(reduced(copy, "elbow").gravity)
    assert json.loads(Path(elbow.files["result"]).read_text())["schema"] == "harness.joint/1"


def test_the_result_is_valid_by_its_schema(elbow: JointRunResult) -> None:
    jsonschema = pytest.importorskip("jsonschema")
    from harness.results.generate import models, schema_text

    schema = json.loads(schema_text("harness.joint/1", models()["harness.joint/1"]))
    jsonschema.validate(json.loads(elbow.model_dump_json(by_alias=True)), schema)


def test_the_page_is_made_again_from_the_trace_alone(elbow: JointRunResult, tmp_path: Path) -> None:
    result, page = rebuild(Path(elbow.files["rrd"]), tmp_path / "again.html")
    assert result == elbow
    assert page.read_bytes() == Path(elbow.files["report"]).read_bytes()


@pytest.mark.full
def test_it_beats_the_file_in_poses_that_were_not_searched_in(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(room, "STARTS", 1)
    result = tune_joint("mujoco", FILE, "elbow")
    assert result.dt_s == 0.002
    assert result.score_after < 0.05 * result.score_before
    assert result.robot is not None
    assert result.robot.joint == "elbow"
    assert len(result.robot.inertia) == len(result.sliders["searched_on"] + result.sliders["scored_on"])
    root = etree.fromstring(f"<all>{result.paste}</all>")
    option, joint = root.find("option"), root.find("joint")
    assert joint.get("name") == "elbow"
    tree = etree.fromstring(FILE.read_bytes())
    own = next(one for one in tree.iter("joint") if one.get("name") == "elbow")
    own.attrib.update(joint.attrib)
    tree.find("option").attrib.update(option.attrib)
    pasted = mujoco.MjModel.from_xml_string(etree.tostring(tree).decode())
    assert tuple(pasted.dof_solref[2]) == pytest.approx(result.settings["solreffriction"])


@pytest.mark.parametrize("by", [0.5, 1.0, 2.0])
def test_a_softer_impedance_has_that_much_more_regularisation(by: float) -> None:
    d = 0.9
    found = loosened({"solimpfriction": (d, 0.95, 0.001, 0.5, 2.0), "solver": "CG"}, by)
    soft, *others = found["solimpfriction"]
    assert (1.0 - soft) / soft == pytest.approx(by * (1.0 - d) / d)
    assert others == [0.95, 0.001, 0.5, 2.0]
    assert found["solver"] == "CG"


def test_a_joint_without_dry_friction_is_refused_in_one_line(tmp_path: Path) -> None:
    file = tmp_path / "arm.xml"
    file.write_text(FILE.read_text().replace('frictionloss="0.3"', ""))
    with pytest.raises(InputError, match="no dry friction"):
        tune_joint("mujoco", file, "elbow")


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
