"""The verdict: the one place that decides what a search has come to."""

from collections.abc import Mapping
from dataclasses import dataclass, replace

from harness.diagnosis.baseline.words import evidence, few_words, strokes_of, words_of
from harness.diagnosis.fit.model_fit import Fit, LawNumber, of_laws
from harness.diagnosis.grading.clocks import beat, unresolved
from harness.diagnosis.grading.contest import Contest, by_evidence
from harness.diagnosis.grading.likely import probability
from harness.diagnosis.grading.lone import next_best, stand_ins, undecided
from harness.diagnosis.outcome import Grade, Verdict
from harness.diagnosis.residual_tests.structure import UNNAMED, Left
from harness.diagnosis.rules import (
    AMONG_NAMES,
    APART,
    FLEXIBLE,
    GAIN,
    LOOSE,
    MAIN_FROM,
    MOST_LIKELY,
    NULL_DRAWS,
    OVER_SIMULATED,
    SECOND_TERM,
    STRUCTURE,
    STRUCTURE_NAMED,
    Rule,
)
from harness.diagnosis.search.extend import key_of
from harness.diagnosis.search.search import Search


@dataclass(frozen=True, slots=True)
class Judgement:
    """What a search has come to.

    refined : the model that the verdict stands by. rival : a pair of other families that a pair is not told apart
    from, which is why it is not named. rules : those that decided.
    """

    verdict: Verdict
    refined: Fit
    rules: tuple[Rule, ...]
    rival: Fit | None = None


_BY_GRADE: Mapping[Grade | None, Verdict] = {Grade.MAIN: "main_effect", Grade.ONE_OF: "one_of"}


def judge(found: Search, graded: Contest | None = None) -> Judgement:
    """Decide.

    graded : how much of the misfit each name takes, where structure is left.
    """
    chosen, structure = found.chosen, found.left is Left.STRUCTURE
    terms = chosen.model.terms
    gates: tuple[Rule, ...] = (AMONG_NAMES, SECOND_TERM) if len(terms) > 1 else (AMONG_NAMES,)
    tested = (OVER_SIMULATED, NULL_DRAWS) if found.by_force else (STRUCTURE_NAMED if terms else STRUCTURE,)
    tested = (*tested, APART) if found.doubted_by else tested
    if structure and graded is not None:
        return Judgement(_BY_GRADE.get(graded.grade, "unexplained"), graded.refined, (*tested, *graded.rules))
    stands = not structure and not terms and found.problem.holds(chosen.model) is not None
    if structure or stands:
        return Judgement("unexplained", found.base, (*gates, *tested, *((STRUCTURE,) if stands else ())))
    rival = None if found.by_force else _near_pair(found)
    if rival is not None:
        return Judgement("unexplained", found.base, (*gates, *tested, FLEXIBLE, APART), rival)
    if terms and _unsure_beside_a_curve(found):
        return Judgement("unexplained", found.base, (*gates, *tested, MAIN_FROM))
    listed = undecided(found)
    if listed:
        # a lone law that is not decided for is listed beside what could stand in its place, or with the next where it
        # is less likely than not
        entry = terms[0]
        unlikely = bool(next_best(found)) and probability(by_evidence(found), entry.term.name) < MOST_LIKELY.value
        if stand_ins(found, entry) or unlikely:
            return Judgement("one_of", chosen, (*gates, *tested, *listed))
        gates = (*gates, *listed, MOST_LIKELY)
    return Judgement("missing_physics" if terms else "adequate", chosen, (*gates, *tested))


def weighed(found: Search, omega: float) -> Search:
    """A search whose model may meet the noise by following what it does not say, as one that explains nothing.

    A law with a clock on the swing, or on any that would do, or bent beyond its name or to nothing that is told,
    follows any other. Samples of one swing say one thing; two laws that meet the noise together may do so by following
    it, where their evidence in words of the motion is small.
    omega : of the motion, rad/s.
    """
    terms = found.chosen.model.terms
    if not terms or found.by_force or found.left is Left.STRUCTURE:
        return found
    problem, base, chosen = found.problem, found.base, found.chosen
    nothing_told = any(map(_tells_nothing, of_laws(chosen)))
    in_time = unresolved(terms, beat(base, problem, omega), problem.duration)
    if not chosen.explains_as_named or in_time or nothing_told:
        return replace(found, chosen=base, left=Left.STRUCTURE, without=())
    if len(terms) < 2:
        return found
    words = words_of(strokes_of(chosen, problem))
    more = len(chosen.free) - len(base.free)
    crowd = not problem.on_bench and few_words(base, chosen, problem)
    if evidence(base.chi2, chosen.chi2, words, more, 1.0) >= GAIN.value and not crowd:
        return found
    return replace(found, chosen=base, left=Left.STRUCTURE, without=(), doubted=chosen)


def _tells_nothing(number: LawNumber) -> bool:
    """Whether it is looser than itself, and the rate of a law that repeats in time or what shapes one that is freed."""
    rate = number.which == number.law.repeating("time")
    shape = number.law.frees != "" and number.parameter.positive
    return (rate or shape) and number.loose(LOOSE.value)


def _unsure_beside_a_curve(found: Search) -> bool:
    """Whether what explains held speeds is less likely than a main effect has to be, and a curve of no name next.

    A law stands beside such a curve as well as alone. Two laws do not, and no list is made of them.
    """
    if found.problem.moves:
        return False
    names, likely = key_of(found.chosen), by_evidence(found)
    if len(names) > 1:
        return likely.get(names, 0.0) < MAIN_FROM.value
    p = probability(likely, *names)
    unnamed = sum(one for of, one in likely.items() if UNNAMED in of and names[0] not in of)
    return p < MAIN_FROM.value and unnamed > 1.0 - p - unnamed


def _near_pair(found: Search) -> Fit | None:
    """The best pair of other families that a pair is not told apart from, None where what was found is decided.

    Two terms, one of them a flexible law, can follow an effect that no catalogue holds as well as they follow their
    own. Such a pair has near relatives: exchange a term for one of another family, and little is lost.
    """
    chosen = found.chosen
    if len(chosen.model.terms) < 2 or all(len(entry.values) < FLEXIBLE.count for entry in chosen.model.terms):
        return None
    own = {entry.term.family for entry in chosen.model.terms}
    others = (r for r in found.rivals if {entry.term.family for entry in r.model.terms} != own)
    return min((r for r in others if r.bic < chosen.bic + APART.value), key=lambda f: f.bic, default=None)
