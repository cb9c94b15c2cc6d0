"""Whether a lone law that explains a recording to its noise is the one, or one that looks like it."""

import math

from harness.diagnosis.baseline.words import evidence, few_words, margin_of, strokes_of, words_beside
from harness.diagnosis.fit.model_fit import Fit
from harness.diagnosis.rules import (
    CLOCK_DRIFT,
    DECISIVE,
    EVEN,
    LEAST_CYCLES,
    LEAST_RATIO,
    MARGIN,
    SHARE_OF_MISFIT,
    TIMES_NEXT,
    Rule,
)
from harness.diagnosis.search.against import among_names
from harness.diagnosis.search.extend import key_of
from harness.diagnosis.search.search import Search
from harness.model.model import ModelTerm
from harness.model.registry import not_parted
from harness.model.terms import clock_drift


def undecided(found: Search) -> tuple[Rule, ...]:
    """The rules by which the chosen lone law is listed and not named, none where it is named.

    Another law that explains the recording as well is listed beside it; of held speeds, a run-down or a fitted force,
    where a law has no phase to err in, one that is not so many times less likely as beside a main effect. Where the
    zero and the spring are not known before, as on a machine, a crowd of small effects can look like one law: it is
    then named by what names a main effect, that is with enough cycles, a misfit to speak of, and no other law near.
    """
    if not _lone(found):
        return ()
    if any(f.bic < found.chosen.bic + DECISIVE.value for f in _others(found) if key_of(f) == (clock_drift.TERM.name,)):
        # nothing but the size of one channel parts the two, and whose clock it is, is not known
        return (CLOCK_DRIFT,)
    if found.by_force or not found.problem.returns:
        # whatever the shape of either costs
        margin = 2.0 * math.log(TIMES_NEXT.value)
        apart = (min(_behind(f, found), f.bic - found.chosen.bic) for f in _others(found))
        return (TIMES_NEXT,) if any(by < margin for by in apart) else ()
    if not found.problem.zero_free:
        return (EVEN,) if any(_behind(f, found) < EVEN.value for f in _others(found)) else ()
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
    if not _lone(found) or found.by_force or not found.problem.zero_free:
        return ()
    chosen, words = found.chosen, words_beside(found.base, strokes_of(found.chosen, found.problem))

    def apart(other: Fit) -> bool:
        gain = evidence(other.chi2, chosen.chi2, words, len(chosen.free) - len(other.free), 1.0)
        said = gain >= margin_of(words) or found.problem.parts_amplitude_from_time
        return said and other.bic >= chosen.bic + DECISIVE.value

    return tuple(f for f in _others(found) if f.explains_as_named and not apart(f))


def stand_ins(found: Search, entry: ModelTerm) -> list[tuple[str, Fit]]:
    """Names, each with its fit, that could stand in a term's place: worse by less than what is decisive, or not parted.

    Evidence that two laws differ is evidence of their shape; a law of the amplitude and one of the time differ in
    little else, and by less than what small effects that nobody models change.
    """
    decay = "driven" not in found.problem.given and not found.problem.parts_amplitude_from_time
    rest = sorted(e.term.name for e in found.chosen.model.terms if e is not entry)
    unparted = near(found)
    listed: list[tuple[str, Fit]] = []
    for rival in found.rivals:
        names = list(key_of(rival))
        if len(names) != len(rest) + 1:
            continue
        for name in rest:
            if name in names:
                names.remove(name)
        if len(names) != 1 or names[0] == entry.term.name:
            continue
        alike = decay and rival.chi2 < LEAST_RATIO.value * found.chosen.chi2 and not_parted(entry.term.name, names[0])
        if _behind(rival, found) < DECISIVE.value or alike or any(rival is one for one in unparted):
            listed.append((names[0], rival))
    return listed


def next_best(found: Search) -> list[tuple[str, Fit]]:
    """The lone law of another name that leaves least against it, where there is one."""
    others = sorted(_others(found), key=lambda f: f.bic)
    return [(key_of(f)[0], f) for f in others[:1]]


def _behind(other: Fit, found: Search) -> float:
    """By how much less the recording speaks for a law than for the chosen one."""
    return among_names(other, found.problem) - among_names(found.chosen, found.problem)


def _lone(found: Search) -> bool:
    """Whether one law alone explains a recording."""
    return found.explained and len(found.chosen.model.terms) == 1


def _others(found: Search) -> list[Fit]:
    """Fits of one law of another name."""
    return [f for f in found.rivals if len(f.model.terms) == 1 and key_of(f) != key_of(found.chosen)]
