"""Whether a lone law that explains a recording to its noise is the one, or one that looks like it."""

from harness.diagnosis.baseline.words import evidence, strokes_of, words_of
from harness.diagnosis.fit.model_fit import Fit
from harness.diagnosis.rules import DECISIVE, EVEN, LEAST_CYCLES, SHARE_OF_MISFIT, Rule
from harness.diagnosis.search.extend import key_of
from harness.diagnosis.search.search import Search


def undecided(found: Search) -> tuple[Rule, ...]:
    """The rules by which the chosen lone law is listed and not named, none where it is named.

    Another law that explains the recording as well is listed beside it. Where the zero and the spring are not known
    before, as on a machine, a crowd of small effects can look like one law: it is then named by what names a main
    effect, that is with enough cycles, a misfit to speak of, and no other law near.
    """
    if found.by_force or not found.explained or len(found.chosen.model.terms) != 1:
        return ()
    near = min((f.bic - found.chosen.bic for f in _others(found)), default=float("inf"))
    if not found.problem.zero_free:
        return (EVEN,) if near < EVEN.value else ()
    taken = 1.0 - found.chosen.chi2 / found.base.chi2
    fails = {
        LEAST_CYCLES: _few_words(found),
        SHARE_OF_MISFIT: taken < SHARE_OF_MISFIT.value,
        DECISIVE: near < DECISIVE.value,
    }
    return tuple(rule for rule, failed in fails.items() if failed)


def _few_words(found: Search) -> bool:
    """Whether the cycles are few, and what they say is spent once the base's own numbers have taken their words."""
    base, chosen = found.base, found.chosen
    strokes = strokes_of(chosen, found.problem)
    if strokes.cycles >= LEAST_CYCLES.value:
        return False
    words = max(words_of(strokes) - len(base.free), 1.0)
    return evidence(base.chi2, chosen.chi2, words, len(chosen.free) - len(base.free), 1.0) < DECISIVE.value


def _others(found: Search) -> list[Fit]:
    """Fits of one law of another name."""
    return [f for f in found.rivals if len(f.model.terms) == 1 and key_of(f) != key_of(found.chosen)]
