"""Errors of the model, and effects of friction beside the base: named with their size, in their joint alone."""

import math
import re
from dataclasses import replace
from functools import reduce
from pathlib import Path

import mujoco
import numpy as np
import pytest
from whole_arm_logs import LOWPASS, NAMES, arm, log_of, machine, with_effect

from benchmarks.robot_calibrate.draws import loose
from benchmarks.robot_calibrate.plant import Friction
from harness.core.arrays import FloatArray
from harness.core.robot import JointLog
from harness.robot.arm import load_arm
from harness.robot.whole_arm.columns import (
    ARMATURE,
    ASYMMETRIC,
    DELAY,
    DRIFT,
    INERTIA,
    LOAD,
    LOAD_OR_POSITION,
    MASS_AT_END,
    MOTOR,
    PAYLOAD,
    POSITION,
    POWER,
    QUADRATIC,
    RIPPLE,
    ROTOR_OR_AXIS,
    ROTOR_OR_SENSOR,
    SCALE_OR_MASS,
    SENSOR,
    SPRING,
    STRIBECK,
    TILT,
    WHICH_IS_LATE,
    ZERO,
)
from harness.robot.whole_arm.perturb import (
    called,
    loaded_bodies,
    moving_bodies,
    tilted,
    with_load,
    with_mass,
    with_zeros,
    without_armature,
)
from harness.robot.whole_arm.result import Entry, Grade, WholeArm
from harness.robot.whole_arm.turning import BACKLASH, PRESLIDING, STATIC, bristles
from harness.robot.whole_arm.whole import whole_arm

FACTORS = (0.9, 1.1, 1.1, 0.9, 1.1, 0.9, 1.1)


def only(found: WholeArm, name: str, joint: str | None = None) -> Entry:
    assert found.named == ((name, joint),)
    return found.model[0]


def friction_is_right(found: WholeArm, share: float = 0.01) -> None:
    plant = machine()[0]
    for joint, coulomb, viscous in zip(found.joints, plant.coulomb, plant.viscous, strict=True):
        assert joint.coulomb.value == pytest.approx(coulomb, rel=share)
        assert joint.viscous.value == pytest.approx(viscous, rel=share)


def test_a_load_at_the_end_is_a_pair_with_the_last_link_and_its_place_is_found() -> None:
    plant, motion = machine()
    wrong = replace(plant, arm=with_load(arm(), 2.8, np.array([0.05, -0.06, 0.1])))
    found = whole_arm(log_of(wrong, motion), arm(), lowpass=LOWPASS)
    told = only(found, PAYLOAD)
    assert (told.pair, told.members) == (MASS_AT_END, (PAYLOAD, "mass of the last link"))
    values = {what: value.value for what, value in told.parameters}
    assert values["mass"] == pytest.approx(2.8, abs=0.02)
    moments = [values[f"moment {axis}"] for axis in "xyz"]
    assert moments == pytest.approx([0.14, -0.168, 0.28], abs=0.005)
    assert "last link" in told.statement
    friction_is_right(found)


@pytest.mark.parametrize("inwards", [1, 2])
def test_a_load_on_an_earlier_body_is_told_with_where_it_sits(inwards: int) -> None:
    """A kilogram beside joint 7's axis, which does not turn with that joint, is no load at the end of the arm."""
    plant, motion = machine(3)
    body = loaded_bodies(arm(), inwards + 1)[-1]
    wrong = replace(plant, arm=with_load(arm(), 1.0, np.array([0.05, -0.06, 0.08]), body))
    found = whole_arm(log_of(wrong, motion), arm(), lowpass=LOWPASS)
    (load,) = found.model
    assert load.name == PAYLOAD
    mass = dict(load.parameters)["mass"]
    assert mass.value == pytest.approx(1.0, abs=0.01)
    assert f"more on {called(arm(), body)} than the model has" in load.statement
    friction = np.array([[j.coulomb.value, j.viscous.value] for j in found.joints], dtype=np.float64)
    assert np.max(np.abs(friction / np.stack((plant.coulomb, plant.viscous), axis=1) - 1.0)) < 0.05


