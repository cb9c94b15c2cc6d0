"""Temperatures of joints are read beside motion and torque, said, and looked at."""

from pathlib import Path

import joint_logs
import numpy as np
import pytest
from joint_logs import ONE

import harness
from harness.core.errors import InputError


def test_temperatures_are_carried_and_said(tmp_path: Path) -> None:
    warmth = 25.0 + ONE.t
    seldom = np.where(np.arange(ONE.t.size) % 10 == 0, warmth, np.nan)
    columns = {"t": ONE.t, **ONE.columns(), "shoulder_temp [degC]": warmth, "elbow_temp [degC]": seldom}
    path = joint_logs.csv(tmp_path / "log.csv", columns)
    found = harness.load_log(path)
    assert found.temperature["shoulder"] == pytest.approx(warmth)
    assert found.temperature["elbow"][:391] == pytest.approx(warmth[:391])
    (topic,) = harness.log(path).topics
    assert topic.units_guessed["temperature"] == "degC"
    assert topic.ranges["elbow"]["temperature"] == pytest.approx((25.0, 28.9))


def test_a_temperature_in_a_unit_of_something_else_is_refused(tmp_path: Path) -> None:
    path = joint_logs.csv(tmp_path / "log.csv", {"t": ONE.t, **ONE.columns(), "elbow.temperature [V]": ONE.t})
    with pytest.raises(InputError, match="degC or K"):
        harness.load_log(path)
