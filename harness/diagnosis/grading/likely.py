"""How likely what may be missing is, from the evidence of models that were fitted, whoever fitted them."""

import math
from collections.abc import Mapping

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
