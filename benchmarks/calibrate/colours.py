"""Noise of first-order colour: what windows of a quarter of a swing see of it, beside what they would by the whole."""

from collections.abc import Iterator, Sequence

import numpy as np

from benchmarks.calibrate.calibration import Calibration, head, quantiles, stands
from harness.diagnosis.baseline.residual_noise import coloured_whole, share_in_windows
from harness.diagnosis.rules import AS_FAST
from harness.estimate.noise import Noise

_SAMPLES, _WIDTHS = (300, 4000), (12, 40)
"""Fewest and most samples of a residual, and of a window."""
_COLOURS = (0.2, 0.85)
_EACH = 50
"""Residuals of a draw."""
MOST_LOST = 1e-3
"""Share of true colours that is borne to be taken for none."""


def measure(seed: int, index: int) -> list[float]:
    """Shares of the expected power that windows see, of residuals that are such noise and are taken for it as a whole.

    As a whole: before the windows are asked.
    """
    random = np.random.default_rng([seed, 29, index])
    shares = []
    for _ in range(_EACH):
        count = int(np.exp(random.uniform(*np.log(_SAMPLES))))
        width = int(random.integers(_WIDTHS[0], _WIDTHS[1] + 1))
        drawn = Noise(1.0, True, random.uniform(*_COLOURS)).drawn(count, random)
        # no window is asked where none fits in
        whole = coloured_whole(drawn, np.ones(count), Noise(1.0, True), count + 1)
        if whole.phi > 0.0:
            shares.append(share_in_windows(drawn, np.ones(count, dtype=np.bool_), whole, width))
    return shares


def said(rows: Sequence[list[float]]) -> Iterator[str]:
    """Quantiles of the inverse, whose largest are the least shares, and how many are below the rule."""
    shares = np.concatenate([np.asarray(row) for row in rows])
    yield head("expected power over the seen")
    yield quantiles("noise of that colour", (1.0 / shares).tolist())
    lost = int(np.count_nonzero(shares < AS_FAST.value))
    why = f"{lost} of {shares.size} residuals of a colour are below it, the least is {float(shares.min()):.3g}"
    yield stands(AS_FAST, lost <= MOST_LOST * shares.size, why)


CALIBRATION = Calibration(measure, said, "power in windows of noise that has a first-order colour")
