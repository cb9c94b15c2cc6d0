"""Break-away of a joint that sticks and slips under a slow servo is read from the torques before its slips."""

import math

import numpy as np
import pytest

from benchmarks.draws import robot_joints
from harness.core.robot.joint_log import JointLog
from harness.robot.recording import slips
from harness.robot.reduction import Reduced


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
