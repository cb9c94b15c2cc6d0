"""Models on a recording that they were not fitted to."""

from dataclasses import replace

from harness.diagnosis.fit.model_fit import fit
from harness.diagnosis.fit.observe import observe
from harness.diagnosis.fit.parameters import free_of
from harness.diagnosis.fit.rmse import rmse
from harness.diagnosis.problem import Problem
from harness.kernels.solve import Scales
from harness.model.model import Model

_STARTS = ("x0", "v0")


def as_started(model: Model, problem: Problem, scales: Scales) -> dict[str, float]:
    """Root mean square of recording minus model by channel, from the problem's own starts, nothing fitted."""
    return rmse(observe(model, problem, (), scales).y, problem)


def only_started(model: Model, problem: Problem, own: Model, scales: Scales) -> dict[str, float]:
    """The same with where and how fast it starts fitted, which belongs to the recording; own : a model of that."""
    here = replace(model, x0=own.x0, v0=own.v0, t0=own.t0, offset=own.offset)
    free = tuple(f for f in free_of(here, _STARTS) if f.name in _STARTS)
    return rmse(fit(here, problem, free, scales).shown.y, problem)
