"""One effect in another form than its name's stays one name: its form is freed before a second name is looked for."""

import math
from collections.abc import Callable

import numpy as np
import pytest

import harness

T = np.arange(0.0, 6.0, 0.02)
NOISE = 2e-5


def decay(friction: Callable[[float], float], spring: Callable[[float], float], c: float) -> harness.Recording:
    """x of a slider of 1 kg let go at 1 m, by Runge-Kutta at a fixed step; laws without a jump."""
    fine, y = 20, np.array([1.0, 0.0])
    h = float(T[1]) / fine

    def rate(y: np.ndarray) -> np.ndarray:
        return np.array([y[1], -spring(y[0]) - c * y[1] - friction(y[1])])

    x = [1.0]
    for _ in T[1:]:
        for _ in range(fine):
            a = rate(y)
            b = rate(y + 0.5 * h * a)
            d = rate(y + 0.5 * h * b)
            y = y + h / 6.0 * (a + 2.0 * b + 2.0 * d + rate(y + h * d))
        x.append(float(y[0]))
    noise = np.random.default_rng(3).normal(0.0, NOISE, T.size)
    return harness.Recording(t=T, channels={"x": np.array(x) + noise}, file="form.csv")


@pytest.mark.parametrize(
    ("friction", "width"),
    [
        (lambda v: 3.0 * math.tanh(10.0 * v), 0.1),
        (lambda v: 3.0 * v / math.hypot(v, 0.1), 0.1),
    ],
)
def test_friction_smoothed_otherwise_is_regularised_friction_with_its_width(
    friction: Callable[[float], float], width: float
) -> None:
    result = harness.diagnose(decay(friction, lambda x: 100.0 * x, 1.0), restoring="spring", zero="spring", engines=())
    assert [m.name for m in result.mechanisms] == ["regularised-friction"]
    assert result.refined.chi2_per_point == pytest.approx(1.0, abs=0.25)
    found = result.mechanisms[0].parameters["v_r"]
    assert found.value == pytest.approx(width, rel=0.02)
    assert result.refined.parameters["x_k"].value == pytest.approx(0.03, rel=0.01)
    assert result.mechanisms[0].probability == pytest.approx(1.0, abs=0.01)
