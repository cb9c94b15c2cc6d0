"""The one least-squares loop: certified answers to the digit, bounds, rank, what cannot be evaluated, named stops.

And integrated autocorrelation time against its closed form, and a series that is too short to tell.
"""

import math
from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.signal import lfilter

from harness.core.arrays import FloatArray
from harness.core.errors import SimulationError
from harness.estimate.noise import Noise
from harness.fit.least_squares import Bounds, Residual, Stop, Until, covariance_of, inverse_of, least_squares
from harness.fit.series import lagged, memory

Law = Callable[[FloatArray, FloatArray], FloatArray]

MISRA_X = np.array([77.6, 114.9, 141.1, 190.8, 239.9, 289.0, 332.8, 378.4, 434.8, 477.3, 536.8, 593.1, 689.1, 760.0])
MISRA_Y = np.array(
    [10.07, 14.73, 17.94, 23.93, 29.61, 35.18, 40.02, 44.82, 50.76, 55.05, 61.01, 66.40, 75.47, 81.78]
)  # fmt: skip
KOWALIK_X = np.array([4.0, 2.0, 1.0, 0.5, 0.25, 0.167, 0.125, 0.1, 0.0833, 0.0714, 0.0625])
KOWALIK_Y = np.array([0.1957, 0.1947, 0.1735, 0.16, 0.0844, 0.0627, 0.0456, 0.0342, 0.0323, 0.0235, 0.0246])
ONION_Y = np.array(
    [16.08, 33.83, 65.80, 97.20, 191.55, 326.20, 386.87, 520.53, 590.03, 651.92, 724.93, 699.56, 689.96, 637.56, 717.41]
)
STRD = [
    (
        "Misra1a", MISRA_X, MISRA_Y, lambda b, x: b[0] * (1.0 - np.exp(-b[1] * x)),
        ((500.0, 1e-4), (250.0, 5e-4)),
        (2.3894212918e02, 5.5015643181e-04), (2.7070075241, 7.2668688436e-06), 1.2455138894e-01,
    ),
    (
        "MGH09", KOWALIK_X, KOWALIK_Y, lambda b, x: b[0] * (x**2 + x * b[1]) / (x**2 + x * b[2] + b[3]),
        ((25.0, 39.0, 41.5, 39.0), (0.25, 0.39, 0.415, 0.39)),
        (1.9280693458e-01, 1.9128232873e-01, 1.2305650693e-01, 1.3606233068e-01),
        (1.1435312227e-02, 1.9633220911e-01, 8.0842031232e-02, 9.0025542308e-02), 3.0750560385e-04,
    ),
    (
        "Rat43", np.arange(1.0, 16.0), ONION_Y, lambda b, x: b[0] / (1.0 + np.exp(b[1] - b[2] * x)) ** (1.0 / b[3]),
        ((100.0, 10.0, 1.0, 1.0), (700.0, 5.0, 0.75, 1.3)),
        (6.9964151270e02, 5.2771253025, 7.5962938329e-01, 1.2792483859),
        (1.6302297817e01, 2.0828735829, 1.9566123451e-01, 6.8761936385e-01), 8.7864049080e03,
    ),
]  # fmt: skip
"""Statistical reference datasets for nonlinear regression (NIST): starts, certified values, their errors, squares."""


def evaluated(law: Law, x: FloatArray, y: FloatArray) -> Callable[[FloatArray], Residual]:
    """Residual of a law with partials by complex steps, exact to rounding."""

    def at(b: FloatArray) -> Residual:
        with np.errstate(all="ignore"):
            steps = [law(b + 1e-30j * unit, x).imag / 1e-30 for unit in np.eye(b.size)]
            return Residual(y - law(b, x), np.column_stack(steps))

    return at


@pytest.mark.parametrize("start", [0, 1])
@pytest.mark.parametrize("case", STRD, ids=[case[0] for case in STRD])
def test_certified_values_to_the_rounding_of_their_squares(case: tuple[str, ...], start: int) -> None:
    _, x, y, law, starts, values, errors, squares = case
    found = least_squares(evaluated(law, x, y), np.array(starts[start]), Until(share=1e-18, iterations=1000))  # type: ignore[arg-type]
    assert found.stop in (Stop.CONVERGED, Stop.NO_DESCENT)
    assert found.point.squares == pytest.approx(squares, rel=1e-9)
    # squares known to 2e-16 tell where they are least to the root of it, in standard errors: seven to ten digits here
    assert np.max(np.abs(found.coordinates - np.array(values)) / np.array(errors)) < 1e-7
    variance = found.point.squares / (len(y) - len(values))
    assert np.sqrt(variance * np.diag(covariance_of(found.point.partials))) == pytest.approx(np.array(errors), rel=1e-7)


