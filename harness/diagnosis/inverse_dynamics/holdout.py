"""Prediction of windows that took no part: every second one, the force fitted to the others alone.

The force that models miss of strokes that they were not fitted to.
"""

from collections.abc import Callable
from contextlib import suppress

import numpy as np

from harness.core.arrays import BoolArray, FloatArray
from harness.core.errors import SimulationError
from harness.diagnosis.fit.model_fit import Fit, fit
from harness.diagnosis.fit.rmse import rmse
from harness.diagnosis.grading.prediction import Predicted
from harness.diagnosis.outcome import Holdout
from harness.diagnosis.problems.inverse import InverseDynamics
from harness.diagnosis.problems.simulated import COARSE, observe
from harness.kernels.solve import Scales
from harness.model.model import Model

FOLDS = 4
"""Refits, each without every fourth block of strokes."""


def left_out(
    problem: InverseDynamics, block: FloatArray, refitted: Callable[[InverseDynamics], Model]
) -> Predicted | None:
    """The force error over blocks of strokes left out of a fit; None where the others cannot be fitted.

    block (m,) : number of each value's block, -1 for what is in every fit. refitted : a model fitted to the values
    that count; it may raise SimulationError.
    """
    count = int(block.max()) + 1
    if count < 2:
        return None
    measured, force, squares = problem.measured, problem.rows["u"], np.zeros(count)
    t = measured.blocks(measured.t)
    for fold in range(min(FOLDS, count)):
        out = (block >= 0) & (block % FOLDS == fold)
        try:
            model = refitted(problem.kept(~out))
        except SimulationError:
            return None
        left = measured.even(force - measured.asked(model)[0]) ** 2
        squares += np.bincount(block[out].astype(np.int64), left[out], count)
    inside = [t[block == i] for i in range(count)]
    spans = tuple((float(s[0]), float(s[-1])) for s in inside)
    return Predicted({"u": squares}, np.array([float(s.size) for s in inside]), {"u": 1.0}, spans)


def held_out(found: Fit, problem: InverseDynamics, block: FloatArray) -> Predicted | None:
    """The force error of a model over blocks of strokes left out of the fit; see ``left_out``."""
    return left_out(problem, block, lambda part: fit(found.model, part, found.free).model)


def holdout_windows(base: Fit, refined: Fit, problem: InverseDynamics, scales: Scales) -> Holdout:
    """Held-out rmse by channel of the base model and the refined one.

    No spans below two windows, nor where a model cannot be fitted to the other windows alone or not followed from
    there, which is then said.
    """
    windows, t = problem.starts.windows[1::2], problem.t
    if not windows:
        return Holdout.none()
    before = predicted_windows(problem, lambda part: _refitted(base, part), scales)
    if before is None:
        return Holdout.none("base")
    after = before if refined is base else predicted_windows(problem, lambda part: _refitted(refined, part), scales)
    if after is None:
        return Holdout.none("refined")
    return Holdout(tuple((w.t0, float(t[w.stop - 1])) for w in windows), before, after)


def predicted_windows(
    problem: InverseDynamics, fitted: Callable[[InverseDynamics], Model], scales: Scales
) -> dict[str, float] | None:
    """Rmse by channel over every second window, of a model fitted to what else there is.

    None where the fit fails: one of all samples must not stand in, which has seen what it would predict.
    """
    out = np.zeros(problem.t.size, dtype=np.bool_)
    for w in problem.starts.windows[1::2]:
        out[w.start : w.stop] = True
    measured = problem.measured
    touched: BoolArray = np.any(out[: measured.t.size].reshape(measured.moving.size, -1), axis=1)
    with suppress(SimulationError):
        model = fitted(problem.kept(~touched[measured.moving]))
        return rmse(observe(model, problem, (), scales, COARSE).y, problem, out)
    return None


def _refitted(found: Fit, part: InverseDynamics) -> Model:
    """Raises SimulationError where the values that count are fewer than its numbers."""
    if part.rows["u"].size <= len(found.free):
        raise SimulationError("the slider hardly moves")
    return fit(found.model, part, found.free).model
