"""The command on a log in which two joints move: friction that was put in comes back, and is put into the model."""

import json
from pathlib import Path

import mujoco
import numpy as np
import pytest

import harness
from harness.app.report.rebuild import rebuild
from harness.cli.main import run
from harness.core.quantity import Quantity
from harness.robot.whole_arm.whole import within_sample

F_K, C = (0.8, 0.3), (0.4, 0.1)
ARM = """
<mujoco><option gravity="0 0 -9.81"/><worldbody>
  <body name="upper"><joint name="shoulder" axis="0 1 0"/>
    <geom type="capsule" fromto="0 0 0 .4 0 0" size=".04" mass="2"/>
    <body name="lower" pos=".4 0 0"><joint name="elbow" axis="0 1 0"/>
      <geom type="capsule" fromto="0 0 0 .3 0 0" size=".03" mass="1"/></body>
  </body>
</worldbody></mujoco>
"""


@pytest.fixture(scope="module")
def case(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """An arm and a log of 20 s at 250 Hz, torque by inverse dynamics with Coulomb and viscous friction, 1 % noise."""
    folder = tmp_path_factory.mktemp("arm")
    (folder / "arm.xml").write_text(ARM)
    model = mujoco.MjModel.from_xml_string(ARM)
    data = mujoco.MjData(model)
    t = np.arange(5000) / 250.0
    q, v, a = (np.zeros((t.size, 2)) for _ in range(3))
    for j, waves in enumerate((((0.7, 0.23, 0.0), (0.2, 0.71, 1.0)), ((0.9, 0.31, 0.5), (0.25, 0.83, 2.0)))):
        for size, hertz, phase in waves:
            w = 2.0 * np.pi * hertz
            q[:, j] += size * np.sin(w * t + phase)
            v[:, j] += size * w * np.cos(w * t + phase)
            a[:, j] -= size * w * w * np.sin(w * t + phase)
    torque = np.zeros_like(q)
    for i in range(t.size):
        data.qpos[:], data.qvel[:], data.qacc[:] = q[i], v[i], a[i]
        mujoco.mj_inverse(model, data)
        torque[i] = data.qfrc_inverse
    torque += np.sign(v) * F_K + v * C
    torque += 0.01 * np.std(torque, axis=0) * np.random.default_rng(5).standard_normal(torque.shape)
    columns, names = [t], ["t"]
    for j, joint in enumerate(("shoulder", "elbow")):
        columns += [q[:, j], torque[:, j]]
        names += [f"{joint}.position", f"{joint}.effort"]
    np.savetxt(folder / "log.csv", np.column_stack(columns), delimiter=",", header=",".join(names), comments="")
    return folder


def test_friction_comes_back_and_goes_into_the_model(case: Path) -> None:
    out = case / "out"
    line = ["diagnose", str(case / "log.csv"), "--robot", str(case / "arm.xml"), "--joint", "elbow"]
    assert run([*line, "--out", str(out), "--json", str(case / "result.json"), "--quiet"]) == 0
    result = json.loads((case / "result.json").read_text())
    assert result["schema"] == "harness.diagnosis/2"
    assert result["robot"]["mode"] == "whole-arm"
    assert [joint["joint"] for joint in result["robot"]["arm"]["joints"]] == ["shoulder", "elbow"]
    for joint, f_k, c in zip(result["robot"]["arm"]["joints"], F_K, C, strict=True):
        assert joint["f_k"]["value"] == pytest.approx(f_k, abs=4.0 * joint["f_k"]["stderr"])
        assert joint["c"]["value"] == pytest.approx(c, abs=4.0 * joint["c"]["stderr"])
        assert joint["f_k"]["value"] == pytest.approx(f_k, rel=0.02)
    assert result["refined"]["parameters"]["f_k"]["value"] == pytest.approx(F_K[1], rel=0.02)
    assert result["verdict"] == "adequate"
    pasted = mujoco.MjModel.from_xml_path(result["files"]["robot_mjcf"])
    assert pasted.dof_frictionloss[1] == pytest.approx(result["refined"]["parameters"]["f_k"]["value"], rel=1e-9)
    assert pasted.dof_frictionloss[0] == 0.0
    left = np.loadtxt(result["files"]["residual_torque"], delimiter=",", skiprows=1)
    assert left.shape[1] == 5
    assert Path(result["files"]["rrd"]).stat().st_size > 1000
    page = Path(result["files"]["report"]).read_text(encoding="utf-8")
    assert "Friction of every joint" in page
    assert result["robot"]["simulated"][0]["engine"] == "mujoco"
    for one in result["robot"]["simulated"]:
        assert one["after"]["x"] < 0.2 * one["before"]["x"]
    _, again = rebuild(Path(result["files"]["rrd"]), case / "again.html")
    assert again.read_text(encoding="utf-8") == page


def test_a_joint_without_effort_is_refused_in_one_line(case: Path, capfd: pytest.CaptureFixture[str]) -> None:
    rows = np.loadtxt(case / "log.csv", delimiter=",", skiprows=1)
    names = "t,shoulder.position,shoulder.effort,elbow.position"
    path = case / "half.csv"
    np.savetxt(path, rows[:, :4], delimiter=",", header=names, comments="")
    line = ["diagnose", str(path), "--robot", str(case / "arm.xml"), "--joint", "elbow", "--out", str(case / "half")]
    assert run([*line, "--quiet"]) == 2
    said = capfd.readouterr().err
    assert said.count("\n") == 1
    assert "elbow" in said
    assert not (case / "half").exists()


def test_the_library_says_what_the_command_says(case: Path) -> None:
    found = harness.diagnose_joint(case / "log.csv", case / "arm.xml", "shoulder")
    assert found.robot is not None
    assert found.robot.joint == "shoulder"
    assert found.files == {}
    f_k = found.refined.parameters["f_k"].value
    assert f_k == pytest.approx(F_K[0], rel=0.02)


@pytest.mark.parametrize(
    ("delay", "stderr", "held"),
    [(-0.002, 4e-5, True), (-0.0039, 4e-5, True), (0.002, 4e-5, True), (-0.006, 4e-5, False), (0.005, 1e-5, False)],
)
def test_what_lies_within_a_sample_is_no_delay(delay: float, stderr: float, held: bool) -> None:
    """At 250 Hz a hold acts 2 ms after its sample in the mean, and a bus hands on what is up to 4 ms old."""
    assert within_sample(Quantity(delay, stderr, "s"), 250.0) is held


def test_a_joint_that_stands_still_is_refused_with_those_that_move(
    case: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    rows = np.loadtxt(case / "log.csv", delimiter=",", skiprows=1)
    names = "t,shoulder.position,shoulder.effort,elbow.position,elbow.effort"
    rows[:, 3] = 0.1
    rows[:, 4] = 0.5
    np.savetxt(case / "still.csv", rows, delimiter=",", header=names, comments="")
    line = ["diagnose", str(case / "still.csv"), "--robot", str(case / "arm.xml"), "--joint", "elbow"]
    assert run([*line, "--out", str(case / "still"), "--quiet"]) == 2
    said = capfd.readouterr().err
    assert said.count("\n") == 1
    assert "elbow" in said
