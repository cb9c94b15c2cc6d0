"""A second law beside the main effect of a machine, where both together explain it to its noise.

On a machine pairs are not looked for: two laws follow a crowd of small effects as well as their own. Beside a main
effect that stands by itself one more is told, if it leaves noise alone and says more in words of the motion than any
other by the margin that a main effect has.
"""

from collections.abc import Iterable, Sequence
from dataclasses import replace

from harness.diagnosis.baseline.words import evidence, margin_of, words_beside
from harness.diagnosis.fit.model_fit import Fit
from harness.diagnosis.grading.grade import Graded
from harness.diagnosis.outcome import Grade
from harness.diagnosis.residual_tests.structure import Left, left_by
from harness.diagnosis.rules import GAIN, SECOND_TERM
from harness.diagnosis.search.extend import key_of, prune, settle
from harness.diagnosis.search.search import Search, less_each, levelled, noise_of, to_an_end, under


def with_second(graded: Graded) -> Search | None:
    """The main effect with the law that explains what it leaves; None where there is none. Raises SimulationError."""
    misfit = graded.misfit
    if graded.grade is not Grade.MAIN or misfit.problem.pairs_searched:
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
