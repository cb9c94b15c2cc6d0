"""A log of a robot's joints read back from every format is the motion that was written; what is odd is said."""

import gzip
import json
from collections.abc import Callable
from contextlib import suppress
from dataclasses import replace
from pathlib import Path

import jsonschema
import numpy as np
import pytest
import scipy.io
from joint_logs import HOLED, ONE, Message, Motion, bag1, bag2, csv, lerobot, messages, motion, parquet, short_of

from harness.cli.main import run
from harness.core.errors import InputError
from harness.core.robot import JointLog
from harness.io.logs.raw import named
from harness.io.logs.read import read_joint_log
from harness.results import generate

KINDS = ("position", "velocity", "effort")


def same(found: JointLog, wanted: Motion, exact: bool = True, names: list[str] | None = None) -> None:
    """The log holds the motion: bit for bit, or to the nanosecond of a stamp and a rounding of a unit."""
    assert list(found.joints) == (names or wanted.joints)
    np.testing.assert_allclose(found.t, wanted.t, rtol=0.0, atol=0.0 if exact else 1e-9)
    for kind in KINDS:
        given = getattr(wanted, kind)
        read = getattr(found, kind)
        assert list(read) == [names[wanted.joints.index(j)] if names else j for j in given], kind
        for values, joint in zip(read.values(), given, strict=True):
            np.testing.assert_allclose(values, given[joint], rtol=0.0 if exact else 1e-12, atol=0.0 if exact else 1e-12)


def stack(kind: str) -> np.ndarray:
    return np.column_stack(list(getattr(ONE, kind).values()))


def npz(path: Path) -> Path:
    np.savez(path, t=ONE.t, q=stack("position"), dq=stack("velocity"), tau=stack("effort"))
    return path


def mat(path: Path) -> Path:
    scipy.io.savemat(path, {"t": ONE.t, "q": stack("position"), "dq": stack("velocity"), "tau": stack("effort")})
    return path


def packed(path: Path) -> Path:
    plain = csv(path.with_suffix(""), {"t": ONE.t, **ONE.columns()})
    path.write_bytes(gzip.compress(plain.read_bytes()))
    return path


def units(path: Path) -> Path:
    scaled = {f"{j}.position [deg]": np.degrees(q) for j, q in ONE.position.items()}
    scaled |= {f"{j}.velocity [deg/s]": np.degrees(v) for j, v in ONE.velocity.items()}
    scaled |= {f"{j}.effort [mN*m]": 1e3 * u for j, u in ONE.effort.items()}
    return csv(path, {"time [ms]": 1e3 * ONE.t, **scaled})


def short(path: Path, words: tuple[str, str, str], time: str = "t") -> Path:
    """Columns by number: {k} of each word is the joint's."""
    pairs = zip(words, KINDS, strict=True)
    found = {w.format(k): y for w, kind in pairs for k, y in enumerate(getattr(ONE, kind).values(), 1)}
    return csv(path, {time: ONE.t, **found})


def lists(path: Path) -> Path:
    return parquet(path, {"t": ONE.t, **{kind: list(stack(kind)) for kind in KINDS}})


def cells_of_lists(path: Path) -> Path:
    """As a bag is written to text: a tuple in each cell, beside names that are none of numbers."""
    table = zip(ONE.t, *(stack(kind).tolist() for kind in KINDS), strict=True)
    rows = [
        ",".join([f"{t:.9f}", "\"['a', 'b']\"", *(f'"({one[0]!r}, {one[1]!r})"' for one in lists)])
        for t, *lists in table
    ]
    path.write_text("\n".join(["Time,name,position,velocity,effort", *rows]) + "\n")
    return path


