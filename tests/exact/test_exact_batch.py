"""A batch equals its members, on any number of threads."""

import numpy as np
import pytest

from benchmarks.exact_batch import fill_batch, stack
from harness.core.errors import InputError
from harness.exact.decay import Decay, fill_uniform


def sliders(n: int) -> list[Decay]:
    rng = np.random.default_rng(3)
    return [
        Decay(rng.uniform(1, 50), rng.uniform(0, 1.3), rng.uniform(0, 0.1), rng.normal(), rng.normal(), 0.1)
        for _ in range(n)
    ]


@pytest.mark.parametrize("threads", [None, 1, 2, 5])
def test_every_row_is_bitwise_the_single_decay(threads: int | None) -> None:
    decays = sliders(23)
    x, v, a = np.empty((3, len(decays), 157))
    fill_batch(stack(decays), -0.1, 0.01, x, v, a, threads)
    for i, decay in enumerate(decays):
        one = np.empty((3, 157))
        fill_uniform(decay, -0.1, 0.01, *one)
        np.testing.assert_array_equal(one, np.stack([x[i], v[i], a[i]]))


def test_the_row_that_is_no_slider_is_named() -> None:
    parameters = stack(sliders(4))
    parameters[2, 1] = -0.5
    with pytest.raises(InputError, match=r"^batch, row 3, decay: zeta: -0.5; expected 0 or more$"):
        fill_batch(parameters, 0.0, 0.1, *np.empty((3, 4, 5)))


def test_shapes_are_checked() -> None:
    with pytest.raises(InputError, match=r"batch: parameters: shape \(4, 5\)"):
        fill_batch(np.ones((4, 5)), 0.0, 0.1, *np.empty((3, 4, 5)))
    with pytest.raises(InputError, match=r"contiguous float64 of shape \(4, 5\)"):
        fill_batch(stack(sliders(4)), 0.0, 0.1, np.empty((4, 5)), np.empty((4, 5)), np.empty((3, 5)))
