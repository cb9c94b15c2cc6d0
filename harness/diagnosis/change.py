"""What changed of a machine between two conditions: each recording read by itself, held against one another jointly."""

from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace

import numpy as np

from harness.core.arrays import FloatArray
from harness.core.errors import SimulationError
from harness.diagnosis.fit.model_fit import Fit, fit
from harness.diagnosis.fit.standard_errors import covariances, unit_of
from harness.diagnosis.kinds.known import kind_of
from harness.diagnosis.outcome import Outcome
from harness.diagnosis.parameters import Free, base_of, free_of
from harness.diagnosis.pooling.own import SAID
from harness.diagnosis.problem import Problem
from harness.diagnosis.rules import MOST_MOVED, MOVED, REPEATS, REPEATS_KNOWN, REPEATS_SPRING
from harness.estimate.changed import Changed, Conditions, Repeats
from harness.kernels.solve import Scales
from harness.model.model import Model, ModelTerm, Restoring
from harness.model.term import Term

INERTIA = "inertia"
"""Of a mass that is not known: all forces per mass change in proportion."""
_UNITS = {"m": "kg", "k": "N/m", "c": "N s/m", "f_k": "N"}
_TOLD = ("main_effect", "missing_physics")


@dataclass(frozen=True, slots=True)
class Number:
    """What conditions are compared by. name : "f_k", or "quadratic-drag.c2". said : what it is, in words."""

    name: str
    said: str
    unit: str


@dataclass(frozen=True, slots=True)
class Compared:
    """numbers : those of every recording. laws : that both conditions were read with. found : what changed."""

    numbers: tuple[Number, ...]
    laws: tuple[str, ...]
    found: Changed


def laws_of(outcomes: Sequence[Outcome]) -> tuple[Model, ...]:
    """The model of each condition that names something, with what it names; laws with a size and no clock."""
    found = []
    for outcome in outcomes:
        named = [e for e in outcome.refined.model.terms if outcome.verdict in _TOLD and _has_a_size(e.term)]
        if named:
            found.append(replace(outcome.refined.model, terms=tuple(named)))
    return tuple(found)


def _has_a_size(term: Term) -> bool:
    return term.searched and term.amplitude is not None and term.phase is None


def compared(before: Sequence[Problem], after: Sequence[Problem], named: Sequence[Model]) -> Compared:
    """Which numbers of a machine changed; named : see ``laws_of``. Raises InputError, SimulationError."""
    laws = tuple({e.term.name: e for model in reversed(named) for e in model.terms}.values())
    sides = [[_read(one, laws, named) for one in side] for side in (before, after)]
    read = [one for side in sides for one in _as_the_best(side, laws)]
    names = [name for name in read[0].at if all(name in one.at for one in read)]
    values = np.array([[one.found.values[one.at[name]] for name in names] for one in read])
    within = _known(np.array([one.covariance(names) for one in read]))
    told = np.diagonal(within, axis1=1, axis2=2).min(axis=0) > 0.0
    names = [name for name, known in zip(names, told.tolist(), strict=True) if known]
    values, within = values[:, told], within[:, told][:, :, told]
    problem = before[0]
    relative = np.array([(REPEATS_SPRING if name == "k" else REPEATS).value for name in names])
    conditions = Conditions(
        names,
        values,
        within,
        np.arange(len(read)) >= len(before),
        _together(names, problem),
        Repeats(relative, REPEATS_KNOWN.value),
    )
    numbers = tuple(_number(name, problem, laws) for name in names)
    most = min(MOST_MOVED.count, len(names))
    return Compared(numbers, tuple(e.term.name for e in laws), conditions.compared(MOVED.value, most))


