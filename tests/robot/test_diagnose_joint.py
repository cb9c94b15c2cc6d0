"""A joint of a robot from its log: friction comes out, and whether the others stand still or it sticks is told."""

import json
import math
import re
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import mujoco
import numpy as np
import pytest

from benchmarks.draws import robot_joints
from harness.app.diagnose.many import diagnose
from harness.app.diagnose.options import DiagnoseOptions, RobotOptions
from harness.cli.main import run
from harness.core.arrays import FloatArray
from harness.core.errors import InputError
from harness.core.recording import Recording
from harness.core.robot import JointLog
from harness.engines.models import folder
from harness.kernels.solve import simulate
from harness.model.model import Model, ModelTerm, Restoring
from harness.results.diagnosis import DiagnosisResult
from harness.robot.arm import load_arm
from harness.robot.example import FRICTION, Friction, excited, write
from harness.robot.recording import coupling, one_joint, slips
from harness.robot.reduction import Reduced, reduced

FILE = folder() / "arm" / "arm.xml"
ARM = load_arm(FILE)


def _diagnosed(log: JointLog, into: Path, file: Path = FILE, joint: str | None = None) -> DiagnosisResult:
    write(log, into / "log.csv")
    options = DiagnoseOptions(robot=RobotOptions(file, joint), engines=())
    return diagnose(into / "log.csv", options, into / "out")


def _near(result: DiagnosisResult, side: str, name: str, truth: float, share: float) -> None:
    found = getattr(result, side).parameters[name]
    assert found.value == pytest.approx(truth, rel=share), name
    assert found.stderr is None or abs(found.value - truth) < 6.0 * found.stderr + 0.003 * abs(truth), name


@pytest.mark.parametrize(
    ("joint", "file"),
    [pytest.param("shoulder", "arm.xml", marks=pytest.mark.full), ("base", "arm.urdf"), ("elbow", "arm.xml")],
)
def test_known_friction_comes_out_of_a_servos_log(tmp_path: Path, joint: str, file: str) -> None:
    log = excited(ARM, FRICTION, (joint,), duration=6.0)
    result = _diagnosed(log, tmp_path, FILE.with_name(file))
    assert result.verdict == "adequate"
    own, truth = reduced(ARM, joint), FRICTION[joint]
    for name, value in (("f_k", truth.f_k), ("c", truth.c), ("inertia", own.moved)):
        _near(result, "baseline", name, value, 0.02)
    assert result.robot is not None
    assert (result.robot.joint, result.robot.mode) == (joint, "locked")
    assert ["f_k", "motor-constant"] in result.robot.confounded
    assert result.statement.startswith(f"{joint}: dry friction ")
    copy = load_arm(Path(result.files["robot_mjcf" if file == "arm.xml" else "robot_urdf"]))
    i = ARM.index(joint)
    assert copy.frictionloss[i] == pytest.approx(truth.f_k, rel=0.02)
    assert copy.damping[i] == pytest.approx(truth.c, rel=0.02)
    assert np.array_equal(np.delete(copy.frictionloss, i), np.delete(ARM.frictionloss, i))
    if joint != "base":
        _near(result, "baseline", "gravity", own.gravity, 0.01)
        _near(result, "baseline", "rest_angle", own.q_eq, 0.01)
    else:
        assert "gravity" not in result.baseline.parameters


def test_what_hides_in_a_joint_is_within_what_is_said_and_reversals_are_not_said_to_be_explained(
    tmp_path: Path,
) -> None:
    log = excited(ARM, FRICTION, ("elbow",), duration=6.0)
    v = log.velocity["elbow"]
    # too little to be seen: a concave friction, and a fall with speed that is over beside each reversal
    more = 0.004 * np.sign(v) * np.abs(v) ** 0.7 + 0.05 * np.sign(v) * np.exp(-((v / 0.02) ** 2))
    result = _diagnosed(replace(log, effort={**log.effort, "elbow": log.effort["elbow"] + more}), tmp_path)
    assert result.verdict == "adequate"
    for side in (result.baseline, result.refined):
        for name, true in (("f_k", FRICTION["elbow"].f_k), ("c", FRICTION["elbow"].c)):
            one = side.parameters[name]
            assert one.value is not None
            assert one.stderr is not None
            assert one.systematic is not None
            assert abs(one.value - true) <= 2.0 * one.stderr + one.systematic
            assert one.systematic <= true * 1.1
    said = re.search(r"No missing physics above (\S+) rad/s.*was not looked at", result.statement)
    assert said is not None
    assert 0.02 < float(said[1]) < float(np.max(np.abs(v)))


