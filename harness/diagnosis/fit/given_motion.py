"""A motion with covariates as they were measured: laws with tables of them, and partials by their gains."""

from dataclasses import replace

import numpy as np

from harness.core.arrays import FloatArray
from harness.diagnosis.problem import Problem
from harness.kernels.solve import By, Effort, Scales, Solution, solve
from harness.model.covariate import Acts, Covariate
from harness.model.given import GIVEN
from harness.model.model import Model, ModelTerm

_MOST = 2000
"""Values of all tables: a column that is slow beside the motion, or smooth, has no more to say."""


def motion_given(
    model: Model,
    t: FloatArray,
    by: tuple[By, ...],
    problem: Problem,
    samples: slice,
    scales: Scales | None,
    effort: Effort,
    want_a: bool,
) -> Solution:
    """The motion at the times t (n,), s, over these samples of a recording, as ``solve`` gives it.

    Raises SimulationError.
    """
    if not model.covariates:
        return solve(model, t, by, problem.drive, scales, effort, want_a)
    first = len(model.terms)
    entries = tuple(_law(one, problem, samples) for one in model.covariates)
    whole = replace(model, terms=(*model.terms, *entries), covariates=())
    sums = [_sum(model, first, b) for b in by]
    names = tuple(dict.fromkeys(name for one in sums for name in one))
    found = solve(whole, t, names, problem.drive, scales, effort, want_a)
    weights = np.zeros((len(names), len(by)))
    for q, one in enumerate(sums):
        for name, factor in one.items():
            weights[names.index(name), q] = factor
    return replace(found, dx=found.dx @ weights, dv=found.dv @ weights, da=found.da @ weights, by=by)


def _law(one: Covariate, problem: Problem, samples: slice) -> ModelTerm:
    """A covariate as a law with its table over a stretch of a recording."""
    t, values = problem.t[samples], problem.covariates[one.name][samples] - one.about
    even = np.linspace(t[0], t[-1], max(min(t.size, _MOST // len(problem.covariates)), 2))
    rate = (even.size - 1) / max(float(t[-1] - t[0]), 1e-300)
    table = (float(t[0]), rate, float(even.size - 1), *np.interp(even, t, values).tolist())
    own = (one.gain, one.level) if one.acts is Acts.FORCE else (one.gain,)
    return ModelTerm(GIVEN[one.acts], own, given=table)


def _sum(model: Model, first: int, by: By) -> dict[By, float]:
    """Which numbers of the laws one of the model moves, and by how much; first : place of the first covariate's law."""
    for i, one in enumerate(model.covariates):
        if by in one.fitted:
            return {(first + i, 0 if by == one.parameter else 1): 1.0}
    found: dict[By, float] = {by: 1.0}
    if by == "c" and model.c > 0.0:
        # what is in proportion to the damping moves with it
        wet = ((first + i, one) for i, one in enumerate(model.covariates) if one.acts is Acts.DAMPING)
        found |= {(i, 0): one.gain / model.c for i, one in wet}
    return found
