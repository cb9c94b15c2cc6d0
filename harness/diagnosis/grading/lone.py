"""Whether a lone law that explains a recording to its noise is the one, or one that looks like it."""

from harness.diagnosis.baseline.words import evidence, few_words, margin_of, strokes_of, words_beside
from harness.diagnosis.fit.model_fit import Fit
from harness.diagnosis.rules import DECISIVE, EVEN, LEAST_CYCLES, MARGIN, SHARE_OF_MISFIT, Rule
from harness.diagnosis.search.extend import key_of
from harness.diagnosis.search.search import Search


def undecided(found: Search) -> tuple[Rule, ...]:
    """The rules by which the chosen lone law is listed and not named, none where it is named.

    Another law that explains the recording as well is listed beside it. Where the zero and the spring are not known
    before, as on a machine, a crowd of small effects can look like one law: it is then named by what names a main
    effect, that is with enough cycles, a misfit to speak of, and no other law near.
    """
    if not _lone(found):
        return ()
    if not found.problem.zero_free:
        return (EVEN,) if any(f.bic < found.chosen.bic + EVEN.value for f in _others(found)) else ()
    taken = 1.0 - found.chosen.chi2 / found.base.chi2
    fails = {
        LEAST_CYCLES: few_words(found.base, found.chosen, found.problem),
        SHARE_OF_MISFIT: taken < SHARE_OF_MISFIT.value,
        MARGIN: bool(near(found)),
    }
    return tuple(rule for rule, failed in fails.items() if failed)


def near(found: Search) -> tuple[Fit, ...]:
    """Other laws that the lone one is not told apart from on a machine: in words, as a main effect from another.

    In samples two laws always differ: by what small effects that nobody models change. Where several amplitudes part
    laws of it from laws of the time, they say so; a law that is bent beyond its name is no other one.
    """
    if not _lone(found) or not found.problem.zero_free:
        return ()
    chosen, words = found.chosen, words_beside(found.base, strokes_of(found.chosen, found.problem))

    def apart(other: Fit) -> bool:
        gain = evidence(other.chi2, chosen.chi2, words, len(chosen.free) - len(other.free), 1.0)
        said = gain >= margin_of(words) or found.problem.parts_amplitude_from_time
        return said and other.bic >= chosen.bic + DECISIVE.value

    return tuple(f for f in _others(found) if f.explains_as_named and not apart(f))


def _lone(found: Search) -> bool:
    """Whether one law alone explains a recording."""
    return not found.by_force and found.explained and len(found.chosen.model.terms) == 1


def _others(found: Search) -> list[Fit]:
    """Fits of one law of another name."""
    return [f for f in found.rivals if len(f.model.terms) == 1 and key_of(f) != key_of(found.chosen)]