def _led(more: Callable[[FloatArray, FloatArray, FloatArray], FloatArray], noise: float) -> JointLog:
    """The elbow led along three sines at 250 Hz, with friction .2 N m; more : N m, of time (s), angle and
    speed; noise : rad."""
    own, random = reduced(ARM, "elbow", {"shoulder": 0.5}), np.random.default_rng(0)
    t, w, sizes = np.arange(0.0, 16.0, 4e-3), np.array([[0.9], [2.3], [5.1]]), np.array([[0.5], [0.3], [0.15]])
    waves = sizes * np.sin(w * t), sizes * w * np.cos(w * t), -sizes * w**2 * np.sin(w * t)
    q, v, a = (np.sum(one, axis=0) for one in waves)
    torque = own.moved * a + own.gravity * np.sin(q - own.q_eq) + 0.1 * v + 0.2 * np.sign(v) + more(t, q, v)
    effort = torque + 2e-3 * random.standard_normal(t.size)
    seen = q + noise * random.standard_normal(t.size)
    still = {"base": np.zeros_like(t), "shoulder": np.full_like(t, 0.5)}
    return JointLog(t, {**still, "elbow": seen}, effort={"elbow": effort}, file="led")


def _on_bristles(f_k: float, far: float) -> JointLog:
    """The elbow led along three sines; its friction builds up over a distance, rad, after each reversal."""
    own, random, fine = reduced(ARM, "elbow", {"shoulder": 0.5}), np.random.default_rng(6), 10
    t, w, sizes = np.arange(0.0, 16.0, 4e-3 / fine), np.array([[0.9], [2.3], [5.1]]), np.array([[0.5], [0.3], [0.15]])
    waves = sizes * np.sin(w * t), sizes * w * np.cos(w * t), -sizes * w**2 * np.sin(w * t)
    q, v, a = (np.sum(one, axis=0) for one in waves)
    z = [0.0]
    for by in np.diff(q):
        # a bristle gives less and less the nearer it is to sliding (Dahl 1968), exactly over each step
        side = math.copysign(far, by)
        z.append(side + (z[-1] - side) * math.exp(-abs(by) / far))
    torque = own.moved * a + own.gravity * np.sin(q - own.q_eq) + 0.1 * v + f_k / far * np.array(z)
    at = t[::fine]
    seen = q[::fine] + 1e-6 * random.standard_normal(at.size)
    effort = torque[::fine] + 2e-3 * random.standard_normal(at.size)
    still = {"base": np.zeros_like(at), "shoulder": np.full_like(at, 0.5)}
    return JointLog(at, {**still, "elbow": seen}, effort={"elbow": effort}, file="bristle")


def test_friction_that_builds_up_after_reversals_is_named_with_its_distance(tmp_path: Path) -> None:
    result = _diagnosed(_on_bristles(f_k=0.3, far=0.06), tmp_path)
    assert [one.name for one in result.mechanisms] == ["presliding"]
    assert result.curve is not None
    told = result.curve.presliding
    assert told is not None
    assert told.value is not None
    assert told.stderr is not None
    assert abs(told.value - 0.06) < 3.0 * told.stderr
    assert told.stderr < 0.1 * 0.06
    assert told.unit == "rad"
    _near(result, "refined", "f_k", 0.3, 0.01)
    _near(result, "refined", "inertia", reduced(ARM, "elbow", {"shoulder": 0.5}).moved, 0.01)


def test_a_friction_that_pulls_more_than_the_inertia_is_named_all_the_same(tmp_path: Path) -> None:
    """Beside reversals it pulls back as a spring does, so that without it the inertia comes out below zero."""
    result = _diagnosed(_on_bristles(f_k=0.5, far=0.02), tmp_path)
    assert result.mechanisms[0].name == "presliding"
    assert any("Without presliding the fitted inertia" in line for line in result.warnings)


