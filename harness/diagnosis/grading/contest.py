"""Which name is the main part of a misfit that nothing explains: a probability of each, and of none.

A real machine has one large omission and a crowd of small ones; no model of one or two terms meets its noise. Small
effects sum up to one law or another by chance: how likely a name is what it seems, simulated machines say, by a softmax
over none and every name (``python -m benchmarks.calibrate posterior`` makes its weights and counts what they are worth
on other draws; Guo et al. 2017, On Calibration of Modern Neural Networks, for why probabilities are held against what
was right). A name's odds do not depend on how many terms the catalogue has.

Where a model meets the noise, what is missing (nothing but noise, a name, a pair that was fitted) is as likely as its
evidence says, each name being as likely as the next before the recording is seen: BIC in samples, or in strokes where
small effects that nobody models may be there (the position's zero is unknown). Of speeds that were held a smooth curve
of no name is as likely as any name.
"""

import math
from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TypeVar

import numpy as np

from harness.core.arrays import FloatArray
from harness.diagnosis.baseline.words import evidence, strokes_of, words_beside
from harness.diagnosis.fit.model_fit import Fit
from harness.diagnosis.grading.likely import Likely, beside_other_forms, no_likelier, weighed
from harness.diagnosis.grading.prediction import Predicted
from harness.diagnosis.outcome import Grade
from harness.diagnosis.residual_tests.structure import UNNAMED, Left, evidence_of_curve
from harness.diagnosis.rules import (
    GAIN,
    LEAST_CYCLES,
    LISTED_FROM,
    LOOSE,
    MAIN_FROM,
    MOST_LIKELY,
    MOST_LISTED,
    NAMES,
    OF_LIST,
    PART_APART,
    PART_SPANS,
    SAME_CLOCK,
    SHARE_OF_EXCESS,
    SHARE_OF_MISFIT,
    TAKEN,
    TIMES_NEXT,
    Rule,
    Weights,
)
from harness.diagnosis.search.against import against, among_names
from harness.diagnosis.search.extend import key_of
from harness.diagnosis.search.search import Search

_LEAST_SHARE, _ALIKE = 0.01, 0.1
"""Below which a share, and the sum of squares of others' shares in it, says nothing more."""
_SURE, _LOOSE = 0.001, 10.0
"""Relative standard errors beyond which more says nothing more."""
_FEWEST_WORDS = 4.0
"""Below which evidence a word says nothing more."""


@dataclass(frozen=True, slots=True)
class Finalist:
    """A catalogue name, alone on the base.

    fit : under the noise of the misfit. gain : evidence over the base. share : of the misfit beyond the sensors' noise
    that it takes off; company : of the misfit, beside the other name with which it leaves least. clock : whether it has
    a clock of its own on the swing. loosest : largest standard error of its parameters, relative; leading : that of the
    number that says how much of the law there is, where a force is fitted. held, run : prediction of blocks that were
    left out, and of the last part from the first, of what is named. None and nan are what was not looked at.
    """

    fit: Fit
    gain: float
    share: float
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

    @property
    def large(self) -> bool:
        """Whether it takes most of the misfit."""
        return self.gain >= GAIN.value and self.share >= SHARE_OF_EXCESS.value


@dataclass(frozen=True, slots=True, kw_only=True)
class Contest(ABC):
    """Finalists, most evidence first, and what they come to: grade and names, most likely first.

    base_held, base_run : prediction by the base. rules : those that decided. known : how well what shares are of is
    known, that over itself and its standard error.
    """

    finalists: tuple[Finalist, ...] = ()
    grade: Grade | None = None
    named: tuple[Finalist, ...] = ()
    base_held: Predicted | None = None
    base_run: Predicted | None = None
    rules: tuple[Rule, ...] = (GAIN,)
    known: float = 1.0

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
    def refined(self) -> Fit:
        """The best model found, the base where nothing helps."""

    @property
    @abstractmethod
    def weights(self) -> Weights:
        """Of the features of a name."""

    @property
    def standing(self) -> tuple[Finalist, ...]:
        """Those that may be named: a clock on the swing follows any other, and what is looser than itself is none."""
        return tuple(f for f in self.finalists if f.gain > 0.0 and not f.clock and not f.leading >= LOOSE.value)

    def features(self, f: Finalist) -> dict[str, float]:
        """What the odds of a name hang on.

        one; share : log of it, less where what it is of is hardly known; company : its share beside another; loose :
        log of its loosest relative standard error; easily : log of how often its law takes a misfit that it has not
        made; cycles : log of them; behind : evidence behind the best, a word; alike : log of the sum of squares of the
        others' shares, in its own.
        """
        share = max(f.share, _LEAST_SHARE)
        loosest = 1.0 if math.isnan(f.loosest) else min(max(f.loosest, _SURE), _LOOSE)
        others = sum((max(o.share, 0.0) / share) ** 2 for o in self.finalists if o is not f)
        best = max(o.gain for o in self.standing)
        return {
            "one": 1.0,
            "share": math.log(max(share * self.known, _LEAST_SHARE)),
            "company": f.share if math.isnan(f.company) else f.company,
            "loose": math.log(loosest),
            "easily": math.log(max(f.fit.model.terms[-1].term.taken, TAKEN.value)),
            "cycles": math.log(max(self.cycles, 1.0)),
            "behind": (f.gain - best) / max(self.words, _FEWEST_WORDS),
            "alike": math.log(_ALIKE + others),
        }

    @property
    def posterior(self) -> dict[str, float]:
        """Probability of each name to be the main effect, and under "" of none to be: most likely first."""
        names = ("", *(f.name for f in self.standing))
        p = softmax([self.weights.odds(self.features(f)) for f in self.standing])
        return dict(sorted(zip(names, map(float, p), strict=True), key=lambda one: -one[1]))

    @property
    def chance(self) -> float | None:
        """Probability of the first name, None where none is named."""
        return self.posterior.get(self.named[0].name) if self.named else None


