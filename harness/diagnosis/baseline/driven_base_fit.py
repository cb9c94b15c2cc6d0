"""The base fit of a driven recording, which its inverse dynamics start."""

import math
from dataclasses import replace
from itertools import product

import numpy as np

from harness.core.errors import SimulationError
from harness.diagnosis.baseline.base_fit import dominant_frequency
from harness.diagnosis.fit.model_fit import Fit, fit
from harness.diagnosis.fit.parameters import free_of
from harness.diagnosis.motion import motion_of
from harness.diagnosis.problem import Problem
from harness.diagnosis.problems.driven import Forced
from harness.kernels.solve import Scales
from harness.model.model import Model

_AT_ONCE = 1e3
"""Times faster than the motion: so fast answers a slider whose mass no force shows, and its time says nothing."""
_DRY = (1.0, 0.5, 1.5)
"""Shares of the dry friction that the inverse dynamics give, from which a driven fit starts."""


def driven_baseline(problem: Forced) -> tuple[Fit, Scales]:
    """The base model fitted to a driven recording, from the inverse dynamics and from less and more dry friction.

    Raises SimulationError when no start could be simulated.
    """
    model, scales = problem.first, driven_scales(problem, problem.first)
    names = problem.base_names
    best: Fit | None = None
    why = ""
    # smoothing rounds off a first motion out of rest, so that a start at rest is looked at too
    still = tuple(name for name in names if name != "v0")
    begun = ((0.0, still), (model.v0, names)) if "v0" in names else ((model.v0, names),)
    for share, (v0, base) in product(_DRY, begun):
        started = replace(model, f_k=share * model.f_k, v0=v0)
        try:
            found = fit(started, problem, free_of(started, base), scales, thorough=False)
        except SimulationError as error:
            why = str(error)
            continue
        if best is None or found.bic < best.bic:
            best = found
    if best is None:
        raise SimulationError(f"no base fit could be simulated: {why}")
    return best, scales


def driven_scales(problem: Problem, model: Model) -> Scales:
    """What counts as ordinary in a driven recording; without a spring omega is the motion's own."""
    if problem.alone:
        each = [driven_scales(one, model) for one in problem.alone]
        omega = float(np.exp(np.mean([math.log(one.omega) for one in each])))
        return Scales(max(one.x for one in each), max(one.v for one in each), omega)
    omega = math.sqrt(model.k / model.m)
    cycle = omega or dominant_frequency(problem.t, next(iter(problem.channels.values())))
    motion = motion_of(problem.t, problem.channels, cycle)
    if omega == 0.0:
        omega = math.sqrt(float(np.mean(motion.v**2))) / max(float(np.std(motion.x)), 1e-300)
    return Scales(0.5 * float(np.ptp(motion.x)), float(np.max(np.abs(motion.v))), omega)


def own_scales(problem: Problem, model: Model) -> Scales:
    """A model's own under the drive; those of the motion where the model has next to no mass."""
    own, seen = Scales.of(model, problem.drive), driven_scales(problem, model)
    return own if own.omega < _AT_ONCE * seen.omega else seen