@pytest.mark.parametrize(("joint", "stiff"), [(1, 12.0), (3, -6.0)])
def test_a_spring_that_no_model_has_is_no_scale_of_the_torque(joint: int, stiff: float) -> None:
    """A balancer, or cables that are bent: what pulls towards a place, or away from it, goes with the angle."""
    plant, motion = machine()
    found = whole_arm(
        log_of(with_effect(plant, joint, lambda t, q, v, load: stiff * (q - 0.3)), motion), arm(), lowpass=LOWPASS
    )
    told = only(found, SPRING, NAMES[joint])
    (stiffness,) = (value for _, value in told.parameters)
    assert stiffness.value == pytest.approx(stiff, rel=0.02)
    assert f"({NAMES[joint]})" in told.statement
    friction_is_right(found)


def test_a_load_beside_a_wheel_turns_with_it(tmp_path: Path) -> None:
    """I + kg r^2 about the axis, where the wheel's own centre of mass is on it."""
    (tmp_path / "wheel.xml").write_text(
        '<mujoco><worldbody><body><joint name="j" axis="0 0 1"/><inertial pos="0 0 0" mass="2"'
        ' diaginertia=".3 .3 .4"/></body></worldbody></mujoco>'
    )
    loaded = with_load(load_arm(tmp_path / "wheel.xml"), 1.5, np.array([0.2, 0.0, 0.0]))
    turning = loaded.inverse(np.zeros((1, 1)), np.zeros((1, 1)), np.ones((1, 1)))
    assert turning[0, 0] == pytest.approx(0.4 + 1.5 * 0.2**2)


def test_a_load_that_is_known_is_not_looked_for() -> None:
    plant, motion = machine()
    log = log_of(replace(plant, arm=with_load(arm(), 0.5)), motion)
    found = whole_arm(log, arm(), payload=0.5, lowpass=LOWPASS)
    assert found.named == ()
    friction_is_right(found)
    without = whole_arm(log, arm(), payload=0.0, lowpass=LOWPASS)
    assert PAYLOAD not in {name for name, _ in without.named}
    assert without.named


def test_masses_that_are_each_off_are_a_pair_with_the_scale_of_torque() -> None:
    plant, motion = machine()
    bodies = moving_bodies(arm())
    wrong = reduce(lambda a, i: with_mass(a, bodies[i], FACTORS[i]), range(7), arm())
    found = whole_arm(log_of(replace(plant, arm=wrong), motion), arm(), lowpass=LOWPASS)
    told = only(found, INERTIA)
    assert (told.pair, told.partner) == (SCALE_OR_MASS, MOTOR)
    seen = [value.value for _, value in told.parameters]
    # the first two turn about the upright axis alone, or hardly weigh: their masses do not show
    assert seen[2:] == pytest.approx([f - 1.0 for f in FACTORS][2:], abs=0.02)
    friction_is_right(found)


def test_a_motor_constant_is_a_pair_with_masses_and_friction_is_in_true_torque() -> None:
    plant, motion = machine()
    gain = np.where(np.arange(7) == 3, 1.1, 1.0)
    log = log_of(replace(plant, gain=gain), motion)
    found = whole_arm(log, arm(), lowpass=LOWPASS)
    told = only(found, MOTOR, "joint4")
    assert (told.pair, told.partner) == (SCALE_OR_MASS, INERTIA)
    assert told.parameters[0][1].value == pytest.approx(0.1, abs=0.005)
    friction_is_right(found)
    known = whole_arm(log, arm(), lowpass=LOWPASS, gain_known=True)
    assert MOTOR not in {name for name, _ in known.named}


@pytest.mark.parametrize("late", [0.005, 0.015])
def test_late_torque_is_a_pair_with_early_position(late: float) -> None:
    plant, motion = machine()
    found = whole_arm(log_of(replace(plant, late=late), motion), arm(), lowpass=LOWPASS)
    told = only(found, DELAY)
    assert (told.pair, told.partner) == (WHICH_IS_LATE, "early position")
    assert told.parameters[0][1].value == pytest.approx(late, abs=3e-4)
    friction_is_right(found)


def test_an_eighth_of_a_sample_is_told_with_its_error_and_not_named() -> None:
    plant, motion = machine()
    found = whole_arm(log_of(replace(plant, late=0.0005, noise=0.1), motion), arm(), lowpass=LOWPASS)
    assert found.named == ()
    ((late, error),) = re.findall(r"([\d.]+) \+- ([\d.]+) s apart, less than a sample", " ".join(found.notes))
    assert abs(float(late) - 0.0005) < 3.0 * float(error) < 0.001
    for joint, viscous in zip(found.joints, plant.viscous, strict=True):
        assert abs((joint.viscous.value or 0.0) - viscous) < 3.0 * (joint.viscous.stderr or 0.0)


