"""A log of a robot's joints that cannot be read is refused in one line, which says what would be.

An effort that never is negative: one that lost its sign is none, one that only touches nought is kept.
"""

import sys
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from joint_logs import HOLED, ONE, Message, bag1, bag2, csv, lerobot, messages, short_of, two

from harness.cli.main import run
from harness.core.errors import InputError
from harness.io.logs.read import read_joint_log
from harness.io.options import ReadOptions
from harness.io.recording import read_recording


def cut(path: Path) -> Path:
    path.write_bytes(path.read_bytes()[: path.stat().st_size // 2])
    return path


def with_text(path: Path) -> Path:
    short_of(path)
    lines = path.read_text().splitlines()
    lines[20] = "0.19,fast" + ",0" * 5
    path.write_text("\n".join(lines))
    return path


BACK = ONE.t.copy()
BACK[100:] -= 0.5


def junk(path: Path) -> Path:
    path.write_bytes(b"\x00\x01 no bag" * 100)
    return path


BAD: dict[str, tuple[Callable[[Path], tuple[Path, dict[str, object]]], str]] = {
    "nothing there": (lambda p: (p / "none.csv", {}), "no such file; expected a file, the folder of a ROS 2 bag"),
    "empty folder": (lambda p: (p, {}), "a folder; expected a file, the folder of a ROS 2 bag, or that of a LeRobot"),
    "no joints": (
        lambda p: (csv(p / "a.csv", {"t": ONE.t, "speed_limit": ONE.t}), {}),
        "no joint's position among the columns t, speed_limit; expected columns t and NAME.position",
    ),
    "no time": (lambda p: (csv(p / "a.csv", ONE.columns()), {}), "no time among the columns"),
    "text": (lambda p: (with_text(p / "a.csv"), {}), "row 20 (line 21), column shoulder.position: the text 'fast'"),
    "time back": (lambda p: (short_of(p / "a.csv", t=BACK), {}), "row 101, t: time 0.5 s goes back from 0.99 s"),
    "nan": (
        lambda p: (short_of(p / "a.csv", **{"elbow.position": HOLED}), {}),
        "row 8, elbow.position: no value or nan. Try: --drop-nan",
    ),
    "few": (
        lambda p: (csv(p / "a.csv", {"t": ONE.t[:9], "e.position": ONE.t[:9]}), {}),
        "9 samples; expected at least 50",
    ),
    "unknown joint": (
        lambda p: (short_of(p / "a.csv"), {"joints": ["elbwo"]}),
        "no joint 'elbwo'; expected one of shoulder, elbow; did you mean elbow?",
    ),
    "two of one": (
        lambda p: (csv(p / "a.csv", {"t": ONE.t, "l/q1": ONE.t, "r/q1": ONE.t}), {}),
        "two columns that may be joint1.position: 'l/q1', 'r/q1'",
    ),
    "gain of nothing": (
        lambda p: (csv(p / "a.csv", {"t": ONE.t, "e.position": ONE.t}), {"gain": 2.0}),
        "--gain: given for a log without current or effort",
    ),
    "gain of another": (lambda p: (short_of(p / "a.csv"), {"gain": {"elbo": 2.0}}), "did you mean elbow?"),
    "gain of 0": (lambda p: (short_of(p / "a.csv"), {"gain": 0.0}), "--gain: 0; expected N m per A, other than 0"),
    "a unit that is none": (lambda p: (short_of(p / "a.csv"), {"angle_unit": "blub"}), "--angle-unit: 'blub' is not"),
    "columns": (
        lambda p: (short_of(p / "a.csv"), {"columns": "elbow=foo"}),
        "--columns: unknown channel 'elbow' in 'elbow=foo'; expected t and NAME.position, NAME.velocity",
    ),
    "a topic of a table": (lambda p: (short_of(p / "a.csv"), {"topic": "/x"}), "--topic: given for"),
    "two topics": (
        lambda p: (two(p / "a"), {}),
        "2 topics of joint states and no --topic; expected --topic with one of /left/joint_states, /right/joint_states",
    ),
    "unknown topic": (
        lambda p: (two(p / "a"), {"topic": "/lft/joint_states"}),
        "no topic of joint states '/lft/joint_states'; expected one of /left/joint_states, /right/joint_states",
    ),
    "no joint states": (lambda p: (bag2(p / "a", {}, text=True), {}), "no joint states, but /rosout (std_msgs/msg/Str"),
    "columns of a bag": (lambda p: (two(p / "a"), {"columns": "t=t"}), "--columns: given for"),
    "junk bag": (lambda p: (junk(p / "a.bag"), {}), "cannot be read as a ROS bag"),
    "junk db3": (lambda p: (junk(p / "a.db3"), {}), "cannot be read as a ROS bag"),
    "junk mcap": (lambda p: (junk(p / "a.mcap"), {}), "cannot be read as a ROS bag (File magic is invalid.)"),
    "cut mcap": (
        lambda p: (cut(bag2(p / "a", {"/j": messages(ONE)}, "mcap") / "a.mcap"), {}),
        "cannot be read as a ROS bag",
    ),
    "cut bag": (lambda p: (cut(bag1(p / "a.bag", {"/j": messages(ONE)})), {}), "cannot be read as a ROS bag"),
    "a joint twice": (
        lambda p: (bag2(p / "a", {"/j": [Message(k, k, ["e", "e"], [0.0, 1.0]) for k in range(60)]}), {}),
        "/j: message 1: the joint e twice",
    ),
    "values without joints": (
        lambda p: (bag2(p / "a", {"/j": [Message(k, k, ["e"], [0.0, 1.0]) for k in range(60)]}), {}),
        "/j: message 1: 2 values of position for 1 joints; expected a value for each joint",
    ),
    "no info": (lambda p: (_broken_info(p / "a"), {}), "unreadable (KeyError: 'features')"),
}


def _broken_info(folder: Path) -> Path:
    lerobot(folder, [replace(ONE, velocity={}, effort={})])
    (folder / "meta" / "info.json").write_text("{}")
    return folder


@pytest.mark.parametrize("case", BAD)
def test_bad_input_is_one_line(tmp_path: Path, case: str, capfd: pytest.CaptureFixture[str]) -> None:
    make, said = BAD[case]
    path, options = make(tmp_path)
    with pytest.raises(InputError) as caught:
        read_joint_log(path, **options)  # type: ignore[arg-type]
    assert said in str(caught.value)
    assert "\n" not in str(caught.value)
    code = run(["log", str(path)])
    out, err = capfd.readouterr()
    assert "Traceback" not in err
    assert (code, err.count("\n")) in {(0, 0), (2, 1)}
    assert bool(out) == (code == 0)


def test_a_bag_without_the_package_says_what_to_install(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = bag1(tmp_path / "a.bag", {"/joint_states": messages(ONE)})
    monkeypatch.setitem(sys.modules, "rosbags", None)
    with pytest.raises(
        InputError, match=r"rosbags that reads it is not installed. Try: pip install 'friction-harness\[bags\]'"
    ):
        read_joint_log(path)
    assert run(["log", str(path)]) == 2


@pytest.mark.parametrize("friction", [0.0, 0.4])
@pytest.mark.parametrize("offset", [0.0, 0.3, 1.2])
def test_a_magnitude_is_dropped_and_a_gravity_torque_that_touches_nought_is_kept(
    tmp_path: Path, friction: float, offset: float
) -> None:
    t = np.arange(0.0, 10.0, 0.005)
    q = 1.2 * np.sin(2.0 * t) + 0.3 * np.sin(3.4 * t + 1.0)
    torque = 3.0 * np.sin(q + offset) + friction * np.sign(np.gradient(q))
    torque += 0.02 * np.random.default_rng(3).standard_normal(t.size)
    for effort, known in ((np.abs(torque), False), (torque - torque.min(), True)):
        path = csv(tmp_path / f"{known}.csv", {"t": t, "arm.position": q, "arm.effort": effort})
        assert ("arm" in read_joint_log(path).effort) is known


@pytest.mark.parametrize(("name", "folded"), [("absu1_Nm", False), ("u", True)])
def test_a_force_without_a_sign_is_refused_by_its_name_and_by_its_values(
    tmp_path: Path, name: str, folded: bool
) -> None:
    t = np.arange(0.0, 10.0, 0.005)
    x = 0.1 * np.sin(2.0 * t) + 0.02 * np.sin(3.4 * t + 1.0)
    u = 40.0 * x + 0.4 * np.sign(np.gradient(x)) + 0.02 * np.random.default_rng(3).standard_normal(t.size)
    path = csv(tmp_path / "driven.csv", {"t": t, "x": x, name: np.abs(u) if folded else u})
    columns = None if folded else f"t=t,x=x,u={name}"
    with pytest.raises(InputError, match="with its sign"):
        read_recording(path, ReadOptions(columns=columns))
    signed = csv(tmp_path / "signed.csv", {"t": t, "x": x, "u": u})
    assert "u" in read_recording(signed).channels
