"""Prediction of windows that took no part: every second one, the force fitted to the others alone."""

from collections.abc import Callable
from contextlib import suppress

import numpy as np

from harness.core.arrays import BoolArray
from harness.core.errors import SimulationError
from harness.diagnosis.fit.model_fit import Fit
from harness.diagnosis.fit.observe import COARSE, observe
from harness.diagnosis.fit.rmse import rmse
from harness.diagnosis.inverse_dynamics.force_fit import refitted
from harness.diagnosis.inverse_dynamics.measured import Measured
from harness.diagnosis.outcome import Holdout
from harness.diagnosis.problems.inverse_dynamics import InverseDynamics
from harness.kernels.solve import Scales
from harness.model.model import Model


def holdout_windows(base: Fit, refined: Fit, problem: InverseDynamics, scales: Scales) -> Holdout:
    """Held-out rmse by channel of the base model and the refined one.

    No spans below two windows, nor where a model cannot be fitted to the other windows alone or not followed from
    there, which is then said.
    """
    windows, t = problem.starts.windows[1::2], problem.t
    if not windows:
        return Holdout.none()
    before = predicted_windows(problem, lambda apart: refitted(base, apart), scales)
    if before is None:
        return Holdout.none("base")
    after = before if refined is base else predicted_windows(problem, lambda apart: refitted(refined, apart), scales)
    if after is None:
        return Holdout.none("refined")
    return Holdout(tuple((w.t0, float(t[w.stop - 1])) for w in windows), before, after)


def predicted_windows(
    problem: InverseDynamics, fitted: Callable[[Measured], Model], scales: Scales
) -> dict[str, float] | None:
    """Rmse by channel over every second window, of a model fitted to what else there is.

    None where the fit fails: one of all samples must not stand in, which has seen what it would predict.
    """
    out = np.zeros(problem.t.size, dtype=np.bool_)
    for w in problem.starts.windows[1::2]:
        out[w.start : w.stop] = True
    measured = Measured.of(problem)
    touched: BoolArray = np.any(out[: measured.t.size].reshape(measured.moving.size, -1), axis=1)
    with suppress(SimulationError):
        model = fitted(measured.part(~touched))
        return rmse(observe(model, problem, (), scales, COARSE).y, problem, out)
    return None