def line(x: FloatArray, y: FloatArray) -> Callable[[FloatArray], Residual]:
    return lambda b: Residual(y - x @ b, x)


@given(st.integers(0, 10_000), st.integers(1, 5))
def test_a_linear_problem_is_that_of_the_normal_equations(seed: int, count: int) -> None:
    random = np.random.default_rng(seed)
    # columns of very different units
    x = random.standard_normal((20, count)) * 10.0 ** random.uniform(-6, 6, count)
    y = random.standard_normal(20)
    found = least_squares(line(x, y), np.zeros(count), Until(1e-20))
    exact = np.linalg.lstsq(x / np.linalg.norm(x, axis=0), y, rcond=None)[0] / np.linalg.norm(x, axis=0)
    assert found.coordinates == pytest.approx(exact, rel=1e-6)
    assert found.stop is not Stop.ITERATIONS


def test_numbers_of_one_effect_share_it_and_one_without_effect_stays() -> None:
    x = np.column_stack([np.ones(9), np.ones(9), np.zeros(9)])
    found = least_squares(line(x, np.full(9, 3.0)), np.array([0.0, 0.0, 7.0]), Until(1e-20))
    assert found.coordinates[0] + found.coordinates[1] == pytest.approx(3.0, rel=1e-9)
    assert found.coordinates[2] == 7.0
    # the sum is known to 1/9; each half of it to a quarter of that, and what does not show has none
    known = covariance_of(x)
    assert np.diag(known) == pytest.approx([1.0 / 36.0, 1.0 / 36.0, 0.0], rel=1e-9)
    assert inverse_of(np.diag([4.0, 1e-20])) == pytest.approx(np.diag([0.25, 1e20]))


def test_a_bound_holds_and_the_others_are_best_beside_it() -> None:
    x = np.column_stack([np.ones(5), np.arange(5.0)])
    free = least_squares(line(x, 1.0 - 2.0 * np.arange(5.0)), np.ones(2), Until(1e-20))
    assert free.coordinates == pytest.approx([1.0, -2.0])
    bounds = Bounds(np.array([-math.inf, 0.0]), np.full(2, math.inf), np.full(2, math.inf))
    held = least_squares(line(x, 1.0 - 2.0 * np.arange(5.0)), np.array([1.0, -5.0]), Until(1e-20), bounds)
    # without its slope the line is the mean, 1 - 2 x 2
    assert held.coordinates == pytest.approx([-3.0, 0.0])
    assert held.stop is Stop.CONVERGED


def test_a_step_is_no_longer_than_allowed() -> None:
    seen: list[float] = []

    def at(b: FloatArray) -> Residual:
        seen.append(float(b[0]))
        return Residual(10.0 - b, np.ones((1, 1)))

    least_squares(at, np.zeros(1), Until(1e-12), Bounds.of(1, longest=3.0))
    assert max(np.diff(seen)) <= 3.0
    assert seen[-1] == pytest.approx(10.0)


def cliff(edge: float) -> Callable[[FloatArray], Residual]:
    """b to be 10, which cannot be evaluated beyond an edge."""

    def at(b: FloatArray) -> Residual:
        if b[0] > edge:
            raise SimulationError("the motion diverges")
        return Residual(10.0 - b, np.ones((1, 1)))

    return at


def test_what_cannot_be_evaluated_is_stepped_back_from() -> None:
    found = least_squares(cliff(9.0), np.zeros(1), Until(1e-9))
    assert 8.0 < found.coordinates[0] <= 9.0
    assert found.stop is Stop.NOT_EVALUATED
    with pytest.raises(SimulationError, match="the motion diverges"):
        least_squares(cliff(-1.0), np.zeros(1), Until(1e-9))


