"""Friction of a whole arm: known answers, in closed loop, of recordings; conventions that must not matter.

And what a motion can tell of a joint's friction, from its columns alone, and the motion that would mend it.
"""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import mujoco
import numpy as np
import pytest
from whole_arm_logs import LOWPASS, NAMES, arm, log_of, machine, of_joints, with_effect

from benchmarks.robot_logs.plants import clean
from harness.core.errors import InputError
from harness.core.robot import JointLog
from harness.robot.arm import Arm, load_arm
from harness.robot.whole_arm.columns import PAYLOAD, STRIBECK, TILT
from harness.robot.whole_arm.perturb import with_load
from harness.robot.whole_arm.result import WholeArm
from harness.robot.whole_arm.whole import whole_arm


def base_of(found: WholeArm) -> np.ndarray[Any, np.dtype[np.float64]]:
    return np.array([[j.coulomb.value, j.viscous.value, j.offset.value] for j in found.joints], dtype=np.float64)


@pytest.mark.parametrize("seed", [0, 1])
def test_friction_of_a_log_without_noise_is_that_put_in(seed: int) -> None:
    plant, motion = machine(seed)
    plant = replace(plant, noise=0.0, counts=0)
    found = whole_arm(log_of(plant, motion), arm(), lowpass=LOWPASS)
    truth = np.stack((plant.coulomb, plant.viscous), axis=1)
    assert np.max(np.abs(base_of(found)[:, :2] / truth - 1.0)) < 1e-3
    assert np.max(np.abs(base_of(found)[:, 2] - plant.offset)) < 3e-3
    assert found.named == ()


def test_claimed_errors_are_those_made_and_nothing_is_named() -> None:
    z = []
    for seed in range(4):
        plant, motion = machine(seed, quiet=False)
        found = whole_arm(log_of(plant, motion, seed), arm(), lowpass=LOWPASS)
        assert found.named == ()
        truth = np.stack((plant.coulomb, plant.viscous, plant.offset), axis=1)
        claimed = np.array([[j.coulomb.stderr, j.viscous.stderr, j.offset.stderr] for j in found.joints])
        z.append((base_of(found) - truth) / claimed)
    assert 0.75 < np.sqrt(np.mean(np.square(z))) < 1.3
    assert np.mean(np.abs(z) < 2.0) > 0.9


def test_neither_the_clock_nor_the_order_of_the_joints_matters() -> None:
    plant, motion = machine(quiet=False)
    log = log_of(plant, motion)
    plain = base_of(whole_arm(log, arm(), lowpass=LOWPASS))
    moved = whole_arm(of_joints(log, NAMES[::-1], log.t + 1000.0), arm(), lowpass=LOWPASS)
    assert [j.joint for j in moved.joints] == list(NAMES)
    assert base_of(moved) == pytest.approx(plain, rel=1e-4, abs=1e-4)


def two_joints(sign: int) -> Arm:
    """Two links that swing, their axes one way or the other."""
    model = mujoco.MjModel.from_xml_string(
        f"<mujoco><worldbody><body><joint name='shoulder' axis='0 {sign} 0' armature='.05'/>"
        "<inertial mass='2' pos='.1 0 -.3' diaginertia='.05 .05 .01'/>"
        f"<body pos='0 0 -.5'><joint name='elbow' axis='0 {sign} 0' armature='.02'/>"
        "<inertial mass='1' pos='0 0 -.2' diaginertia='.02 .02 .005'/></body></body></worldbody></mujoco>"
    )
    none = np.zeros(2)
    return Arm("two.xml", model, ("shoulder", "elbow"), np.array([0.05, 0.02]), none, none)


def swung(sign: int, seconds: float = 12.0, quick: float = 0.02) -> JointLog:
    """quick : rad, of a wave of 2 Hz on a slow one."""
    t = np.arange(round(seconds * 500)) / 500.0
    turns = 2 * np.pi * np.array([[0.31, 0.47], [1.7, 2.1]])
    size = np.array([[0.5, 0.6], [quick, quick]])
    angle = t[:, None, None] * turns
    q, v = np.sum(size * np.sin(angle), axis=1), np.sum(size * turns * np.cos(angle), axis=1)
    a = -np.sum(size * turns**2 * np.sin(angle), axis=1)
    torque = two_joints(1).inverse(q, v, a) + np.array([1.5, 0.7]) * np.sign(v) + np.array([0.8, 0.3]) * v + 0.2
    torque += 0.01 * np.random.default_rng(1).standard_normal(torque.shape)
    names = ("shoulder", "elbow")
    return JointLog(
        t,
        {n: sign * q[:, i] for i, n in enumerate(names)},
        effort={n: sign * torque[:, i] for i, n in enumerate(names)},
    )


