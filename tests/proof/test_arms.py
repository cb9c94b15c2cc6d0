"""The way of a whole arm: its rigid body, its friction, its files, and what is right of it."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from harness.app.prove.blind_worker import answered
from harness.proof.paths import chain, joints, plant
from harness.proof.paths.arms import Arm, draw_arm
from harness.proof.paths.files import unpacked
from harness.proof.paths.forms import ARM
from harness.proof.paths.made import CONTROL, FORM, made
from harness.proof.paths.rigs import BARE
from harness.proof.paths.score import outcome
from harness.proof.tally import OURS
from harness.robot.arm import load_arm

UP = np.array([0.0, 0.0, chain.G])


@pytest.fixture(scope="module")
def arm() -> Arm:
    return draw_arm(np.random.default_rng(11))


@pytest.mark.parametrize("written", [joints.mjcf, joints.urdf])
def test_the_rigid_body_is_that_of_the_file(written: Any, arm: Arm, tmp_path: Path) -> None:
    file = tmp_path / f"arm.{'xml' if written is joints.mjcf else 'urdf'}"
    file.write_text(written(arm.links))
    q, v, a = np.random.default_rng(1).standard_normal((3, 20, len(arm.names)))
    own = chain.rigid(arm.bodies(), UP, q, v, a)
    rotors = np.array([link.rotor for link in arm.links]) * (written is joints.urdf)
    assert load_arm(file, None).inverse(q, v, a) == pytest.approx(own - rotors * a, abs=1e-6 * np.max(np.abs(own)))


def test_torque_is_what_the_motion_and_its_friction_need(arm: Arm) -> None:
    q, v, a, u = np.moveaxis(arm.run(BARE), 2, 0)
    rigid = chain.rigid(arm.bodies(), UP, arm.rest + q, v.copy(), a.copy())
    left = u - rigid - arm.b[:, 1] * v - arm.b[:, 3] * np.sign(v)
    assert np.max(np.abs(left[v != 0.0])) < 1e-9 * np.max(np.abs(u))
    # and where a joint rests friction holds it with no more than there is of it
    assert np.all(np.abs(left) <= arm.b[:, 3] * (1.0 + 1e-9))


def test_positions_are_the_integral_of_speeds(arm: Arm) -> None:
    q, v, a, _ = np.moveaxis(arm.run(BARE), 2, 0)
    gone = np.cumsum(0.5 * (v[1:] + v[:-1]), axis=0) * arm.dt
    assert np.max(np.abs(q[1:] - q[0] - gone)) < 1e-3 * np.ptp(q)
    assert np.max(np.abs(v)) < 0.5 * np.max(np.abs(a))


def test_time_passes_where_a_joint_comes_loose_and_is_held_again() -> None:
    # a rest at the edge of what friction holds: each loosening ended at once, and in the end the arm stood still
    resting = draw_arm(np.random.default_rng([77, 5, 0]))
    q, v, a, _ = np.moveaxis(resting.ticks(BARE), 2, 0)
    gone = 0.5 * (v[1:] + v[:-1]) * resting.tick
    jerk = np.abs(np.diff(a, axis=0))
    assert np.max(np.abs(np.diff(q, axis=0) - gone) / (jerk + 1.0)) < 0.5 * resting.tick**2


def test_an_effect_is_of_its_joint_alone(arm: Arm) -> None:
    p = BARE.copy()
    p[plant.COG], p[plant.COG_L] = 0.5 * arm.b[arm.joint, 3], 0.3
    run = arm.run(p)
    q, v, a, u = np.moveaxis(run, 2, 0)
    left = u - chain.rigid(arm.bodies(), UP, arm.rest + q, v.copy(), a.copy())
    left -= arm.b[:, 1] * v + arm.b[:, 3] * np.sign(v)
    size = np.array([np.max(np.abs(one[w != 0.0])) for one, w in zip(left.T, v.T, strict=True)])
    assert size[arm.joint] > 0.3 * arm.b[arm.joint, 3]
    assert np.max(np.delete(size, arm.joint)) < 1e-9 * np.max(np.abs(u))
    assert arm.loss(p) > 100.0 * arm.loss(BARE)
    assert arm.right(("force-ripple",)) == [f"{arm.names[arm.joint]}: force-ripple"]
    assert arm.right(("payload",)) == ["payload"]


@pytest.mark.parametrize(
    ("found", "hidden", "said"),
    [
        ([], [], "silent"),
        ([], ["j2: stribeck"], "silent"),
        ([("stribeck", "j2", [])], ["j2: stribeck"], "named"),
        ([("stribeck", "j1", [])], ["j2: stribeck"], "wrong"),
        ([("quadratic-drag", "j2", ["stribeck"])], ["j2: stribeck"], "listed"),
        ([("stribeck", "j2", []), ("backlash", "j1", [])], ["j2: stribeck"], "wrong"),
        ([("torque-delay", "j1", [])], ["torque-delay"], "named"),
        ([("motor-constant", "j1", [])], [], "wrong"),
    ],
)
def test_right_is_the_mechanism_in_its_joint(found: list[Any], hidden: list[str], said: str) -> None:
    entries = [{"name": name, "joint": joint, "grade": "main", "rivals": rivals} for name, joint, rivals in found]
    assert outcome({"right": hidden}, {"verdict": "main_effect", "found": entries}) == said


def test_what_is_small_claims_beside_nothing_right_of_its_joint_alone() -> None:
    small = {"name": "quadratic-drag", "joint": "j2", "grade": "minor", "rivals": []}
    right = {"name": "stribeck", "joint": "j2", "grade": "main", "rivals": []}
    hidden = {"right": ["j2: stribeck"]}
    assert outcome(hidden, {"found": [right, small]}) == "named"
    assert outcome(hidden, {"found": [small]}) == "wrong"
    assert outcome(hidden, {"found": [right, {**small, "joint": "j1"}]}) == "wrong"


def test_friction_of_every_joint_is_found_in_a_clean_log(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    one = made(1, 2, ARM, CONTROL, "")
    files = unpacked(one.recording)
    assert files is not None
    assert set(files) == {"recording.csv", one.answer["arguments"][1]}
    said = json.loads(answered(OURS, one.answer["arguments"], one.recording))
    assert said["found"] == []
    for name, true in one.answer["base"].items():
        number = said["refined"]["parameters"][name]
        assert abs(number["value"] - true) < 4.0 * number["stderr"]


def test_a_joint_off_its_mark_is_no_load_without_a_mass(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A zero .048 rad off moves a centre of mass, as half a gram does that hangs 33 m away."""
    monkeypatch.chdir(tmp_path)
    one = made(7503, 39, ARM, FORM, "arm, a joint off its mark")
    found = json.loads(answered(OURS, one.answer["arguments"], one.recording))["found"]
    assert [entry["name"] for entry in found] == ["zero-offset"]
