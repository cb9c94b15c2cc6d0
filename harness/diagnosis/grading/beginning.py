"""Whether a free decay was free from its beginning on: a law says of the first half-swing what it says of the rest.

Laws as a search has begun them, where a misfit is looked at: they are gone on with, not looked for again.

Does a model explain what follows the first turning point, though none explains the whole? Then a hand was there.

A hand that moves the slider before it lets go, or takes long to, is no physics of the machine; the motion is free from
the first turning point on at the latest.

A second law beside the main effect of a machine, where both together explain it to its noise.

On a machine pairs are not looked for: two laws follow a crowd of small effects as well as their own. Beside the
likeliest effect one more is told, if it leaves noise alone and says more in words of the motion than any other by the
margin that a main effect has.
"""

import math
from collections.abc import Iterable, Sequence
from contextlib import suppress
from dataclasses import replace

import numpy as np

from harness.core.arrays import BoolArray, FloatArray
from harness.core.errors import SimulationError
from harness.diagnosis.baseline.words import evidence, margin_of, words_beside
from harness.diagnosis.fit.model_fit import Fit, fit
from harness.diagnosis.grading.grade import Graded, grade
from harness.diagnosis.grading.misfit import misfit
from harness.diagnosis.outcome import Grade
from harness.diagnosis.parameters import base_of, free_of
from harness.diagnosis.problem import Problem
from harness.diagnosis.problems.simulated import COARSE
from harness.diagnosis.residual_tests.structure import Left, left_by
from harness.diagnosis.rules import BEGINS_ALIKE, GAIN, LEAST_RATIO, SECOND_TERM
from harness.diagnosis.search.extend import extend, key_of, prune, settle
from harness.diagnosis.search.release_transient import of_a_hand
from harness.diagnosis.search.search import Search, less_each, levelled, noise_of, search, to_an_end, under
from harness.kernels.solve import Scales, solve
from harness.model.model import Model


def from_within(models: Sequence[Model], problem: Problem, begin: float, scales: Scales) -> tuple[Model, ...]:
    """Models of a recording that begins later within the same motion, where their own motion is by then.

    begin : s. None of a recording that is simulated from more than one start or with covariates, and none that cannot
    be simulated.
    """
    if problem.covariates:
        return ()
    moved = []
    for model in models:
        starts = problem.starts.of(model)
        if len(starts) != 1:
            return ()
        with suppress(SimulationError):
            there = solve(starts[0].model, np.array([begin]), (), problem.drive, scales, COARSE, want_a=False)
            moved.append(replace(model, x0=float(there.x[0]), v0=float(there.v[0]), t0=begin))
    return tuple(moved)


def after_first_turn(graded: Graded) -> tuple[Search, Scales, float] | None:
    """The search of what follows the first turning point, where it explains that; None where it does not.

    With what counts as ordinary in it, and the time left out, s. Raises SimulationError.
    """
    misfit = graded.misfit
    if misfit.left_out == 0.0:
        return None
    promising = [misfit.base, *(f.fit for f in graded.finalists[:1])]
    if not any(_explains(fit, graded) for fit in promising):
        return None
    problem = misfit.sensed(noise_of(misfit.base, misfit.sensed(misfit.noise), misfit.scales.omega))
    base = settle(under(misfit.base, problem), problem, misfit.scales)
    alone = extend(base, problem, misfit.scales, begun=[f.fit.model for f in graded.finalists])
    found = search(problem, base, misfit.scales, alone=alone)
    return (found, misfit.scales, misfit.left_out) if found.explained else None


def _explains(fit: Fit, graded: Graded) -> bool:
    """Whether a fit leaves noise alone, at the level that it leaves itself."""
    misfit = graded.misfit
    problem = misfit.sensed(noise_of(fit, misfit.sensed(misfit.noise), misfit.scales.omega))
    seen, base = under(fit, problem), under(misfit.base, problem)
    return left_by(seen, problem, misfit.scales.omega, base) is Left.NOISE


