"""What another form of a named law would shift the other numbers by, and readings of an encoder that slows down."""

import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import harness
from harness.core.arrays import FloatArray
from harness.core.recording import Recording

C, F_K, F_S, V_S = 0.4, 1.5, 2.3, 0.6


def run_down(fall: float, rate: float) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Times (n,), way and speed of 1 kg let go at 5 m/s, whose friction falls as exp(-(v/V_S)^fall); 0 for none."""

    def law(t: float, state: FloatArray) -> list[float]:
        v = max(state[1], 0.0)
        more = (F_S - F_K) * math.exp(-((v / V_S) ** fall)) if fall else 0.0
        return [v, -F_K - more - C * v if v > 0.0 else 0.0]

    def stops(t: float, state: FloatArray) -> float:
        return float(state[1])

    stops.terminal = True  # type: ignore[attr-defined]
    found = solve_ivp(law, (0.0, 20.0), (0.0, 5.0), rtol=1e-10, atol=1e-12, dense_output=True, events=stops)
    t = np.arange(0.0, found.t[-1], 1.0 / rate)
    x, v = found.sol(t)
    return t, x, v


@pytest.mark.parametrize(("fall", "noise"), [(1.0, 2e-2), (0.5, 2e-2), (0.5, 2e-3)])
def test_the_form_of_a_law_is_in_the_errors_of_the_other_numbers(fall: float, noise: float) -> None:
    t, _, v = run_down(fall, 400.0)
    v = v + noise * np.random.default_rng(3).standard_normal(t.size)
    found = harness.diagnose(Recording(t, {"v": v}), mass=1.0, engines=())
    assert [m.name for m in found.mechanisms] == ["stribeck"]
    for name, truth in (("f_k", F_K), ("c", C)):
        number = found.refined.parameters[name]
        assert number.value is not None
        assert number.stderr is not None
        error = math.hypot(number.stderr, number.systematic or 0.0)
        assert abs(number.value - truth) <= 2.0 * error
        # of some use all the same
        assert error < 0.3 * truth


def test_a_run_down_that_an_encoder_reads_to_its_end_is_clean() -> None:
    t, x, _ = run_down(0.0, 2000.0)
    step = 0.02
    found = harness.diagnose(Recording(t, {"x": step * np.round(x / step)}), mass=1.0, engines=())
    assert found.verdict == "adequate"
    for name, truth in (("f_k", F_K), ("c", C)):
        number = found.refined.parameters[name]
        assert number.value is not None
        assert number.stderr is not None
        assert abs(number.value - truth) <= 3.0 * number.stderr
