"""Prediction of windows that took no part: every second one, the force fitted to the others alone."""

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


def holdout_windows(base: Fit, refined: Fit, problem: InverseDynamics, scales: Scales) -> Holdout:
    """Held-out rmse by channel of the base model and the refined one.

    No spans below two windows, nor where a model cannot be fitted to the other windows alone or not followed from
    there, which is then said.
    """
    windows, t = problem.starts.windows[1::2], problem.t
    if not windows:
        return Holdout.none()
    out = np.zeros(t.size, dtype=np.bool_)
    for w in windows:
        out[w.start : w.stop] = True
    measured = Measured.of(problem)
    touched: BoolArray = np.any(out[: measured.t.size].reshape(measured.moving.size, -1), axis=1)
    apart = measured.part(~touched)

    before = _predicted(base, apart, problem, scales, out)
    if before is None:
        return Holdout.none("base")
    after = before if refined is base else _predicted(refined, apart, problem, scales, out)
    if after is None:
        return Holdout.none("refined")
    return Holdout(tuple((w.t0, float(t[w.stop - 1])) for w in windows), before, after)


def _predicted(
    found: Fit, apart: Measured, problem: InverseDynamics, scales: Scales, out: BoolArray
) -> dict[str, float] | None:
    """None where the fit fails: one of all samples must not stand in, which has seen what it would predict."""
    with suppress(SimulationError):
        return rmse(observe(refitted(found, apart), problem, (), scales, COARSE).y, problem, out)
    return None
