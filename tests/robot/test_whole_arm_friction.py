"""Coulomb, viscous and offset of a whole arm: known answers, conventions that must not matter, claimed errors."""

from dataclasses import replace
from typing import Any

import mujoco
import numpy as np
import pytest
from whole_arm_logs import LOWPASS, NAMES, arm, log_of, machine, of_joints

from harness.core.errors import InputError
from harness.core.robot.joint_log import JointLog
from harness.robot.arm import Arm
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


def swung(sign: int, seconds: float = 12.0) -> JointLog:
    t = np.arange(round(seconds * 500)) / 500.0
    turns = 2 * np.pi * np.array([[0.31, 0.47], [1.7, 2.1]])
    size = np.array([[0.5, 0.6], [0.02, 0.02]])
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
