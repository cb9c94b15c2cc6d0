"""Which base parameter recordings do not share: each in turn is made every recording's own, and fitted.

What each of several recordings says alone of the base parameters, and whether they say the same.

Viscous friction, spring and Coulomb friction are fitted to each by itself. Their differences are held against the
errors of both, joint over all: a recording's c and f_k are told apart poorly, and what one has more of the other
has less. Errors are those of a single recording (harness.diagnosis.fit.standard_errors): by curvature, by curvature
times what is left, and by what half-swings say; the one that lets most through decides.
"""

import math
from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from scipy.special import chdtrc, fdtrc

from harness.core.arrays import FloatArray
from harness.core.errors import SimulationError
from harness.core.quantity import Quantity
from harness.diagnosis.baseline.base_fit import baseline
from harness.diagnosis.baseline.words import Strokes, evidence, words_of
from harness.diagnosis.fit.model_fit import Fit, fit
from harness.diagnosis.fit.standard_errors import base_parameters, covariances
from harness.diagnosis.parameters import base_of, free_of
from harness.diagnosis.problem import Problem
from harness.diagnosis.problems.together import Together
from harness.diagnosis.residual_tests.structure import Left, left_by
from harness.diagnosis.search.extend import settle
from harness.diagnosis.search.search import noise_of, under
from harness.kernels.solve import Scales
from harness.model.elsewhere import Elsewhere, named
from harness.model.model import Model


@dataclass(frozen=True, slots=True)
class Alone:
    """A recording by itself. parameters : omega_n, zeta, x_k with standard errors."""

    problem: Problem
    fit: Fit
    scales: Scales
    explained: bool
    parameters: Mapping[str, Quantity]

    @classmethod
    def of(cls, found: Fit, problem: Problem, scales: Scales) -> "Alone":
        """By a model that was fitted to it."""
        explained = left_by(found, problem, scales.omega, found) is Left.NOISE
        return cls(problem, found, scales, explained, base_parameters(found, problem, scales.omega, explained))


@dataclass(frozen=True, slots=True)
class Compared:
    """What recordings say alone, and the chance that they would differ so much if they were of one machine as it was.

    chi2, freedom : of all differences. values : independent ones that the errors rest on.
    """

    alone: tuple[Alone, ...]
    chi2: float
    freedom: int
    values: float = math.inf

    @property
    def chance(self) -> float:
        """That recordings which agree differ so much."""
        if not self.freedom:
            return 1.0
        if math.isinf(self.values):
            return float(chdtrc(self.freedom, self.chi2))
        return float(fdtrc(self.freedom, self.values, self.chi2 / self.freedom))


def alone(problem: Problem) -> Alone:
    """A recording with its base fit. Raises InputError, SimulationError."""
    base, scales = baseline(problem)
    problem = replace(problem, noise=noise_of(base, problem, scales.omega))
    found = settle(under(base, problem), problem, scales)
    return Alone.of(found, problem, scales)


def compared(each: Sequence[Alone]) -> Compared:
    """Whether they say the same."""
    tests = [_differences(each, kind) for kind in range(min(len(_matrices(one)) for one in each))]
    chi2, freedom = min(tests, key=lambda one: one[0])
    return Compared(tuple(each), chi2, freedom)


def _matrices(one: Alone) -> tuple[FloatArray, ...]:
    return covariances(one.fit, one.problem, one.scales.omega, one.explained)


def _differences(each: Sequence[Alone], kind: int) -> tuple[float, int]:
    """Chi-square of what recordings say about what they say together, and its degrees of freedom."""
    physics = each[0].problem.physics
    size = len(physics)
    precision, weighed, seen = np.zeros((size, size)), np.zeros(size), np.zeros(size, dtype=np.int64)
    all_of_it = []
    for one in each:
        names = [f.name for f in one.fit.free]
        at = [names.index(name) for name in physics]
        matrices = _matrices(one)
        covariance = matrices[min(kind, len(matrices) - 1)][np.ix_(at, at)]
        values = one.fit.values[at]
        # a number on its bound has no error and says nothing; what is infinite says nothing either
        told = (np.diag(covariance) > 0.0) & np.isfinite(np.diag(covariance))
        inverse = np.zeros((size, size))
        if np.any(told):
            inverse[np.ix_(told, told)] = np.linalg.pinv(covariance[np.ix_(told, told)])
        precision, weighed, seen = precision + inverse, weighed + inverse @ values, seen + told
        all_of_it.append((values, inverse))
    mean = np.linalg.pinv(precision) @ weighed
    chi2 = sum(float((values - mean) @ inverse @ (values - mean)) for values, inverse in all_of_it)
    return chi2, int(np.sum(np.maximum(seen - 1, 0)))