@dataclass(frozen=True, slots=True)
class _Read:
    """A recording with its model."""

    problem: Problem
    found: Fit
    scales: Scales

    @property
    def at(self) -> dict[str, int]:
        """Place of each number among those that are fitted, by name."""
        return {f.name: i for i, f in enumerate(self.found.free) if f.name in _UNITS or isinstance(f.by, tuple)}

    def fits(self, physics: Sequence[Model], laws: Sequence[ModelTerm]) -> list[Fit]:
        """With all laws, begun from each of these models; those that can be followed."""
        found: list[Fit] = []
        for one in physics:
            model = _beside(self.found.model, one, laws)
            free = tuple(f for f in free_of(model, base_of(self.found.free)) if _sized(f, laws))
            with suppress(SimulationError):
                found.append(fit(model, self.problem, free, self.scales))
        return found

    def covariance(self, names: Sequence[str]) -> FloatArray:
        """Of these numbers (p, p), the one that lets less through; nan of what it does not tell."""
        at = [self.at[name] for name in names]
        matrices = covariances(self.found, self.problem, self.scales.omega, explained=False)
        found = max(matrices, key=lambda one: float(np.sum(np.log(np.diag(one)[at] + 1e-300))))[np.ix_(at, at)]
        told = (np.diag(found) > 0.0) & np.isfinite(np.diag(found))
        return np.where(np.outer(told, told), found, np.where(np.eye(len(at)) > 0.0, np.nan, 0.0))


def _read(problem: Problem, laws: Sequence[ModelTerm], named: Sequence[Model]) -> _Read:
    """A recording fitted with all laws, from its base fit without any and from each model that names one."""
    based = kind_of(problem).fit_base(problem)
    read = _Read(based.problem, based.fit, based.scales)
    if not laws:
        return read
    fits = read.fits([based.fit.model, *named], laws)
    if not fits:
        raise SimulationError("a recording cannot be simulated with the terms found")
    return replace(read, found=min(fits, key=lambda one: one.chi2))


def _as_the_best(read: Sequence[_Read], laws: Sequence[ModelTerm]) -> Iterator[_Read]:
    """Each recording of a condition, begun once more as the one of them that is followed best."""
    best = min(read, key=lambda one: one.found.chi2 / one.found.points)
    for one in read:
        fits = one.fits([best.found.model], laws) if laws and one is not best else []
        yield replace(one, found=min([one.found, *fits], key=lambda found: found.chi2))


def _beside(own: Model, physics: Model, laws: Sequence[ModelTerm]) -> Model:
    """A recording's own start with the physics of a model: its laws as large as they are in it, nothing of others."""
    sizes = {e.term.name: e.values for e in physics.terms}
    terms = []
    for entry in laws:
        place = entry.term.amplitude
        assert place is not None
        none = entry.term.parameters[place].none
        size = sizes[entry.term.name][place] if entry.term.name in sizes else none
        values = tuple(size if i == place and size is not None else v for i, v in enumerate(entry.values))
        terms.append(replace(entry, values=values))
    moved = {stem: getattr(physics, stem) for stem in ("c", "k", "f_k")}
    return replace(own, terms=tuple(terms), **moved)


def _sized(f: Free, laws: Sequence[ModelTerm]) -> bool:
    """Whether a number is of the base, or says how much of a law there is: its form stays as it was found."""
    return isinstance(f.by, str) or f.by[1] == laws[f.by[0]].term.amplitude


def _known(within: FloatArray) -> FloatArray:
    """Covariances (n, p, p) with the typical variance of the others where a recording does not tell a number.

    A number on its bound is as well known as in a recording that shows it; 0 of what none tells.
    """
    found = within.copy()
    for i in range(within.shape[1]):
        own = within[:, i, i]
        typical = float(np.nanmean(own)) if np.any(np.isfinite(own)) else 0.0
        found[:, i, i] = np.where(np.isfinite(own), own, typical)
    return found


def _together(names: Sequence[str], problem: Problem) -> dict[str, np.ndarray]:
    """Further directions: a mass that nobody knows, of which a bob's pulls it back in proportion.

    A measured force is none per mass: where it does not show the mass, no other force moves with it.
    """
    if "m" in names or not problem.moves or problem.drive is not None:
        return {}
    bob = problem.restoring is Restoring.PENDULUM
    return {INERTIA: np.array([not (bob and name == "k") for name in names])}


def _number(name: str, problem: Problem, laws: Sequence[ModelTerm]) -> Number:
    if name in _UNITS:
        return Number(name, SAID[name], unit_of(_UNITS[name], problem))
    entry = next(e for e in laws if name.startswith(f"{e.term.key}."))
    amplitude = entry.term.amplitude
    assert amplitude is not None
    return Number(name, entry.term.name.replace("-", " "), unit_of(entry.term.parameters[amplitude].unit, problem))
