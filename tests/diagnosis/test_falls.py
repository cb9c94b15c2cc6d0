"""What a model misses less of blocks left out: surely, or by chance."""

import numpy as np
import pytest

from harness.diagnosis.grading.prediction import Predicted, surely_less


def _by_span(squares: list[float]) -> Predicted:
    spans = tuple((float(i), float(i + 1)) for i in range(len(squares)))
    return Predicted({"x": np.array(squares)}, np.ones(len(squares)), {"x": 1.0}, spans)


@pytest.mark.parametrize(
    ("after", "sure"),
    [
        # a tenth of each block, though the first misses a hundred times the last
        ([10.0, 3.0, 0.9, 0.3, 0.11], True),
        # all but the largest nearly vanish, which falls to a fifth
        ([20.0, 0.6, 0.1, 0.05, 0.02], True),
        # the largest alone falls; the others rise
        ([10.0, 45.0, 14.0, 4.5, 1.5], False),
        # as much as before, give or take
        ([90.0, 33.0, 9.0, 3.3, 0.9], False),
        ([100.0, 30.0, 10.0, 3.0, 1.0], False),
    ],
)
def test_a_fall_is_sure_by_its_share_of_each_block(after: list[float], sure: bool) -> None:
    """The jackknife's error of a ratio: how unequal the blocks are is no scatter."""
    before = _by_span([100.0, 30.0, 10.0, 3.0, 1.0])
    assert surely_less(_by_span(after), before, 2.0) is sure
    assert not surely_less(before, _by_span(after), 2.0)


def test_a_fall_in_few_blocks_takes_more_to_be_sure() -> None:
    """Student's distribution: the same shares of four blocks, and of sixteen."""
    shares = [0.3, 0.9, 0.5, 1.0]
    few, many = (surely_less(_by_span(shares * n), _by_span([1.0] * 4 * n), 2.0) for n in (1, 4))
    assert (few, many) == (False, True)
