"""Whose a log's joints are: names by pattern and order, in tables and bags; LeRobot's ranges; temperatures."""

import json
from pathlib import Path

import joint_logs
import numpy as np
import pytest
from joint_logs import ONE

import harness
from harness.core.errors import InputError
from harness.io.logs.read import read_joint_log

FER = ("fer_joint1", "fer_joint2")
KINDS = ("position", "velocity", "effort")
PANDA = joint_logs.motion(joints=("panda_joint1", "panda_joint2"))


@pytest.fixture(scope="module")
def logs(tmp_path_factory: pytest.TempPathFactory) -> list[Path]:
    """The same motion as a table and as a bag."""
    folder = tmp_path_factory.mktemp("names")
    table = joint_logs.csv(folder / "log.csv", {"t": PANDA.t, **PANDA.columns()})
    return [table, joint_logs.bag2(folder / "bag", {"/joint_states": joint_logs.messages(PANDA)})]


@pytest.mark.parametrize("names", [{"panda_joint{i}": "fer_joint{i}"}, {"*": "*"}])
def test_joints_go_by_a_shape_of_names_and_by_order(logs: list[Path], names: dict[str, str]) -> None:
    for log in logs:
        found = read_joint_log(log, joints=FER, names=names)
        assert found.joints == FER
        assert found.position["fer_joint2"] == pytest.approx(PANDA.columns()["panda_joint2.position"])


def test_a_refusal_has_the_names_that_read_the_log(logs: list[Path]) -> None:
    with pytest.raises(InputError) as refused:
        read_joint_log(logs[0], joints=FER)
    shape, _, other = refused.value.accepted.split('"')[1].partition("=")
    assert read_joint_log(logs[0], joints=FER, names={shape: other}).joints == FER
    with pytest.raises(InputError, match=r'--names "\*=\*"'):
        read_joint_log(logs[0], joints=("shoulder", "elbow"))
    with pytest.raises(InputError, match="as many of both"):
        read_joint_log(logs[0], joints=(*FER, "fer_joint3"), names={"*": "*"})


def test_shares_of_ranges_become_angles(tmp_path: Path) -> None:
    motion = joint_logs.motion(joints=("elbow_flex", "gripper"))
    shares = {"elbow_flex": 80.0 * np.sin(motion.t), "gripper": 50.0 + 30.0 * np.sin(motion.t)}
    columns = {f"{joint}.pos": y for joint, y in shares.items()}
    log = joint_logs.csv(tmp_path / "log.csv", {"t": motion.t, **columns})
    calibration = tmp_path / "arm.json"
    ranges = {"elbow_flex": (1000, 3048), "gripper": (2000, 3024)}
    told = {
        name: {"id": i, "drive_mode": 0, "homing_offset": 0, "range_min": low, "range_max": high}
        for i, (name, (low, high)) in enumerate(ranges.items())
    }
    calibration.write_text(json.dumps(told))
    found = harness.load_log(log, calibration=calibration)
    assert found.position["elbow_flex"] == pytest.approx(0.8 * 0.5 * np.pi * np.sin(motion.t), abs=1e-6)
    assert found.position["gripper"] == pytest.approx(0.3 * 0.5 * np.pi * np.sin(motion.t), abs=1e-6)
    calibration.write_text(json.dumps({"wrist": told["gripper"]}))
    with pytest.raises(InputError, match=r"no elbow_flex, gripper, but wrist"):
        harness.load_log(log, calibration=calibration)
    calibration.write_text("[1, 2]")
    with pytest.raises(InputError, match="range_min"):
        harness.load_log(log, calibration=calibration)


def test_the_same_of_a_data_set_with_its_goals(tmp_path: Path) -> None:
    one = joint_logs.motion(joints=("elbow_flex",))
    motion = joint_logs.Motion(one.t, {"elbow_flex": 100.0 * one.position["elbow_flex"]})
    folder = joint_logs.lerobot(tmp_path / "set", [motion, motion])
    calibration = tmp_path / "arm.json"
    calibration.write_text(json.dumps({"elbow_flex": {"range_min": 1024, "range_max": 3072}}))
    found = harness.load_log(folder, topic="1", calibration=calibration)
    assert found.position["elbow_flex"] == pytest.approx(0.5 * np.pi * one.position["elbow_flex"])
    assert found.goal["elbow_flex"] == pytest.approx(found.position["elbow_flex"] + 0.1 / 200.0 * np.pi)