def test_a_tilted_base_is_named_with_its_angles() -> None:
    plant, motion = machine()
    found = whole_arm(log_of(replace(plant, arm=tilted(arm(), 0.05, 1)), motion), arm(), lowpass=LOWPASS)
    told = only(found, TILT)
    assert [value.value for _, value in told.parameters] == pytest.approx([0.0, 0.05], abs=1e-3)
    friction_is_right(found)


def test_zeros_that_are_off_are_named_with_their_joints() -> None:
    plant, motion = machine()
    shift = np.zeros(7)
    shift[[1, 3]] = 0.03, -0.05
    found = whole_arm(log_of(replace(plant, arm=with_zeros(arm(), shift)), motion), arm(), lowpass=LOWPASS)
    told = only(found, ZERO)
    assert told.partner.startswith("centre of mass")
    numbers = {name: value.value for name, value in told.parameters}
    assert [numbers[f"joint{j}"] for j in (2, 4)] == pytest.approx([0.03, -0.05], abs=2e-3)
    assert "--offset" in told.statement
    friction_is_right(found)


def test_a_rotor_of_one_joint_is_a_pair_with_its_link() -> None:
    plant, motion = machine()
    heavy = with_mass(arm(), 1, 1.0)
    heavy.model.dof_armature[4] += 0.05
    found = whole_arm(log_of(replace(plant, arm=heavy), motion), arm(), lowpass=LOWPASS)
    told = only(found, ARMATURE, "joint5")
    assert told.pair == ROTOR_OR_AXIS
    assert told.parameters[0][1].value == pytest.approx(0.05, abs=2e-3)


def test_a_sensor_behind_the_gearbox_is_a_pair_until_its_side_is_known() -> None:
    plant, motion = machine()
    log = log_of(replace(plant, arm=without_armature(arm())), motion)
    told = only(whole_arm(log, arm(), lowpass=LOWPASS), SENSOR)
    assert (told.pair, told.partner) == (ROTOR_OR_SENSOR, ARMATURE)
    known = whole_arm(log, arm(), sensor="link", lowpass=LOWPASS)
    assert known.named == ()
    assert all(SENSOR not in pair for pair in known.confounded)


def test_a_load_adds_the_weight_and_the_inertia_of_a_point_and_no_more() -> None:
    rng = np.random.default_rng(1)
    q, a = rng.normal(size=(2, 5, 7))
    at, kg, body, still = np.array([0.02, -0.03, 0.06]), 0.4, 7, np.zeros((5, 7))
    loaded = with_load(arm(), kg, at)
    weight = loaded.inverse(q, still, still) - arm().inverse(q, still, still)
    pushed = loaded.inverse(q, still, a) - arm().inverse(q, still, a)
    for i in range(5):
        data = mujoco.MjData(arm().model)
        data.qpos[:] = q[i]
        mujoco.mj_forward(arm().model, data)
        place = data.xpos[body] + data.xmat[body].reshape(3, 3) @ (arm().model.body_ipos[body] + at)
        jacobian = np.zeros((3, 7))
        mujoco.mj_jac(arm().model, data, jacobian, None, place, body)
        assert weight[i] == pytest.approx(jacobian.T @ np.array([0.0, 0.0, kg * 9.81]), abs=1e-9)
        assert pushed[i] - weight[i] == pytest.approx(kg * jacobian.T @ (jacobian @ a[i]), abs=1e-9)


@pytest.mark.parametrize(("span", "pair"), [(0.02, True), (0.5, False)])
def test_offset_and_gravity_are_a_pair_where_a_joint_moves_little(span: float, pair: bool) -> None:
    plant, motion = machine(quiet=False)
    small = motion.amplitude.copy()
    small[3] *= span
    small[[0, 1, 2, 4, 5, 6]] = 0.0
    middle = motion.middle.copy()
    moved = type(motion)(middle, small, motion.frequency, motion.phase)
    found = whole_arm(log_of(plant, moved), arm(), joints=("joint4",), lowpass=LOWPASS)
    assert (("offset of joint4", "gravity") in found.confounded) == pair