_PHYSICS = ("c", "k", "f_k")
CANDIDATES = ("m", "k", "c", "f_k")
SAID = {"m": "inertia", "k": "stiffness", "c": "viscous damping", "f_k": "dry friction"}
"""What may differ, and what it is called."""


@dataclass(frozen=True, slots=True)
class Freed:
    """A model with one more parameter of each recording's own. gain : evidence over the one without."""

    stem: str
    problem: Together
    fit: Fit
    gain: float


def freed(found: Fit, problem: Together, scales: Scales, alone: Sequence[Model] = ()) -> list[Freed]:
    """Every parameter that may differ, alone, most evidence first.

    alone : the base model of each recording by itself, from which it is begun too.
    """
    words = words_of(Strokes.between(problem.turns(found.shown.v), problem.t.size))
    seen = []
    for stem in CANDIDATES:
        if stem in problem.starts.own or stem not in ("m", *problem.physics):
            continue
        with suppress(SimulationError):
            better = _fitted(found, problem, scales, stem, alone)
            more = len(problem.starts.stretches) - 1
            gain = evidence(found.chi2, better.chi2, words, more, float(len(CANDIDATES)))
            seen.append(Freed(stem, problem.with_own((*problem.starts.own, stem)), better, gain))
    return sorted(seen, key=lambda one: -one.gain)


def _fitted(found: Fit, problem: Together, scales: Scales, stem: str, alone: Sequence[Model]) -> Fit:
    best: Fit | None = None
    why: SimulationError | None = None
    names = [named(stem, r) for r in range(1, len(problem.starts.stretches))]
    for model in _begun(found.model, problem, stem, alone):
        try:
            one = fit(model, problem, free_of(model, (*base_of(found.free), *names)), scales, thorough=False)
        except SimulationError as error:
            why = error
            continue
        if best is None or one.chi2 < best.chi2:
            best = one
    if best is None:
        raise why or SimulationError("no start")
    return best


def _begun(model: Model, problem: Together, stem: str, alone: Sequence[Model]) -> list[Model]:
    """From where all are alike, and from where the recordings end alone."""
    further = (one.having(**{stem: float(getattr(model, stem))}) for one in model.elsewhere)
    alike = replace(model, elsewhere=tuple(Elsewhere(one.values) for one in further))
    return [alike, begun_apart(model, (*problem.own_names, stem), alone)] if alone else [alike]


def begun_apart(model: Model, stems: Sequence[str], each: Sequence[Model]) -> Model:
    """A model that begins where recordings end alone: with these numbers their own, and the median of what is shared.

    Numbers of laws too: beside what recordings differ in, those of all together are far from any of them.
    """
    own = [{stem: float(getattr(one, stem)) for stem in stems} for one in each]
    if "m" in stems and each[0].k > 0.0:
        # alone each is per unit of its own mass, which its frequency tells
        own = [{**values, "m": each[0].k / one.k * one.m} for values, one in zip(own, each, strict=True)]
    first: dict[str, Any] = own[0]
    elsewhere = tuple(Elsewhere(tuple(values.items())) for values in own[1:])
    return replace(median_of(model, each), elsewhere=elsewhere, **first)


def median_of(model: Model, others: Sequence[Model]) -> Model:
    """A model with the physics of others, every number of it and of its laws their median."""
    base: dict[str, Any] = {stem: float(np.median([getattr(other, stem) for other in others])) for stem in _PHYSICS}
    terms = []
    for entry in model.terms:
        same = [one.values for other in others for one in other.terms if one.term is entry.term]
        values = tuple(np.median(same, axis=0).tolist()) if same else entry.values
        terms.append(replace(entry, values=values))
    return replace(model, terms=tuple(terms), **base)
