"""Laws that keep time with the motion, or with a drive that repeats itself, follow any other."""

import math

import numpy as np
import pytest

from harness.core.arrays import FloatArray
from harness.diagnosis.grading.clocks import in_step, on_the_swing, unresolved
from harness.diagnosis.inverse_dynamics.protocol import periods
from harness.model.model import ModelTerm

SWING, SPAN = 5.0, 60.0


@pytest.mark.parametrize(
    ("omega_2", "zeta_2", "follows"),
    [
        (5.05, 0.001, True),  # on the swing
        (7.0, 0.5, True),  # its band reaches it
        (40.0, 1.0, True),  # damped as strongly as it swings: a delay
        (0.05, 0.01, True),  # slower than the recording shows
        (7.0, 0.02, False),
        (40.0, 0.3, False),
    ],
)
def test_a_resonator_that_the_swing_reaches_follows_anything(omega_2: float, zeta_2: float, follows: bool) -> None:
    mode = ModelTerm.named("attached-mode", omega_2=omega_2, mass_ratio=0.001, zeta_2=zeta_2)
    assert on_the_swing(mode, SWING, SPAN) is follows
    assert unresolved((mode,), SWING, SPAN) is follows


@pytest.mark.parametrize(("times", "follows"), [(1.0, True), (7.0, True), (31.0, True), (7.5, False), (0.5, False)])
def test_a_push_to_and_fro_keeps_time_and_place_together(times: float, follows: bool) -> None:
    period = 6.0
    hum = ModelTerm.named("harmonic-force", A=1.0, Omega=times * 2.0 * math.pi / period, phase=0.0)
    assert in_step(hum, period, 10.0 * period) is follows


@pytest.mark.parametrize("cycles", [1.75, 2.5, 4.4, 7.0, 12.0, 80.0])
def test_a_ripple_of_few_cycles_is_looked_for(cycles: float) -> None:
    x: FloatArray = 0.3 * np.sin(np.arange(6000.0) / 300.0)
    force = 0.2 * np.cos(2.0 * math.pi * x * cycles / 0.6 + 0.4) + 0.05 * np.random.default_rng(2).standard_normal(
        x.size
    )
    assert min(abs(0.6 / period - cycles) for period in periods(x, force)) < 0.5
