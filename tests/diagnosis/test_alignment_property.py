"""Any recording against itself: shifted by up to 80 % of its length, resampled, cropped, with noise."""

import pytest
from scipy.stats import binom

from benchmarks.aligned import figures, outcome


@pytest.mark.parametrize("count", [8, pytest.param(500, marks=pytest.mark.full)])
def test_a_recording_finds_itself(count: int) -> None:
    """Within three standard errors in 97 %, slipped a period in silence in 1 %: as chance allows of so many draws."""
    found = [outcome(seed) for seed in range(count)]
    said = figures(found)
    print(said)
    missed, silent = (
        sum(one.apart >= 3.0 for one in found),
        sum(one.slipped and not one.told for one in found),
    )
    # more than these come in one of a thousand series at the promised rates
    assert missed <= binom.ppf(0.999, count, 0.03), said
    assert silent <= binom.ppf(0.999, count, 0.01), said