@pytest.mark.parametrize("noise", [1e-4, 1e-3])
def test_what_smoothing_takes_off_a_ripple_is_no_part_of_its_amplitude(tmp_path: Path, noise: float) -> None:
    """A pass at 1.6 rad/s takes 70 ms over a period of .11 rad, of which smoothing leaves a share alone."""
    result = _diagnosed(_led(lambda t, q, v: 0.02 * np.cos(2.0 * np.pi * q / 0.11), noise), tmp_path)
    assert [one.name for one in result.mechanisms] == ["force-ripple"]
    _given(result, {"amplitude": 0.02, "period": 0.11}, within=0.02)


def test_a_load_that_sways_is_found_by_what_turns_round_with_the_motion(tmp_path: Path) -> None:
    """Its torque has the frequencies of the motion above and below its own, and not its own."""
    result = _diagnosed(_led(lambda t, q, v: 0.04 * np.sign(v) * np.cos(3.1 * t), 1e-3), tmp_path)
    assert [one.name for one in result.mechanisms] == ["normal-load-variation"]
    _given(result, {"depth": 0.2, "Omega": 3.1}, within=0.01)


def _given(result: DiagnosisResult, true: dict[str, float], within: float) -> None:
    """Numbers of the first mechanism: true to three standard errors, which are at most this share of them."""
    for name, value in true.items():
        one = result.mechanisms[0].parameters[name]
        assert one.value is not None
        assert one.stderr is not None
        assert abs(one.value - value) < 3.0 * one.stderr
        assert one.stderr < within * value


def _swing(f_k: float = 0.03, c: float = 0.05, seed: int = 0, terms: tuple[ModelTerm, ...] = ()) -> JointLog:
    """The shoulder let go 1.2 rad from where it hangs, exactly, with noise of an encoder."""
    own = reduced(ARM, "shoulder", {"elbow": 0.5})
    t = np.arange(0.0, 8.0, 0.005)
    moved = simulate(Model(own.moved, c, own.gravity, f_k, x0=1.2, restoring=Restoring.PENDULUM, terms=terms), t)
    seen = own.q_eq + moved.x + 1e-4 * np.random.default_rng(seed).normal(size=t.size)
    still = {"base": np.zeros_like(t), "elbow": np.full_like(t, 0.5)}
    return JointLog(t, {**still, "shoulder": seen}, file="swing")


def test_a_free_swing_without_torques_takes_its_inertia_from_the_model(tmp_path: Path) -> None:
    result = _diagnosed(_swing(), tmp_path)
    own = reduced(ARM, "shoulder", {"elbow": 0.5})
    assert result.verdict == "adequate"
    found = result.baseline.parameters
    assert found["inertia"].value == pytest.approx(own.moved)
    assert found["inertia"].why == "the robot's model gives it: no torque was measured"
    for name, value in (("f_k", 0.03), ("c", 0.05), ("gravity", own.gravity), ("rest_angle", own.q_eq)):
        _near(result, "baseline", name, value, 0.02)
    assert found["f_k"].unit == "N m"
    assert result.robot is not None
    assert ["f_k", "inertia"] in result.robot.confounded
    assert result.robot.reduction is not None
    assert result.robot.reduction.held["elbow"] == pytest.approx(0.5)


def test_what_is_pasted_stands_for_a_law_that_no_model_has(tmp_path: Path) -> None:
    """Beside drag: over the swing the pasted line takes as much power."""
    c2 = 0.3 * reduced(ARM, "shoulder", {"elbow": 0.5}).moved
    log = _swing(terms=(ModelTerm.named("quadratic-drag", c2=c2),))
    result = _diagnosed(log, tmp_path)
    assert [one.name for one in result.mechanisms] == ["quadratic-drag"]
    assert any("nearest straight line" in line for line in result.warnings)
    copy, i = load_arm(Path(result.files["robot_mjcf"])), ARM.index("shoulder")
    v = np.abs(np.gradient(log.position["shoulder"], log.t))
    pasted, lost = copy.frictionloss[i] * v + copy.damping[i] * v**2, 0.03 * v + 0.05 * v**2 + c2 * v**3
    assert np.mean(pasted) == pytest.approx(np.mean(lost), rel=0.15)
    own: dict[str, Any] = {}
    exec(Path(result.files["friction"]).read_text(encoding="utf-8"), own)
    assert own["JOINT"] == "shoulder"
    force, _, _ = own["law"](np, own["START"], 0.0, -2.0, 0.0, 0.0, 0.0)
    assert force == pytest.approx(4.0 * c2, rel=0.2)
    model = load_arm(Path(result.files["robot_mjcf"])).model
    own["attach"](model, mujoco.MjData(model))()
    assert model.dof_frictionloss[i] == 0.0


