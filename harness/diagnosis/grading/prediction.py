"""Prediction of what was left out of a fit: interleaved blocks of cycles, and the last part from the first."""

import math
from collections.abc import Callable, Mapping
from contextlib import suppress
from dataclasses import dataclass

import numpy as np
from scipy import special

from harness.core.arrays import BoolArray, FloatArray
from harness.core.cores import each
from harness.core.errors import SimulationError
from harness.diagnosis.baseline.words import Strokes
from harness.diagnosis.fit.model_fit import Fit, fit
from harness.diagnosis.problem import Problem
from harness.diagnosis.problems.simulated import FINE, observe
from harness.kernels.solve import Scales
from harness.model.term import Spans

_FOLDS = 4
"""Refits, each without every fourth block."""
_BLOCKS = 8
"""Blocks of whole cycles at most: each cycle its own below."""
_ITERATIONS = 15
"""Of a refit that starts from the fit to all."""
_TRAINED = 0.6
"""Share of the recording that a free run is fitted to."""
_NONE = 1e-300
"""Squares of nothing, where something is divided by them."""


@dataclass(frozen=True, slots=True)
class Predicted:
    """What a model fitted elsewhere misses.

    squares : by channel, in its unit squared, one sum a span, (b,). samples : (b,). sigma : by channel, of the noise in
    whose units channels are added up. spans : s.
    """

    squares: Mapping[str, FloatArray]
    samples: FloatArray
    sigma: Mapping[str, float]
    spans: Spans

    @property
    def by_span(self) -> FloatArray:
        """Squares over all channels in units of the noise, (b,)."""
        return np.asarray(sum(s / self.sigma[c] ** 2 for c, s in self.squares.items()), dtype=np.float64)

    @property
    def total(self) -> float:
        """Over all spans."""
        return float(np.sum(self.by_span))

    @property
    def rmse(self) -> dict[str, float]:
        """By channel, in its unit."""
        return {c: math.sqrt(float(np.sum(s)) / float(np.sum(self.samples))) for c, s in self.squares.items()}


def _missed(problem: Problem, shown: Mapping[str, FloatArray]) -> dict[str, FloatArray]:
    """Squares (n,) of what is missed, by channel: beside a noisy force, of what each sample adds to those before."""
    left = {c: y - shown[c] for c, y in problem.channels.items()}
    if problem.force_noise is not None:
        left = {c: problem.noise[c].sigma * white for c, white in problem.whitened(left).items()}
    return {c: problem.weight[c] * r**2 for c, r in left.items()}


def _refitted(found: Fit, problem: Problem, scales: Scales, train: BoolArray) -> dict[str, FloatArray] | None:
    with suppress(SimulationError):
        again = fit(found.model, problem.weighted(train), found.free, scales, _ITERATIONS, thorough=False)
        return observe(again.model, problem, (), scales, FINE).y
    return None


def blocks_of(strokes: Strokes) -> FloatArray:
    """The block (n,) of each sample; the first cycle, with the largest swings, is in none (-1) but in each fit."""
    cycle = strokes.of // 2 - 1
    cycles = int(cycle[-1]) + 1
    size = max(1, -(-cycles // _BLOCKS))
    return np.where(cycle < 0, -1, cycle // size)


def held_out(found: Fit, problem: Problem, scales: Scales, strokes: Strokes) -> Predicted | None:
    """What a model misses of blocks of cycles that it was not fitted to; None where it cannot be refitted.

    The trajectory runs through. An interleaved block says little against a law of time: see ``free_run``.
    """
    return by_blocks(problem, strokes, lambda out: _refitted(found, problem, scales, ~out))


def by_blocks(
    problem: Problem, strokes: Strokes, refitted: Callable[[BoolArray], Mapping[str, FloatArray] | None]
) -> Predicted | None:
    """What is missed of blocks that were left out, fold by fold.

    refitted : from the samples (n,) left out to what a model shows (n,) by channel that was fitted to the others.
    """
    block = blocks_of(strokes)
    count = int(block.max()) + 1
    if count < 2:
        return None
    squares = {c: np.zeros(count) for c in problem.channels}
    outs = [(block >= 0) & (block % _FOLDS == fold) for fold in range(min(_FOLDS, count))]
    for out, shown in zip(outs, each(refitted, outs), strict=True):
        if shown is None:
            return None
        for c, left in _missed(problem, shown).items():
            squares[c] += np.bincount(block[out], left[out], count)
    inside = [problem.t[block == i] for i in range(count)]
    spans = tuple((float(t[0]), float(t[-1])) for t in inside)
    return Predicted(squares, np.array([float(t.size) for t in inside]), _sigma(problem), spans)


def trained(problem: Problem) -> BoolArray:
    """The samples (n,) that a free run is fitted to."""
    return problem.opening(_TRAINED)


def free_run(found: Fit, problem: Problem, scales: Scales) -> Predicted | None:
    """What a model fitted to the first 60 % misses of the rest, which it runs through freely."""
    train = trained(problem)
    shown = _refitted(found, problem, scales, train)
    if shown is None:
        return None
    t, squares = problem.t[~train], _missed(problem, shown)
    summed = {c: np.array([float(np.sum(s[~train]))]) for c, s in squares.items()}
    return Predicted(summed, np.array([float(t.size)]), _sigma(problem), ((float(t[0]), float(t[-1])),))


def _sigma(problem: Problem) -> dict[str, float]:
    return {c: problem.noise[c].sigma for c in problem.channels}


def surely_less(after: Predicted, before: Predicted, errors: float) -> bool:
    """Whether the share of squares that is still missed is below 1 by so many of its standard errors.

    By the jackknife over blocks (Miller 1974, Biometrika 61, 1): blocks of large swings weigh as they should, and that
    they miss more than others is no scatter. ``errors`` are those of a scatter that is known; from few blocks it takes
    as many as are as sure by Student's distribution.
    """
    a, b = after.by_span, before.by_span
    count = a.size
    if count < 2 or before.total <= 0.0:
        return after.total < before.total
    without = (after.total - a) / np.maximum(before.total - b, _NONE)
    scatter = math.sqrt((count - 1) / count * float(np.sum((without - np.mean(without)) ** 2)))
    sure = float(special.stdtrit(count - 1, special.ndtr(errors)))
    return bool(1.0 - after.total / before.total > sure * scatter)


def ratio(after: Predicted | None, before: Predicted | None) -> float:
    """Root mean square after over before; 1 where one could not be had: it says nothing for a term."""
    if after is None or before is None or before.total <= 0.0:
        return 1.0
    return float(np.sqrt(after.total / before.total))