TWO = joint_logs.motion(joints=("left/elbow", "right/elbow"))


@pytest.mark.parametrize("pattern", ["{joint}.{kind}", "/joint_states/{joint}/{kind}"])
def test_what_stands_before_a_joint_s_name_tells_two_of_that_name_apart(tmp_path: Path, pattern: str) -> None:
    log = joint_logs.csv(tmp_path / "log.csv", {"t": TWO.t, **TWO.columns(pattern)})
    assert harness.load_log(log).joints == ("left/elbow", "right/elbow")
    found = read_joint_log(log, joints=("right/elbow",))
    assert found.effort["right/elbow"] == pytest.approx(TWO.effort["right/elbow"])


@pytest.mark.parametrize("model", ["arm::elbow", "left/elbow"])
def test_a_joint_is_known_by_the_last_part_of_its_name(tmp_path: Path, model: str) -> None:
    log = joint_logs.csv(tmp_path / "log.csv", {"t": PANDA.t, **joint_logs.motion().columns()})
    found = read_joint_log(log, joints=("shoulder", model))
    assert found.joints == ("shoulder", model)
    assert any(f"elbow is {model}" in note for note in found.notes)
    with pytest.raises(InputError):
        read_joint_log(log, joints=("left/wrist", "right/wrist"))


def test_names_that_a_message_has_beside_its_numbers_go_before_an_order(tmp_path: Path) -> None:
    motion = joint_logs.motion()
    columns: dict[str, list[str]] = {"field.header.stamp": [str(round(1e9 * (t + 1.6e9))) for t in motion.t]}
    for i, joint in enumerate(reversed(motion.joints)):
        columns |= {f"field.name{i}": [joint] * motion.t.size}
        columns |= {f"field.{kind}{i}": [repr(float(y)) for y in getattr(motion, kind)[joint]] for kind in KINDS}
    rows = [",".join(columns), *map(",".join, zip(*columns.values(), strict=True))]
    (tmp_path / "log.csv").write_text("\n".join(rows) + "\n")
    found = read_joint_log(tmp_path / "log.csv", joints=("shoulder", "elbow"))
    for kind in KINDS:
        for joint in motion.joints:
            assert getattr(found, kind)[joint] == pytest.approx(getattr(motion, kind)[joint])


@pytest.mark.parametrize(
    ("log", "model", "shape"),
    [
        (("l_hip_joint", "l_knee_joint"), ("hip_joint", "knee_joint"), "l_{i}={i}"),
        (("hip", "knee"), ("fl_hip_joint", "fl_knee_joint"), "{i}=fl_{i}_joint"),
        (("l_hip", "l_knee_1"), ("hip", "knee_1"), "l_{i}={i}"),
    ],
)
def test_the_names_that_are_proposed_make_every_joint(
    tmp_path: Path, log: tuple[str, str], model: tuple[str, str], shape: str
) -> None:
    motion = joint_logs.motion(joints=log)
    path = joint_logs.csv(tmp_path / "log.csv", {"t": motion.t, **motion.columns()})
    with pytest.raises(InputError) as refused:
        read_joint_log(path, joints=model)
    assert f'--names "{shape}"' in refused.value.accepted
    assert read_joint_log(path, joints=model, names=dict([shape.split("=")])).joints == model


def test_temperatures_are_carried_and_said(tmp_path: Path) -> None:
    warmth = 25.0 + ONE.t
    seldom = np.where(np.arange(ONE.t.size) % 10 == 0, warmth, np.nan)
    columns = {"t": ONE.t, **ONE.columns(), "shoulder_temp [degC]": warmth, "elbow_temp [degC]": seldom}
    path = joint_logs.csv(tmp_path / "log.csv", columns)
    found = harness.load_log(path)
    assert found.temperature["shoulder"] == pytest.approx(warmth)
    assert found.temperature["elbow"][:391] == pytest.approx(warmth[:391])
    (topic,) = harness.log(path).topics
    assert topic.units_guessed["temperature"] == "degC"
    assert topic.ranges["elbow"]["temperature"] == pytest.approx((25.0, 28.9))


def test_a_temperature_in_a_unit_of_something_else_is_refused(tmp_path: Path) -> None:
    path = joint_logs.csv(tmp_path / "log.csv", {"t": ONE.t, **ONE.columns(), "elbow.temperature [V]": ONE.t})
    with pytest.raises(InputError, match="degC or K"):
        harness.load_log(path)
