"""Grades: which term is the main part of a misfit that nothing explains, and by what margin.

A real machine has one large omission and a crowd of small ones; no model of one or two terms meets its noise. So a term
is judged by its share of the misfit, by evidence that counts words and not samples, by its distance to every other
term, and by prediction of what it was not fitted to.
"""

import math
from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TypeVar

import numpy as np

from harness.core.cores import each
from harness.diagnosis.baseline.words import evidence, margin_of
from harness.diagnosis.fit.model_fit import Fit
from harness.diagnosis.fit.standard_errors import loosest
from harness.diagnosis.grading.chance import OF_MOTION, Odds, Seen, shared_out
from harness.diagnosis.grading.clocks import on_the_swing
from harness.diagnosis.grading.friction_split import resplit
from harness.diagnosis.grading.misfit import Misfit
from harness.diagnosis.grading.prediction import Predicted, free_run, held_out, ratio, surely_less, trained, worse_in
from harness.diagnosis.outcome import Grade
from harness.diagnosis.rules import (
    AMONG_ALIKE,
    GAIN,
    HELD_OUT,
    LEAST_CYCLES,
    LEAST_RATIO,
    LOOSE,
    MARGIN,
    MOST_LIKELY,
    MOST_LISTED,
    NEARLY_AS_MUCH,
    PREDICTS_BETTER,
    RUN_BETTER,
    RUNS_ON_BETTER,
    SAME_CLOCK,
    SHARE_OF_EXCESS,
    SHARE_OF_MISFIT,
    TAKEN,
    Rule,
)
from harness.diagnosis.search.against import in_company
from harness.diagnosis.search.extend import extend
from harness.diagnosis.search.look import evidence as starting_evidence
from harness.diagnosis.search.search import under
from harness.model.model import Model
from harness.model.registry import NAMED
from harness.model.term import Evidence

_FINALISTS = 4
"""Names whose predictions are computed."""


@dataclass(frozen=True, slots=True)
class Finalist:
    """A catalogue name, alone on the base.

    fit : under the noise of the misfit. gain : evidence over the base. share : of the misfit beyond the sensors' noise
    that it takes off; of_all : of the whole; company : of the misfit, beside the other name with which it leaves least.
    clock : whether it has a clock of its own on the swing. held, run : prediction of blocks that were left out, and of
    the last part from the first. loosest : largest standard error of its parameters, relative; leading : that of the
    number that says how much of the law there is, where a force is fitted. None and nan are what
    was not looked at.
    """

    fit: Fit
    gain: float
    share: float
    of_all: float
    clock: bool
    held: Predicted | None = None
    run: Predicted | None = None
    loosest: float = math.nan
    leading: float = math.nan
    company: float = math.nan

    @property
    def name(self) -> str:
        """Catalogue name."""
        return self.fit.model.terms[-1].term.name


@dataclass(frozen=True, slots=True, kw_only=True)
class Contest(ABC):
    """Finalists, and what they come to: grade and names, best first.

    base_held, base_run : prediction by the base. chance : of the first name to be the main effect, None where that was
    not asked. rules : those that decided.
    """

    finalists: tuple[Finalist, ...] = ()
    grade: Grade | None = None
    named: tuple[Finalist, ...] = ()
    base_held: Predicted | None = None
    base_run: Predicted | None = None
    chance: float | None = None
    rules: tuple[Rule, ...] = (GAIN,)

    @property
    @abstractmethod
    def words(self) -> float:
        """Independent words of what the base leaves."""

    @property
    @abstractmethod
    def cycles(self) -> float:
        """Full swings that say something new."""

    @property
    @abstractmethod
    def words_run(self) -> float:
        """Words of the part that a free run predicts."""

    @property
    @abstractmethod
    def refined(self) -> Fit:
        """The best model found, the base where nothing helps."""

    @property
    @abstractmethod
    def odds(self) -> Odds:
        """By which a name that stands apart is the main effect."""

    def chance_of(self, first: Finalist) -> float:
        """Of a name that stands apart to be the main effect, as simulated machines that look like this one say."""
        return self.odds.chance(self.seen(first))

    @property
    def standing(self) -> tuple[Finalist, ...]:
        """Finalists that may be listed: none that surely predicts a channel worse than the base."""
        return tuple(f for f in self.finalists if not worse_in(f.held, self.base_held, PREDICTS_BETTER.value))

    @property
    def posterior(self) -> dict[str, float]:
        """Probability of each name to be the main effect, and under "" of none to be: most likely first.

        A clock on the swing follows any other, so that what it takes counts against the others and never for itself.
        """
        named = [f for f in self.standing if f.gain > 0.0 and not f.clock]
        return shared_out({f.name: self.chance_of(f) for f in named}, self.named[0].name if self.chance else "")

    def seen(self, first: Finalist) -> Seen:
        """What is known of a name that stands apart."""
        others = [f for f in self.finalists if f is not first]
        return Seen(first.share, tuple(f.share for f in others), first.loosest, self.cycles, first.company)


C = TypeVar("C", bound=Contest)


