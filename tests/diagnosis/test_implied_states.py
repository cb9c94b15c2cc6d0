"""Internal states that a recorded motion implies: closed forms against the equations in time, and their partials."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from harness.core.arrays import FloatArray
from harness.model.history import History
from harness.model.terms.attached_mode import ridden
from harness.model.terms.presliding import bent

SIGMA, F_K = 500.0, 2.0
TIMES: FloatArray = np.asarray(np.arange(30001) * 1e-4, dtype=np.float64)
AT: FloatArray = TIMES[[7000, 13000, 29000]]


def speed(t: float) -> float:
    return float(0.3 * np.cos(5.0 * t) + 0.1 * np.sin(11.0 * t))


def history(f_k: float = F_K) -> History:
    v = 0.3 * np.cos(5.0 * TIMES) + 0.1 * np.sin(11.0 * TIMES)
    return History(TIMES, v, AT, np.interp(AT, TIMES, v), f_k)


def test_bristles_bend_along_the_way_as_the_equation_in_time_says() -> None:
    """z' = v - sigma0 |v| z / f_k (Dahl 1968), fully bent at first."""
    exact = solve_ivp(
        lambda t, z: [speed(t) - SIGMA * abs(speed(t)) * z[0] / F_K],
        (0.0, 3.0), [F_K / SIGMA], t_eval=AT, rtol=1e-10, atol=1e-14,
    ).y[0]  # fmt: skip
    assert bent((SIGMA, 1.0), history()).values.ravel() == pytest.approx(exact, rel=1e-6)


def test_their_partials_are_differences() -> None:
    found = bent((SIGMA, 1.0), history()).by
    h = 1e-4
    by_sigma = (bent((SIGMA + h, 0.0), history()).values - bent((SIGMA - h, 0.0), history()).values) / (2.0 * h)
    by_level = (bent((SIGMA, 0.0), history(F_K + 1e-7)).values - bent((SIGMA, 0.0), history(F_K - 1e-7)).values) / 2e-7
    assert found[0] == pytest.approx(by_sigma, rel=1e-5)
    assert found["f_k"] == pytest.approx(by_level, rel=1e-5)


def test_what_never_moved_or_has_no_friction_is_not_bent() -> None:
    still = History(np.array([0.0, 1.0]), np.zeros(2), np.array([1.0]), np.zeros(1), F_K)
    assert bent((SIGMA, 0.0), still).values.item() == 0.0
    assert bent((SIGMA, 0.0), history(0.0)).values.ravel() == pytest.approx(np.zeros(3))


def test_a_mass_that_rides_along_is_shaken_as_its_equation_says() -> None:
    """r'' = -omega^2 r - 2 zeta omega r' - x'', at rest at first; the speed is relative to the slider's."""
    omega, zeta = 21.0, 0.03

    def acceleration(t: float) -> float:
        return float(-1.5 * np.sin(5.0 * t) + 1.1 * np.cos(11.0 * t))

    exact = solve_ivp(
        lambda t, z: [z[1], -(omega**2) * z[0] - 2.0 * zeta * omega * z[1] - acceleration(t)],
        (0.0, 3.0), [0.0, 0.0], t_eval=AT, rtol=1e-11, atol=1e-14,
    ).y.T  # fmt: skip
    found = ridden((omega, 0.1, zeta), history())
    assert found.values == pytest.approx(exact, abs=1e-6 * np.abs(exact).max())
    more = ridden((omega, 0.1, zeta + 1e-4), history()).values - ridden((omega, 0.1, zeta - 1e-4), history()).values
    assert found.by[2] == pytest.approx(more / 2e-4, rel=1e-3, abs=1e-6)


@pytest.mark.parametrize("zeta", [0.0, 1.0])
def test_a_riding_mass_without_and_with_critical_damping_stays_finite(zeta: float) -> None:
    assert np.all(np.isfinite(ridden((21.0, 0.1, zeta), history()).values))
