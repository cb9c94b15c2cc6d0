"""The force that models miss of strokes that they were not fitted to."""

from collections.abc import Callable

import numpy as np

from harness.core.arrays import BoolArray, FloatArray
from harness.core.errors import SimulationError
from harness.diagnosis.grading.prediction import Predicted
from harness.diagnosis.inverse_dynamics.measured import Measured
from harness.model.model import Model

FOLDS = 4
"""Refits, each without every fourth block of strokes."""


def left_out(measured: Measured, block: FloatArray, refitted: Callable[[BoolArray], Model]) -> Predicted | None:
    """The force error over blocks of strokes left out of a fit; None where the others cannot be fitted.

    block (m,) : number of each value's block, -1 for what is in every fit. refitted : a model fitted to the values
    (m,) that are kept; it may raise SimulationError.
    """
    count = int(block.max()) + 1
    if count < 2:
        return None
    t, force, squares = measured.blocks(measured.t), measured.blocks(measured.u), np.zeros(count)
    for fold in range(min(FOLDS, count)):
        out = (block >= 0) & (block % FOLDS == fold)
        try:
            model = refitted(~out)
        except SimulationError:
            return None
        left = measured.even(force - measured.asked(model)) ** 2
        squares += np.bincount(block[out].astype(np.int64), left[out], count)
    inside = [t[block == i] for i in range(count)]
    spans = tuple((float(s[0]), float(s[-1])) for s in inside)
    return Predicted({"u": squares}, np.array([float(s.size) for s in inside]), {"u": 1.0}, spans)