JOINT = 3
COULOMB = float(machine()[0].coulomb[JOINT])
CASES: dict[str, tuple[Friction, dict[str, float]]] = {
    STRIBECK: (
        lambda t, q, v, g: 0.4 * COULOMB * np.sign(v) * np.exp(-((v / 0.25) ** 2)),
        {"f_s - f_c": 0.4 * COULOMB, "v_s": 0.25},
    ),
    LOAD: (lambda t, q, v, g: 0.05 * np.abs(g) * np.sign(v), {"share of load": 0.05}),
    RIPPLE: (lambda t, q, v, g: 0.2 * np.sin(9.0 * q), {"wave": 9.0}),
    POSITION: (lambda t, q, v, g: 0.3 * np.sign(v) * np.sin(5.0 * q), {"wave": 5.0}),
    ASYMMETRIC: (lambda t, q, v, g: 0.3 * np.abs(v), {"half difference": 0.3}),
    QUADRATIC: (lambda t, q, v, g: 0.3 * v * np.abs(v), {"c_2": 0.3}),
    DRIFT: (lambda t, q, v, g: 0.3 * np.sign(v) * t / 12.0, {"rise of Coulomb": 0.3}),
    PRESLIDING: (lambda t, q, v, g: COULOMB * (bristles(q, 0.004) - np.sign(v)), {"length": 0.004, "held": COULOMB}),
    STATIC: (lambda t, q, v, g: 0.5 * COULOMB * np.sign(v) * np.exp(-((v / 0.05) ** 2)), {"v_s": 0.05}),
    BACKLASH: (loose(0.01), {"share": 1.0}),
}


@pytest.mark.parametrize("name", CASES)
def test_an_effect_is_named_with_its_numbers_in_its_joint_alone(name: str) -> None:
    plant, motion = machine()
    effect, numbers = CASES[name]
    found = whole_arm(log_of(with_effect(plant, JOINT, effect), motion), arm(), lowpass=LOWPASS)
    assert found.named == ((name, f"joint{JOINT + 1}"),)
    (told,) = found.joints[JOINT].effects
    # what is pasted is the line through all of the friction that acts, whatever its law
    t = np.linspace(0.0, 12.0, 3000)
    q, v, _ = motion.at(t)
    slides = np.abs(v[:, JOINT]) > 0.15
    friction = with_effect(plant, JOINT, effect).friction(t, q, v)[slides, JOINT]
    columns = np.column_stack((np.sign(v[slides, JOINT]), v[slides, JOINT], np.ones(int(slides.sum()))))
    line = found.joints[JOINT].line
    assert line is not None

    def left(coulomb: float, viscous: float) -> float:
        rest = friction - columns[:, :2] @ (coulomb, viscous)
        return float(np.std(rest))

    best = left(*np.linalg.lstsq(columns, friction, rcond=None)[0][:2])
    assert left(line[0].value or 0.0, line[1].value or 0.0) < 1.1 * best + 0.02 * COULOMB
    values = dict(told.parameters)
    for what, truth in numbers.items():
        assert values[what].value == pytest.approx(truth, rel=0.1)
    assert told.share > 0.5
    assert told.grade in (Grade.EXPLAINS, Grade.MAIN)
    likeliest = max(found.likely, key=found.likely.__getitem__)
    assert likeliest == (f"joint{JOINT + 1}: {name}",)
    # reversals are few, and say less
    assert found.likely[likeliest] > (0.6 if name in (PRESLIDING, STATIC, BACKLASH) else 0.9)
    before, after = found.joints[JOINT].held_out or (0.0, 0.0)
    assert after < before or name in (PRESLIDING, STATIC, BACKLASH)
    for _, value in told.parameters:
        assert str(value) in told.statement or name == BACKLASH


@pytest.mark.parametrize("name", [PRESLIDING, BACKLASH])
def test_a_turn_within_a_coarse_encoders_steps_is_no_rest(name: str) -> None:
    """At its slowest a joint stays for a while within two steps of 0.4 mrad, as far as its acceleration says."""
    plant, motion = machine()
    coarse = with_effect(replace(plant, counts=2**14), JOINT, CASES[name][0])
    found = whole_arm(log_of(coarse, motion), arm(), lowpass=LOWPASS)
    assert (name, f"joint{JOINT + 1}") in found.named


