"""A log that does not go together with its model: said with the option that mends it, and nothing is named."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from two_joint_arm import ARM, moved

import harness
from harness.cli.main import run
from harness.results.diagnosis import DiagnosisResult

JOINTS = ("shoulder", "elbow")
F_K = (0.8, 0.4)


@pytest.fixture(scope="module")
def motion() -> tuple[np.ndarray, ...]:
    """t, q, torque of 12 s at 125 Hz, with dry friction."""
    t, q, v, torque = moved(1500, 125.0, F_K, (0.1, 0.1))
    return t, q, torque + 0.02 * np.random.default_rng(5).standard_normal(v.shape)


def _written(folder: Path, t: np.ndarray, q: np.ndarray, torque: np.ndarray) -> Path:
    (folder / "arm.xml").write_text(ARM)
    names = [f"{joint}.{kind}" for kind in ("position", "effort") for joint in JOINTS]
    rows = np.column_stack((t, q, torque))
    np.savetxt(folder / "log.csv", rows, delimiter=",", header=",".join(["t", *names]), comments="")
    return folder / "log.csv"


Change = Callable[[np.ndarray, np.ndarray], tuple[np.ndarray, np.ndarray]]
CHANGES: dict[str, tuple[Change, str]] = {
    "signs": (lambda q, u: (q, -u), "--gain -1"),
    "millis": (lambda q, u: (q, 1e3 * u), "--gain 0.001"),
    "feet": (lambda q, u: (q, 0.7375621 * u), "--gain 1.355818"),
    "swapped": (lambda q, u: (q[:, ::-1], u[:, ::-1]), "--names shoulder=elbow,elbow=shoulder"),
    "one sign": (lambda q, u: (q, u * (-1, 1)), "--gain shoulder=-1"),
    "turned": (lambda q, u: (q * (1, -1), u * (1, -1)), "--flip elbow"),
    "zero": (lambda q, u: (q - (0, np.pi / 2), u), "--offset elbow=1.5708"),
    "degrees": (lambda q, u: (np.degrees(q), u), "--angle-unit deg"),
}


@pytest.mark.parametrize("change", CHANGES)
def test_a_mismatch_is_said_with_what_mends_it(change: str, motion: tuple[np.ndarray, ...], tmp_path: Path) -> None:
    t, q, torque = motion
    make, option = CHANGES[change]
    log = _written(tmp_path, t, *make(q, torque))
    found = harness.diagnose_joint(log, tmp_path / "arm.xml", "elbow", engines=())
    assert found.verdict == "unexplained"
    assert not found.mechanisms
    assert found.statement.endswith(f"Try: {option}")
    assert found.robot is not None
    assert not found.robot.paste.mjcf
    assert any(option == one.option and one.suspicion for one in found.robot.match)


def test_the_option_mends_it_and_amperes_are_told_by_joint(motion: tuple[np.ndarray, ...], tmp_path: Path) -> None:
    t, q, torque = motion
    log = _written(tmp_path, t, q, torque / (11.0, 4.0))
    model = tmp_path / "arm.xml"
    found = harness.diagnose_joint(log, model, "elbow", engines=())
    assert "current in A" in found.statement
    option = found.statement.partition("Try: ")[2].split()
    gains = {name: float(gain) for name, _, gain in (one.partition("=") for one in option[1].split(","))}
    assert gains == {"shoulder": pytest.approx(11.0, rel=0.02), "elbow": pytest.approx(4.0, rel=0.02)}
    line = ["diagnose", str(log), "--robot", str(model), "--joint", "elbow", "--quiet", *option]
    assert run([*line, "--out", str(tmp_path / "out"), "--json", str(tmp_path / "result.json")]) == 0
    mended = DiagnosisResult.model_validate_json((tmp_path / "result.json").read_text())
    assert mended.baseline.parameters["f_k"].value == pytest.approx(F_K[1], rel=0.05)
    assert mended.robot is not None
    for one in mended.robot.match:
        assert one.correlation == pytest.approx(1.0, abs=0.01)
        assert not one.suspicion


STRANGE: dict[str, Change] = {
    "another robot": (lambda q, u: (q, np.roll(u, 600, axis=0))),
    "no torque of an arm": (lambda q, u: (q, 40.0 * np.sin(np.arange(u.size) / 11.0).reshape(u.shape))),
}


@pytest.mark.parametrize("change", STRANGE)
def test_a_torque_that_nothing_explains_is_refused_without_an_option(
    change: str, motion: tuple[np.ndarray, ...], tmp_path: Path
) -> None:
    t, q, torque = motion
    log = _written(tmp_path, t, *STRANGE[change](q, torque))
    found = harness.diagnose_joint(log, tmp_path / "arm.xml", "elbow", engines=())
    assert not found.mechanisms
    assert "does not follow the model's" in found.statement
    assert "Try" not in found.statement
