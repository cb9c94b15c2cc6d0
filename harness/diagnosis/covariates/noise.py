"""What the noise of a covariate does: the slider has not felt it, a simulation that is given the column does."""

import math
from dataclasses import replace

import numpy as np

from harness.diagnosis.fit.model_fit import Fit
from harness.diagnosis.input_noise.propagation import force_noise
from harness.diagnosis.problem import P
from harness.estimate.noise import Noise
from harness.model.covariate import Acts

_LEAST = 0.1
"""Of the variance that is left of an acceleration, what is the sensor's own in any case."""


def allowing(problem: P, base: Fit) -> P:
    """The problem with the noise of its covariates, as a force, allowed for where it shows; base : a fit of it."""
    model, variance = base.model, 0.0
    sigma = {one.name: one.noise for one in problem.acting}
    speed = math.sqrt(float(np.mean(base.shown.v**2)))
    for one in model.covariates:
        size = {Acts.FORCE: 1.0, Acts.FRICTION: model.f_k, Acts.DAMPING: model.c * speed}[one.acts]
        variance += (one.gain * size * sigma[one.name]) ** 2
    if variance == 0.0:
        return problem
    force = Noise(math.sqrt(variance), True)
    noise = dict(problem.noise)
    if "a" in noise:
        # what a simulation leaves of an acceleration has the force's noise in it
        seen = noise["a"].sigma ** 2
        noise["a"] = replace(noise["a"], sigma=math.sqrt(max(seen - variance / model.m**2, _LEAST * seen)))
    allowed = force_noise(model, base.shown, problem.t, force, noise)
    return problem if allowed is None else replace(problem, noise=noise, force_noise=allowed)
