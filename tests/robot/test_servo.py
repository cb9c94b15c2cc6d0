"""A joint under its servo, from goals and positions: what comes out of logs of a plant of another make."""

import json
import re
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest

import harness
from harness.cli.main import run as command
from harness.core.arrays import FloatArray
from harness.results.diagnosis import DiagnosisResult
from harness.robot.servo.plant import Run
from harness.show.stored import AFTER_NAME

STEP = 2.0 * np.pi / 4096
STALL, BRAKE, VOLTS, GAIN = 0.45, 0.5, 7.4, 0.166 * 16.0
INERTIA, ARMATURE, GRAVITY, F_K = 0.02, 0.03, 0.6, 0.08
ARM = """<mujoco><worldbody><body><joint name="elbow" axis="0 1 0" frictionloss="0.05" damping="0.6" armature="0.028"/>
<inertial pos="0 0 {reach}" mass="0.6" diaginertia="{about} {about} {about}"/></body></worldbody>
<actuator><position joint="elbow" kp="17.8" forcerange="-3.35 3.35"/></actuator></mujoco>"""


class Log(NamedTuple):
    t: FloatArray
    q: FloatArray
    goal: FloatArray


def logged(
    seed: int,
    seconds: float = 24.0,
    rate: float = 50.0,
    dead: float = 0.0,
    haste: float = 0.0,
    ramp: float = np.inf,
    gravity: float = GRAVITY,
) -> Log:
    """Goal and position of a joint whose servo works in steps of 0.5 ms, by explicit Euler; friction stops it.

    dead : error, rad, up to which it does nothing. haste : rad/s^2 by which its own goal takes its speed up and down.
    ramp : rad/s, the most of that.
    """
    rng = np.random.default_rng(seed)
    t = np.arange(0.0, seconds, 1.0 / rate)
    waves = [(rng.uniform(0.1, 0.4), rng.uniform(0.5, 4.0), rng.uniform(0.0, 6.0)) for _ in range(3)]
    goal = np.sum([a * np.sin(w * t + p) for a, w, p in waves], axis=0)
    late, h = 0.01, 5e-4
    q, v = float(goal[0]), 0.0
    wanted, pace = q, 0.0
    found: list[float] = []
    for i in range(round(t[-1] / h) + 1):
        now = i * h
        if now >= t[min(len(found), t.size - 1)] - 1e-9 and len(found) < t.size:
            found.append(q)
        sent = goal[max(int((now - late) * rate + 1e-9), 0)]
        if haste:
            fast = np.sign(sent - wanted) * min(np.sqrt(2.0 * haste * abs(sent - wanted)), ramp)
            pace += min(max(fast - pace, -haste * h), haste * h)
            wanted += pace * h
        else:
            wanted = sent
        error = wanted - q if abs(wanted - q) > dead else 0.0
        torque = STALL * VOLTS * min(max(GAIN * error, -1.0), 1.0) - (BRAKE + 0.04) * v - gravity * np.sin(q)
        if v == 0.0 and abs(torque) <= F_K:
            continue
        side = np.sign(v) or np.sign(torque)
        new = v + h * (torque - side * F_K) / (INERTIA + ARMATURE)
        v = 0.0 if new * side < 0.0 else new
        q += h * v
    seen = np.round((np.array(found) + 0.5 * STEP * rng.standard_normal(t.size)) / STEP) * STEP
    return Log(t, seen, goal)


def log_in(folder: Path, dead: float = 0.0, haste: float = 0.0, ramp: float = np.inf) -> Path:
    one = logged(1, dead=dead, haste=haste, ramp=ramp)
    table = np.column_stack((one.t, one.goal, one.q))
    np.savetxt(folder / "log.csv", table, "%.9g", ",", header="t,elbow.goal,elbow.position", comments="")
    return folder / "log.csv"


def run(folder: Path, *words: str) -> DiagnosisResult:
    """What the command leaves of a log of ``logged``."""
    log_in(folder)
    assert command(["diagnose", str(folder / "log.csv"), "--out", str(folder / "out"), "--quiet", *words]) == 0
    result = DiagnosisResult.model_validate_json((folder / "out" / "result.json").read_text(encoding="utf-8"))
    assert result.robot is not None
    assert result.robot.servo is not None
    page = (folder / "out" / "report.html").read_text(encoding="utf-8")
    # where no term was found there is one model, and nothing stands twice
    assert (AFTER_NAME in page) == bool(result.robot.servo.terms)
    return result


