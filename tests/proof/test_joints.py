"""Ways of the proof with a model beside the log: a robot's joint, a servo, a simulation of the user's own."""

import json
import math
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import harness
from harness.app.prove.blind_worker import answered
from harness.proof.paths import plant
from harness.proof.paths.files import unpacked
from harness.proof.paths.forms import JOINT, SERVO
from harness.proof.paths.made import CONTROL, FORM, made
from harness.proof.paths.rigs import BARE, MOST, STEP, draw_rig
from harness.proof.paths.simulated import Settings, programmed, stepped
from harness.proof.tally import OURS
from harness.robot.arm import load_arm
from harness.robot.reduction import reduced


def _asked(
    seed: int, index: int, group: str, form: str, folder: Path, patch: pytest.MonkeyPatch, path: str = JOINT
) -> tuple[Any, dict[str, Any]]:
    """The answer of a drawn joint, and what is said of it."""
    patch.chdir(folder)
    one = made(seed, index, path, group, form)
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


def test_a_servo_asks_for_no_more_than_it_has_and_rests_where_torques_balance() -> None:
    rig = draw_rig(SERVO, np.random.default_rng(4))
    n = 300
    held = replace(rig, drive=(np.full(n, rig.zero + 0.4),))
    x = held.run(BARE)[:, 0]
    assert rig.gains is not None
    gain, stall = rig.gains[plant.GAIN], rig.gains[plant.STALL]
    assert np.ptp(x[-50:]) == 0.0
    # at rest the servo's torque holds gravity to within dry friction, a step of the encoder and one of the duty
    off = stall * gain * (0.4 - x[-1]) - rig.b[2] * math.sin(x[-1])
    assert abs(off) < rig.b[3] + stall * (gain * STEP + 1e-3)
    asked = np.abs(rig.drive[0] - rig.zero - rig.run(BARE)[:, 0]) * gain
    assert np.max(asked) < MOST


def test_friction_under_load_costs_the_servo_more() -> None:
    rig = draw_rig(SERVO, np.random.default_rng(4))
    p = BARE.copy()
    p[plant.GEAR], p[plant.GEAR_U] = 0.2, 0.1 * rig.b[2]
    late = [np.abs(rig.drive[0] - rig.zero - rig.run(q)[:, 0]).mean() for q in (BARE, p)]
    assert late[1] > late[0]


def test_a_program_of_somebody_s_own_turns_where_the_closed_form_says() -> None:
    k, f_k, x0 = 100.0, 0.1, 0.05
    x = programmed(x0, 1e-5, 3000, 100, 0.0, k, f_k)[:, 1]
    half = round(math.pi / math.sqrt(k) / 1e-3)
    for turn in range(1, 8):
        near = slice(turn * half - 3, turn * half + 4)
        assert np.max(np.abs(x[near])) == pytest.approx(x0 - 2.0 * turn * f_k / k, abs=2e-6)


@pytest.mark.parametrize("integrator", ["Euler", "RK4"])
def test_mujoco_steps_the_slider_that_was_meant(integrator: str) -> None:
    model = Settings(1e-3, integrator, "").model(2.0, c=0.0, k=200.0, f_k=0.0)
    t, x, *_ = stepped(model, 0.05, 2000).T
    assert x == pytest.approx(0.05 * np.cos(10.0 * t), abs=5e-4)


@pytest.mark.parametrize(("index", "told"), [(8, True), (10, False)])
def test_a_servo_with_nothing_missing_is_not_called_otherwise(
    index: int, told: bool, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """In the first the delay ends on its bound, and damping goes with it; the second has two minima."""
    truth, said = _asked(13, index, CONTROL, "", tmp_path, monkeypatch, SERVO)
    assert said["verdict"] == "adequate"
    assert bool(truth["base"]) == told
    for name, true in truth["base"].items():
        number = said["refined"]["parameters"][name]
        assert abs(number["value"] - true) < 3.0 * number["stderr"]
