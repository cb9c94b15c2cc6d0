"""The command on a log in which two joints move: friction that was put in comes back, and is put into the model."""

import json
from pathlib import Path

import mujoco
import numpy as np
import pytest
from two_joint_arm import ARM, moved

import harness
from harness.app.report.rebuild import rebuild
from harness.cli.main import run
from harness.core.quantity import Quantity
from harness.robot.whole_arm.whole import within_sample

F_K, C = (0.8, 0.3), (0.4, 0.1)
COLUMNS = "shoulder.position,shoulder.effort,elbow.position,elbow.effort"


@pytest.fixture(scope="module")
def case(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """An arm and a log of 20 s at 250 Hz, torque by inverse dynamics with Coulomb and viscous friction, 1 % noise."""
    folder = tmp_path_factory.mktemp("arm")
    (folder / "arm.xml").write_text(ARM)
    t, q, _, torque = moved(5000, 250.0, F_K, C)
    torque += 0.01 * np.std(torque, axis=0) * np.random.default_rng(5).standard_normal(torque.shape)
    table = np.column_stack((t, q[:, 0], torque[:, 0], q[:, 1], torque[:, 1]))
    np.savetxt(folder / "log.csv", table, delimiter=",", header=f"t,{COLUMNS}", comments="")
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


@pytest.mark.parametrize("kind", ["without effort", "still"])
def test_a_joint_that_cannot_be_asked_is_refused_in_one_line(
    kind: str, case: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    rows, names = np.loadtxt(case / "log.csv", delimiter=",", skiprows=1), COLUMNS
    if kind == "still":
        rows[:, 3:] = (0.1, 0.5)
    else:
        rows, names = rows[:, :4], COLUMNS.removesuffix(",elbow.effort")
    path, out = case / f"{kind}.csv", case / kind
    np.savetxt(path, rows, delimiter=",", header=f"t,{names}", comments="")
    line = ["diagnose", str(path), "--robot", str(case / "arm.xml"), "--joint", "elbow", "--out", str(out)]
    assert run([*line, "--quiet"]) == 2
    said = capfd.readouterr().err
    assert said.count("\n") == 1
    assert "elbow" in said
    assert not out.exists()