def test_a_log_in_turns_of_its_own_is_counted_from_the_nearest_rest() -> None:
    log = _swing()
    turned = replace(log, position={**log.position, "shoulder": log.position["shoulder"] + 4.0 * np.pi})
    own = reduced(ARM, "shoulder", {"elbow": 0.5})
    x, y = (one_joint(one, own).recording["x"] for one in (log, turned))
    assert np.allclose(x, y)


def _sprung(tmp_path: Path) -> Path:
    (tmp_path / "sprung.xml").write_text(
        FILE.read_text().replace('name="shoulder" ', 'name="shoulder" stiffness="3" springref="0.5" ')
    )
    return tmp_path / "sprung.xml"


def test_a_spring_of_the_joint_beside_gravity_is_taken_off_the_effort(tmp_path: Path) -> None:
    arm = load_arm(_sprung(tmp_path))
    own = reduced(arm, "shoulder")
    log = excited(ARM, {}, ("shoulder",), duration=2.0)
    one = one_joint(log, own)
    taken = log.effort["shoulder"] - one.recording["u"]
    assert np.allclose(taken, 3.0 * (log.position["shoulder"] - 0.5))
    swing = replace(log, effort={})
    with pytest.raises(InputError, match="both gravity and a spring pull it back"):
        one_joint(swing, own)


def test_a_slide_has_gravitys_force_taken_off(tmp_path: Path) -> None:
    file = tmp_path / "lift.xml"
    body = '<joint name="lift" type="slide" axis="0 0 1"/><inertial pos="0 0 0" mass="3" diaginertia="1 1 1"/>'
    file.write_text(f"<mujoco><worldbody><body>{body}</body></worldbody></mujoco>")
    own = reduced(load_arm(file), "lift")
    t = np.linspace(0.0, 3.0, 300)
    log = JointLog(t, {"lift": np.sin(t)}, effort={"lift": np.cos(3.0 * t)})
    one = one_joint(log, own)
    assert (one.restoring, one.recording.angular, one.inertia) == ("none", False, None)
    assert np.allclose(one.recording["u"], np.cos(3.0 * t) - 3 * 9.81)
    with pytest.raises(InputError, match="nothing pulls a slide back"):
        one_joint(replace(log, effort={}), own)


def test_an_effort_that_is_hardly_in_newton_metres_is_said() -> None:
    log = excited(ARM, {}, ("shoulder",), duration=2.0)
    large = replace(log, effort={name: 1e4 * y for name, y in log.effort.items()})
    assert one_joint(log, reduced(ARM, "shoulder")).warnings == ()
    assert "it is hardly in N m" in one_joint(large, reduced(ARM, "shoulder")).warnings[0]


def test_a_log_without_efforts_in_which_all_move_asks_for_the_joint(tmp_path: Path) -> None:
    log = replace(excited(ARM, FRICTION, ARM.joints, duration=3.0), effort={})
    with pytest.raises(InputError, match="base, shoulder, elbow move"):
        _diagnosed(log, tmp_path)


def test_the_result_is_valid_json_by_its_schema(tmp_path: Path) -> None:
    jsonschema = pytest.importorskip("jsonschema")
    from harness.results.generate import models, schema_text

    result = _diagnosed(_swing(f_k=0.05), tmp_path)
    data = json.loads((tmp_path / "out" / "result.json").read_text())
    assert data["robot"]["joint"] == "shoulder"
    # settings are what was asked, so that going on can tell whether it is the same; the joint that was found is above
    assert data["settings"]["robot"]["joint"] is None
    jsonschema.validate(data, json.loads(schema_text("harness.diagnosis/2", models()["harness.diagnosis/2"])))
    assert DiagnosisResult.model_validate(data) == result


def test_the_friction_of_an_example_is_what_was_asked_for() -> None:
    """The log's torque less the rigid model's, at the middle of the samples, is Coulomb's and viscous friction."""
    log = excited(ARM, {"elbow": Friction(0.4, 0.1, 0.05)}, ("elbow",), duration=3.0, seed=4)
    own = reduced(ARM, "elbow")
    again = excited(ARM, {"elbow": Friction(0.4, 0.1, 0.05)}, ("elbow",), duration=3.0, seed=4)
    assert np.array_equal(log.effort["elbow"], again.effort["elbow"])
    recording = Recording(log.t, {"x": log.position["elbow"], "v": log.velocity["elbow"]})
    t, v = recording.t, log.velocity["elbow"]
    smooth = np.convolve(v, np.ones(9) / 9, "same")
    a = np.gradient(smooth, t)
    left = log.effort["elbow"] - own.torque(log.position["elbow"], a) - 0.1 * smooth - 0.05
    fast = (np.abs(smooth) > 0.5) & (np.abs(a) < 3.0)
    assert np.median((left * np.sign(smooth))[fast]) == pytest.approx(0.4, abs=0.02)