NUMBERED = ["joint1", "joint2"]
TABLES: dict[str, tuple[str, Callable[[Path], Path], list[str] | None]] = {
    "NAME.position": ("a.csv", lambda p: csv(p, {"t": ONE.t, **ONE.columns()}), None),
    "NAME/position": ("a.csv", lambda p: csv(p, {"time_s": ONE.t, **ONE.columns("{joint}/{kind}")}), None),
    "of PlotJuggler": (
        "a.csv",
        lambda p: csv(p, {"__time": ONE.t, **ONE.columns("/joint_states/{joint}/{kind}")}),
        None,
    ),
    "NAME_position": ("a.csv", lambda p: csv(p, {"timestamp": ONE.t, **ONE.columns("{joint}_{kind}")}), None),
    "position[i]": ("a.csv", lambda p: csv(p, {"t": ONE.t, **ONE.columns("{kind}[{i}]")}), NUMBERED),
    "of rostopic": ("a.csv", lambda p: csv(p, {"%time": ONE.t, **ONE.columns("field.{kind}{i}")}), NUMBERED),
    "x1_rad": ("a.csv", lambda p: short(p, ("x{}_rad", "v{}", "u{}_Nm"), "t_s"), NUMBERED),
    "q1": ("a.csv", lambda p: short(p, ("q{}", "dq{}", "tau{}")), NUMBERED),
    "pos_meas1": ("a.csv", lambda p: short(p, ("pos_meas{}", "vel_meas{}", "tau_meas{}"), "time"), NUMBERED),
    "position_j1": (
        "a.csv",
        lambda p: short(p, ("actual_position_j{}", "actual_velocity_j{}", "measured_torque_j{}"), "time"),
        NUMBERED,
    ),
    "theta1": ("a.csv", lambda p: short(p, ("theta{}", "dtheta{}", "tauEst{}"), "time"), NUMBERED),
    "ms": ("a.csv", lambda p: csv(p, {"ms": 1e3 * ONE.t, **ONE.columns("{joint}_{kind}")}), None),
    "lists in cells": ("a.csv", cells_of_lists, NUMBERED),
    "gzip": ("a.csv.gz", packed, None),
    "units": ("a.csv", units, None),
    "comment": ("a.csv", lambda p: csv(p, {"t": ONE.t, **ONE.columns()}, "# made here\n"), None),
    "npz": ("a.npz", npz, NUMBERED),
    "mat": ("a.mat", mat, NUMBERED),
    "parquet": ("a.parquet", lambda p: parquet(p, {"t": ONE.t, **ONE.columns()}), None),
    "parquet lists": ("a.parquet", lists, NUMBERED),
    "bag 1": ("a.bag", lambda p: bag1(p, {"/joint_states": messages(ONE)}), None),
    "bag 2": ("a", lambda p: bag2(p, {"/joint_states": messages(ONE)}), None),
    "sqlite3 alone": ("a", lambda p: bag2(p, {"/joint_states": messages(ONE)}) / "a.db3", None),
    "mcap": ("a", lambda p: bag2(p, {"/joint_states": messages(ONE)}, "mcap"), None),
    "mcap alone": ("a", lambda p: bag2(p, {"/joint_states": messages(ONE)}, "mcap") / "a.mcap", None),
}


@pytest.mark.parametrize("kind", TABLES)
def test_every_format_is_the_motion(tmp_path: Path, kind: str) -> None:
    name, write, names = TABLES[kind]
    path = write(tmp_path / name)
    found = read_joint_log(path)
    same(found, ONE, exact=name.startswith("a.") and kind not in ("units", "ms", "bag 1"), names=names)
    assert found.file == str(path)
    assert len(found.sha256) == 64
    assert not any("derivative" in note or "gap" in note for note in found.notes)


@pytest.mark.parametrize("kind", ["NAME.position", "q1", "parquet lists", "bag 1", "bag 2", "mcap alone"])
def test_the_command_says_what_is_in_each(tmp_path: Path, kind: str, capfd: pytest.CaptureFixture[str]) -> None:
    name, write, names = TABLES[kind]
    path = write(tmp_path / name)
    assert run(["log", str(path), "--json", "-"]) == 0
    said = json.loads(capfd.readouterr().out)
    assert said["schema"] == "harness.log/1"
    jsonschema.validate(said, json.loads((generate.FOLDER / "harness.log-1.json").read_text()))
    (topic,) = said["topics"]
    assert topic["count"] == 400
    assert topic["rate_hz"] == pytest.approx(100.0, rel=1e-6)
    assert topic["joints"] == (names or ONE.joints)
    assert topic["fields"] == list(KINDS)
    assert topic["units_guessed"] == {"position": "rad", "velocity": "rad/s", "effort": "N m"}
    assert topic["gaps_s"] == []
    for joint, wanted in zip(topic["joints"], ONE.joints, strict=True):
        q = ONE.position[wanted]
        assert topic["ranges"][joint]["position"] == pytest.approx([q.min(), q.max()])
    assert run(["log", str(path)]) == 0
    assert "400" in capfd.readouterr().out


