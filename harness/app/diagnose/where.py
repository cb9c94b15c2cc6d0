"""Where a named effect acts, as results say it: spans of time, a regime, a plain condition."""

import numpy as np

from harness.diagnosis.outcome import Mechanism, Outcome
from harness.results.common import Where


def where_of(mechanism: Mechanism, outcome: Outcome) -> Where:
    """Place of a mechanism; its share is of the baseline's mean square mismatch, in units of the noise."""
    t, place = outcome.problem.t, mechanism.place
    inside = np.zeros(t.size, dtype=np.bool_)
    for low, high in place.spans:
        inside |= (t >= low) & (t <= high)
    squares = outcome.base.residual.reshape(-1, t.size) ** 2
    total = float(squares.sum())
    share = float(squares[:, inside].sum()) / total if total > 0.0 else None
    time_s = [[low, high] for low, high in place.spans]
    return Where(time_s=time_s, regime=place.regime, condition=place.condition, share=share)
