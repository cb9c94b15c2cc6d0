"""How likely what may be missing is, from the evidence of models that were fitted, whoever fitted them."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from harness.diagnosis.outcome import Hypothesis
from harness.diagnosis.residual_tests.structure import UNNAMED
from harness.diagnosis.rules import OTHER_FORM, UNSEEN

_LEAST = 0.01
"""Probability below which a hypothesis is not given."""
_SURE = 0.99
"""Probability that is said at most."""
Likely = Mapping[tuple[str, ...], float]
"""Probability of each hypothesis by its names, of which none has none."""


def weighed(evidence: Mapping[tuple[str, ...], float]) -> Likely:
    """Probabilities from evidence, twice a log likelihood, that counts already how likely each name was before."""
    most = max(evidence.values())
    return _whole({names: math.exp(0.5 * (size - most)) for names, size in evidence.items()})


@dataclass(frozen=True, slots=True)
class Chosen:
    """A name of the model that a search came to. gain : evidence that the model loses without it. rivals : others that
    would have done nearly as well in its place, with by how much they are worse.
    """

    name: str
    gain: float
    rivals: Mapping[str, float]


def of_steps(steps: Sequence[Chosen], whole: float, others: Mapping[tuple[str, ...], float], choices: int) -> Likely:
    """Which names are missing, of models that a search in steps fitted: each name as likely before as any other.

    whole : evidence of all steps together, others : of other models that were fitted. choices : names that there are.
    """
    chosen = tuple(step.name for step in steps)
    sizes: dict[tuple[str, ...], float] = {(): 0.0}
    for names, size in others.items():
        ordered = *(name for name in chosen if name in names), *(name for name in names if name not in chosen)
        sizes[ordered] = size
    for step in steps:
        rest = tuple(name for name in chosen if name != step.name)
        beside = {rest: whole - step.gain, **{(*rest, n): whole - worse for n, worse in step.rivals.items()}}
        sizes |= {names: max(size, sizes.get(names, -math.inf)) for names, size in beside.items()}
    sizes[chosen] = whole
    # what speaks louder than the model that the search came to was refused, and speaks no louder than that
    prior = 2.0 * math.log(choices)
    return weighed({names: min(size, whole) - prior * len(names) for names, size in sizes.items()})


def no_likelier(likely: Likely, chosen: tuple[str, ...], choices: int) -> Likely:
    """The same, where what has more evidence than the model a search came to was refused: it is no likelier than that.

    choices : names, each as likely before as any other.
    """
    most = {names: likely[chosen] * float(choices) ** (len(chosen) - len(names)) for names in likely}
    return _whole({names: p if UNNAMED in names else min(p, most[names]) for names, p in likely.items()})


def beside_other_forms(likely: Likely, explained: float) -> Likely:
    """The same beside another effect, in a form that the catalogue lacks, that looks like the laws that explain so many
    squares, in units of the noise: what shapes it is a number more, known to one over the root of these.
    """
    named = sum(p for names, p in likely.items() if names)
    return _whole({**likely, (): OTHER_FORM.value / math.sqrt(max(explained, 1.0)) * named})


def with_unseen(likely: Likely) -> Likely:
    """The same beside a verdict that names nothing: an effect that has a name may be there.

    It is too weak, or too unlike its law, and could have any name, so that no hypothesis has its probability.
    """
    whole = 1.0 + UNSEEN.value * likely.get((), 0.0)
    return {names: p / whole for names, p in likely.items()}


def probability(of: Likely, name: str) -> float:
    """That a name is among what is missing, at most 1."""
    return min(sum(p for names, p in of.items() if name in names), 1.0)


def ranked(likely: Likely) -> tuple[Hypothesis, ...]:
    """Hypotheses that are worth a word, most likely first."""
    each = (Hypothesis(names, p) for names, p in likely.items() if p >= _LEAST)
    return tuple(sorted(each, key=lambda one: -one.probability))


def said(p: float) -> str:
    """A probability in a sentence."""
    return f"P {min(p, _SURE):.2f}"


def _whole(likely: Likely) -> Likely:
    whole = sum(likely.values())
    return {names: p / whole for names, p in likely.items()}