NAMES: list[tuple[str, tuple[str, str, int] | None]] = [
    ("elbow.position", ("position", "elbow", 0)),
    ("/joint_states/elbow_joint/effort", ("effort", "elbow_joint", 0)),
    ("shoulder_pan.pos", ("position", "shoulder_pan", 0)),
    ("joint_1.velocity", ("velocity", "joint_1", 0)),
    ("j1_torque_Nm", ("effort", "j1", 0)),
    ("motor.current", ("current", "motor", 0)),
    ("actual_q_0", ("position", "", 0)),
    ("actual_qd_5", ("velocity", "", 5)),
    ("actual_current_3", ("current", "", 3)),
    ("/joint_states/position[11]", ("position", "", 11)),
    ("tau_J[2]", ("effort", "", 2)),
    ("x2_rad", ("position", "", 2)),
    ("u1_Nm", ("effort", "", 1)),
    ("absu3_Nm", ("magnitude", "", 3)),
    ("q", ("position", "", 0)),
    ("target_q_0", ("goal", "", 0)),
    ("xcmd1_rad", ("goal", "", 1)),
    ("elbow.target.position", ("goal", "elbow", 0)),
    ("tau_des1", None),
    ("base.x", None),
    ("actual_TCP_pose_0", None),
    ("x1_N", None),
    ("temperature", ("temperature", "", 0)),
    ("elbow_temp", ("temperature", "elbow", 0)),
    ("humidity", None),
    ("", None),
]


@pytest.mark.parametrize(("name", "wanted"), NAMES)
def test_what_a_name_says(name: str, wanted: tuple[str, str, int] | None) -> None:
    found = named(name)
    assert (found and (found.field, found.joint, found.number)) == wanted


def test_joints_of_the_model_are_chosen_by_name_and_give_names_where_there_are_none(tmp_path: Path) -> None:
    by_name = csv(tmp_path / "a.csv", {"t": ONE.t, **ONE.columns()})
    found = read_joint_log(by_name, joints=["elbow", "finger"])
    assert found.joints == ("elbow",)
    assert "The log has no finger." in found.notes
    numbered = csv(tmp_path / "b.csv", {"t": ONE.t, **ONE.columns("{kind}[{i}]")})
    same(read_joint_log(numbered, joints=["shoulder", "elbow"]), ONE)
    few = read_joint_log(numbered, joints=["shoulder"])
    assert few.joints == ("shoulder",)
    assert any("2 joints and the model 1: the first 1" in note for note in few.notes)


def test_columns_and_gain_are_taken(tmp_path: Path) -> None:
    path = csv(
        tmp_path / "a.csv", {"clock": ONE.t, "foo": np.degrees(ONE.position["elbow"]), "bar": ONE.effort["elbow"]}
    )
    found = read_joint_log(path, columns="t=clock,elbow.position=foo[deg],elbow.effort=2*bar[N*m]")
    np.testing.assert_allclose(found.position["elbow"], ONE.position["elbow"], rtol=1e-12)
    np.testing.assert_allclose(found.effort["elbow"], 2.0 * ONE.effort["elbow"], rtol=1e-12)
    ur = {f"actual_q_{i}": q for i, q in enumerate(ONE.position.values())}
    ur |= {f"actual_current_{i}": u for i, u in enumerate(ONE.effort.values())}
    path = csv(tmp_path / "ur.csv", {"timestamp": 17.0 + ONE.t, **ur, "target_q_0": ONE.t})
    plain = read_joint_log(path)
    assert not plain.effort
    assert any("Current is logged and no effort: --gain, in N m per A" in note for note in plain.notes)
    driven = read_joint_log(path, gain={"joint1": 12.5})
    np.testing.assert_allclose(driven.effort["joint1"], 12.5 * ONE.effort["shoulder"], rtol=1e-12)
    assert list(driven.effort) == ["joint1"]
    taken = read_joint_log(csv(tmp_path / "c.csv", {"t": ONE.t, **ONE.columns()}), gain=3.0)
    np.testing.assert_allclose(taken.effort["elbow"], 3.0 * ONE.effort["elbow"], rtol=1e-12)
    assert any("logged as effort is taken as current" in note for note in taken.notes)
    assert any("One --gain for 2 joints" in note for note in taken.notes)


