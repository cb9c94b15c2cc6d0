"""Noise that is not the same throughout, as what a model leaves shows it: of stamps that jitter, or of a tachometer."""

import math
from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from harness.core.arrays import FloatArray
from harness.diagnosis.fit.model_fit import Fit
from harness.diagnosis.problem import P, Problem
from harness.diagnosis.problems.simulated import FINE
from harness.estimate.noise import Uneven, channel_noise
from harness.kernels.solve import Scales
from harness.model.model import Model

_WINDOW, _QUINTIC = 8, 5
"""Samples of a window whose noise tells of stamps, and what is taken off it: a law that acts for longer stays out."""
_BESIDE = 4.0
"""Standard deviations of a stamp within which a sample may lie on the other side of a jump."""


def stamped(problem: P, model: Model, scales: Scales) -> P:
    """A problem whose samples count as their noise lets them; itself where it is even. model : fitted to it.

    An acceleration jumps where dry friction turns round: a sample beside that is left out. Raises SimulationError.
    """
    shown = problem.shows(model, (), scales, FINE)
    t, beside = problem.t, _to_reversal(problem.t, shown.v)
    turns = beside <= float(np.median(np.diff(t)))
    found = {}
    for c, y in problem.channels.items():
        left = y - shown.y[c]
        noise = channel_noise(t, left, 2.0 * np.pi / scales.omega)
        value, slope = shown.y[c], np.gradient(shown.y[c], t)
        found[c] = Uneven.of(c, t, left, value, slope, noise, _WINDOW, _QUINTIC, turns)
    worst, share = max(one.jitter for one in found.values()), max(one.share for one in found.values())
    if max(worst, share) <= 0.0:
        return problem
    level = {c: problem.level[c] * one.level for c, one in found.items()}
    counts = {c: (beside > _BESIDE * worst) | (c != "a") for c in problem.channels}
    return replace(problem, level=level, jitter=worst, share=share).weighted(counts)


def likelihood(found: Fit, problem: Problem, weight: Mapping[str, FloatArray]) -> float:
    """BIC of a fit under noise of unknown level, more of it by ``Problem.level``, over samples with a weight (n,)."""
    total = 0.0
    for c, left in problem.left(found.shown).items():
        used, level = weight[c] > 0.0, problem.level[c]
        even = (left / level)[used]
        total += even.size * math.log(float(np.mean(even**2))) + 2.0 * float(np.sum(np.log(level[used])))
    return total + len(found.free) * math.log(problem.points)


def _to_reversal(t: FloatArray, v: FloatArray) -> FloatArray:
    """Time (n,), s, from each sample to the nearest at which the speed v (n,) changes its sign."""
    at = np.flatnonzero(np.sign(v[1:]) != np.sign(v[:-1]))
    if not at.size:
        return np.full(t.size, np.inf)
    share = v[at] / (v[at] - v[at + 1])
    times = t[at] + share * (t[at + 1] - t[at])
    after = np.clip(np.searchsorted(times, t), 1, max(times.size - 1, 1))
    ends = np.stack((times[np.minimum(after - 1, times.size - 1)], times[np.minimum(after, times.size - 1)]))
    return np.asarray(np.min(np.abs(t - ends), axis=0), dtype=np.float64)
