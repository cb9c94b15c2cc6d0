"""What a slider has felt of its force, told by its motion between reversals, whatever its friction is."""

from dataclasses import replace

import numpy as np
import pytest

from harness.core.arrays import FloatArray
from harness.diagnosis.prepare.felt import Felt, felt, unheard
from harness.diagnosis.prepare.intersample import held
from harness.diagnosis.smoothed_state.state import Course
from harness.estimate.noise import Noise
from harness.kernels.solve import Drive, solve
from harness.model.model import Model, ModelTerm, Restoring
from harness.model.terms.stribeck import TERM

T: FloatArray = np.arange(4000.0) * 0.002
PLAIN = Model(2.0, 3.0, 0.0, 2.5, restoring=Restoring.NONE, mass_known=True)
STRIBECK = replace(PLAIN, terms=(ModelTerm(TERM, (3.5, 0.05)),))
STIRRED, SENSOR = 0.3, 1e-7


def _told(model: Model, unfelt: float, *, is_held: bool = True) -> Felt:
    """Of a force that a loop stirs, N, with noise that nobody felt, N, as a sensor of x shows the motion."""
    random = np.random.default_rng(4)
    u = 14.0 * np.sin(2.1 * T) + 8.0 * np.sin(5.3 * T + 1.0) + STIRRED * random.standard_normal(T.size)
    x = solve(model, T, drive=Drive(T, u, is_held)).x + SENSOR * random.standard_normal(T.size)
    read, own = u + unfelt * random.standard_normal(T.size), Noise(SENSOR, True)
    course = Course.of(T, {"x": x}, {"x": own})
    base = replace(PLAIN, m=1.03 * PLAIN.m, f_k=2.8)
    found = felt(T, x, own, course, base, [held(T, read), Drive(T, read)])
    assert found is not None
    return found


@pytest.mark.parametrize("model", [PLAIN, STRIBECK], ids=["plain", "stribeck"])
@pytest.mark.parametrize("is_held", [True, False], ids=["held", "straight"])
def test_scatter_that_was_felt_is_no_noise_and_tells_how_the_force_acts(model: Model, is_held: bool) -> None:
    found = _told(model, 0.0, is_held=is_held)
    assert found.held is is_held
    assert found.level < 0.1 * STIRRED


@pytest.mark.parametrize("model", [PLAIN, STRIBECK], ids=["plain", "stribeck"])
@pytest.mark.parametrize("unfelt", [0.05, 0.15])
def test_noise_beside_felt_scatter_is_measured(model: Model, unfelt: float) -> None:
    assert _told(model, unfelt).level == pytest.approx(unfelt, rel=0.25)


def test_too_few_samples_between_reversals_tell_nothing() -> None:
    t: FloatArray = np.arange(400.0) * 0.002
    x = 0.01 * np.sin(2.0 * np.pi * t / 0.04)
    own = Noise(1e-6, True)
    course = Course.of(t, {"x": x}, {"x": own})
    assert felt(t, x, own, course, PLAIN, [held(t, x)]) is None


@pytest.mark.parametrize("sensor", [0.0, 0.02, 0.3])
def test_scatter_that_echoes_the_encoder_is_no_sensor_s(sensor: float) -> None:
    """A command of gain 4e4 N/m and 300 N s/m upon counts of 1e-5 m, read with a sensor's noise of its own, N."""
    random, dt = np.random.default_rng(7), T[1] - T[0]
    moved = 0.05 * np.sin(2.1 * T) + 0.03 * np.sin(5.3 * T + 1.0)
    seen = 1e-5 * np.round((moved + 2e-6 * random.standard_normal(T.size)) / 1e-5)
    off = 0.05 * np.sin(2.1 * T + 0.02) + 0.03 * np.sin(5.3 * T + 1.02) - seen
    u = 4e4 * off + 300.0 * np.gradient(off, dt) + sensor * random.standard_normal(T.size)
    found = unheard(T, u, seen, Course.of(T, {"x": seen}, {"x": Noise(4e-6, True)}))
    assert found is not None
    if sensor:
        assert found == pytest.approx(sensor, rel=0.25)
    else:
        assert found < 1e-3