def test_an_episode_of_a_data_set_is_read(tmp_path: Path) -> None:
    episodes = [replace(motion(n, seed=n), velocity={}, effort={}) for n in (60, 80, 70)]
    for chunked in (False, True):
        folder = lerobot(tmp_path / str(chunked), episodes, chunked=chunked)
        with pytest.raises(InputError, match="3 episodes and no --topic; expected --topic with one of 0, 1, 2"):
            read_joint_log(folder)
        for number, one in enumerate(episodes):
            same(read_joint_log(folder, topic=str(number)), one)
        with pytest.raises(InputError, match="no episode '7'; expected one of 0, 1, 2"):
            read_joint_log(folder, topic="7")
    same(read_joint_log(folder / "data" / "chunk-001" / "file-000.parquet"), episodes[1])
    unnamed = lerobot(tmp_path / "nested", episodes[:1], names={"motors": ["a", "b"]})
    same(read_joint_log(unnamed), episodes[0], names=["a", "b"])


def test_joints_are_followed_by_name_and_empty_fields_are_not_logged(tmp_path: Path) -> None:
    sent = messages(replace(ONE, velocity={}))
    for message in sent[::3]:
        for kind in ("names", "position", "effort"):
            setattr(message, kind, list(getattr(message, kind))[::-1])
    gripper = [Message(m.stamp + 1000, m.received + 1000, ["finger"], [0.01]) for m in sent[::10]]
    both = sorted([*sent, *gripper], key=lambda m: m.received)
    found = read_joint_log(bag2(tmp_path / "a", {"/joint_states": both}))
    assert not found.velocity
    for joint in ONE.joints:
        first = "elbow" if joint == "elbow" else "shoulder"
        np.testing.assert_array_equal(found.position[joint], ONE.position[first])
        np.testing.assert_array_equal(found.effort[joint], ONE.effort[first])
    assert any("change their order in" in note for note in found.notes)
    assert any("40 messages speak of other joints (finger): not used" in note for note in found.notes)


@pytest.mark.parametrize(
    ("change", "said"), [(lambda s, k: 0, "do not change"), (lambda s, k: s - k * 10**8, "go back")]
)
def test_receive_times_stand_in_for_headers_that_say_nothing(
    tmp_path: Path, change: Callable[[int, int], int], said: str
) -> None:
    sent = [replace(m, stamp=change(m.stamp, k)) for k, m in enumerate(messages(ONE))]
    found = read_joint_log(bag2(tmp_path / "a", {"/joint_states": sent}))
    np.testing.assert_allclose(found.t, ONE.t, atol=1e-9)
    assert any("those of receiving" in note and said in note for note in found.notes)


def noted(tmp_path: Path, one: Motion) -> str:
    return " ".join(read_joint_log(csv(tmp_path / "odd.csv", {"t": one.t, **one.columns()})).notes)


def test_repeated_rows_are_dropped_and_counted(tmp_path: Path) -> None:
    rows = np.sort(np.concatenate([np.arange(400), np.arange(0, 400, 16)]))

    def taken(columns: dict[str, np.ndarray]) -> dict[str, np.ndarray]:
        return {name: values[rows] for name, values in columns.items()}

    path = csv(tmp_path / "a.csv", taken({"t": ONE.t, **ONE.columns()}))
    found = read_joint_log(path)
    same(found, ONE)
    assert "25 of 425 rows repeat the stamp of the one before: dropped." in found.notes


@pytest.mark.parametrize(
    ("factor", "said"),
    [
        (180.0 / np.pi, "57.3 times the derivative of the position, as velocity in deg/s"),
        (np.pi / 180.0, "0.01745 times the derivative of the position, as positions in degrees"),
        (
            1000.0,
            "1000 times the derivative of the position, as velocity in mm/s beside positions in m, or times in ms",
        ),
        (-1.0, "-1 times the derivative of the position, as velocity with the sign turned"),
        (1.37, "1.37 times the derivative of the position."),
    ],
)
def test_a_velocity_in_another_unit_is_said(tmp_path: Path, factor: float, said: str) -> None:
    odd = replace(ONE, velocity={joint: factor * v for joint, v in ONE.velocity.items()})
    assert f"The velocity of shoulder and elbow is {said}" in noted(tmp_path, odd)