def test_the_direction_in_which_angles_are_counted_turns_the_offset_alone() -> None:
    one, other = (whole_arm(swung(sign), two_joints(sign)) for sign in (1, -1))
    assert one.named == other.named
    assert base_of(other) == pytest.approx(base_of(one) * [1.0, 1.0, -1.0], abs=1e-9)
    assert base_of(one) == pytest.approx(np.array([[1.5, 0.8, 0.2], [0.7, 0.3, 0.2]]), abs=0.01)


@pytest.mark.parametrize(
    ("law", "name", "numbers"),
    [
        (lambda v: 0.5 / (1.0 + (v / 0.6) ** 2), "stribeck", {"f_s - f_c": 0.5, "v_s": 0.6}),
        (lambda v: 0.5 * np.exp(-np.abs(v) / 0.5), "stribeck", {"f_s - f_c": 0.5, "v_s": 0.5}),
        (lambda v: 0.5 * np.abs(v) ** 0.5, "power-law-damping", {"c_p": 0.5, "exponent": 0.5}),
        (lambda v: 0.5 * np.abs(v) ** 0.5 - 0.3 * np.abs(v), "power-law-damping", {"c_p": 0.5, "exponent": 0.5}),
    ],
    ids=("Lorentzian", "exponential", "power of the speed", "the same without viscous friction"),
)
def test_a_law_in_another_form_takes_one_name_with_its_numbers(
    law: Callable[[Any], Any], name: str, numbers: dict[str, float]
) -> None:
    """Of the elbow alone, beside Coulomb .7 and viscous friction .3; neither a second name nor one of the shoulder."""
    log = swung(1, 30.0, quick=0.0)
    v = np.gradient(log.position["elbow"], log.t)
    effort = {**log.effort, "elbow": log.effort["elbow"] + law(v) * np.sign(v)}
    found = whole_arm(replace(log, effort=effort), two_joints(1))
    assert found.named == ((name, "elbow"),)
    said = dict(found.joint("elbow").effects[0].parameters)
    for number, true in numbers.items():
        value, error = said[number].value, said[number].stderr
        assert value is not None
        assert error is not None
        assert abs(value - true) < 3.0 * error
        assert error < 0.2 * true


def test_uneven_stamps_are_put_on_even_ones_and_that_is_said() -> None:
    log = swung(1)
    t = log.t + np.random.default_rng(2).uniform(-2e-4, 2e-4, log.t.size)
    at = {name: np.interp(t, log.t, log.position[name]) for name in log.joints}
    effort = {name: np.interp(t, log.t, log.effort[name]) for name in log.joints}
    found = whole_arm(JointLog(t, at, effort=effort), two_joints(1))
    assert any("Uneven" in note for note in found.notes)
    assert base_of(found) == pytest.approx(np.array([[1.5, 0.8, 0.2], [0.7, 0.3, 0.2]]), abs=0.02)


def test_a_joint_that_rests_is_refused_with_the_reason_and_the_other_one_is_not() -> None:
    log = swung(1)
    rests = JointLog(log.t, {**log.position, "elbow": np.zeros(log.t.size)}, effort=log.effort)
    found = whole_arm(rests, two_joints(1))
    assert found.joint("elbow").coulomb.value is None
    assert "does not move" in found.joint("elbow").statement
    assert found.joint("shoulder").coulomb.value is not None
    with pytest.raises(KeyError):
        found.joint("wrist")


def test_a_joint_that_was_not_logged_is_taken_to_rest() -> None:
    log = swung(1)
    found = whole_arm(of_joints(log, ("shoulder",)), two_joints(1))
    assert any("elbow was not logged" in note for note in found.notes)