def test_a_servo_s_numbers_come_from_goal_and_position_and_engines_move_so(tmp_path: Path) -> None:
    reach = GRAVITY / (9.81 * 0.6)
    about = INERTIA - 0.6 * reach**2
    (tmp_path / "arm.xml").write_text(ARM.format(reach=-reach, about=about), encoding="utf-8")
    result = run(tmp_path, "--robot", str(tmp_path / "arm.xml"), "--servo", "sts3215:16")
    robot = result.robot
    assert robot is not None
    assert robot.servo is not None
    numbers = robot.servo.parameters
    for name, true, near in (("f_k", F_K, 0.06), ("stall", STALL, 0.05), ("armature", ARMATURE, 0.15)):
        assert numbers[name].value == pytest.approx(true, rel=near)
    assert sum(numbers[name].value or 0.0 for name in ("c", "brake")) == pytest.approx(BRAKE + 0.04, rel=0.05)
    late = re.search(r" goals ([\d.]+) \+- ([\d.]+) ms old", result.statement)
    assert late
    assert float(late[1]) == pytest.approx(1e3 * (numbers["delay"].value or 0.0), abs=0.06)
    assert float(late[2]) == pytest.approx(1e3 * (numbers["delay"].stderr or 0.0), rel=0.06)
    assert robot.servo.scale == "gravity"
    assert robot.servo.fitted[0].after < 1.3e3 * STEP * np.sqrt(0.25 + 1.0 / 12.0)
    assert robot.servo.floor_mrad == pytest.approx(1e3 * STEP * np.sqrt(0.25 + 1.0 / 12.0), rel=0.3)
    assert {one.engine for one in robot.simulated} == {"mujoco", "pybullet"}
    assert all(one.after["x"] < 0.2 * one.before["x"] for one in robot.simulated)
    assert "<position" in robot.paste.mjcf
    assert robot.servo.bam["friction_base"] == numbers["f_k"].value


def test_goal_and_position_alone_are_understood_and_all_is_a_ratio_to_the_inertia(tmp_path: Path) -> None:
    result = harness.diagnose_servo(log_in(tmp_path))
    assert result.plot(library="matplotlib").axes
    assert len(result.curves[str(tmp_path / "log.csv")]["x"]) == len(logged(1).t)
    robot = result.robot
    assert robot is not None
    assert robot.servo is not None
    assert robot.servo.scale == "inertia"
    assert robot.paste.mjcf == ""
    whole, numbers = INERTIA + ARMATURE, {name: p.value for name, p in robot.servo.parameters.items()}
    assert numbers["f_k"] == pytest.approx(F_K / whole, rel=0.1)
    assert np.hypot(numbers["sine"] or 0.0, numbers["cosine"] or 0.0) == pytest.approx(GRAVITY / whole, rel=0.1)
    # what is too weak to be seen has the rest
    assert result.posterior[0].names == []
    assert 0.7 < sum(one.probability for one in result.posterior) < 0.9
    assert result.statement.startswith(f"No missing term is shown (P {result.posterior[0].probability:.2f}): the servo")


def test_a_level_joint_s_torques_are_ratios_though_a_model_gives_its_link_s_inertia(tmp_path: Path) -> None:
    """Nothing tells the rotor, which no model has, from what the link weighs."""
    one = logged(1, gravity=0.0)
    table = np.column_stack((one.t, one.goal, one.q))
    np.savetxt(tmp_path / "log.csv", table, "%.9g", ",", header="t,pan.goal,pan.position", comments="")
    link = f'<inertial pos="0 0 0" mass="1" diaginertia="{INERTIA} {INERTIA} {INERTIA}"/>'
    arm = f'<mujoco><worldbody><body><joint name="pan" axis="0 0 1"/>{link}</body></worldbody></mujoco>'
    (tmp_path / "arm.xml").write_text(arm, encoding="utf-8")
    result = harness.diagnose_servo(tmp_path / "log.csv", robot=tmp_path / "arm.xml", joint="pan")
    assert result.robot is not None
    servo, whole = result.robot.servo, INERTIA + ARMATURE
    assert servo is not None
    assert servo.scale == "inertia"
    assert servo.stiffness.value == pytest.approx(STALL * VOLTS * GAIN / whole, rel=0.02)
    assert servo.stiffness.unit == "N m/rad per kg m^2"
    assert servo.parameters["f_k"].value == pytest.approx(F_K / whole, rel=0.05)
    assert "neither gravity nor a data sheet" in result.statement


