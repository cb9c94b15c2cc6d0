"""PyBullet has no wheel above Python 3.11: there everything else works, and the doctor says what is missing."""

import sys
import tomllib
from pathlib import Path

import numpy as np
import pytest
from packaging.requirements import Requirement

from harness.app import doctor
from harness.app.diagnose.options import DiagnoseOptions
from harness.app.run.run import RunOptions
from harness.app.shared.reading import ReadOptions
from harness.cli.main import run
from harness.core.errors import SimulationError
from harness.engines import registry
from harness.proof.engine_source import engine_motion
from harness.proof.plant.model import base_model

CHECKOUT = Path(__file__).resolve().parents[2]


@pytest.fixture
def hidden(monkeypatch: pytest.MonkeyPatch) -> None:
    """An interpreter that cannot import pybullet."""
    for name in list(sys.modules):
        if name == "pybullet" or name.startswith("harness.engines.pybullet"):
            monkeypatch.delitem(sys.modules, name)
    monkeypatch.setitem(sys.modules, "pybullet", None)


@pytest.fixture
def later(hidden: None, monkeypatch: pytest.MonkeyPatch) -> None:
    """The same on a Python that has no wheel of it."""
    monkeypatch.setattr(registry, "NO_PYBULLET", sys.version_info[:2])


def test_it_is_a_dependency_where_there_is_a_wheel() -> None:
    lines = tomllib.loads((CHECKOUT / "pyproject.toml").read_text())["project"]["dependencies"]
    (found,) = [one for one in map(Requirement, lines) if one.name == "pybullet"]
    assert found.marker is not None
    for version in ("3.11", "3.12", "3.13", "3.14"):
        asked = found.marker.evaluate({"python_version": version})
        assert asked == (tuple(map(int, version.split("."))) < registry.NO_PYBULLET)


@pytest.mark.usefixtures("later")
def test_the_usual_engines_are_those_that_can_be_had() -> None:
    assert registry.usual() == ("mujoco",)
    assert RunOptions().engines == RunOptions.asked().engines == ("mujoco",)
    assert DiagnoseOptions().engines == DiagnoseOptions.chosen(ReadOptions()).engines == ("mujoco",)


@pytest.mark.usefixtures("pybullet")
@pytest.mark.usefixtures("hidden")
def test_a_broken_installation_is_no_reason_to_leave_it_out() -> None:
    assert registry.usual() == ("mujoco", "pybullet")
    assert not doctor.healthy(doctor.doctor())


@pytest.mark.usefixtures("hidden")
def test_asked_for_by_name_it_is_said_to_be_missing() -> None:
    with pytest.raises(SimulationError, match="engine pybullet: not installed"):
        registry.load("pybullet")
    with pytest.raises(SimulationError, match="engine pybullet: not installed"):
        engine_motion(base_model(1.0, 1.0, 100.0, 3.0, 1.0), np.linspace(0.0, 1.0, 11), "pybullet")


@pytest.mark.usefixtures("later")
def test_the_doctor_says_so_and_is_content(monkeypatch: pytest.MonkeyPatch) -> None:
    found = doctor.doctor()
    (check,) = [one for one in found.checks if one.name == "engine pybullet"]
    assert not check.ok
    assert "not installed" in check.found
    assert check.remedy is not None
    assert "Python 3.11" in check.remedy
    assert "optional" in check.needed_for
    assert doctor.healthy(found)


@pytest.mark.usefixtures("later")
def test_the_main_job_runs_and_names_what_is_left_out(tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    assert run(["run", "--preset", "tuned", "--out", str(tmp_path / "out")]) == 0
    out, _ = capfd.readouterr()
    assert "mujoco tuned" in out
    assert "pybullet tuned" not in out
    assert "- pybullet is left out: it has no wheel for this Python" in out