@pytest.mark.parametrize("length", [0.01, 0.004, 0.0])
def test_presliding_is_told_of_a_joint_that_rests_where_it_turns(length: float, tmp_path: Path) -> None:
    """To and fro with a rest of .3 s at either end; a joint without bristles is held there by any friction there is."""
    link = '<body><joint name="j" axis="0 0 1"/><inertial pos="0 0 0" mass="1" diaginertia=".5 .5 .5"/></body>'
    (tmp_path / "arm.xml").write_text(f"<mujoco><worldbody>{link}</worldbody></mujoco>")
    t, rng = np.arange(0.0, 24.0, 0.004), np.random.default_rng(8)
    ends = rng.uniform(0.2, 0.6, 17) * np.resize([-1.0, 1.0], 17)
    way, begun = (t // 1.5).astype(int), t % 1.5
    far, s = np.diff(ends)[way], np.clip(begun / 1.2, 0.0, 1.0)
    q = ends[way] + far * s**3 * (10.0 - 15.0 * s + 6.0 * s**2)
    v = far * 30.0 * s**2 * (1.0 - s) ** 2 / 1.2
    a = far * 60.0 * s * (1.0 - s) * (1.0 - 2.0 * s) / 1.2**2
    held = np.where(s < 1.0, np.sign(far), rng.uniform(-1.0, 1.0, 16)[way])
    torque = 0.5 * a + 0.1 * v + 0.8 * (bristles(q, length) if length else held)
    log = JointLog(t, {"j": q}, effort={"j": torque + 0.004 * rng.standard_normal(t.size)})
    found = whole_arm(log, load_arm(tmp_path / "arm.xml"))
    if not length:
        assert found.named == ()
        return
    assert found.named == ((PRESLIDING, "j"),)
    numbers = dict(found.joints[0].effects[0].parameters)
    assert numbers["length"].value == pytest.approx(length, rel=0.1)
    assert numbers["held"].value == pytest.approx(0.8, rel=0.1)


@pytest.mark.parametrize("resting", [(6, 15), (2, 7, 11, 15)])
def test_static_friction_is_told_of_a_joint_that_rests_at_a_few_of_its_reversals(
    resting: tuple[int, ...], tmp_path: Path
) -> None:
    """Two sines of .4 and .29 Hz, held for .3 s at some of 19 reversals by less friction than it slides with."""
    link = '<body><joint name="j" axis="0 0 1"/><inertial pos="0 0 0" mass="1" diaginertia=".5 .5 .5"/></body>'
    (tmp_path / "arm.xml").write_text(f"<mujoco><worldbody>{link}</worldbody></mujoco>")
    turn, size, rng = 2.0 * np.pi * np.array([0.4, 0.29]), np.array([0.3, 0.18]), np.random.default_rng(8)
    t, fine = np.arange(0.0, 24.0, 0.004), np.arange(0.0, 24.0, 0.0005)
    ends = fine[np.flatnonzero(np.diff(np.sign(np.cos(np.outer(fine, turn)) @ (size * turn)))) + 1]
    going, held = t.copy(), np.zeros(t.size, dtype=np.bool_)
    for k, end in enumerate(ends[list(resting)]):
        held |= (t > end + 0.3 * k) & (t < end + 0.3 * (k + 1))
        going = np.where(t > end + 0.3 * k, np.maximum(going - 0.3, end), going)
    angle = np.outer(going, turn)
    q, v, a = np.sin(angle) @ size, np.cos(angle) @ (size * turn), -np.sin(angle) @ (size * turn**2)
    slides = np.sign(v) * (0.8 + 0.2 * np.exp(-((v / 0.06) ** 2))) + 0.1 * v
    torque = np.where(held, 0.3, 0.5 * a + slides) + 0.004 * rng.standard_normal(t.size)
    found = whole_arm(JointLog(t, {"j": q}, effort={"j": torque}), load_arm(tmp_path / "arm.xml"))
    assert found.named == ((STATIC, "j"),)
    numbers = dict(found.joints[0].effects[0].parameters)
    for number, true in {"f_s - f_c": 0.2, "v_s": 0.06}.items():
        assert abs((numbers[number].value or 0.0) - true) < 3.0 * (numbers[number].stderr or 0.0) < 0.4 * true


def test_load_and_position_of_one_gravity_joint_are_a_pair() -> None:
    """Alone in its plane, a joint's load is a function of its position: neither can be named without the other."""
    plant, motion = machine()
    still = motion.amplitude.copy()
    still[[i for i in range(7) if i != 1]] = 0.0
    middle = motion.middle.copy()
    middle[1] = 1.0
    alone = type(motion)(middle, still, motion.frequency, motion.phase)
    effect: Friction = lambda t, q, v, g: 0.05 * np.abs(g) * np.sign(v)  # noqa: E731
    found = whole_arm(log_of(with_effect(plant, 1, effect), alone), arm(), joints=("joint2",), lowpass=LOWPASS)
    told = [e for e in found.joint("joint2").effects if e.name in (LOAD, POSITION)]
    assert told, found.joint("joint2")
    assert all(e.pair == LOAD_OR_POSITION for e in told)


@pytest.mark.parametrize(
    ("own", "said"), [(0.0, "the torque of gravity and motion"), (1.0, "all torque that its gears")]
)
def test_friction_grows_with_the_torque_of_the_motion_where_gravity_is_none(own: float, said: str) -> None:
    """Of an upright joint: with what moves the arm, or with that and the friction that the gears overcome."""
    plant, motion = machine()
    t = np.arange(0.0, 12.0, 0.004)
    q, v, a = motion.at(t)
    share, v = 0.04, v[:, 0]
    sliding = plant.coulomb[0] * np.sign(v) + plant.viscous[0] * v
    carried = np.abs(arm().inverse(q, motion.at(t)[1], a)[:, 0] + own * sliding)
    effect: Friction = lambda at, _, speed, g: share * np.interp(at, t, carried) * np.sign(speed)  # noqa: E731
    found = whole_arm(log_of(with_effect(plant, 0, effect), motion), arm(), lowpass=LOWPASS)
    assert found.named == ((LOAD, NAMES[0]),)
    (told,) = found.joints[0].effects
    assert said in told.statement
    assert dict(told.parameters)["share of load"].value == pytest.approx(share, rel=0.1)
    assert found.joints[0].coulomb.value == pytest.approx(plant.coulomb[0], rel=0.03)


def test_bristles_turn_over_their_length() -> None:
    q = np.concatenate((np.linspace(0.0, 0.1, 1000), np.linspace(0.1, 0.0, 1000)))
    state = bristles(q, 0.01)
    after = np.abs(q - 0.1)
    exact = -1.0 + 2.0 * np.exp(-after / 0.01)
    assert state[1000:] == pytest.approx(exact[1000:], abs=1e-9 + 2.0 * math.exp(-9.0))


def test_laws_of_one_joint_that_bend_alike_have_the_numbers_put_in_within_their_errors() -> None:
    plant, motion = machine()
    plant = replace(plant, viscous=np.where(np.arange(plant.viscous.size) == 2, 0.0, plant.viscous))
    put_in = {"f_s - f_c": 1.5, "v_s": 0.19, "c_p": 4.9, "exponent": 0.67}

    def slower_and_concave(t: FloatArray, q: FloatArray, v: FloatArray, g: FloatArray) -> FloatArray:
        falls = put_in["f_s - f_c"] * np.exp(-((v / put_in["v_s"]) ** 2))
        return np.asarray(np.sign(v) * (falls + put_in["c_p"] * np.abs(v) ** put_in["exponent"]))

    log = log_of(with_effect(plant, 2, slower_and_concave), motion)
    found = whole_arm(log, arm(), joints=[NAMES[2]], lowpass=LOWPASS).joints[0]
    effects = found.effects
    assert {one.name for one in effects} == {STRIBECK, POWER}
    assert (found.viscous.value, found.viscous.stderr) == (0.0, None)  # held at nothing, and measured by nothing
    assert f"no viscous friction: {POWER} is fitted in its place" in found.statement
    told = dict(effects[0].parameters) | dict(effects[1].parameters)
    for name, value in put_in.items():
        assert abs((told[name].value or 0.0) - value) < 3.0 * (told[name].stderr or 0.0) < 0.1 * value


@pytest.mark.parametrize("v_s", [0.08, 0.4])
def test_the_speed_over_which_friction_falls_is_that_put_in_at_either_end_of_those_tried(v_s: float) -> None:
    plant, motion = machine()

    def falls(t: FloatArray, q: FloatArray, v: FloatArray, g: FloatArray) -> FloatArray:
        return np.asarray(0.5 * plant.coulomb[3] * np.sign(v) * np.exp(-((v / v_s) ** 2)))

    log = log_of(with_effect(plant, 3, falls), motion)
    (one,) = whole_arm(log, arm(), joints=[NAMES[3]], lowpass=LOWPASS).joints[0].effects
    assert one.name == STRIBECK
    told = dict(one.parameters)["v_s"]
    assert abs((told.value or 0.0) - v_s) < 3.0 * (told.stderr or 0.0) < 0.2 * v_s