def test_degrees_are_said_and_read_when_told(tmp_path: Path) -> None:
    odd = replace(ONE, position={joint: np.degrees(q) for joint, q in ONE.position.items()}, velocity={})
    assert "degrees look so; --angle-unit deg reads them as such" in noted(tmp_path, odd)
    path = csv(tmp_path / "deg.csv", {"t": odd.t, **odd.columns()})
    same(read_joint_log(path, angle_unit="deg"), replace(ONE, velocity={}), exact=False)
    bag = bag2(tmp_path / "bag", {"/joint_states": messages(odd)})
    same(read_joint_log(bag, angle_unit="deg"), replace(ONE, velocity={}), exact=False)


def test_torque_without_a_sign_is_left_out_and_torque_of_gravity_is_not(tmp_path: Path) -> None:
    odd = replace(ONE, effort={joint: np.abs(u) for joint, u in ONE.effort.items()})
    path = csv(tmp_path / "a.csv", {"t": odd.t, **odd.columns()})
    found = read_joint_log(path)
    assert not found.effort
    assert any("The effort of shoulder and elbow never is negative" in note for note in found.notes)
    holding = replace(ONE, effort={joint: 20.0 + u for joint, u in ONE.effort.items()})
    assert set(read_joint_log(csv(tmp_path / "b.csv", {"t": ONE.t, **holding.columns()})).effort) == set(ONE.joints)


def test_coarse_steps_and_gaps_are_said(tmp_path: Path) -> None:
    step = 0.25
    odd = replace(ONE, velocity={joint: step * np.round(v / step) for joint, v in ONE.velocity.items()})
    gone = np.concatenate([np.arange(100), np.arange(150, 400)])
    path = csv(tmp_path / "a.csv", {k: v[gone] for k, v in {"t": odd.t, **odd.columns()}.items()})
    notes = " ".join(read_joint_log(path).notes)
    assert "The velocity of shoulder and elbow comes in steps of 0.25 rad/s." in notes
    assert "There is 1 gap in time, the longest of 0.51 s at t = 0.99 s." in notes


def test_a_folder_that_a_killed_recorder_left_is_read(tmp_path: Path) -> None:
    folder = bag2(tmp_path / "a", {"/joint_states": messages(ONE)})
    (folder / "metadata.yaml").unlink()
    same(read_joint_log(folder), ONE, exact=False)


def test_rows_without_a_value_are_left_out_when_asked(tmp_path: Path) -> None:
    path = short_of(tmp_path / "a.csv", **{"elbow.position": HOLED})
    found = read_joint_log(path, drop_nan=True, start=0.05, stop=2.0)
    assert len(found.t) == 195
    assert "1 rows without a value are skipped (--drop-nan)." in found.notes


def test_what_is_nan_or_nought_throughout_is_not_logged(tmp_path: Path) -> None:
    nothing = np.zeros(400)
    path = short_of(
        tmp_path / "a.csv", **{"shoulder.effort": nothing, "elbow.effort": nothing, "elbow.velocity": nothing * np.nan}
    )
    found = read_joint_log(path)
    assert (list(found.velocity), list(found.effort)) == (["shoulder"], [])
    assert "The effort is 0 throughout: taken as not logged." in found.notes
    assert "No velocity is logged of elbow." in found.notes


