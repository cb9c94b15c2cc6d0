"""A joint of the user's model in the engines: creep, lead and false damping are what engines and laws make of it."""

import json
import math
from pathlib import Path

import mujoco
import numpy as np
import pytest

from harness.app.report.rebuild import rebuild
from harness.app.run.joint import JointRun, run_joint
from harness.engines.models import folder
from harness.fidelity.laws import half_implicit
from harness.results.run import JointRunResult
from harness.robot.arm import load_arm
from harness.robot.own_model import words
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
    assert any("does not hold gravity's 0.7554 N m" in sentence for sentence in elbow.conclusions)
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