def softmax(odds: list[float]) -> FloatArray:
    """Probability of none, whose log odds are 0, and of each name by its own (m,): (1 + m,)."""
    at = np.array([0.0, *odds])
    each = np.exp(at - at.max())
    return np.asarray(each / each.sum())


C = TypeVar("C", bound=Contest)


def answered(likely: Mapping[str, float]) -> tuple[Grade | None, tuple[str, ...]]:
    """What probabilities of each name, of none under "" and of a curve of no name come to.

    A main effect, or a list that most likely holds it; None without names where neither is said.
    """
    ranked = sorted((one for one in likely.items() if one[0] not in ("", UNNAMED)), key=lambda one: -one[1])
    any_name = sum(p for _, p in ranked)
    if not ranked or any_name < LISTED_FROM.value:
        return None, ()
    (first, p), *others = ranked
    alone = all(p >= TIMES_NEXT.value * other for _, other in others)
    if p >= (MAIN_FROM if others else MOST_LIKELY).value and alone:
        return Grade.MAIN, (first,)
    if not others:
        return None, ()
    before = np.cumsum([0.0, *(p for _, p in ranked[:-1])])
    count = max(int(np.count_nonzero(before < OF_LIST.value * any_name)), 2)
    return Grade.ONE_OF, tuple(name for name, _ in ranked[: min(count, MOST_LISTED.count)])


def decided(found: C) -> C:
    """Grade finalists: a main effect, a list that most likely holds it, or the largest part of many."""
    likely = found.posterior
    grade, names = answered(likely)
    if grade is None:
        return _minor(found)
    by_name = {f.name: f for f in found.standing}
    few = (LEAST_CYCLES,) if found.cycles < LEAST_CYCLES.value else ()
    unsure = (MOST_LIKELY,) if likely[names[0]] < OF_LIST.value else ()
    rules = (GAIN, MAIN_FROM, TIMES_NEXT, *((LISTED_FROM, OF_LIST) if grade is Grade.ONE_OF else ()), *few, *unsure)
    return replace(found, grade=grade, named=tuple(by_name[name] for name in names), rules=rules)


def shown_as_part(found: C) -> C:
    """The largest part as one that is there whatever the rest is: nothing else does the like of it, every span that
    was left out is missed less with it.

    Laws that nobody knows of sum up to one or another, but then to several, and not everywhere.
    """
    if found.grade is not Grade.MINOR or not found.named:
        return found
    first, before = found.named[0], found.base_held
    after = next((f.held for f in found.finalists if f.name == first.name and f.held), first.held)
    if before is None or after is None or after.by_span.size < PART_SPANS.value:
        return found
    falls = bool(np.all(after.by_span < before.by_span))
    others = max((f.share for f in found.finalists if f.name != first.name), default=0.0)
    apart = others <= PART_APART.value * first.share and first.share >= SHARE_OF_MISFIT.value
    if not (falls and apart):
        return found
    return replace(found, grade=Grade.PART, rules=(*found.rules, SHARE_OF_MISFIT, PART_APART, PART_SPANS))


def in_step(found: Contest) -> Finalist | None:
    """A law with a clock on the swing that takes as much as what is named; None where none does.

    It follows any other, and is none of the names.
    """
    most = found.named[0].share if found.grade in (Grade.MAIN, Grade.ONE_OF) else 0.0
    return next((f for f in found.finalists if f.clock and f.large and f.share >= most), None)