def bent(slope: float, value: float = 1.0) -> Callable[[FloatArray], Residual]:
    """A residual whose partials are not its own."""
    return lambda b: Residual(np.array([value + b[0] ** 2]), np.array([[slope]]))


STOPS = [
    (bent(1.0), Until(1e-9), Stop.NO_DESCENT),
    (bent(math.inf), Until(1e-9), Stop.NOT_EVALUATED),
    (bent(1.0, math.nan), Until(1e-9), Stop.NOT_EVALUATED),
    (bent(0.0), Until(0.0), Stop.CONVERGED),
    (line(np.ones((1, 1)), np.ones(1)), Until(0.0, iterations=1), Stop.ITERATIONS),
    (line(np.ones((1, 1)), np.ones(1)), Until(0.0, iterations=0), Stop.ITERATIONS),
    (line(np.ones((1, 1)), np.ones(1)), Until(1e-9), Stop.CONVERGED),
]


@pytest.mark.parametrize(("at", "until", "stop"), STOPS)
def test_every_stop_has_its_name(at: Callable[[FloatArray], Residual], until: Until, stop: Stop) -> None:
    assert least_squares(at, np.zeros(1), until).stop is stop


@pytest.mark.parametrize("e", [1e-1, 1e-3, 1e-5, 1e-6])
def test_covariance_of_two_numbers_that_hardly_part(e: float) -> None:
    """Columns (1, 0) and (1, e): ((1 + e^2, -1), (-1, 1)) / e^2; 1 + e^2 itself has no digit of e left for e = 1e-8."""
    exact = np.array([[1.0 + e * e, -1.0], [-1.0, 1.0]]) / (e * e)
    found = covariance_of(np.array([[1.0, 1.0], [0.0, e]]))
    assert found == pytest.approx(exact, rel=10.0 * np.finfo(float).eps / e)


def test_a_number_that_does_not_show_and_a_direction_of_rounding_have_no_variance() -> None:
    assert covariance_of(np.array([[2.0, 0.0], [0.0, 0.0]])) == pytest.approx(np.diag([0.25, 0.0]))
    # of two that say the same, their sum is known
    assert covariance_of(np.array([[1.0, 1.0], [0.0, 1e-9]])) == pytest.approx(np.full((2, 2), 0.25))


def coloured(phi: float, size: int, seed: int = 2) -> FloatArray:
    fresh = np.random.default_rng(seed).standard_normal(size)
    return np.asarray(lfilter([1.0], [1.0, -phi], fresh), dtype=np.float64)


@pytest.mark.parametrize("phi", [0.0, 0.5, 0.8, 0.95])
def test_memory_of_first_order_noise_is_its_closed_form(phi: float) -> None:
    exact = (1.0 + phi) / (1.0 - phi)
    found = memory(coloured(phi, 100_000))
    assert found.time == pytest.approx(exact, rel=0.1)
    assert found.independent == pytest.approx(100_000 / exact, rel=0.1)
    assert not found.too_short


def test_a_series_of_few_memories_says_that_it_is_too_short() -> None:
    assert memory(coloured(0.99, 2000)).too_short
    assert memory(np.sin(np.linspace(0.0, 3.0, 1000))).too_short
    assert memory(np.zeros(100)).time == 1.0


@pytest.mark.parametrize("phi", [-0.4, 0.0, 0.7])
def test_whitened_noise_is_white_and_of_unit_size(phi: float) -> None:
    noise = Noise(0.3, True, phi)
    white = noise.whitened(noise.drawn(50_000, np.random.default_rng(1)))
    assert np.std(white) == pytest.approx(1.0, rel=0.02)
    assert float(white[1:] @ white[:-1]) / white.size == pytest.approx(0.0, abs=0.02)
    columns = np.column_stack([white, 2.0 * white])
    assert noise.whitened(columns)[:, 1] == pytest.approx(2.0 * noise.whitened(white))


def test_lags_are_sums_of_products_without_the_end_meeting_the_beginning() -> None:
    series = coloured(0.5, 40)
    direct = [float(series[: 40 - lag] @ series[lag:]) for lag in range(40)]
    assert lagged(series, 40) == pytest.approx(direct, abs=1e-12)
    assert lagged(series, 60)[40:] == pytest.approx(0.0, abs=1e-12)
