"""The way of a robot's joint in the proof: its log and model belong together, and what is said of them is true."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import harness
from harness.app.prove.blind_worker import answered
from harness.proof.paths.files import unpacked
from harness.proof.paths.forms import JOINT
from harness.proof.paths.made import CONTROL, FORM, made
from harness.proof.tally import OURS
from harness.robot.arm import load_arm
from harness.robot.reduction import reduced


def _asked(
    seed: int, index: int, group: str, form: str, folder: Path, patch: pytest.MonkeyPatch
) -> tuple[Any, dict[str, Any]]:
    """The answer of a drawn joint, and what is said of it."""
    patch.chdir(folder)
    one = made(seed, index, JOINT, group, form)
    return one.answer, json.loads(answered(OURS, one.answer["arguments"], one.recording))


@pytest.mark.parametrize("index", range(4))
def test_the_model_is_that_of_the_joint_that_moves(index: int, tmp_path: Path) -> None:
    one = made(5, index, JOINT, CONTROL, "")
    files = unpacked(one.recording)
    assert files is not None
    for name, text in files.items():
        (tmp_path / name).write_text(text, encoding="utf-8")
    model = next(name for name in files if name.startswith("robot"))
    log = harness.load_log(tmp_path / "recording.csv", joints=["elbow", "wrist"])
    assert np.ptp(log.position["elbow"]) > 0.2
    assert np.ptp(log.position["wrist"]) < 1e-3
    own = reduced(load_arm(tmp_path / model, None), "elbow", {"wrist": 0.3})
    assert own.inertia == pytest.approx(one.answer["base"]["mass"], rel=1e-6)
    assert np.hypot(own.a, own.b) == pytest.approx(one.answer["base"].get("k", 0.0), rel=1e-6, abs=1e-9)


def test_what_chance_takes_as_well_is_not_likely(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """stribeck has a BIC of 27 in this clean log, and what noise leaves of a true model gives it as much."""
    _, said = _asked(1, 0, CONTROL, "", tmp_path, monkeypatch)
    assert said["verdict"] == "adequate"
    assert said["posterior"][0]["names"] == []
    assert said["posterior"][0]["probability"] > 0.5


def test_a_torque_that_ripples_is_still_its_model_s(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The model explains an eighth of a controller's torque, at its own size: slope 1.1 +- 0.1."""
    _, said = _asked(11, 13, FORM, "drag, linear to quadratic", tmp_path, monkeypatch)
    assert "do not go together" not in said["statement"]