def _minor(found: C) -> C:
    """The largest single part, no headline."""
    parts = [f for f in found.standing if f.gain >= GAIN.value]
    rules = (GAIN, LISTED_FROM, *((SAME_CLOCK,) if in_step(found) is not None else ()))
    return replace(found, grade=Grade.MINOR if parts else None, named=tuple(parts[:1]), rules=rules)


def of_contest(found: Contest) -> Likely:
    """Which name is the main part of what is missing."""
    return {(name,) if name else (): p for name, p in found.posterior.items()}


def of_search(found: Search) -> Likely:
    """Which model explains what was recorded, of those that were fitted; see ``by_evidence``.

    What has more evidence than the model the search came to was refused, and is no likelier than that. Where laws
    explain what the base does not, nothing of that is noise, but another effect in a form that the catalogue lacks may
    look like them: what shapes it is a number more, known to one over the root of the squares that they explain.
    """
    likely, chosen = by_evidence(found, beyond_noise=True), key_of(found.chosen)
    if not likely:
        return {}
    believed = no_likelier(likely, chosen, NAMES)
    if chosen and found.problem.moves:
        believed = beside_other_forms(believed, found.base.chi2 - found.chosen.chi2)
    return believed


def by_evidence(found: Search, beyond_noise: bool = False) -> Likely:
    """Which model explains what was recorded, of those that were fitted, each name being as likely before.

    beyond_noise : of evidence in words, whether squares count beyond those that the chosen model leaves. A verdict is
    to err on the side of the base, and counts all noise as misfit.

    Of a fitted force no evidence counts beyond that of the model the search came to: what has more was refused, since
    chance takes as much off a true model, or since it moves otherwise. Beside noise of a force each law has to take off
    what such noise may leave, before it counts. None where a model of sliding is found and what holds at rest is not.
    """
    if found.left is Left.NOISE and found.problem.holds(found.chosen.model) is not None:
        return {}
    gain = _gain(found, beyond_noise)
    best: dict[tuple[str, ...], float] = {(): gain(found.base)}
    ceiling = gain(found.chosen) if found.by_force else math.inf
    # a law that is bent beyond its name says nothing of that
    others = (one for one in (*found.singles, *found.rivals) if one.explains_as_named)
    fitted = [(key_of(one), min(gain(one), ceiling)) for one in (*others, found.chosen)]
    chance = _by_chance([(0, best[()]), *((len(names), size) for names, size in fitted)], found.problem.spare)
    for names, size in fitted:
        own = size - 2.0 * len(names) * math.log(NAMES) - chance[len(names)]
        best[names] = max(best.get(names, -math.inf), own)
    if not found.problem.moves:
        for one in (found.base, *found.singles):
            names = key_of(one)
            alone = best[names] if names else 0.0
            best[(*names, UNNAMED)] = alone + evidence_of_curve(one) - 2.0 * math.log(NAMES)
    return weighed(best)


def _by_chance(fitted: Sequence[tuple[int, float]], spare: float) -> list[float]:
    """What noise of a force alone may have given models of no, one, .. laws: ``spare`` a law, and no more than is seen.

    fitted : laws and evidence of each model.
    """
    given = [0.0]
    most = max(size for count, size in fitted if count == 0)
    for count in range(1, max(count for count, _ in fitted) + 1):
        more = max((size for laws, size in fitted if laws == count), default=most)
        given.append(given[-1] + min(spare, max(more - most, 0.0)))
        most = max(most, more)
    return given


def _counts_words(found: Search) -> bool:
    """Whether evidence counts words of a misfit and not samples: small effects that nobody models may be there.

    Several amplitudes part a law from what these could do in its place.
    """
    problem = found.problem
    return problem.moves and not found.by_force and problem.zero_free and not problem.parts_amplitude_from_time


def _gain(found: Search, beyond_noise: bool) -> Callable[[Fit], float]:
    """Evidence of a fit over the base, twice a log likelihood."""
    base, problem = found.base, found.problem
    if not problem.moves:
        # beside a curve of any shape, to which the level of the noise is unknown as well
        words = float(problem.points - len(base.free))
        return lambda one: evidence(base.chi2, one.chi2, words, len(one.free) - len(base.free), 1.0)
    if found.by_force:
        return lambda one: against(base, problem) - against(one, problem)
    if not _counts_words(found):
        return lambda one: against(base, problem) - among_names(one, problem)
    words = words_beside(base, strokes_of(found.chosen, problem))
    if not beyond_noise:
        return lambda one: evidence(base.chi2, one.chi2, words, len(one.free) - len(base.free), 1.0)

    def speaks_against(one: Fit) -> float:
        # noise is one a word, and what is left beyond it has no level that is known
        left = max(one.chi2 - found.chosen.chi2, 0.0)
        return words * math.log1p(left / words) + len(one.free) * math.log(problem.points)

    return lambda one: speaks_against(base) - speaks_against(one)
