"""The derivatives against central differences of the 50-digit evaluation, and the saltation at reversals."""

import math

import mpmath as mp
import numpy as np
import pytest
from exact_mp import DIGITS, HighPrecisionDecay

from benchmarks.exact_sensitivity import PARAMETERS, fill_sensitivities
from harness.core.arrays import FloatArray
from harness.exact.decay import Decay, fill_at, schedule

ORDER = ("omega_n", "zeta", "x_k", "x_0", "v_0", "t_0")


def sensitivities(decay: Decay, t: FloatArray) -> tuple[FloatArray, FloatArray]:
    """States (3, n) and derivatives (3, n, 6)."""
    state, rates = np.empty((3, t.size)), np.empty((3, t.size, 6))
    fill_sensitivities(decay, t, *state, *rates)
    return state, rates


def differences(decay: Decay, t: float, parameter: str) -> FloatArray:
    """Central differences of x, v, a with a step of 1e-15 in 50 digits."""
    with mp.workdps(DIGITS):
        omega_n, zeta, x_k, x_s, x0, v0 = (mp.mpf(p) for p in decay.arguments)
        step = mp.mpf(10) ** -15
        sides = []
        for sign in (1, -1):
            d = dict.fromkeys(ORDER, mp.mpf(0))
            # from rest the derivative to v_0 is one-sided, along the motion: reflect the other side
            d[parameter] = sign * step
            truth = HighPrecisionDecay(
                omega_n + d["omega_n"], zeta + d["zeta"], x_k + d["x_k"], x_s, x0 + d["x_0"], v0 + d["v_0"], pieces=60
            )
            sides.append(truth(mp.mpf(t) - d["t_0"]))
        return np.array([float((p - m) / (2 * step)) for p, m in zip(*sides, strict=True)])


KINDS = {
    "undamped": Decay(7.0, 0.0, 0.04, 1.0, 3.0, 0.06),
    "paper": Decay(10.0, 0.05, 0.03, 1.0, 0.7),
    "backward": Decay(10.0, 0.05, 0.03, -1.0, 9.0),
    "damped": Decay(3.0, 0.6, 0.01, 0.5, -4.0),
    "just below critical": Decay(3.0, 1 - 1e-7, 0.01, 0.5, -4.0),
    "just above critical": Decay(3.0, 1 + 1e-7, 0.01, 0.5, -4.0),
    "critical": Decay(3.0, 1.0, 0.01, 0.5, 4.0),
    "overdamped": Decay(3.0, 4.0, 0.01, 0.5, 4.0),
    "overdamped overshoot": Decay(3.0, 2.0, 0.01, 0.2, -20.0),
    "frictionless": Decay(5.0, 0.02, 0.0, 0.3, 1.0),
}


@pytest.mark.parametrize("kind", KINDS)
def test_derivatives_equal_central_differences(kind: str) -> None:
    decay = KINDS[kind]
    assert PARAMETERS == ORDER
    truth = HighPrecisionDecay(*decay.arguments, pieces=60)
    begins = np.array([float(p.begin) for p in truth.pieces])
    rng = np.random.default_rng(11)
    # one time in every half-cycle, and in the final rest
    ends = np.append(begins[1:], begins[-1] + 2.0 / decay.omega_n)[:12]
    t = np.array([b + (e - b) * rng.uniform(0.05, 0.95) for b, e in zip(begins[: ends.size], ends, strict=True)])
    _, rates = sensitivities(decay, t)
    units = np.array([1.0, decay.omega_n, decay.omega_n**2])
    for column, parameter in enumerate(PARAMETERS):
        for j, time in enumerate(t):
            expected = differences(decay, float(time), parameter) / units
            size = max(1.0, float(np.max(np.abs(expected))))
            np.testing.assert_allclose(rates[:, j, column] / units, expected, rtol=0, atol=2e-12 * size)


def test_states_are_those_of_the_plain_evaluation() -> None:
    for decay in KINDS.values():
        t = np.linspace(-0.1, 5, 700)
        plain = np.empty((3, t.size))
        fill_at(decay, t, *plain)
        state, _ = sensitivities(decay, t)
        np.testing.assert_allclose(state, plain, rtol=0, atol=1e-12 * decay.omega_n**2)


def test_saltation_at_a_reversal() -> None:
    """x and v are continuous there, so their derivatives jump by (rate before - rate after) dt_i/dp: 0 for x."""
    decay = KINDS["paper"]
    events = schedule(decay).events
    around = np.array([events.t[1] - 1e-12, events.t[1] + 1e-12])
    _, rates = sensitivities(decay, around)
    dx, dv = rates[0], rates[1]
    np.testing.assert_allclose(dx[1], dx[0], atol=1e-6)
    shift = (dv[1] - dv[0]) / (events.a_before[1] - events.a_after[1])  # the derivative of the event time
    half = math.pi / (decay.omega_n * math.sqrt(1 - decay.zeta**2))
    first = differences_of_first_event(decay)
    np.testing.assert_allclose(shift[0], first[0] - half / decay.omega_n, rtol=1e-6)
    np.testing.assert_allclose(shift[3], first[1], rtol=1e-6)
    assert shift[5] == pytest.approx(1.0, rel=1e-6)  # a later start moves every event by as much


def differences_of_first_event(decay: Decay) -> FloatArray:
    """Central differences of the first reversal's time to omega_n and x_0."""
    with mp.workdps(DIGITS):
        step = mp.mpf(10) ** -15
        result = []
        for index in (0, 4):
            ends = []
            for sign in (1, -1):
                p = [mp.mpf(number) for number in decay.arguments]
                p[index] += sign * step
                ends.append(HighPrecisionDecay(p[0], p[1], p[2], p[3], p[4], p[5], pieces=2).pieces[0].end)
            result.append(float((ends[0] - ends[1]) / (2 * step)))
        return np.array(result)


def test_from_rest_the_release_speed_counts_along_the_motion() -> None:
    rest, moving = Decay(10.0, 0.05, 0.03, 1.0), Decay(10.0, 0.05, 0.03, 1.0, -1e-7)
    t = np.array([0.1, 0.5, 1.1, 2.0, 3.0])
    slow, fast = np.empty((3, t.size)), np.empty((3, t.size))
    fill_at(rest, t, *slow)
    fill_at(moving, t, *fast)
    _, rates = sensitivities(rest, t)
    np.testing.assert_allclose((fast - slow) / -1e-7, rates[:, :, 4], rtol=0, atol=3e-4)


def test_stuck_from_the_start_moves_with_its_position_alone() -> None:
    _, rates = sensitivities(Decay(10.0, 0.05, 0.03, 0.02), np.array([-1.0, 0.0, 2.0]))
    expected = np.zeros((3, 3, 6))
    expected[0, :, 3] = 1.0
    np.testing.assert_array_equal(rates, expected)
