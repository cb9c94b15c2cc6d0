"""Which terms: forward by full fits of what the screen lets through, pairs from several singles, pruned by BIC."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial

from harness.core.budget import counted
from harness.core.cores import each
from harness.core.errors import SimulationError
from harness.diagnosis.baseline.base_fit import at_rest
from harness.diagnosis.fit.model_fit import Fit, chi2_of, fit
from harness.diagnosis.fit.swing_fit import Swing, swung
from harness.diagnosis.parameters import base_of, free_of, with_friction
from harness.diagnosis.problem import Problem
from harness.diagnosis.problems.simulated import COARSE
from harness.diagnosis.rules import DECISIVE, PERIOD_SEEN
from harness.diagnosis.search.against import far_out
from harness.diagnosis.search.few_pieces import for_looks
from harness.diagnosis.search.look import Look, Recorded, within
from harness.diagnosis.search.screen import Candidate
from harness.kernels.solve import Scales
from harness.model.model import Model
from harness.model.registry import NAMED
from harness.model.term import Term

_COARSE_SAMPLES = 1200
_COARSE_ITERATIONS = 6
_FIRST_ITERATIONS = 3
_SWING_ITERATIONS = 12
_KEPT_STARTS, _GONE_ON_WITH = 2, 12
"""Samples and iterations of first looks (the last of a swing's), starts of a law and laws that are gone on with.

They bound the work.
"""
_EARLY = 0.5
"""Share of a recording in which phases have not yet parted, so that a law promises what it would."""
_FINALISTS, _SURE_FINALISTS, _NEAR_BEST = 8, 3, 0.1
"""Laws fitted to all samples: at most, in any case, and while they gain this share of the best."""
_MISPLACED, _MISPLACED_SHARE = 150.0, 0.02
"""What a fit may lose by an event on the wrong side of a sample."""


@dataclass(frozen=True, slots=True)
class Step:
    """Fits of one more term each on a model, best first by BIC, one per catalogue key.

    begun : where first looks left each law, best first; from there it is gone on with elsewhere.
    """

    before: Fit
    fits: tuple[Fit, ...]
    begun: tuple[Model, ...] = ()


def key_of(found: Fit) -> tuple[str, ...]:
    """Catalogue names of a fit's terms, sorted."""
    return tuple(sorted(entry.term.name for entry in found.model.terms))


def _said(model: Model) -> str:
    """The terms of a model, for people."""
    return " with ".join(entry.term.name for entry in model.terms)


def _try(model: Model, problem: Problem, base: tuple[str, ...], scales: Scales, iterations: int) -> Fit | None:
    try:
        return fit(model, problem, free_of(model, base), scales, iterations, COARSE, thorough=False)
    except SimulationError:
        return None


def _by_swing(
    model: Model, swing: Swing | None, base: tuple[str, ...], scales: Scales, iterations: int
) -> Model | None:
    """By amplitude and phase; None where these are not seen."""
    if swing is None:
        return None
    try:
        return swung(model, swing, free_of(model, base), scales, iterations)
    except SimulationError:
        return None


def _nearest(models: Sequence[Model | None], problem: Problem, scales: Scales) -> Model:
    """Of those that there are."""
    there = [m for m in models if m is not None]
    return min(there, key=lambda m: chi2_of(m, problem, scales, COARSE)) if len(there) > 1 else there[0]


def _start(
    candidate: Candidate,
    problem: Problem,
    early: Problem,
    swing: Swing | None,
    base: tuple[str, ...],
    scales: Scales,
) -> Fit | None:
    """A first few steps from the candidate, or from where its swing or the first part of the recording leads."""
    start = _nearest((candidate.model, candidate.short), problem, scales)
    first = _by_swing(start, swing, base, scales, _FIRST_ITERATIONS)
    if first is None:
        found = _try(start, early, base, scales, _FIRST_ITERATIONS)
        first = None if found is None else found.model
    return _try(_nearest((start, first), problem, scales), problem, base, scales, _FIRST_ITERATIONS)


def _rough(candidates: Sequence[Candidate], problem: Problem, base: tuple[str, ...], scales: Scales) -> list[Fit]:
    """A rough fit of every entry, best first: a few steps of every start, then the nearest of each entry go on."""
    early = problem.first_part(_EARLY)
    swing = Swing.of(problem, scales.omega)
    starts = each(
        lambda c: _start(c, problem, early, swing, base, scales), candidates, lambda c: f"trying {_said(c.model)}"
    )
    begun: dict[str, list[Fit]] = {}
    for candidate, found in zip(candidates, starts, strict=True):
        if found is not None:
            begun.setdefault(candidate.term.key, []).append(found)
    groups = sorted(begun.values(), key=lambda g: min(f.chi2 for f in g))

    def best_of(place: int) -> Fit:
        group = sorted(groups[place], key=lambda f: f.chi2)
        nearest = group[:_KEPT_STARTS] if place < _GONE_ON_WITH else []
        further = (_gone_on(f.model, problem, swing, base, scales) for f in nearest)
        return min((*group, *(f for f in further if f is not None)), key=lambda f: f.bic)

    return sorted(each(best_of, range(len(groups))), key=lambda f: f.bic)


def _gone_on(model: Model, problem: Problem, swing: Swing | None, base: tuple[str, ...], scales: Scales) -> Fit | None:
    """More steps."""
    start = _nearest((model, _by_swing(model, swing, base, scales, _SWING_ITERATIONS)), problem, scales)
    return _try(start, problem, base, scales, _COARSE_ITERATIONS)


def _further(
    begun: Sequence[Model], current: Fit, problem: Problem, small: Problem, scales: Scales, terms: Sequence[Term]
) -> list[Fit]:
    """A rough fit of every entry, best first, from where each was begun and from one look at this recording."""
    base = _base(current, problem)
    swing = Swing.of(small, scales.omega)
    starts: dict[str, list[Model]] = {}
    for model in begun:
        starts.setdefault(model.terms[-1].term.key, []).append(model)
    looked: dict[str, Model] = {}
    for candidate in Look.at(current, problem, scales, terms).worthy():
        looked.setdefault(candidate.term.key, _nearest((candidate.model, candidate.short), small, scales))
    for key, model in looked.items():
        starts.setdefault(key, []).append(model)

    def best_of(group: Sequence[Model]) -> Fit | None:
        fits = (_gone_on(m, small, swing, base, scales) for m in group)
        return min((f for f in fits if f is not None), key=lambda f: f.bic, default=None)

    best = each(best_of, tuple(starts.values()), lambda g: f"trying {_said(g[0])}")
    return sorted((f for f in best if f is not None), key=lambda f: f.bic)


def _candidates(current: Fit, problem: Problem, scales: Scales, terms: Sequence[Term]) -> list[Candidate]:
    """What a first look lets through, of the whole recording and of its first part alone.

    In the first part a misfit has not grown yet, so that the first-order answer is a good one.
    """
    worthy = Look.at(current, problem, scales, terms).worthy()
    first = opening(current, problem, scales, terms)
    if first is not None:
        # laws that no first look can tell of begin where the whole recording leaves its numbers, here as well
        worthy += [c for c in first.worthy() if c.term.amplitude is not None]
    rubbing = _with_friction(current, problem, scales)
    if rubbing is not None:
        worthy += Look.at(rubbing, problem, scales, terms).worthy()
    return worthy


def _ending(look: Look, scales: Scales) -> list[Candidate]:
    """What may bring a model near the noise, by the whole recording or by its first part."""
    ending = look.ending()
    first = opening(look.fitted, look.part, scales, look.terms)
    if first is not None:
        ending += [c for c in first.ending() if c.term.amplitude is not None]
    rubbing = _with_friction(look.fitted, look.part, scales)
    if rubbing is not None:
        ending += Look.at(rubbing, look.part, scales, look.terms).ending()
    return ending


def opening(current: Fit, problem: Problem, scales: Scales, terms: Sequence[Term]) -> Look | None:
    """A look at the first part alone, with the model fitted to it; None where it cannot be."""
    early = problem.first_part(_EARLY)
    before = _try(current.model, early, base_of(current.free), scales, _COARSE_ITERATIONS)
    return None if before is None else Look.at(before, early, scales, terms)


def _with_friction(current: Fit, problem: Problem, scales: Scales) -> Fit | None:
    """A model whose friction has vanished, with half of its damping given back to it; None where it has not.

    What is missing may have taken friction's place in the base. Laws that bend or modulate friction then answer to
    nothing, and are looked for from here.
    """
    split = with_friction(current.model, base_of(current.free), scales)
    if split is None:
        return None
    try:
        return fit(split, problem, current.free, scales, 0, COARSE, thorough=False)
    except SimulationError:
        return None


def _base(current: Fit, problem: Problem) -> tuple[str, ...]:
    """What is fitted beside the laws."""
    return tuple(dict.fromkeys((*base_of(current.free), *problem.starts.names)))


@counted()
def extend(
    current: Fit,
    problem: Problem,
    scales: Scales,
    terms: Sequence[Term] = NAMED,
    begun: Sequence[Model] = (),
    look: Look | None = None,
    also: Sequence[Model] = (),
) -> Step:
    """Fit every term that is worth it on top of a model.

    begun : models with one term more, from another search of the same motion; they stand for most of the first looks.
    look : at the model; a term is worth a fit only if it may bring it near the noise then. also : models with one term
    more that are worth a fit whatever a look says.
    """
    base = _base(current, problem)
    small, _ = for_looks(current, problem, scales, _COARSE_SAMPLES)
    if begun:
        best = _further(begun, current, problem, small, scales, terms)
    else:
        worthy = _candidates(current, problem, scales, terms) if look is None else _ending(look, scales)
        asked = (Candidate(model.terms[-1].term, model, math.inf) for model in also)
        best = _rough((*worthy, *asked), small, base, scales)
    return _finished(best, current, problem, small, scales)


@counted()
def pair_up(starts: Sequence[Sequence[Model]], current: Fit, problem: Problem, scales: Scales) -> Step:
    """Fit models of two laws that are worth it whatever a look says, each from the best of its own starts.

    current : what they are held against, and whose base numbers are free.
    """
    base = _base(current, problem)
    small, _ = for_looks(current, problem, scales, _COARSE_SAMPLES)

    def best_of(models: Sequence[Model]) -> Fit | None:
        first = (_try(m, small, base, scales, _FIRST_ITERATIONS) for m in models)
        begun = sorted((f for f in first if f is not None), key=lambda f: f.chi2)
        return None if not begun else _try(begun[0].model, small, base, scales, _COARSE_ITERATIONS) or begun[0]

    rough = each(best_of, starts, lambda models: f"trying {_said(models[0])}")
    return _finished(sorted((f for f in rough if f is not None), key=lambda f: f.bic), current, problem, small, scales)


def _finished(best: Sequence[Fit], current: Fit, problem: Problem, small: Problem, scales: Scales) -> Step:
    """Rough fits to ``small``, best first, as fits to all samples."""
    base = _base(current, problem)
    # a law's release from rest is found once it is settled, and the model's has been: till then both have speeds to pay
    before = current.bic + (len(base) - len(base_of(current.free))) * math.log(max(problem.points, 2))
    finalists = _finalists(best, chi2_of(current.model, small, scales, COARSE) + before - current.chi2)
    fitted = each(lambda f: _quick(f.model, problem, base, scales), finalists, lambda f: f"fitting {_said(f.model)}")
    quick = sorted((q for q in fitted if q is not None), key=lambda f: f.bic)
    fits: dict[tuple[str, ...], Fit] = {}
    reach = max(_MISPLACED, _MISPLACED_SHARE * (before - quick[0].bic)) if quick else 0.0

    # under a force in few pieces reversals lie beside where they are, and a hasty fit leaves them there
    beside = small.drive is not problem.drive

    def settled(hasty: Fit) -> Fit:
        near = hasty.bic - (far_out(hasty) if beside else 0.0) < min(quick[0].bic + reach, before)
        return settle(hasty, problem, scales) if near else hasty

    for found in each(settled, quick, lambda f: f"settling {_said(f.model)}"):
        key = key_of(found)
        if _is_seen(found, problem) and (key not in fits or found.bic < fits[key].bic):
            fits[key] = found
    return Step(current, tuple(sorted(fits.values(), key=lambda f: f.bic)), tuple(f.model for f in best))


def _is_seen(found: Fit, problem: Problem) -> bool:
    """Whether what was recorded holds a period over the travel, half a one in time, and what else each law needs."""
    seen = replace(Recorded.of(problem.t, found.shown.x, "driven" in problem.given), span=problem.duration)
    return all(within(entry, found.model.f_k, seen, PERIOD_SEEN.value) for entry in found.model.terms)


def _finalists(rough: Sequence[Fit], before: float) -> list[Fit]:
    """Rough fits, best first, that go on: the first ones, and those that come near; before : BIC without the entry.

    Where the best promises less than what an event on the wrong side of a sample costs, all come near.
    """
    most = before - rough[0].bic if rough else 0.0
    reach = _NEAR_BEST * most if most > _MISPLACED else -DECISIVE.value
    return [f for i, f in enumerate(rough[:_FINALISTS]) if i < _SURE_FINALISTS or before - f.bic > reach]


def _quick(model: Model, problem: Problem, base: tuple[str, ...], scales: Scales) -> Fit | None:
    try:
        return fit(model, problem, free_of(model, base), scales, thorough=False)
    except SimulationError:
        return None


def settle(found: Fit, problem: Problem, scales: Scales) -> Fit:
    """The same model fitted with care about jumps, released from rest if that serves as well."""
    try:
        return at_rest(fit(found.model, problem, found.free, scales), problem, scales)
    except SimulationError:
        return found


def prune(found: Fit, problem: Problem, scales: Scales) -> tuple[Fit, tuple[Fit | None, ...]]:
    """Leave out each term that BIC does not miss; and what is left, without each of its terms in turn.

    The latter are fitted again; None where that cannot be simulated.
    """
    while found.model.terms:
        smaller = tuple(each(partial(_without, found, problem, scales), range(len(found.model.terms))))
        best = min((f for f in smaller if f is not None), key=lambda f: f.bic, default=None)
        if best is None or best.bic > found.bic + DECISIVE.value:
            return found, smaller
        found = best
    return found, ()


def _without(found: Fit, problem: Problem, scales: Scales, index: int) -> Fit | None:
    model = replace(found.model, terms=found.model.terms[:index] + found.model.terms[index + 1 :])
    try:
        return fit(model, problem, free_of(model, base_of(found.free)), scales)
    except SimulationError:
        return None
