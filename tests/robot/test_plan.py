"""A planned motion: within its limits, at rest at both ends, and friction better told than by random ones."""

import json
from pathlib import Path

import numpy as np
import pyarrow.parquet as pq
import pytest
from two_joint_arm import ARM

from harness.app.plan import plan
from harness.cli.main import run
from harness.core.errors import InputError

LIMITED = ARM.replace('name="shoulder"', 'name="shoulder" range="-100 100" actuatorfrcrange="-20 20"').replace(
    'name="elbow"', 'name="elbow" range="-60 60" actuatorfrcrange="-4 4"'
)


@pytest.fixture(scope="module")
def planned(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder of a plan of six seconds, which the command has made."""
    folder = tmp_path_factory.mktemp("plan")
    (folder / "arm.xml").write_text(LIMITED)
    line = ["plan", "--robot", str(folder / "arm.xml"), "--seconds", "6", "--rate", "100", "--speed", "2", "--quiet"]
    assert run([*line, "--out", str(folder / "out")]) == 0
    return folder


def test_a_plan_keeps_within_its_limits_and_begins_and_ends_at_rest(planned: Path) -> None:
    rows = np.loadtxt(planned / "out" / "trajectory.csv", delimiter=",", skiprows=1)
    t, q, v = rows[:, 0], rows[:, [1, 4]], rows[:, [2, 5]]
    assert np.all(np.abs(q) <= np.radians((100.0, 60.0)))
    assert np.all(np.abs(v) <= 2.0)
    assert np.all(v[[0, -1]] == 0.0)
    assert np.gradient(q, t, axis=0)[2:-2] == pytest.approx(v[2:-2], abs=0.02)
    result = json.loads((planned / "out" / "result.json").read_text())
    assert [one["torque"] <= most for one, most in zip(result["joints"], (20.0, 4.0), strict=True)] == [True, True]
    ros = (planned / "out" / "trajectory.yaml").read_text()
    assert ros.count("time_from_start") == 301


def test_a_plan_is_an_episode_of_lerobot_in_degrees(planned: Path) -> None:
    rows = np.loadtxt(planned / "out" / "trajectory.csv", delimiter=",", skiprows=1)
    told = json.loads((planned / "out" / "lerobot" / "meta" / "info.json").read_text())
    (file,) = (planned / "out" / "lerobot" / "data").glob("*/*.parquet")
    table = pq.read_table(file).to_pydict()
    assert told["features"]["action"]["names"] == ["shoulder.pos", "elbow.pos"]
    assert list(table) == list(told["features"])
    for k, column in enumerate((1, 4)):
        told_at = np.degrees(np.interp(table["timestamp"], rows[:, 0], rows[:, column]))
        assert np.array(table["action"])[:, k] == pytest.approx(told_at, abs=0.1)


def test_a_plan_tells_friction_better_than_random_motions(planned: Path) -> None:
    result = json.loads((planned / "out" / "result.json").read_text())
    assert result["better"] > 1.2
    assert result["better_than_drawn"] > 2.0


def test_a_robot_that_cannot_hold_its_rest_pose_moves_about_another(planned: Path, tmp_path: Path) -> None:
    result = plan(planned / "arm.xml", torque=2.0, seconds=4.0, speed=1.0, out=tmp_path / "out")
    assert all(one.torque <= 2.0 for one in result.joints)
    assert any("about another" in note for note in result.notes)


def test_what_gravity_does_not_allow_and_what_is_too_short_is_refused(planned: Path, tmp_path: Path) -> None:
    level = tmp_path / "level.xml"
    level.write_text(LIMITED.replace('range="-100 100"', 'range="-60 60"'))
    with pytest.raises(InputError, match="gravity alone asks more of shoulder"):
        plan(level, torque=0.5, seconds=4.0, out=tmp_path / "a")
    with pytest.raises(InputError, match="at least 4 s"):
        plan(planned / "arm.xml", seconds=2.0, out=tmp_path / "b")
    with pytest.raises(InputError, match="elbow"):
        plan(planned / "arm.xml", ["elbo"], out=tmp_path / "c")


def test_joints_on_a_ratio_are_planned_as_one_within_both_ranges(tmp_path: Path) -> None:
    """A finger that a mimic moves twice as far has no way of its own, and its range bounds the other's."""
    fingers = "".join(
        f'<body name="{name}"><joint name="{name}" type="slide" axis="0 {side} 0" range="0 {most}"/>'
        '<inertial pos="0 0 0" mass=".1" diaginertia="1e-4 1e-4 1e-4"/></body>'
        for name, side, most in (("left", 1, 0.05), ("right", -1, 0.06))
    )
    tie = '<equality><joint joint1="right" joint2="left" polycoef="0 2 0 0 0"/></equality></mujoco>'
    text = LIMITED.replace("</worldbody>", f"{fingers}</worldbody>").replace("</mujoco>", tie)
    (tmp_path / "arm.xml").write_text(text)
    result = plan(tmp_path / "arm.xml", seconds=6.0, rate=100.0, out=tmp_path / "out")
    assert [one.joint for one in result.joints] == ["shoulder", "elbow", "left"]
    left = np.genfromtxt(tmp_path / "out" / "trajectory.csv", delimiter=",", names=True)["leftposition"]
    assert 0.0 <= left.min() < left.max() <= 0.03
    with pytest.raises(InputError, match="where left takes it"):
        plan(tmp_path / "arm.xml", ("right",), seconds=6.0)
