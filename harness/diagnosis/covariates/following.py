"""How a measured covariate enters: as a force, on friction or on damping, each fitted beside the base model.

The three are compared by what they leave, in values that count as independent.

What the noise of a covariate does: the slider has not felt it, a simulation that is given the column does.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from harness.core.arrays import FloatArray
from harness.core.errors import InputError, SimulationError
from harness.diagnosis.covariates.values import NAMED, Acting, Rival, little, said
from harness.diagnosis.fit.model_fit import Fit, evaluate, fit
from harness.diagnosis.input_noise.propagation import force_noise
from harness.diagnosis.parameters import base_of, free_of, with_friction
from harness.diagnosis.problem import P, Problem
from harness.diagnosis.rules import COVARIATE_VARIES
from harness.estimate.noise import Noise
from harness.kernels.solve import Scales
from harness.model.covariate import Acts
from harness.model.model import Model

_LEAST = 0.1
"""Of the variance that is left of an acceleration, what is the sensor's own in any case."""


def allowing(problem: P, base: Fit) -> P:
    """The problem with the noise of its covariates, as a force, allowed for where it shows; base : a fit of it."""
    model, variance = base.model, 0.0
    sigma = {one.name: one.noise.sigma for one in problem.acting}
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


_BLOCK = 10
"""Samples whose mean counts as one value of a covariate."""
_ALONE = 1e-9
"""Share of a column's squares below which others say it whole, but for rounding."""


@dataclass(frozen=True, slots=True)
class Entered:
    """The base model with its covariates, what was found of how they enter, and a sentence on each."""

    fit: Fit
    acting: tuple[Acting, ...]
    said: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class _Way(Rival):
    """A way in, fitted; share : of what it does that neither the base model nor time says."""

    fit: Fit
    share: float


def enter(base: Fit, problem: Problem, scales: Scales) -> Entered:
    """The covariates of a problem, one after another, each where it enters best.

    Raises InputError for one that follows from the base model and time, SimulationError where none can be simulated.
    """
    fitted, acting, sentences = base, list(problem.acting), []
    for i, one in enumerate(acting):
        ways, refused = _ways(one, fitted, problem, scales)
        if not ways and refused:
            parts = ", ".join(f"as {NAMED[acts]} {100.0 * (1.0 - share):.3g} %" for acts, share in refused.items())
            accepted = "one that varies by itself beyond its noise"
            raise InputError(
                f"{one.file}: covariate {one.name}", f"the base model and time say what it does: {parts}", accepted
            )
        if not ways:
            raise SimulationError(f"no model with {one.name} could be simulated")
        best = ways[0]
        sentence = said(ways, fitted.residual, one.asked, tuple(refused))
        sentences.append(f"{sentence}{little(one.name, best.share)}")
        acting[i], fitted = replace(one, acts=best.covariate.acts), best.fit
    return Entered(fitted, tuple(acting), tuple(sentences))


def _ways(one: Acting, base: Fit, problem: Problem, scales: Scales) -> tuple[Sequence[_Way], dict[Acts, float]]:
    """Ways in, the best first, and those that are refused with the share that is their own."""
    found, refused = [], {}
    for acts in Acts if one.acts is None else (one.acts,):
        # a spring's unknown zero and a force's level are the same
        covariate = one.entering(acts, "offset" not in base_of(base.free) and "x" in problem.channels)
        model = base.model
        if acts is Acts.FRICTION:
            model = with_friction(model, base_of(base.free), scales) or model
        start = replace(model, covariates=(*model.covariates, covariate))
        try:
            share, noisy = _own(one, start, base, problem, scales)
            if noisy:
                refused[acts] = share
                if not (problem.alone and covariate.has_level):
                    continue
                # of several the same push all the time, which none of its variation needs to tell
                start = replace(model, covariates=(*model.covariates, replace(covariate, known=True)))
            fitted = fit(start, problem, free_of(start, base_of(base.free)), scales, thorough=False)
        except SimulationError:
            continue
        found.append(_Way(fitted.model.covariates[-1], fitted.residual, fitted, share))
    return sorted(found, key=lambda way: way.fit.chi2), refused


def _own(one: Acting, start: Model, base: Fit, problem: Problem, scales: Scales) -> tuple[float, bool]:
    """Share of what a covariate does that neither the base nor the same effect in proportion to time says.

    And whether that is too little beside the covariate's noise for a fit of its gain.
    """
    free = free_of(start, base_of(base.free))
    at = [f.name for f in free].index(start.covariates[-1].parameter)
    others, t = np.arange(len(free)) != at, problem.t

    def columns(values: FloatArray) -> FloatArray:
        return evaluate(start, problem.giving(one.name, values), free, scales)[1]

    jacobian = evaluate(start, problem, free, scales)[1]
    change, steady = jacobian[:, at], columns(np.full(t.size, one.about + 1.0))[:, at]
    in_time = columns(one.about + t - float(np.mean(t)))[:, at]
    alone = _left(change, steady[:, None])
    rest = _left(change, np.column_stack((jacobian[:, others], steady, in_time)))
    left, whole = float(rest @ rest), max(float(alone @ alone), 1e-300)
    least = (COVARIATE_VARIES.value * one.noise.of_means(_BLOCK).sigma) ** 2 * float(steady @ steady)
    return left / whole, left <= max(least, _ALONE * whole)


def _left(y: FloatArray, columns: FloatArray) -> FloatArray:
    """What columns (N, q) leave of y (N,)."""
    size = np.linalg.norm(columns, axis=0)
    table = columns[:, size > 0.0] / size[size > 0.0]
    left: FloatArray = y - table @ np.linalg.lstsq(table, y, rcond=1e-12)[0]
    return left
