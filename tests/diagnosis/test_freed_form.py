"""One effect in another form than its name's stays one name: its form is freed before a second name is looked for."""

import math

import numpy as np
import pytest

import harness

T = np.arange(0.0, 6.0, 0.02)
WIDTH = 0.1


def decay() -> harness.Recording:
    """x of a slider of 1 kg let go at 1 m, by Runge-Kutta at a fixed step; its friction has no jump."""
    fine, y = 20, np.array([1.0, 0.0])
    h = float(T[1]) / fine

    def rate(y: np.ndarray) -> np.ndarray:
        return np.array([y[1], -100.0 * y[0] - y[1] - 3.0 * y[1] / math.hypot(y[1], WIDTH)])

    x = [1.0]
    for _ in T[1:]:
        for _ in range(fine):
            a = rate(y)
            b = rate(y + 0.5 * h * a)
            d = rate(y + 0.5 * h * b)
            y = y + h / 6.0 * (a + 2.0 * b + 2.0 * d + rate(y + h * d))
        x.append(float(y[0]))
    noise = np.random.default_rng(3).normal(0.0, 2e-5, T.size)
    return harness.Recording(t=T, channels={"x": np.array(x) + noise}, file="form.csv")


def test_friction_smoothed_otherwise_is_regularised_friction_with_its_width() -> None:
    result = harness.diagnose(decay(), restoring="spring", zero="spring", engines=())
    assert [m.name for m in result.mechanisms] == ["regularised-friction"]
    assert result.refined.chi2_per_point == pytest.approx(1.0, abs=0.25)
    found = result.mechanisms[0].parameters["v_r"]
    assert found.value == pytest.approx(WIDTH, rel=0.02)
    assert result.refined.parameters["x_k"].value == pytest.approx(0.03, rel=0.01)
    assert result.mechanisms[0].probability == pytest.approx(1.0, abs=0.01)
