"""A force in few straight pieces: the nearest there is, and a fitted model leaves what it left."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from harness.core.arrays import FloatArray
from harness.diagnosis.fit.observe import COARSE, observe
from harness.diagnosis.fit.parameters import free_of
from harness.diagnosis.prepare.intersample_curve import curve
from harness.diagnosis.problems.driven import Driven
from harness.diagnosis.search.few_pieces import in_few_pieces, projected
from harness.estimate.noise import Noise
from harness.kernels.solve import Drive, Scales, solve
from harness.model.model import Model

SLIDER = Model(1.3, 0.9, 45.0, 0.6)
T: FloatArray = np.arange(2400.0) / 300.0
U: FloatArray = np.asarray(6.0 * np.sin(4.0 * T) + 3.0 * np.sin(9.3 * T + 0.4), dtype=np.float64)
SCALES = Scales(0.3, 2.0, 6.0)


def driven(u: FloatArray, noise: float = 1e-4) -> Driven:
    """A slider under a smooth force, as its fit begins."""
    drive = curve(T, u)
    x = solve(SLIDER, T, drive=drive).x + noise * np.random.default_rng(1).standard_normal(T.size)
    return Driven(T, {"x": x}, {"x": Noise(noise, True)}, drive=drive, first=SLIDER)


@settings(max_examples=30)
@given(st.integers(2, 60), st.floats(-5.0, 5.0), st.floats(-5.0, 5.0))
def test_a_straight_force_stays_what_it_is(count: int, level: float, slope: float) -> None:
    """However uneven its knots are, and where there are none."""
    t = np.unique(np.random.default_rng(count).uniform(0.0, 3.0, 200))
    t = t[(t < 1.0) | (t > 1.4)]
    found = projected(Drive(t, level + slope * t), count)
    assert found.t.size == count
    assert (found.t[0], found.t[-1]) == (t[0], t[-1])
    assert np.interp(t, found.t, found.u) == pytest.approx(level + slope * t, abs=1e-6)


def test_what_is_left_out_is_even() -> None:
    """The nearest force by its mean square leaves nothing along any piece, so that the momentum stays; the error of
    straight pieces falls with their square.
    """
    whole = curve(T, U)
    weight = np.gradient(whole.t)
    errors = []
    for count in (80, 160):
        few = projected(whole, count)
        left = whole.u - np.interp(whole.t, few.t, few.u)
        assert abs(weight @ left) < 1e-9 * float(weight @ np.abs(whole.u))
        errors.append(float(np.sqrt(weight @ left**2)))
    assert errors[0] / errors[1] == pytest.approx(4.0, rel=0.1)


def test_a_fitted_model_leaves_what_it_left_in_a_fifth_of_the_pieces() -> None:
    """Sample by sample but for the integrator's error, and its partials are the same but for a hundredth."""
    problem = driven(U)
    few = in_few_pieces(problem, SLIDER, SCALES)
    assert few.drive is not None
    assert problem.drive is not None
    assert 5 * few.drive.t.size < problem.drive.t.size
    by = tuple(f.by for f in free_of(SLIDER, ("m", "c", "k", "f_k")))
    here, there = (observe(SLIDER, one, by, SCALES, COARSE) for one in (problem, few))
    left, left_few = problem.channels["x"] - here.y["x"], few.channels["x"] - there.y["x"]
    assert left_few == pytest.approx(left, abs=COARSE.tolerance * SCALES.x)
    size = np.linalg.norm(here.dy["x"], axis=0)
    assert np.linalg.norm(there.dy["x"] - here.dy["x"], axis=0) / size == pytest.approx(0.0, abs=0.01)


def test_a_force_that_few_pieces_do_not_follow_stays_whole() -> None:
    """Nothing is gained of few samples, of none that move, and where the motion would be another."""
    problem = driven(U)
    coarse = replace(problem, drive=Drive(T[::20], U[::20]))
    assert in_few_pieces(coarse, SLIDER, SCALES) is coarse
    buzz = driven(np.asarray(U + 4000.0 * np.sin(700.0 * T), dtype=np.float64))
    assert in_few_pieces(buzz, SLIDER, Scales(0.3, 2.0, 0.5)) is buzz
    stiff = replace(SLIDER, k=1e14)
    assert in_few_pieces(problem, stiff, SCALES) is problem