@pytest.mark.parametrize(
    ("change", "asked", "words"),
    [
        (lambda log: JointLog(log.t, log.position), {}, "no joint's effort"),
        (lambda log: of_joints(log, ("shoulder", "elbow")), {"joints": ("wrist",)}, "joint wrist"),
        (lambda log: log, {"joints": ()}, "no joint asked for"),
        (lambda log: JointLog(log.t, log.position, effort={"shoulder": log.effort["shoulder"]}),
         {"joints": ("elbow",)}, "joint elbow without position or effort"),
        (lambda log: JointLog(log.t, {**log.position, "tool": log.t}, effort={"tool": log.t}), {}, "joint tool"),
        (lambda log: JointLog(log.t[:900], {n: y[:900] for n, y in log.position.items()},
                              effort={n: y[:900] for n, y in log.effort.items()}), {}, "1.8 s"),
        (lambda log: JointLog(log.t, {n: 0.0 * y for n, y in log.position.items()}, effort=log.effort), {},
         "no joint that moves to and fro"),
        (lambda log: log, {"lowpass": 300.0}, "300 Hz"),
        (lambda log: log, {"payload": -1.0}, "-1"),
        (lambda log: log, {"sensor": "outside"}, "'outside'"),
    ],
)  # fmt: skip
def test_bad_input_is_refused_by_name(change: Any, asked: dict[str, Any], words: str) -> None:
    with pytest.raises(InputError) as refused:
        whole_arm(change(swung(1)), two_joints(1), **asked)
    assert words in str(refused.value)


F_K, C = np.array([1.5, 0.5]), np.array([1.0, 0.3])
ARM = """
<mujoco><option gravity="0 0 -9.81" timestep=".002"/><worldbody>
  <body><joint name="shoulder" axis="0 1 0" armature=".05"/>
    <geom type="capsule" fromto="0 0 0 .4 0 0" size=".04" mass="2" contype="0"/>
    <body pos=".4 0 0"><joint name="elbow" axis="0 1 0" armature=".05"/>
      <geom type="capsule" fromto="0 0 0 .3 0 0" size=".03" mass="1" contype="0"/></body>
  </body>
</worldbody></mujoco>
"""


def _logged(late: int) -> JointLog:
    """20 s at 500 Hz; late : samples by which the torque's record is."""
    model = mujoco.MjModel.from_xml_string(ARM)
    model.dof_frictionloss[:], model.dof_damping[:] = F_K, C
    data, bare = mujoco.MjData(model), mujoco.MjModel.from_xml_string(ARM)
    ahead = mujoco.MjData(bare)
    count, omega = 2.0 * np.pi / 2**18, 20.0
    t = np.arange(10001) * model.opt.timestep
    waves = 2.0 * np.pi * np.array([[0.23, 0.71], [0.31, 0.83]])
    sizes, turns = np.array([[0.7, 0.2], [0.9, 0.25]]), np.array([[0.0, 1.0], [0.5, 2.0]])
    angle = waves * t[:, None, None] + turns
    q, v, a = (np.sum(sizes * f, axis=2) for f in (np.sin(angle), waves * np.cos(angle), -(waves**2) * np.sin(angle)))
    data.qpos[:], data.qvel[:] = q[0], v[0]
    seen, torque, inertia = np.zeros_like(q), np.zeros_like(q), np.zeros((2, 2))
    following, last = np.zeros(2), q[0]
    for k in range(t.size):
        seen[k] = np.round(data.qpos / count) * count
        torque[k] = following
        ahead.qpos[:], ahead.qvel[:], ahead.qacc[:] = q[k], v[k], a[k]
        mujoco.mj_inverse(bare, ahead)
        mujoco.mj_fullM(bare, ahead, inertia)
        speed, last = (seen[k] - last) / model.opt.timestep, seen[k]
        error = omega**2 * (q[k] - seen[k]) + 1.4 * omega * (v[k] - speed)
        data.qfrc_applied[:] = torque[k]
        mujoco.mj_step(model, data)
        following = ahead.qfrc_inverse + inertia @ error
    # the first second is the way onto the motion
    recorded = np.roll(torque, late, axis=0)[500:]
    names = ("shoulder", "elbow")
    position, effort = ({name: y[:, i].copy() for i, name in enumerate(names)} for y in (seen[500:], recorded))
    return JointLog(t[500:], position, effort=effort)


def test_a_clean_arm_in_closed_loop_is_quiet(tmp_path: Path) -> None:
    """The bus hands on a torque that is one sample old."""
    (tmp_path / "arm.xml").write_text(ARM)
    found = whole_arm(_logged(1), load_arm(tmp_path / "arm.xml"))
    assert not found.named
    for joint, f_k, c in zip(found.joints, F_K, C, strict=True):
        assert joint.coulomb.value == pytest.approx(f_k, rel=0.01)
        assert joint.viscous.value == pytest.approx(c, rel=0.05)