@pytest.mark.parametrize("kind", ["bag 1", "sqlite3 alone", "mcap alone"])
def test_a_damaged_bag_is_a_log_or_one_line(tmp_path: Path, kind: str, capfd: pytest.CaptureFixture[str]) -> None:
    path = TABLES[kind][1](tmp_path / ("a.bag" if kind == "bag 1" else "a"))
    data = path.read_bytes()
    draw = np.random.default_rng(7)
    for _ in range(4):
        changed = bytearray(data)
        for place in draw.integers(0, len(data), 20):
            changed[place] = draw.integers(256)
        path.write_bytes(changed[: draw.integers(len(data) // 2, len(data) + 1)])
        with suppress(InputError):
            assert np.all(np.isfinite(read_joint_log(path).t))
        assert run(["log", str(path), "--json", "-"]) in (0, 2)
        assert capfd.readouterr().err.count("\n") <= 1


def test_the_robot_recordings(recordings: Path) -> None:
    folder = recordings / "machines"
    if not (folder / "ur10").is_dir():
        pytest.skip("no logs of robots among the recordings")
    ur = read_joint_log(folder / "ur10" / "ur10_exciting_trajectory.db3")
    assert (len(ur.t), len(ur.joints), len(ur.effort)) == (3441, 6, 6)
    assert ur.joints[0] == "shoulder_pan_joint"
    assert np.median(np.diff(ur.t)) == pytest.approx(0.008, rel=1e-6)
    double = read_joint_log(folder / "dfki-double-pendulum" / "dfki_double_20220812-061157.csv", joints=["a", "b"])
    assert double.joints == ("a", "b")
    assert set(double.effort) == {"a", "b"}
    arm = read_joint_log(folder / "so101" / "so101_chirp_sweep.csv")
    assert len(arm.joints) == 6
    assert not arm.effort
    assert any("comes in steps of 0.0767 rad/s" in note for note in arm.notes)


def test_seconds_and_nanoseconds_of_a_header_are_one_time(tmp_path: Path) -> None:
    """As a bag that was flattened to columns has them; a gap is longer than any second."""
    ns = 1_700_000_000_250_000_000 + np.round(1e9 * np.where(ONE.t > ONE.t.mean(), ONE.t + 7.0, ONE.t)).astype(int)
    clock = {"header.stamp.sec": ns // 10**9, "header.stamp.nanosec": ns % 10**9}
    found = read_joint_log(csv(tmp_path / "flat.csv", {**clock, **ONE.columns()}))
    np.testing.assert_allclose(found.t - found.t[0], 1e-9 * (ns - ns[0]), atol=1e-8)
    assert found.t.size == ONE.t.size
    assert not any("nanosec" in note for note in found.notes)


def test_an_angle_that_wraps_is_one_course(tmp_path: Path) -> None:
    moved = motion(joints=("wrist",))
    away = moved.position["wrist"] + 3.0
    columns = {"t": moved.t, "wrist.position": (away + np.pi) % (2.0 * np.pi) - np.pi}
    found = read_joint_log(csv(tmp_path / "log.csv", columns))
    assert np.diff(found.position["wrist"]) == pytest.approx(np.diff(away), abs=1e-9)
    assert any("wrist: the position wraps" in note for note in found.notes)


def test_stamps_in_two_units_are_of_one_clock(tmp_path: Path) -> None:
    moved = motion(joints=("wrist",))
    since = [f"{1.7e9 + t:.6f}" if i < 150 else str(round(1e9 * (1.7e9 + t))) for i, t in enumerate(moved.t)]
    rows = [f"{stamp},{x!r}" for stamp, x in zip(since, map(float, moved.position["wrist"]), strict=True)]
    (tmp_path / "log.csv").write_text("\n".join(["t,wrist.position", *rows]) + "\n")
    assert read_joint_log(tmp_path / "log.csv").t == pytest.approx(moved.t, abs=1e-6)


def test_a_servo_s_register_is_an_angle(tmp_path: Path) -> None:
    moved = motion(joints=("wrist",))
    steps = np.round(moved.position["wrist"] * 4096 / (2.0 * np.pi)) + 2048
    columns = {"time_ms": 1e3 * moved.t, "Goal Position": steps, "Present Position": steps}
    found = read_joint_log(csv(tmp_path / "log.csv", columns))
    for of in (found.position, found.goal):
        (x,) = of.values()
        assert x == pytest.approx(moved.position["wrist"], abs=np.pi / 4096 + 1e-9)


def test_a_clock_in_another_language_and_mujoco_s_own_names_are_read(tmp_path: Path) -> None:
    moved = motion()
    called = zip(("qpos", "qvel", "qfrc_actuator"), ("position", "velocity", "effort"), strict=True)
    columns = {f"{name}[{i}]": getattr(moved, kind)[j] for name, kind in called for i, j in enumerate(moved.joints)}
    found = read_joint_log(csv(tmp_path / "log.csv", {"Zeit [ms]": 1e3 * moved.t, **columns}))
    assert found.t == pytest.approx(moved.t)
    assert found.effort["joint2"] == pytest.approx(moved.effort["elbow"])
