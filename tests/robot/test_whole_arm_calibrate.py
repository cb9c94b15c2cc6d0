"""What a likelihood could tell against closed forms, and the command that prints the figures."""

from dataclasses import replace

import numpy as np
import pytest
from whole_arm_logs import machine

from benchmarks.robot_calibrate.__main__ import main
from benchmarks.robot_calibrate.limit import Limit, Path
from harness.robot.whole_arm.rules import RULES


def limit(noise: float, memory: float = 0.0, counts: int = 0) -> Limit:
    plant, motion = machine()
    return Limit(Path.of(replace(plant, noise=noise, memory=memory, counts=counts), motion, 12.0, 500.0), 15.0, 3)


def test_bounds_go_with_the_noise_and_gains_with_its_inverse_square() -> None:
    one, two = limit(0.01), limit(0.02)
    assert two.bounds == pytest.approx(2.0 * one.bounds)
    torque = one.v * np.abs(one.v)
    assert one.gain(torque) == pytest.approx(4.0 * two.gain(torque))
    assert one.gain(3.0 * np.sign(one.v) - 2.0 * one.v + 1.0) == pytest.approx(0.0, abs=1e-6)


def test_bounds_of_white_noise_are_those_of_least_squares() -> None:
    plant, motion = machine()
    path = Path.of(replace(plant, noise=0.01, counts=0), motion, 12.0, 500.0)
    v = path.v[:, 3]
    columns = np.stack((np.sign(v), v, np.ones_like(v)), axis=1)
    plain = path.sigma[3] * np.sqrt(np.diag(np.linalg.inv(columns.T @ columns)))
    # a jump has some of its information beyond the filter
    assert Limit(path, 15.0, 3).bounds == pytest.approx(plain, rel=0.05)
    assert np.all(Limit(path, 15.0, 3).bounds >= 0.999 * plain)


def test_an_encoder_and_noise_that_remembers_tell_less() -> None:
    assert np.all(limit(0.01, counts=2**12).bounds > limit(0.01).bounds)
    assert np.all(limit(0.01, memory=0.01).bounds > limit(0.01).bounds)


def test_the_command_prints_the_figures_of_a_clean_arm(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["--draws", "1", "--only", "clean", "--seed", "5"]) == 0
    said = capsys.readouterr().out
    assert "Coulomb: within 1%" in said
    assert "clean arms in which nothing is named: 100.0% of 1" in said


def test_rules_have_names_of_their_own_and_say_where_they_come_from() -> None:
    assert len({rule.name for rule in RULES}) == len(RULES)
    assert all(rule.moves and rule.origin for rule in RULES)