def test_one_moving_joint_is_locked_and_three_are_a_whole_arm() -> None:
    locked = coupling(ARM, excited(ARM, FRICTION, ("shoulder",), duration=10.0), "shoulder")
    assert (locked.mode, locked.moving, locked.torque) == ("locked", (), 0.0)
    assert locked.reduced.held == pytest.approx({"base": 0.0, "elbow": 0.0}, abs=1e-5)
    moving = coupling(ARM, excited(ARM, FRICTION, ARM.joints, duration=10.0), "shoulder")
    assert moving.mode == "whole-arm"
    assert set(moving.moving) == {"base", "elbow"}
    assert moving.torque > moving.residual * 0.5
    assert moving.share > 0.9


SLIDE = """<mujoco><worldbody><body><joint name="{joint}" type="{kind}"/><geom size=".05" mass="1" pos="0 0 .1"/></body>
</worldbody></mujoco>"""


@pytest.mark.parametrize(
    ("kind", "unit", "said"),
    [
        ("hinge", "mm", "positions in mm, and it turns; expected an angle"),
        ("slide", "deg", "it slides; expected a length"),
    ],
)
def test_a_position_of_another_kind_than_its_joint_is_refused(tmp_path: Path, kind: str, unit: str, said: str) -> None:
    (tmp_path / "one.xml").write_text(SLIDE.format(joint="one", kind=kind))
    t = np.arange(0.0, 5.0, 0.01)
    table = np.column_stack((t, 20.0 * np.exp(-0.2 * t) * np.cos(6.0 * t)))
    np.savetxt(tmp_path / "log.csv", table, "%.5f", ",", header=f"t,one.position [{unit}]", comments="")
    with pytest.raises(InputError, match=said):
        diagnose(tmp_path / "log.csv", DiagnoseOptions(robot=RobotOptions(tmp_path / "one.xml", "one"), engines=()))


def test_others_that_move_are_seen_in_a_wrong_unit_too() -> None:
    """An effort in another unit leaves much more than the others' torque, and hangs on it all the same."""
    log = excited(ARM, FRICTION, ARM.joints, duration=10.0)
    large = replace(log, effort={name: 30.0 * y for name, y in log.effort.items()})
    found = coupling(ARM, large, "shoulder")
    assert found.torque < 0.1 * found.residual
    assert found.mode == "whole-arm"


def test_a_slow_drift_of_another_does_not_matter() -> None:
    log = excited(ARM, FRICTION, ("shoulder",), duration=10.0)
    drifting = {**log.position, "elbow": log.position["elbow"] + 0.002 * log.t / 10.0}
    found = coupling(ARM, replace(log, position=drifting), "shoulder")
    assert found.moving == ("elbow",)
    assert found.mode == "locked"


def test_a_constant_column_does_not_move_whatever_its_digits_say() -> None:
    log = excited(ARM, FRICTION, ("shoulder",), duration=5.0)
    digits = 0.7 + 1e-16 * np.random.default_rng(1).standard_normal(log.t.size)
    found = coupling(ARM, replace(log, position={**log.position, "elbow": digits}), "shoulder")
    assert found.moving == ()


def _log(**position: float) -> JointLog:
    t = np.linspace(0.0, 2.0, 200)
    return JointLog(t, {name: scale * np.sin(3.0 * t) for name, scale in position.items()}, file="log.csv")


BAD = [
    (_log(shoulder=0.5), "elbow", "'elbow', whose position log.csv does not hold.*of the log: shoulder"),
    (_log(lift=0.5, wrist=0.1), "shoulder", "joints lift, wrist, and .* has base, shoulder, elbow"),
    (_log(shoulder=0.5), "sholder", "did you mean shoulder"),
    (_log(shoulder=math.degrees(0.8)), "shoulder", "as in degrees"),
]