def from_the_beginning(found: Search, later: Graded, scales: Scales) -> Graded | None:
    """A misfit graded from the release on, where from the first turning point on it comes to no name and no hand shows.

    What acts at the largest swings alone, a stop or a sensor that clips, acts there. found : of the whole recording;
    later : graded from the first turning point. Raises SimulationError.
    """
    if later.misfit.left_out == 0.0 or later.grade in (Grade.MAIN, Grade.ONE_OF):
        return None
    # what is over while a hand lets go says nothing of whether one was there
    seen_whole = (f for f in found.singles if f.shown.x.size == found.problem.t.size)
    lasting = next((f for f in seen_whole if not of_a_hand(f, found.problem, scales)), None)
    after = replace(later.misfit.problem, noise=found.problem.noise)
    if lasting is None or not _begins_alike(lasting, found.problem, after, scales):
        return None
    seen = grade(misfit(found.problem, found.base, scales, whole=True), found.begun)
    said = seen.grade in (Grade.MAIN, Grade.ONE_OF) and not of_a_hand(seen.named[0].fit, found.problem, scales)
    return replace(seen, rules=(*seen.rules, BEGINS_ALIKE)) if said else None


def _begins_alike(best: Fit, problem: Problem, later: Problem, scales: Scales) -> bool:
    """Whether no hand shows in what comes before ``later``.

    best : of one law more than the base, to the whole; later : under the same noise. It must leave of the beginning
    about what it leaves of the half-swing that follows, or of all that does, and of that no more than if it alone were
    fitted: a hand bends the whole fit.
    """
    first = problem.t < later.t[0]
    second = ~first & (problem.t < later.t[0] + math.pi / scales.omega)
    left = _squares(best, problem)
    usual = max(_mean(left, second), _mean(left, ~first))
    if _mean(left, first) > BEGINS_ALIKE.value**2 * usual:
        return False
    moved = from_within((best.model,), problem, float(later.t[0]), scales)
    names = tuple(dict.fromkeys((*base_of(best.free), *later.starts.names)))
    for model in moved:
        with suppress(SimulationError):
            own = _squares(fit(model, later, free_of(model, names), scales, thorough=False), later)
            return _mean(left, ~first) <= LEAST_RATIO.value * float(own.mean())
    return False


def _squares(shown: Fit, problem: Problem) -> FloatArray:
    """What a fit leaves of each sample (n,), over all channels in units of their noise."""
    left = {c: problem.even(c, y - shown.shown.y[c]) / problem.noise[c].sigma for c, y in problem.channels.items()}
    return sum((problem.weight[c] * r**2 for c, r in left.items()), start=0.0 * problem.t)


def _mean(values: FloatArray, where: BoolArray) -> float:
    return float(values[where].mean()) if where.any() else math.inf


def with_second(graded: Graded) -> Search | None:
    """The likeliest name with the law that explains what it leaves; None where none does. Raises SimulationError."""
    misfit = graded.misfit
    if graded.grade not in (Grade.MAIN, Grade.ONE_OF) or misfit.problem.pairs_searched:
        return None
    scales, main = misfit.scales, graded.named[0].fit
    problem = misfit.sensed(noise_of(main, misfit.sensed(misfit.noise), misfit.scales.omega))
    first = settle(under(main, problem), problem, scales)
    step = to_an_end(first, problem, scales)
    if not step.fits or step.fits[0].bic > first.bic - SECOND_TERM.value:
        return None
    problem = replace(problem, noise=noise_of(step.fits[0], problem, scales.omega))
    rivals = sorted((settle(under(f, problem), problem, scales) for f in step.fits[:2]), key=lambda f: f.bic)
    base, first, chosen = under(misfit.base, problem), under(first, problem), rivals[0]
    if left_by(chosen, problem, scales.omega, base) is not Left.NOISE:
        return None
    others = (*rivals[1:], *(under(f, problem) for f in step.fits[2:]))
    if not _told(first, chosen, others, words_beside(base, misfit.strokes)):
        return None
    kept, without = prune(chosen, problem, scales)
    if key_of(kept) != key_of(chosen):
        return None
    base = settle(base, problem, scales)
    singles = [under(f.fit, problem) for f in graded.finalists]
    alone = {key_of(f) for f in singles}
    singles += [f for f in without if f is not None and key_of(f) not in alone]
    less = less_each(chosen, without, (*singles, first))
    return levelled(Search(problem, base, chosen, _by_bic(singles), _by_bic((chosen, *others)), Left.NOISE, less))


def _told(first: Fit, chosen: Fit, others: Sequence[Fit], words: float) -> bool:
    """Whether a second law says more than the first alone, and by a margin more than every other second law."""

    def gain(over: Fit) -> float:
        return evidence(over.chi2, chosen.chi2, words, len(chosen.free) - len(over.free), 1.0)

    return gain(first) >= GAIN.value and all(gain(one) >= margin_of(words) for one in others)


def _by_bic(fits: Iterable[Fit]) -> tuple[Fit, ...]:
    """Best first."""
    return tuple(sorted(fits, key=lambda f: f.bic))