@dataclass(frozen=True, slots=True, kw_only=True)
class Graded(Contest):
    """What a misfit comes to; the first name's fit is the best model found."""

    misfit: Misfit

    @property
    def words(self) -> float:
        """Of the misfit."""
        return self.misfit.words

    @property
    def cycles(self) -> float:
        """Of the motion."""
        return self.misfit.strokes.cycles

    @property
    def words_run(self) -> float:
        """Strokes of the last part."""
        later = self.misfit.strokes.of[~trained(self.misfit.problem)]
        return max(float(np.unique(later).size - 1), 1.0)

    @property
    def refined(self) -> Fit:
        """The first name's."""
        return self.named[0].fit if self.named else self.misfit.base

    @property
    def odds(self) -> Odds:
        """Of a motion."""
        return OF_MOTION


def grade(misfit: Misfit, begun: Sequence[Model] = ()) -> Graded:
    """Grade the catalogue against a misfit; begun : models with one law each, to go on with. Raises SimulationError."""
    problem, scales, strokes = misfit.problem, misfit.scales, misfit.strokes
    finalists = ranked(misfit, begun)
    if not finalists:
        return Graded(misfit=misfit)
    base_held, base_run = held_out(misfit.base, problem, scales, strokes), free_run(misfit.base, problem, scales)

    def predicted(f: Finalist) -> Finalist:
        held, run = held_out(f.fit, problem, scales, strokes), free_run(f.fit, problem, scales)
        return replace(f, held=held, run=run, loosest=_loosest(f.fit, misfit))

    seen = (*each(predicted, finalists[:_FINALISTS]), *finalists[_FINALISTS:])
    return decided(Graded(misfit=misfit, finalists=seen, base_held=base_held, base_run=base_run))


def _loosest(fit: Fit, misfit: Misfit) -> float:
    """Under the sensors' noise, as a result gives the standard errors."""
    problem = misfit.sensed(misfit.noise_left(fit))
    return loosest(under(fit, problem), problem, len(fit.model.terms) - 1, misfit.scales.omega)


def decided(found: C) -> C:
    """Grade finalists whose evidence and predictions are known."""
    found = replace(found, chance=None)
    return _by_share(found) or _by_run(found) or _minor(found)


def ranked(misfit: Misfit, begun: Sequence[Model] = ()) -> list[Finalist]:
    """Every catalogue name alone, the best law of each that is what the name says, most evidence first.

    What explains everything may bend its law; of the part of a misfit that a law takes, the name is all that is said.
    """
    problem, base, scales = misfit.problem, misfit.base, misfit.scales
    extended = resplit(extend(base, problem, scales, begun=begun).fits, problem, scales)
    fits = [f for f in extended if f.as_named]
    if not fits:
        return []
    noise = misfit.noise_left(min(fits, key=lambda f: f.chi2))
    excess = base.chi2 - misfit.floor(noise)
    cells = cells_of(starting_evidence(base, problem, scales))
    span = problem.duration
    best: dict[str, Finalist] = {}
    for one in fits:
        entry = one.model.terms[-1]
        taken = base.chi2 - one.chi2
        # evidence is twice a logarithm: what takes a misfit by chance so many times more often counts that squared
        easily = max(1.0, entry.term.taken / TAKEN.value) ** 2
        found = Finalist(
            one,
            misfit.evidence_of(one, noise, easily * cells[entry.term.name]),
            min(taken / excess, 1.0) if excess > 0.0 else 0.0,
            taken / base.chi2,
            on_the_swing(entry, scales.omega, span),
        )
        if entry.term.name not in best or found.gain > best[entry.term.name].gain:
            best[entry.term.name] = found
    alone = sorted(best.values(), key=lambda f: -f.gain)
    return [replace(f, company=_company(f, alone, base) / excess) for f in alone] if excess > 0.0 else alone


def _company(one: Finalist, alone: Sequence[Finalist], base: Fit) -> float:
    """Beside whichever other; a law with a clock on the swing follows any."""
    return in_company(one.fit, [f.fit for f in alone if f is not one and not f.clock], base)


def cells_of(seen: Evidence) -> dict[str, float]:
    """Places that each name's parameters are scanned over: its probes, a cosine and a sine counted as one."""
    cells: dict[str, float] = {}
    for term in NAMED:
        probes = len(term.probes(seen)) / (1.0 if term.phase is None else 2.0)
        cells[term.name] = cells.get(term.name, 0.0) + max(probes, 1.0)
    return cells


def _alike(first: Finalist, found: Contest) -> list[Finalist]:
    """Those that are not told apart from the first; a clock on the swing follows anything, so that it must predict.

    Such a one is no name, but beside it the first does not stand apart.
    """
    margin = margin_of(found.words)
    near = [f for f in found.standing if f is not first and f.gain >= GAIN.value and f.gain > first.gain - margin]
    return [f for f in near if not f.clock] + [f for f in near if f.clock and worthy(f, found)]


def worthy(f: Finalist, found: Contest) -> bool:
    """Whether a term takes most of the misfit, and predicts."""
    return (
        f.gain >= GAIN.value
        and not f.leading >= LOOSE.value
        and f.share >= SHARE_OF_EXCESS.value
        and f.of_all >= SHARE_OF_MISFIT.value
        and ratio(f.held, found.base_held) <= HELD_OUT.value
    )


