"""What is missing, as probabilities: of nothing but noise, of each name, and of pairs that were fitted.

Where a name is the main part of a misfit, simulated machines say how likely it is (``Contest.posterior``). Where a
model meets the noise its evidence does, each name being as likely as the next before the recording is seen: BIC in
samples, or in strokes where small effects that nobody models may be there (the position's zero is unknown). Of speeds
that were held a smooth curve of no name is as likely as any name.
"""

import math
from collections.abc import Callable, Sequence

from harness.diagnosis.baseline.words import evidence, strokes_of, words_beside
from harness.diagnosis.fit.model_fit import Fit
from harness.diagnosis.grading.contest import Contest
from harness.diagnosis.outcome import Hypothesis
from harness.diagnosis.residual_tests.structure import UNNAMED, Left, evidence_of_curve
from harness.diagnosis.rules import NAMES
from harness.diagnosis.search.against import against, among_names
from harness.diagnosis.search.extend import key_of
from harness.diagnosis.search.search import Search

_LEAST = 0.01
"""Probability below which a hypothesis is not given."""


def of_contest(found: Contest) -> tuple[Hypothesis, ...]:
    """Which name is the main part of what is missing, most likely first."""
    each = (Hypothesis((name,) if name else (), p) for name, p in found.posterior.items())
    return tuple(one for one in each if one.probability >= _LEAST)


def of_search(found: Search) -> tuple[Hypothesis, ...]:
    """Which model explains what was recorded, of those that were fitted, most likely first.

    Of a fitted force no evidence counts beyond that of the model the search came to: what has more was refused, since
    chance takes as much off a true model, or since it moves otherwise. Beside noise of a force each law has to take off
    what such noise may leave, before it counts. None where a model of sliding is found and what holds at rest is not.
    """
    if found.left is Left.NOISE and found.problem.holds(found.chosen.model) is not None:
        return ()
    gain = _gain(found)
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
    most = max(best.values())
    weight = {names: math.exp(0.5 * (size - most)) for names, size in best.items()}
    whole = sum(weight.values())
    ranked = sorted(weight.items(), key=lambda one: -one[1])
    return tuple(Hypothesis(names, w / whole) for names, w in ranked if w >= _LEAST * whole)


def probability(of: tuple[Hypothesis, ...], name: str) -> float:
    """That a name is among what is missing, at most 1."""
    return min(sum(one.probability for one in of if name in one.names), 1.0)


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


def _gain(found: Search) -> Callable[[Fit], float]:
    """Evidence of a fit over the base, twice a log likelihood."""
    base, problem = found.base, found.problem
    if not problem.moves:
        # beside a curve of any shape, to which the level of the noise is unknown as well
        words = float(problem.points - len(base.free))
        return lambda one: evidence(base.chi2, one.chi2, words, len(one.free) - len(base.free), 1.0)
    # several amplitudes part a law from what small effects could do in its place
    if found.by_force:
        return lambda one: against(base, problem) - against(one, problem)
    if not problem.zero_free or problem.parts_amplitude_from_time:
        return lambda one: against(base, problem) - among_names(one, problem)
    words = words_beside(base, strokes_of(found.chosen, problem))
    return lambda one: evidence(base.chi2, one.chi2, words, len(one.free) - len(base.free), 1.0)
