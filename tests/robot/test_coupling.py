"""Whether the others stand still is said from the torque that they put on a joint."""

import math
from dataclasses import replace

import numpy as np
import pytest

from harness.core.errors import InputError
from harness.core.robot.joint_log import JointLog
from harness.engines.models import folder
from harness.robot.arm import load_arm
from harness.robot.coupling import coupling
from harness.robot.example import FRICTION, excited

ARM = load_arm(folder() / "arm" / "arm.xml")


def test_one_moving_joint_is_locked_and_three_are_a_whole_arm() -> None:
    locked = coupling(ARM, excited(ARM, FRICTION, ("shoulder",), duration=10.0), "shoulder")
    assert (locked.mode, locked.moving, locked.torque) == ("locked", (), 0.0)
    assert locked.reduced.held == pytest.approx({"base": 0.0, "elbow": 0.0}, abs=1e-5)
    moving = coupling(ARM, excited(ARM, FRICTION, ARM.joints, duration=10.0), "shoulder")
    assert moving.mode == "whole-arm"
    assert set(moving.moving) == {"base", "elbow"}
    assert moving.torque > moving.residual * 0.5
    assert moving.share > 0.9


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
    (_log(shoulder=0.5), "elbow", "'elbow', whose position log.csv does not hold.*of the log is accepted: shoulder"),
    (_log(lift=0.5, wrist=0.1), "shoulder", "joints lift, wrist, and .* has base, shoulder, elbow"),
    (_log(shoulder=0.5), "sholder", "did you mean shoulder"),
    (_log(shoulder=math.degrees(0.8)), "shoulder", "this looks like degrees"),
]


@pytest.mark.parametrize(("log", "joint", "said"), BAD)
def test_logs_that_do_not_go_with_the_model_are_refused(log: JointLog, joint: str, said: str) -> None:
    with pytest.raises(InputError, match=said):
        coupling(ARM, log, joint)
