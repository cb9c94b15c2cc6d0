"""A friction curve: what was put in lies within its band, whatever its law; directions, loads and a line to paste."""

from collections.abc import Callable
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from two_joint_arm import ARM, moved

from harness.core.arrays import FloatArray
from harness.core.robot import JointLog
from harness.robot.arm import load_arm
from harness.robot.friction_curve import FrictionCurve, of_series
from harness.robot.whole_arm.whole import whole_arm

FORCE = ("N m", "N m s/rad")
NAMES = ("shoulder", "elbow")
Friction = Callable[[FloatArray], FloatArray]
SHAPES: dict[str, Friction] = {
    "Coulomb and viscous": lambda v: np.sign(v) * 0.4 + 0.2 * v,
    "Stribeck, Lorentzian": lambda v: np.sign(v) * (0.4 + 0.25 / (1.0 + (v / 0.4) ** 2)) + 0.1 * v,
    "saturating with speed": lambda v: np.sign(v) * (0.3 + 0.4 * np.tanh(np.abs(v) / 0.5)),
    "quadratic drag": lambda v: np.sign(v) * 0.4 + 0.1 * v + 0.1 * v * np.abs(v),
}


@cache
def motion() -> tuple[FloatArray, ...]:
    """t, q, v and torque without friction of 24 s at 250 Hz."""
    return moved(6000, 250.0, (0.0, 0.0), (0.0, 0.0))


def told(
    shape: Friction, folder: Path, more: FloatArray | float = 0.0, warmth: FloatArray | None = None
) -> FrictionCurve:
    """The elbow's curve of a log with this friction and torque noise of 1 %; more (n,) : torque, warmth : degC."""
    t, q, v, torque = motion()
    rng = np.random.default_rng(2)
    torque = torque + np.column_stack((0.8 * np.sign(v[:, 0]), shape(v[:, 1]) + more))
    torque += 0.01 * np.std(torque, axis=0) * rng.standard_normal(torque.shape)
    position, effort = ({name: y[:, i] for i, name in enumerate(NAMES)} for y in (q, torque))
    file = folder / "arm.xml"
    file.write_text(ARM)
    log = JointLog(t, position, effort=effort, temperature={} if warmth is None else {"elbow": warmth})
    found = whole_arm(log, load_arm(file)).joint("elbow").curve
    assert found is not None
    return found


@pytest.mark.parametrize("name", ["Stribeck, Lorentzian", "saturating with speed"])
def test_the_curve_is_what_was_put_in_and_its_law_is_said(name: str, tmp_path: Path) -> None:
    found = told(SHAPES[name], tmp_path)
    true = SHAPES[name](found.v)
    assert found.friction == pytest.approx(true, rel=0.03)
    inside = (found.low < true) & (true < found.high)
    assert np.mean(inside) > 0.7
    assert {one.name: one.probability for one in found.laws}[name] > 0.1
    assert found.apart > 1e-3
    f_k, c = (q.value or 0.0 for q in found.line)
    slides = motion()[2][:, 1]
    slides = slides[np.abs(slides) > found.v[found.v > 0.0][0]]
    left = SHAPES[name](slides) - f_k * np.sign(slides) - c * slides
    columns = np.column_stack((np.sign(slides), slides))
    best = SHAPES[name](slides) - columns @ np.linalg.lstsq(columns, SHAPES[name](slides), rcond=None)[0]
    assert np.std(left) < 1.1 * np.std(best) + 0.005


def test_friction_that_differs_between_the_directions_is_said(tmp_path: Path) -> None:
    found = told(lambda v: np.sign(v) * 0.4 + np.where(v > 0.0, 0.3, 0.1) * v, tmp_path)
    assert found.apart < 1e-6


def test_what_friction_changes_with_has_its_size(tmp_path: Path) -> None:
    t, _, v, _ = motion()
    plain = {one.what: one for one in told(SHAPES["Coulomb and viscous"], tmp_path).changes}
    assert not any(one.surely for one in plain.values())
    assert plain["temperature"].why
    rising = 0.1 * np.sign(v[:, 1]) * (t - t.mean()) / t[-1]
    found = {one.what: one for one in told(SHAPES["Coulomb and viscous"], tmp_path, rising).changes}
    by = found["time"].by
    assert by is not None
    assert by.value == pytest.approx(0.1 / t[-1], rel=0.1)
    assert found["time"].surely
    assert not found["position"].surely


def test_friction_changes_with_the_temperature_that_is_logged(tmp_path: Path) -> None:
    t, _, v, _ = motion()
    warmth = 25.0 + 8.0 * np.minimum(t / 8.0, 1.0) - 5.0 * np.clip((t - 12.0) / 8.0, 0.0, 1.0)
    falling = -0.01 * np.sign(v[:, 1]) * (warmth - warmth.mean())
    changes = told(SHAPES["Coulomb and viscous"], tmp_path, falling, warmth).changes
    found = {one.what: one for one in changes}
    by = found["temperature"].by
    assert by is not None
    assert by.unit == "N m/K"
    assert by.value == pytest.approx(-0.01, rel=0.1)
    assert found["temperature"].surely
    assert not found["time"].surely
    hardly = told(SHAPES["Coulomb and viscous"], tmp_path, 0.0, 25.0 + 0.1 * np.sin(t))
    assert {one.what: one.why for one in hardly.changes}["temperature"]


@pytest.mark.parametrize("name", SHAPES)
def test_bands_of_a_series_cover(name: str) -> None:
    """Of 20 series with noise that remembers, 95 % bands hold the truth at most knots."""
    t = np.arange(4000) / 200.0
    v = np.sin(1.7 * t) + 0.6 * np.sin(4.1 * t)
    inside = []
    for seed in range(20):
        noise = np.convolve(np.random.default_rng(seed).standard_normal(t.size + 19), np.full(20, 0.05), "valid")
        found = of_series(v, SHAPES[name](v) + 0.05 * noise, FORCE)
        assert found is not None
        speeds, shape = found.v, SHAPES[name]
        inside.append((found.low < shape(speeds)) & (shape(speeds) < found.high))
    assert np.mean(inside) > 0.85


def test_speeds_that_are_too_few_make_no_curve() -> None:
    assert of_series(np.full(500, 0.3), np.ones(500), FORCE) is None
    assert of_series(np.repeat((0.3, -0.3), 250), np.ones(500), FORCE) is None
