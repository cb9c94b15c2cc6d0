"""Several measurements of one number: its value, the error within, the spread between, and which one stands out."""

import numpy as np
import pytest

from harness.estimate.repeated import repeated


@pytest.mark.parametrize(("spread", "count"), [(0.0, 3), (0.0, 5), (1.0, 5), (5.0, 20)])
def test_the_spread_is_told_from_the_error_and_two_errors_mean_95_percent(spread: float, count: int) -> None:
    rng = np.random.default_rng(count)
    draws, inside, outliers, found = 400, 0, 0, []
    for _ in range(draws):
        errors = rng.uniform(0.5, 1.5, count)
        values = 7.0 + rng.normal(0.0, spread, count) + errors * rng.standard_normal(count)
        seen = repeated(values.tolist(), errors.tolist())
        inside += abs(seen.value - 7.0) < 2.0 * seen.stderr
        outliers += bool(seen.outliers)
        found.append(seen.between**2)
    assert inside / draws > 0.85  # few recordings tell the spread itself poorly
    assert outliers / draws < 0.08
    if spread > 0.0:
        assert np.mean(found) ** 0.5 == pytest.approx(spread, rel=0.25)


@pytest.mark.parametrize("at", [0, 2, 4])
def test_one_that_is_off_stands_out_and_the_others_do_not(at: int) -> None:
    values = [1.00, 1.01, 0.99, 1.005, 0.995]
    values[at] += 0.2
    assert repeated(values, [0.01] * 5).outliers == (at,)


def test_of_two_neither_stands_out() -> None:
    assert repeated([1.0, 2.0], [0.01, 0.01]).outliers == ()