@pytest.mark.parametrize(("log", "joint", "said"), BAD)
def test_logs_that_do_not_go_with_the_model_are_refused(log: JointLog, joint: str, said: str) -> None:
    with pytest.raises(InputError, match=said):
        coupling(ARM, log, joint)


def _stick_slip(rng: np.random.Generator) -> tuple[JointLog, Reduced, float]:
    """A log of 20 s at 250 Hz, the joint, and its break-away torque, N m."""
    inertia, gravity, kp = rng.uniform(0.2, 0.6), rng.uniform(3.0, 10.0), rng.uniform(40.0, 80.0)
    f_s, f_k = rng.uniform(2.0, 3.0), rng.uniform(0.5, 1.0)
    offset, h, every = rng.uniform(-0.1, 0.1), 2e-4, 20
    q = v = 0.0
    rows = np.empty((5000, 3))
    for i in range(5000 * every):
        t = i * h
        turn = 2.0 * math.pi * 0.08 * t
        torque = kp * (0.12 * math.sin(turn) - q) + 1.5 * (0.06 * math.cos(turn) - v) + gravity * math.cos(q) + offset
        if i % every == 0:
            rows[i // every] = t, q, torque
        free = torque - gravity * math.cos(q) - offset
        if v == 0.0 and abs(free) <= f_s:
            continue
        sliding = f_k + (f_s - f_k) * math.exp(-abs(v) / 0.12)
        after = v + h * (free - 0.05 * v - math.copysign(sliding, v if v else free)) / inertia
        v = 0.0 if v * after < 0.0 and abs(free) <= f_s else after
        q += h * v
    rows[:, 1:] += (2e-5, 0.02) * rng.standard_normal((5000, 2))
    log = JointLog(rows[:, 0].copy(), {"j": rows[:, 1].copy()}, effort={"j": rows[:, 2].copy()})
    return log, Reduced("j", inertia, 0.0, b=gravity), f_s


@pytest.mark.parametrize("seed", range(4))
def test_break_away_is_the_last_torque_before_a_slip(seed: int) -> None:
    log, own, f_s = _stick_slip(np.random.default_rng(seed))
    found = slips(log, own)
    assert found is not None
    assert found.still > 0.5
    broken = found.break_away
    assert broken is not None
    assert broken.value == pytest.approx(f_s, rel=0.06)
    assert broken.stderr is not None
    assert broken.value is not None
    assert abs(broken.value - f_s) < 3.0 * broken.stderr


def test_a_joint_that_slides_too_shortly_to_be_fitted_is_told_by_its_slips() -> None:
    told = robot_joints.slips(1, 0)
    assert told.right, told.said


def test_a_joint_that_swings_has_no_slips() -> None:
    t = np.arange(5000) / 250.0
    q = 0.3 * np.sin(2.0 * t) + 2e-5 * np.random.default_rng(0).standard_normal(t.size)
    assert slips(JointLog(t, {"j": q}, effort={"j": np.cos(t)}), Reduced("j", 0.4, 0.0, b=5.0)) is None
    assert slips(JointLog(t, {"j": q}), Reduced("j", 0.4, 0.0, b=5.0)) is None


def test_a_table_in_another_language_ends_in_columns_of_the_one_joint(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    body = '<body><joint name="elbow" axis="0 1 0"/><geom size="0.1" mass="1" pos="0 0 -0.2"/></body>'
    (tmp_path / "arm.xml").write_text(f"<mujoco><worldbody>{body}</worldbody></mujoco>")
    t = np.arange(0.0, 4.0, 0.02)
    rows = [f"{a:.3f};{30.0 * np.sin(2.0 * a):.4f};{2.0 * np.sin(2.0 * a + 1.0):.4f}".replace(".", ",") for a in t]
    (tmp_path / "log.csv").write_text("\n".join(["Zeit [s];Winkel Ellbogen [°];Drehmoment Ellbogen [Nm]", *rows]))
    assert run(["diagnose", str(tmp_path / "log.csv"), "--robot", str(tmp_path / "arm.xml")]) == 2
    said = capsys.readouterr().err
    columns = "t='Zeit [s]'[s],elbow.position='Winkel Ellbogen [°]'[°],elbow.effort='Drehmoment Ellbogen [Nm]'[Nm]"
    assert f'Try: harness diagnose {tmp_path / "log.csv"} --robot {tmp_path / "arm.xml"} --columns "{columns}"' in said
