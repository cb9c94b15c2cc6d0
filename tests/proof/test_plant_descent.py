"""Least squares with partials taken seldom: the same minimum as SciPy's, in a fraction of the calls."""

import math

import numpy as np
import pytest
from scipy.optimize import least_squares

from harness.core.arrays import FloatArray
from harness.proof.plant.base_fit import descend

T = np.linspace(0.0, 4.0, 300)
TRUE = np.array([1.0, 0.4, 5.0, 0.3])
SEEN = TRUE[0] * np.exp(-TRUE[1] * T) * np.cos(TRUE[2] * T + TRUE[3]) + 0.01 * np.random.default_rng(1).normal(size=300)


class Counted:
    """Residual of a damped cosine in units of its noise; counts what it is asked."""

    def __init__(self) -> None:
        self.calls = 0

    def __call__(self, z: FloatArray) -> FloatArray:
        self.calls += 1
        said = z[0] * np.exp(-z[1] * T) * np.cos(z[2] * T + z[3])
        return np.asarray((SEEN - said) / 0.01)


@pytest.mark.parametrize("start", [(1.3, 0.2, 4.8, 0.1), (0.7, 0.6, 5.2, 0.6), (1.0, 0.4, 5.0, 0.3)])
def test_the_minimum_is_that_of_scipy_and_costs_less(start: tuple[float, ...]) -> None:
    ours, theirs = Counted(), Counted()
    found = descend(ours, np.array(start), 1e-4, 30)
    known = least_squares(theirs, np.array(start), method="lm")
    assert found.chi2 == pytest.approx(2.0 * known.cost, abs=0.5)
    assert found.z == pytest.approx(known.x, rel=2e-2)
    assert ours.calls < 0.7 * theirs.calls


def test_it_stops_where_there_is_no_point_in_going_on() -> None:
    start = np.array([1.3, 0.2, 4.8, 0.1])
    whole, short = Counted(), Counted()
    best = descend(whole, start, 1e-4, 30)
    bound = 10.0 * best.chi2
    found = descend(short, start, 1e-4, 30, bounds=(bound, math.inf))
    assert best.chi2 < found.chi2 < bound
    assert short.calls < whole.calls


def test_what_lies_beyond_doubt_is_left_with_less_care() -> None:
    start = np.array([1.3, 0.2, 4.8, 0.1])
    careless = Counted()
    found = descend(careless, start, 1e-4, 30, bounds=(-math.inf, 1.0))
    assert found.chi2 < 1.5 * descend(Counted(), start, 1e-4, 30).chi2
