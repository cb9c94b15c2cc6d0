"""How much of what the base model leaves lies where a named effect acts."""

import numpy as np

from harness.diagnosis.fit.model_fit import Fit
from harness.diagnosis.problem import Problem
from harness.model.place import Place


def share_within(place: Place, base: Fit, problem: Problem) -> float | None:
    """Share of the base's mean square mismatch, in units of the noise, within a place; None where nothing is left."""
    t = problem.t
    inside = np.zeros(t.size, dtype=np.bool_)
    for low, high in place.spans:
        inside |= (t >= low) & (t <= high)
    squares = base.residual.reshape(-1, t.size) ** 2
    total = float(squares.sum())
    return float(squares[:, inside].sum()) / total if total > 0.0 else None
