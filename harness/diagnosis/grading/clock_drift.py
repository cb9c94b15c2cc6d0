"""A recording's clock whose rate drifts: one channel does not tell it from a spring whose stiffness does."""

from contextlib import suppress
from dataclasses import replace

import numpy as np

from harness.core.errors import SimulationError
from harness.diagnosis.fit.model_fit import Fit, fit
from harness.diagnosis.fit.observe import observe
from harness.diagnosis.fit.parameters import free_of
from harness.diagnosis.problem import Problem
from harness.diagnosis.problems.free_decay import FreeDecay
from harness.diagnosis.rules import CLOCK_DRIFT
from harness.diagnosis.search.search import Search, under
from harness.kernels.solve import Scales
from harness.model.model import ModelTerm
from harness.model.terms import clock_drift, stiffness_drift

_TRIED = (0.5, 1.0, 1.5)
"""Of the rate that stands for the stiffness's."""
_SHARE = 1e-3
"""Of a rate, over which a slope by it is taken."""


def with_clock(found: Search, scales: Scales) -> Search:
    """The search with a drifting clock among the rivals of a lone drift of stiffness that clocks are known to have.

    As many numbers follow the same recording: the base under another time. Where its acceleration is measured beside
    its position, the clock leaves more, and is no rival.
    """
    problem, terms = found.problem, found.chosen.model.terms
    if (
        not found.explained
        or [e.term.name for e in terms] != [stiffness_drift.TERM.name]
        or not isinstance(problem, FreeDecay)
    ):
        return found
    # a frequency goes with the root of a stiffness
    slope = 0.5 * terms[0].values[0]
    if abs(slope) * problem.duration > CLOCK_DRIFT.value:
        return found
    with suppress(SimulationError):
        tried = [(by * slope, _under_clock(found.base, problem, by * slope, scales)) for by in _TRIED]
        low, middle, high = (one.chi2 for _, one in tried)
        bend = low - 2.0 * middle + high
        best = slope * (1.0 + 0.25 * (low - high) / bend) if bend > 0.0 else min(tried, key=lambda one: one[1].chi2)[0]
        rival = _as_law(found.base, problem, best, scales)
        rivals = sorted((*found.rivals, rival), key=lambda one: one.bic)
        return replace(found, rivals=tuple(rivals))
    return found


def _under_clock(base: Fit, problem: Problem, slope: float, scales: Scales) -> Fit:
    """The base fitted to the recording by a clock whose rate changes by ``slope`` (1/s)."""
    return fit(base.model, _timed(base, problem, slope), base.free, scales)


def _timed(base: Fit, problem: Problem, slope: float) -> Problem:
    return replace(problem, t=problem.t + 0.5 * slope * (problem.t - base.model.t0) ** 2)


def _as_law(base: Fit, problem: Problem, slope: float, scales: Scales) -> Fit:
    """The same as a fit of a model that has the clock for a term, so that it is counted and said like any law."""
    here = _under_clock(base, problem, slope, scales)
    beside = observe(here.model, _timed(base, problem, (1.0 + _SHARE) * slope), scales=scales).y
    dy = {
        c: np.column_stack([partials, (beside[c] - here.shown.y[c]) / (_SHARE * slope)])
        for c, partials in here.shown.dy.items()
    }
    model = here.model.with_terms(ModelTerm(clock_drift.TERM, (slope,)))
    free = (*here.free, *free_of(model, ()))
    return under(replace(here, model=model, free=free, shown=replace(here.shown, dy=dy)), problem)