@pytest.mark.parametrize(("seed", "number"), [(3, 1), (1, 16)])
def test_friction_that_an_engine_regularises_is_no_power_of_the_speed(seed: int, number: int) -> None:
    """A power whose exponent may be none at all is Coulomb friction, which would be lost to it."""
    one = clean(seed, number, "mujoco")
    found = whole_arm(one.log, one.arm)
    assert found.named == ()
    for joint, coulomb in zip(found.joints, one.plant.coulomb, strict=True):
        assert joint.coulomb.value == pytest.approx(coulomb, rel=0.02)


@pytest.mark.parametrize("kg", [0.02, 0.06])
def test_an_error_that_is_smaller_than_models_are_exact_is_named_only_where_it_is_most(kg: float) -> None:
    """A load alone, and beside a joint whose friction falls with speed by far more."""
    plant, motion = machine()
    loaded = replace(plant, arm=with_load(arm(), kg))
    assert whole_arm(log_of(loaded, motion), arm(), lowpass=LOWPASS).named == ((PAYLOAD, None),)
    falls = with_effect(loaded, 0, lambda t, q, v, g: plant.coulomb[0] * np.sign(v) * np.exp(-((v / 0.3) ** 2)))
    found = whole_arm(log_of(falls, motion), arm(), lowpass=LOWPASS)
    assert ((PAYLOAD, None) in found.named) == (kg > 0.03)
    assert (STRIBECK, "joint1") in found.named
    (said,) = [one for one in (*found.notes, *(error.statement for error in found.model)) if "more at the end" in one]
    assert f"There is {kg:g}" in said
    assert found.joints[0].coulomb.value == pytest.approx(plant.coulomb[0], rel=0.02)


@pytest.fixture
def folder(recordings: Path) -> Path:
    found = recordings / "machines" / "dfki-double-pendulum"
    if not found.is_dir():
        pytest.skip("no log of the double pendulum here")
    return found


@pytest.mark.full
def test_a_double_pendulum_has_the_friction_its_makers_found_and_a_lag(folder: Path) -> None:
    model = mujoco.MjModel.from_xml_path(str(folder / "double_pendulum.urdf"))
    shipped, damping = model.dof_frictionloss.copy(), model.dof_damping.copy()
    model.dof_frictionloss[:] = model.dof_damping[:] = 0.0
    arm = Arm("double_pendulum.urdf", model, ("Joint1", "Joint2"), model.dof_armature.copy(), shipped, damping)
    rows = np.loadtxt(folder / "dfki_double_20220812-061157.csv", delimiter=",", skiprows=1)
    log = JointLog(
        rows[:, 0], {"Joint1": rows[:, 1], "Joint2": rows[:, 2]}, effort={"Joint1": rows[:, 5], "Joint2": rows[:, 6]}
    )
    found = whole_arm(log, arm, lowpass=15.0)
    for joint in found.joints:
        assert joint.coulomb.value == pytest.approx(0.135, abs=0.06)
        assert joint.held_out is not None
        assert joint.held_out[1] < 1.05 * joint.held_out[0]
    errors = {error.name: error for error in found.model}
    assert not {PAYLOAD, TILT} & errors.keys()
    assert abs(dict(errors["torque-delay"].parameters)["delay"].value or 0.0) < 0.02


def test_a_motion_that_excites_everything_tells_everything() -> None:
    plant, motion = machine(quiet=False)
    found = whole_arm(log_of(plant, motion), arm(), lowpass=LOWPASS).identifiable
    assert {(one.joint, one.parameter) for one in found} == {
        (f"joint{i}", name) for i in range(1, 8) for name in ("Coulomb friction", "viscous friction", "offset")
    }
    assert all(one.verdict == "identifiable" and not one.why for one in found)


def test_a_short_way_cannot_part_an_offset_from_what_gravity_may_be_and_a_still_joint_nothing() -> None:
    plant, motion = machine(quiet=False)
    small = motion.amplitude.copy()
    small[3] *= 0.02
    small[[0, 1, 2, 4, 5, 6]] = 0.0
    found = whole_arm(log_of(plant, replace(motion, amplitude=small)), arm(), lowpass=LOWPASS).identifiable
    told = {(one.joint, one.parameter): one for one in found}
    offset = told["joint4", "offset"]
    assert offset.verdict in ("weak", "not")
    assert offset.why
    assert "larger angle" in offset.mend
    still = [one for one in found if one.joint == "joint2"]
    assert {one.verdict for one in still} == {"not"}
    errors = [one.error for one in found if one.joint == "joint4" and one.error is not None]
    assert len(errors) == 3
    assert np.all(np.isfinite(errors))
