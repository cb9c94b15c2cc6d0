"""Prediction of windows that took no part: every second one, the force fitted to the others alone."""

import math
from contextlib import suppress

import numpy as np

from harness.core.arrays import BoolArray
from harness.core.errors import SimulationError
from harness.diagnosis.driven.forcefit import refitted
from harness.diagnosis.driven.measured import Measured
from harness.diagnosis.fit import Fit
from harness.diagnosis.observe import COARSE, observe
from harness.diagnosis.outcome import Holdout
from harness.diagnosis.problem import Problem
from harness.kernels.solve import Scales


def holdout_windows(base: Fit, refined: Fit, problem: Problem, scales: Scales) -> Holdout:
    """Held-out rmse by channel of the base model and the refined one; no spans below two windows."""
    assert problem.restarts is not None
    windows, t = problem.restarts.windows[1::2], problem.t
    if not windows:
        return Holdout((), {}, {})
    out = np.zeros(t.size, dtype=np.bool_)
    for w in windows:
        out[w.start : w.stop] = True
    measured = Measured.of(problem)
    touched: BoolArray = np.any(out[: measured.t.size].reshape(measured.moving.size, -1), axis=1)
    apart = measured.part(~touched)

    def rmse(found: Fit) -> dict[str, float]:
        return _rmse(found, apart, problem, scales, out)

    before = rmse(base)
    spans = tuple((w.t0, float(t[w.stop - 1])) for w in windows)
    return Holdout(spans, before, before if refined is base else rmse(refined))


def _rmse(found: Fit, apart: Measured, problem: Problem, scales: Scales, out: BoolArray) -> dict[str, float]:
    model = found.model
    with suppress(SimulationError):
        model = refitted(found, apart)
    shown = observe(model, problem, (), scales, COARSE)
    return {c: float(np.sqrt(np.mean((y - shown.y[c])[out] ** 2))) for c, y in problem.channels.items()}


def left_said(problem: Problem) -> str:
    """What a fitted force leaves, said plainly: it was not tested for being noise."""
    assert problem.drive is not None
    level = problem.noise["u"].sigma
    share = 100.0 * level / math.sqrt(float(np.mean(problem.drive.u**2)))
    return (
        f"{level:.3g} N rms of the force ({share:.2g} %) are left over; they count as the drive's own, coloured, and"
        " were not tested for being noise"
    )