@pytest.mark.parametrize(("more", "name"), [({"dead": 0.02}, "dead-band"), ({"haste": 40.0}, "goal-speed-limit")])
def test_what_a_servo_makes_of_its_goal_is_one_name_in_whatever_form(
    more: dict[str, float], name: str, tmp_path: Path
) -> None:
    """Beyond its dead band a servo feels all of an error, and its goal's speed takes time to change."""
    result = harness.diagnose_servo(log_in(tmp_path, **more))
    assert [one.name for one in result.mechanisms] == [name]
    likeliest, probability = result.posterior[0], result.mechanisms[0].probability
    assert likeliest.names == [name]
    assert probability is not None
    assert probability >= likeliest.probability > 0.9
    assert result.statement.startswith(f"Missing: {name} (P {min(probability, 0.99):.2f}). The servo")


def test_a_data_set_in_degrees_needs_no_robot_and_is_asked_for_its_unit(
    tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    """Of LeRobot: a folder, whose columns nobody can name."""
    one, folder = logged(1), tmp_path / "set"
    columns = {"observation.state": np.degrees(one.q)[:, None], "action": np.degrees(one.goal)[:, None]}
    lists = {name: pa.array(list(values), pa.list_(pa.float64())) for name, values in columns.items()}
    (folder / "meta").mkdir(parents=True)
    (folder / "data" / "chunk-000").mkdir(parents=True)
    features = {name: {"dtype": "float32", "shape": [1], "names": ["elbow.pos"]} for name in columns}
    (folder / "meta" / "info.json").write_text(json.dumps({"codebase_version": "v3.0", "features": features}))
    table = pa.table(lists | {"timestamp": one.t, "episode_index": np.zeros(one.t.size, dtype=int)})
    pq.write_table(table, folder / "data" / "chunk-000" / "file-000.parquet")
    line = ["diagnose", str(folder), "--quiet", "--out", str(tmp_path / "out")]
    assert command(line) == 2
    assert capfd.readouterr().err.endswith(f"degrees look so. Try: harness {' '.join(line)} --angle-unit deg\n")
    assert command([*line, "--angle-unit", "deg"]) == 0
    result = DiagnosisResult.model_validate_json((tmp_path / "out" / "result.json").read_text(encoding="utf-8"))
    assert result.robot is not None
    assert result.robot.servo is not None
    assert result.robot.servo.parameters["f_k"].value == pytest.approx(F_K / (INERTIA + ARMATURE), rel=0.1)


def test_a_profile_is_found_where_no_servo_without_one_moves_nearly_so(tmp_path: Path) -> None:
    """Torque, rotor and zero of a fit without it are then far from their own."""
    result = harness.diagnose_servo(log_in(tmp_path, haste=3.0, ramp=0.4))
    found = result.mechanisms[0]
    assert found.name == "goal-speed-limit"
    assert found.parameters["ramp"].value == pytest.approx(0.4, rel=0.02)
    assert found.parameters["haste"].value == pytest.approx(3.0, rel=0.05)
    assert result.refined.rmse["x"] < 1.3 * STEP * np.sqrt(0.25 + 1.0 / 12.0)


@pytest.mark.parametrize("limit", [50.0, 0.05])
def test_a_free_run_is_exact_to_a_part_in_ten_thousand_where_a_goal_jumps_between_its_steps(limit: float) -> None:
    """A jump of 1 rad, 13.7 ms late: the step response of a mass on a damped spring, or of one that is pushed alone."""
    t, inertia, damping, stiff = np.arange(0.0, 0.3, 0.02), 0.05, 0.6, 9.0
    goal, none = np.where(t >= 0.02, 1.0, 0.0), np.zeros_like(t)
    load = np.tile((inertia, 0.0, 0.0), (t.size, 1))
    numbers = {"stall": 1.0, "gain": stiff, "armature": 0.0, "brake": damping, "delay": 0.0137, "limit": limit}
    shown = Run(t, none, goal, none + 1.0, none + 1.0, load).simulated(numbers, [(0, t.size)])
    rate, since = damping / inertia, np.maximum(t - 0.0337, 0.0)
    pushed = limit / damping * (since - (1.0 - np.exp(-rate * since)) / rate)
    fast = np.sqrt(stiff / inertia - 0.25 * rate**2)
    swung = 1.0 - np.exp(-0.5 * rate * since) * (np.cos(fast * since) + 0.5 * rate / fast * np.sin(fast * since))
    exact = swung if limit > stiff else pushed
    assert shown == pytest.approx(exact, abs=1e-4 * np.max(exact))


def stepped(folder: Path, ramp: float = np.inf, lead: float = 0.0) -> Path:
    """A log of goals that jump by up to 2 rad, so that the drive saturates; ramp : rad/s at which the servo's own goal
    moves at most. lead : s, of a derivative gain over the gain.
    """
    rate, h = 100.0, 2.5e-4
    t = np.arange(0.0, 24.0, 1.0 / rate)
    goal = np.random.default_rng(5).uniform(-1.0, 1.0, 48)[(t / 0.8).astype(int)]
    q, v, own = goal[0], 0.0, goal[0]
    rows: list[float] = []
    for i in range(round(t[-1] / h) + 1):
        if i * h >= t[min(len(rows), t.size - 1)] - 1e-9 and len(rows) < t.size:
            rows.append(q)
        own += np.clip(goal[max(int((i * h - 0.01) * rate + 1e-9), 0)] - own, -ramp * h, ramp * h)
        duty = np.clip(GAIN * (own - q - lead * v), -1.0, 1.0)
        torque = STALL * VOLTS * duty - (BRAKE + 0.04) * v - GRAVITY * np.sin(q)
        new = v + h * torque / (INERTIA + ARMATURE)
        most = h * F_K / (INERTIA + ARMATURE)
        v = new - np.clip(new, -most, most)
        q += h * v
    table = np.column_stack((t, goal, np.round(np.array(rows) / STEP) * STEP))
    np.savetxt(folder / "steps.csv", table, "%.9g", ",", header="t,elbow.goal,elbow.position", comments="")
    return folder / "steps.csv"


@pytest.mark.parametrize(
    ("more", "name", "number", "true"),
    [({}, "drive-limit", "limit", 1.0 / GAIN), ({"ramp": 2.0}, "goal-speed-limit", "ramp", 2.0)],
)
def test_goals_that_jump_tell_what_bounds_a_servo_that_nobody_names(
    more: dict[str, float], name: str, number: str, true: float, tmp_path: Path
) -> None:
    """A drive at its most and a goal that the servo moves by itself are far from a servo that pulls as it errs."""
    result = harness.diagnose_servo(stepped(tmp_path, **more))
    first = result.mechanisms[0]
    assert (result.verdict, first.name) == ("missing_physics", name)
    assert first.parameters[number].value == pytest.approx(true, rel=0.02)
    assert result.refined.parameters["f_k"].value == pytest.approx(F_K / (INERTIA + ARMATURE), rel=0.05)


def test_a_derivative_gain_shows_where_the_duty_is_at_its_limit(tmp_path: Path) -> None:
    result = harness.diagnose_servo(stepped(tmp_path, lead=0.045), servo="sts3215:16")
    named = {one.name: one.parameters for one in result.mechanisms}
    assert named["derivative-gain"]["kd"].value == pytest.approx(0.045 * GAIN, rel=0.05)


@pytest.mark.parametrize(
    ("words", "said"),
    [(["--servo", "sts9999"], "sts3215"), (["--servo", "sts3215:x"], "number"), (["--servo", "xl330:1,2"], "gains")],
)
def test_a_servo_that_is_none_is_refused_with_those_there_are(
    words: list[str], said: str, tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "log.csv").write_text(
        "t,goal,position\n"
        + "".join(f"{0.02 * i:.2f},{0.1 * (i // 20 % 2)},{0.09 * (i // 20 % 2)}\n" for i in range(99))
    )
    assert command(["diagnose", str(tmp_path / "log.csv"), *words]) == 2
    assert said in capfd.readouterr().err
