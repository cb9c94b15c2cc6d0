"""Fits again from other shares of dry and viscous friction: a law of damping may stand for either of them.

How often the slider turns before it sticks jumps with f_k, so that a descent that begins with the base model's friction
ends where that friction is, though the law that was added would do without it.
"""

import math
from collections.abc import Iterator, Sequence
from dataclasses import replace

from harness.core.errors import SimulationError
from harness.diagnosis.fit.model_fit import Fit, fit
from harness.diagnosis.parameters import base_of
from harness.diagnosis.problem import Problem
from harness.kernels.solve import Scales
from harness.model.model import Model

_DRY = (0.0, 0.5)
"""Shares of the dry friction that is kept; the rest becomes viscous."""
_GIVEN = 0.5
"""Share of the damping that becomes dry where there is no dry friction."""
_NONE = 0.05
"""Share of the damping below which dry friction is none."""
_NEAR = 0.5
"""Fits that leave more than the first by this share of what it takes off are too far behind to catch up."""
_MOST = 8
_ITERATIONS = 20
_ROUNDS, _WORTH = 4, 0.9
"""Rounds at most, and the share of the squares below which a round has come nearer, so that another may."""
"""Fits that are tried again, and iterations of each: they bound the work."""


def resplit(fits: Sequence[Fit], problem: Problem, scales: Scales) -> list[Fit]:
    """The same laws, each from where its fit leaves least; fits : best first, one a law."""
    if not fits:
        return []
    base = max(f.chi2 for f in fits)
    least = min(f.chi2 for f in fits)
    near = sorted(fits, key=lambda f: f.chi2)[:_MOST]
    reached = [f for f in near if f.chi2 <= least + _NEAR * (base - least)]
    return [_best(f, problem, scales) if any(f is r for r in reached) else f for f in fits]


def _best(found: Fit, problem: Problem, scales: Scales) -> Fit:
    if "f_k" not in base_of(found.free):
        return found
    for _ in range(_ROUNDS):
        before = found.chi2
        found = _nearer(found, problem, scales)
        if found.chi2 > _WORTH * before:
            break
    return found


def _nearer(found: Fit, problem: Problem, scales: Scales) -> Fit:
    best = found
    for model in _others(found.model, scales):
        try:
            again = fit(model, problem, found.free, scales, _ITERATIONS, thorough=False)
        except SimulationError:
            continue
        if again.chi2 < best.chi2:
            best = again
    return best


def _others(model: Model, scales: Scales) -> Iterator[Model]:
    """Models of equal loss over a cycle of half the amplitude: 4 f_k X = pi c omega X^2."""
    dry_as_viscous = 4.0 / (math.pi * scales.omega * 0.5 * scales.x)
    viscous_as_dry = 1.0 / dry_as_viscous
    if model.f_k < _NONE * model.c * viscous_as_dry:
        yield replace(model, c=(1.0 - _GIVEN) * model.c, f_k=_GIVEN * model.c * viscous_as_dry)
        return
    for share in _DRY:
        yield replace(model, c=model.c + (1.0 - share) * model.f_k * dry_as_viscous, f_k=share * model.f_k)
