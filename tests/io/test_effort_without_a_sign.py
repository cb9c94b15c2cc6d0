"""An effort that never is negative: one that lost its sign is none, one that only touches nought is kept."""

from pathlib import Path

import numpy as np
import pytest
from joint_logs import csv

from harness.core.errors import InputError
from harness.io.logs.read import read_joint_log
from harness.io.options import ReadOptions
from harness.io.recording import read_recording


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
