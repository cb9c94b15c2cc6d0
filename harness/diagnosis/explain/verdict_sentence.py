"""The verdict in a sentence."""

from collections.abc import Sequence

from harness.diagnosis.outcome import Grade, Mechanism, Outcome
from harness.diagnosis.rules import MOST_LIKELY

_NOTHING = "Viscous and Coulomb friction explain {} to {} noise: nothing is left out that {} could show."
_NOBODY = (
    "Viscous and Coulomb friction do not explain {}, and no entry of the catalogue is the main part of what they leave."
)
_ONE = ("this recording", "its", "it", "this recording")
_SURE = 0.99
"""Probability that is not told apart from certainty."""
_SEVERAL = ("these recordings", "their", "they", "these recordings together")


def sentence_of(outcome: Outcome, has: Sequence[str] = ()) -> str:
    """The verdict in a sentence or two, with numbers, and what was chosen before it.

    has : names of the terms that the user's own simulation has, which then does not leave them out.
    """
    return " ".join((_verdict(outcome, has), *outcome.problem.choices))


def _verdict(outcome: Outcome, has: Sequence[str]) -> str:
    # beside the names that share a verdict a model may hold small parts
    parts = (Grade.TABULATED, Grade.MINOR) if outcome.verdict == "one_of" else (Grade.TABULATED,)
    it, its, they, _ = _SEVERAL if outcome.problem.alone else _ONE
    graded = outcome.verdict in ("main_effect", "one_of", "unexplained")
    # a constant force that the base has
    own = [m for m in outcome.mechanisms if graded and m.grade is Grade.EXPLAINS]
    named = [m for m in outcome.mechanisms if m.grade not in parts and m not in own]
    words = [m.name.replace("-", " ") for m in named]
    if outcome.verdict == "adequate":
        return _NOTHING.format(it, its, they)
    if outcome.verdict == "missing_physics":
        said = " ".join(m.statement for m in outcome.mechanisms)
        if len(words) == 1 and MOST_LIKELY in outcome.rules:
            sure = f"({_likely(outcome)}explains {it} to {its} noise)"
            return f"Most likely missing: {words[0]}{_had(outcome, has)} {sure}: {said}"
        return f"{_left_out([m.name for m in outcome.mechanisms], has)}: {said}"
    left = "" if outcome.remainder is None else f" {_capital(outcome.remainder.looks_like)}."
    beside = "".join(f" Beside it: {m.statement}" for m in own)
    return f"{_graded(outcome, named, has)}{beside}{_tabulated(outcome)}{left}"


def _graded(outcome: Outcome, named: Sequence[Mechanism], has: Sequence[str]) -> str:
    """Which names are how much of what is left out."""
    words = [m.name.replace("-", " ") for m in named]
    it, its, _, these = _SEVERAL if outcome.problem.alone else _ONE
    share = _percent(named[0].share) if words else ""
    leaves = "viscous and Coulomb friction leave" if has else "the simulation leaves"
    if outcome.verdict == "main_effect":
        over = 1.0 if outcome.remainder is None else outcome.remainder.over_noise
        return (
            f"Most likely missing: {words[0]}{_had(outcome, has)} ({_likely(outcome)}{share} of the misfit):"
            f" {named[0].statement} The residual is {over:.2g} times the sensors' noise."
        )
    if outcome.verdict == "one_of":
        one_of = f"one of {', '.join(words[:-1])} or {words[-1]}"
        if outcome.remainder is None:
            others = "the other" if len(words) == 2 else "the others"
            return (
                f"What {leaves} out is {one_of}: {words[0]} explains {it} to {its} noise, {others} nearly as well, and"
                f" {these} cannot tell which."
            )
        return (
            f"The main thing that {leaves} out is {one_of}; {these} cannot tell which. The first takes {share} of the"
            " misfit off."
        )
    minor = f" The largest single part of it is {words[0]} ({share})." if words else ""
    return f"{_NOBODY.format(it)}{minor}"


def _likely(outcome: Outcome) -> str:
    """Probability of the first name, where it is known."""
    p = outcome.mechanisms[0].probability
    return "" if p is None else f"P {min(p, _SURE):.2f}, "


def _left_out(names: Sequence[str], has: Sequence[str]) -> str:
    """What explains the recording, and how much of it the simulation has."""
    own, missing = ([n.replace("-", " ") for n in names if (n in has) is inside] for inside in (True, False))
    if not own:
        return f"The simulation leaves out {' and '.join(missing)}"
    if not missing:
        return f"Viscous and Coulomb friction leave out {' and '.join(own)}, which your simulation has"
    return f"The simulation has {' and '.join(own)} and leaves out {' and '.join(missing)}"


def _had(outcome: Outcome, has: Sequence[str]) -> str:
    """Of the first name: that the user's simulation has it."""
    return ", which your simulation has" if outcome.mechanisms[0].name in has else ""


def _tabulated(outcome: Outcome) -> str:
    """What has no name, as a table."""
    tables = [m for m in outcome.mechanisms if m.grade is Grade.TABULATED]
    if not tables:
        return ""
    said = " ".join(dict.fromkeys(m.statement for m in tables))
    return f" What has no name is in the model as a table that takes {_percent(tables[0].share)} off. {said}"


def _percent(share: float | None) -> str:
    return "an unknown share" if share is None else f"{100.0 * share:.0f} %"


def _capital(text: str) -> str:
    return f"{text[0].upper()}{text[1:]}"