def _by_share(found: C) -> C | None:
    """A main effect by its share of the misfit, or the names that share that place; None where no term has it."""
    rules: tuple[Rule, ...] = (GAIN, SHARE_OF_EXCESS, SHARE_OF_MISFIT, HELD_OUT)
    # a clock on the swing follows anything: it is never the main effect
    candidates = [f for f in found.standing if not f.clock and worthy(f, found)]
    if not candidates:
        return None
    if any(f.leading >= LOOSE.value for f in found.finalists):
        rules = (*rules, LOOSE)
    first = candidates[0]
    near = _alike(first, found)
    better = [f for f in candidates if f not in near and _predicts_better(f, first)]
    listed, rules = (first, *near, *better), (*rules, MARGIN, LEAST_RATIO)
    if any(f.clock for f in listed):
        listed, rules = tuple(f for f in listed if not f.clock), (*rules, SAME_CLOCK)
    if len(listed) == 1:
        return _alone(found, first, rules)
    return replace(found, grade=Grade.ONE_OF, named=listed[: MOST_LISTED.count], rules=(*rules, MOST_LISTED))


def _alone(found: C, first: Finalist, rules: tuple[Rule, ...]) -> C:
    """A name beside which no other is listed: the main effect where that is likely enough, else listed with the next.

    Where nothing comes next it is the main effect if that is more likely than not, and else the largest part.
    """
    likely, least = found.chance_of(first), found.odds.least
    rules = (*rules, least, *((LEAST_CYCLES,) if found.cycles < LEAST_CYCLES.value else ()))
    found = replace(found, chance=likely)
    if likely >= least.value:
        return replace(found, grade=Grade.MAIN, named=(first,), rules=rules)
    listed = (first, *_nearly_as_much(first, found))[: MOST_LISTED.count]
    if len(listed) > 1:
        return replace(found, grade=Grade.ONE_OF, named=listed, rules=(*rules, NEARLY_AS_MUCH, MOST_LISTED))
    grade = Grade.MAIN if likely >= MOST_LIKELY.value else Grade.MINOR
    return replace(found, grade=grade, named=listed, rules=(*rules, MOST_LIKELY))


def _nearly_as_much(first: Finalist, found: Contest) -> tuple[Finalist, ...]:
    """Others that take nearly as much off as the first, else the next, most evidence first.

    Several small effects sum up to any.
    """
    others = [f for f in found.standing if f is not first and not f.clock]
    near = tuple(f for f in others if f.share >= NEARLY_AS_MUCH.value * first.share)
    return near or tuple(f for f in others if f.gain >= GAIN.value)[:1]


def _predicts_better(one: Finalist, first: Finalist) -> bool:
    """Whether a term misses clearly less of what was left out than the first one, of blocks or of the last part."""
    if one.held is None or first.held is None:
        return False
    forward = ratio(one.run, first.run) if one.run is not None else 1.0
    return surely_less(one.held, first.held, PREDICTS_BETTER.value) or forward <= RUNS_ON_BETTER.value


def _by_run(found: C) -> C | None:
    """Names whose free run is far better than the base's though they take little off where they were fitted.

    What hardly shows in the large swings can rule the small ones. They are listed, never the main effect.
    """
    if found.base_run is None:
        return None
    good: list[tuple[float, Finalist]] = []
    for f in found.standing:
        if f.run is None or f.clock or f.gain <= 0.0 or ratio(f.run, found.base_run) > RUN_BETTER.value:
            continue
        if evidence(found.base_run.total, f.run.total, found.words_run, 0, AMONG_ALIKE.value) >= GAIN.value:
            good.append((f.run.total, f))
    good.sort(key=lambda one: one[0])
    listed = tuple(f for total, f in good if total < LEAST_RATIO.value * good[0][0])
    if not 0 < len(listed) <= MOST_LISTED.count:
        return None
    listed = listed if len(listed) > 1 else (*listed, *_nearly_as_much(listed[0], found))[: MOST_LISTED.count]
    return replace(found, grade=Grade.ONE_OF, named=listed, rules=(RUN_BETTER, GAIN)) if len(listed) > 1 else None


def in_step(found: Contest) -> Finalist | None:
    """A law with a clock on the swing that takes as much as what is named; None where none does.

    It follows any other, and is none of the names.
    """
    most = found.named[0].share if found.named and found.grade is not Grade.MINOR else 0.0
    clocks = (f for f in found.finalists if f.clock and worthy(f, found))
    return next((f for f in clocks if f.share >= NEARLY_AS_MUCH.value * most), None)


def _minor(found: C) -> C:
    """The largest single part, no headline."""
    parts = [f for f in found.standing if f.gain >= GAIN.value and not f.clock]
    rules: tuple[Rule, ...] = (GAIN, SHARE_OF_EXCESS)
    if in_step(found) is not None:
        rules = (*rules, SAME_CLOCK)
    return replace(found, grade=Grade.MINOR if parts else None, named=tuple(parts[:1]), rules=rules)
