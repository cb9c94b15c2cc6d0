"""A long recording in few samples, for first looks: means of what a model leaves, added to what it shows.

A thinned recording throws away most of what it says. What a fitted model leaves over is slow beside the motion, so that
its means over short groups of samples keep nearly all of it, at the noise of a mean.
"""

import math
from dataclasses import replace

import numpy as np

from harness.diagnosis.fit.observe import Observation
from harness.diagnosis.problem import Problem
from harness.estimate.noise import Noise

_PER_CYCLE = 24
"""Groups a cycle is given at least: the third harmonic then keeps 96 % of its height."""


def condensed(problem: Problem, shown: Observation, samples: int, omega: float) -> tuple[Problem, float]:
    """A problem of about this many samples, and by how much its chi-square falls short of the whole one's.

    shown : what a model fitted to ``problem`` shows. omega : rad/s. A driven recording is thinned, since errors of its
    force travel from sample to sample.
    """
    n = problem.t.size
    cycles = omega * float(problem.t[-1] - problem.t[0]) / (2.0 * math.pi)
    size = int(n // max(samples, _PER_CYCLE * cycles))
    if size <= 1:
        return problem, 1.0
    if problem.restarts is not None:
        small = problem.part(slice(None, None, size))
        return small, problem.points / max(small.points, 1)
    first = np.arange(0, n - size + 1, size)
    middle = first + size // 2
    used = int(first[-1]) + size
    channels, weight = {}, {}
    for c, y in problem.channels.items():
        counts = problem.weight[c][:used]
        total = np.add.reduceat(counts, first)
        left = np.add.reduceat((y - shown.y[c])[:used] * counts, first)
        channels[c] = shown.y[c][middle] + left / np.maximum(total, 1e-300)
        weight[c] = np.sqrt(total / size)
    noise = {c: _of_means(value, size) for c, value in problem.noise.items()}
    force = problem.force_noise
    force = force if force is None else replace(force, averaged=True)
    problem = replace(problem, t=problem.t[middle], channels=channels, weight=weight, noise=noise, force_noise=force)
    return problem, 1.0


def _of_means(noise: Noise, size: int) -> Noise:
    """Noise of the mean of ``size`` neighbours whose colour is of first order."""
    lags = np.arange(1, size)
    shared = 1.0 + 2.0 * float(np.sum((1.0 - lags / size) * noise.phi**lags)) if noise.phi else 1.0
    return replace(noise, sigma=noise.sigma * math.sqrt(shared / size), phi=noise.phi**size)
