"""Driven recordings pooled, as far as their forces allow: what differs is each one's own, and is said.

The base model is fitted to the force of each by itself. The differences of its numbers are held against the errors of
both, jointly, as an F of as many values as the forces count as: what is left of a force is coloured, and its errors
are those of Newey and West (see ``Fit.covariance``). Where they differ by more, each number is made every
recording's own in turn, and held against the best law of the catalogue that all would share.
"""

from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass, replace

import numpy as np

from harness.core.arrays import FloatArray
from harness.core.errors import SimulationError
from harness.diagnosis.baseline.base_fit import driven_scales
from harness.diagnosis.baseline.words import evidence
from harness.diagnosis.fit.model_fit import Fit, fit
from harness.diagnosis.fit.standard_errors import base_parameters
from harness.diagnosis.inverse_dynamics.search import extended, moving
from harness.diagnosis.inverse_dynamics.strokes import force_words
from harness.diagnosis.parameters import base_of, free_of
from harness.diagnosis.pooling.own import CANDIDATES, Alone, Compared
from harness.diagnosis.pooling.pooled import MOST, Pooled
from harness.diagnosis.problems.forces_together import ForcesTogether, begun_alike
from harness.diagnosis.problems.inverse import InverseDynamics
from harness.diagnosis.rules import DECISIVE, OWN, POOLED
from harness.diagnosis.search.search import under
from harness.kernels.solve import Scales
from harness.model.elsewhere import named
from harness.model.model import Model, Restoring

_PHYSICS = ("m", "c", "k", "f_k")


@dataclass(frozen=True, slots=True)
class Freed:
    """A model with one more parameter of each recording's own. gain : evidence over the one without."""

    stem: str
    problem: ForcesTogether
    fit: Fit
    gain: float


def shared_forces(problem: ForcesTogether) -> Pooled[ForcesTogether]:
    """Recordings whose base parameters differ have one or two of their own, if that says more than the catalogue does.

    Raises SimulationError when little moves or the base model cannot be fitted.
    """
    scales = driven_scales(problem, problem.first)
    fits = [fit(one.first, one, free_of(one.first, one.base_names), scales) for one in problem.each]
    problem = problem.under_levels([max((f.chi2 / f.residual.size) ** 0.5, 1e-300) for f in fits])
    alone = tuple(_alone(one, f, scales) for one, f in zip(problem.each, fits, strict=True))
    seen = _compared(alone, fits)
    base = fit(problem.first, problem, free_of(problem.first, problem.base_names), scales)
    if seen.chance < POOLED.value:
        problem, base = _parted(base, problem, scales)
    return Pooled(problem, _shown(base, problem, scales), scales, seen)


def unmasked_forces(found: Model, before: Pooled[ForcesTogether]) -> Pooled[ForcesTogether] | None:
    """Recordings with one more parameter of their own, where one shows beside the laws that were found."""
    problem, scales = before.problem, before.scales
    if not found.terms or len(before.own) >= MOST:
        return None
    each = freed(fit(found, problem, free_of(found, problem.base_names), scales), problem, scales)
    if not each or each[0].gain < OWN.value + DECISIVE.value:
        return None
    problem = each[0].problem
    base = fit(problem.first, problem, free_of(problem.first, problem.base_names), scales)
    return replace(before, problem=problem, base=_shown(base, problem, scales))


def _shown(found: Fit, problem: InverseDynamics, scales: Scales) -> Fit:
    """Under the level that it leaves, with its motion. Raises SimulationError."""
    level = problem.levelled(found.residual, found.memory.independent)
    return moving(under(found, level), level, scales)


def freed(found: Fit, problem: ForcesTogether, scales: Scales) -> list[Freed]:
    """Every parameter that may differ, alone, most evidence first."""
    more = len(problem.each) - 1
    seen = []
    for stem in CANDIDATES:
        if stem in problem.own_names or (stem == "k" and problem.restoring is Restoring.NONE):
            continue
        other = problem.with_own((*problem.starts.own, stem))
        names = dict.fromkeys((*base_of(found.free), *(named(stem, r) for r in range(1, more + 1))))
        model = begun_alike(found.model, stem)
        with suppress(SimulationError):
            better = fit(model, problem, free_of(model, tuple(names)), scales)
            words = min(force_words(better.memory, problem.measured).pieces.count, better.memory.independent)
            gain = evidence(found.chi2, better.chi2, max(words, 1.0), more, float(len(CANDIDATES)))
            seen.append(Freed(stem, other, better, gain))
    return sorted(seen, key=lambda one: -one.gain)


def _parted(base: Fit, problem: ForcesTogether, scales: Scales) -> tuple[ForcesTogether, Fit]:
    while len(problem.starts.own) < MOST:
        each = freed(base, problem, scales)
        if not each or each[0].gain < OWN.value:
            break
        best = each[0]
        laws = extended(base, problem, scales)
        independent = best.fit.memory.independent
        # a law that says as much leaves one machine, which is the simpler thing to say
        if laws and laws[0].bic_of(independent) < best.fit.bic_of(independent) + DECISIVE.value:
            break
        problem, base = best.problem, best.fit
    return problem, base


def force_alone(problem: InverseDynamics, model: Model, scales: Scales) -> Alone:
    """A recording by itself with the terms of a model. Raises SimulationError."""
    return _alone(problem, fit(model, problem, free_of(model, problem.base_names), scales), scales)


def _alone(problem: InverseDynamics, found: Fit, scales: Scales) -> Alone:
    shown = _shown(found, problem, scales)
    return Alone(problem, shown, scales, True, base_parameters(shown, problem, scales.omega, True))


def _compared(alone: tuple[Alone, ...], fits: Sequence[Fit]) -> Compared:
    """Chi-square of what recordings say about what they say together, and the values that its errors rest on."""
    names = [name for name in _PHYSICS if all(name in base_of(f.free) for f in fits)]
    size = len(names)
    precision, weighed = np.zeros((size, size)), np.zeros(size)
    each: list[tuple[FloatArray, FloatArray]] = []
    for one, found in zip(alone, fits, strict=True):
        at = [[f.name for f in found.free].index(name) for name in names]
        covariance, values = found.covariance()[np.ix_(at, at)], one.fit.values[at]
        told = np.diag(covariance) > 0.0
        inverse = np.zeros((size, size))
        if np.any(told):
            inverse[np.ix_(told, told)] = np.linalg.pinv(covariance[np.ix_(told, told)], hermitian=True)
        precision, weighed = precision + inverse, weighed + inverse @ values
        each.append((values, inverse))
    mean = np.linalg.pinv(precision, hermitian=True) @ weighed
    chi2 = sum(float((values - mean) @ inverse @ (values - mean)) for values, inverse in each)
    independent = min(f.memory.independent - len(f.free) for f in fits)
    return Compared(alone, chi2, size * (len(fits) - 1), max(independent, 1.0))
