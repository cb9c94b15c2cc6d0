"""How far what a model shows is from a recording.

Models on a recording that they were not fitted to.
"""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from harness.core.arrays import BoolArray, FloatArray
from harness.diagnosis.fit.model_fit import fit
from harness.diagnosis.parameters import free_of
from harness.diagnosis.problem import Problem
from harness.diagnosis.problems.simulated import observe
from harness.kernels.solve import Scales
from harness.model.model import Model


def rmse(shown: Mapping[str, FloatArray], problem: Problem, at: BoolArray | None = None) -> dict[str, float]:
    """Root mean square of recording minus ``shown`` (n,) by channel, in its unit.

    at (n,) : samples to look at, None for those that count.
    """
    return {c: rms(y - shown[c], problem.weight[c] > 0.0 if at is None else at) for c, y in problem.channels.items()}


def rms(difference: FloatArray, at: BoolArray) -> float:
    """Root mean square of a difference (n,) over some samples (n,)."""
    return float(np.sqrt(np.mean(difference[at] ** 2)))


def fit_percent(shown: Mapping[str, FloatArray], problem: Problem) -> dict[str, float]:
    """Normalised root mean square fit by channel, 100 (1 - |y - yhat| / |y - mean y|), over samples that count."""
    at = {c: weight > 0.0 for c, weight in problem.weight.items()}
    return {c: percent_followed(shown[c][at[c]], y[at[c]]) for c, y in problem.channels.items()}


def motion_followed(shown: Mapping[str, FloatArray], problem: Problem) -> float:
    """That of the position, or of the speed where no position is recorded."""
    percent = fit_percent(shown, problem)
    return percent["x" if "x" in percent else "v"]


def percent_followed(shown: FloatArray, seen: FloatArray) -> float:
    """100 (1 - |y - yhat| / |y - mean y|) of arrays (n,); 0 where what was seen does not move."""
    spread = float(np.linalg.norm(seen - np.mean(seen)))
    return 100.0 * (1.0 - float(np.linalg.norm(seen - shown)) / spread) if spread > 0.0 else 0.0


_STARTS = ("x0", "v0")


def as_started(model: Model, problem: Problem, scales: Scales) -> dict[str, float]:
    """Root mean square of recording minus model by channel, from the problem's own starts, nothing fitted."""
    return rmse(observe(model, problem, (), scales).y, problem)


def only_started(model: Model, problem: Problem, own: Model, scales: Scales) -> dict[str, float]:
    """The same with where and how fast it starts fitted, which belongs to the recording; own : a model of that."""
    here = replace(model, x0=own.x0, v0=own.v0, t0=own.t0, offset=own.offset)
    free = tuple(f for f in free_of(here, _STARTS) if f.name in _STARTS)
    return rmse(fit(here, problem, free, scales).shown.y, problem)
