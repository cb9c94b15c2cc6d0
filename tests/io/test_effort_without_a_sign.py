"""An effort that never is negative: one that lost its sign is none, one that only touches nought is kept."""

from pathlib import Path

import numpy as np
import pytest
from joint_logs import csv

from harness.io.logs.read import read_joint_log


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
