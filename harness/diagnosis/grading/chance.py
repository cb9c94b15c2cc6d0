"""How likely a name that stands apart is the main effect, and not what several small effects come to together.

Small effects sum up to one law or another by chance; where other laws take nearly as much off, where the law takes
less beside another, where its own numbers are loose, and where there are many cycles to see small effects in, that is
likely. How likely, a logistic regression says (Cox 1958, J. R. Stat. Soc. B 20, 215) on simulated machines, of which
half have a main effect: ``python -m benchmarks.calibrate chance`` makes its weights, and ``force-chance`` those of a
fitted force, whose path comes back to the same places at other speeds, so that sums are parted more often.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from scipy.special import expit

from harness.core.arrays import FloatArray
from harness.diagnosis.rules import (
    CHANCE,
    CHANCE_ALIKE,
    CHANCE_COMPANY,
    CHANCE_INTERCEPT,
    CHANCE_LONG,
    CHANCE_LOOSE,
    CHANCE_OF_SHARE,
    FORCE_CHANCE,
    FORCE_CHANCE_ALIKE,
    FORCE_CHANCE_COMPANY,
    FORCE_CHANCE_INTERCEPT,
    FORCE_CHANCE_LONG,
    FORCE_CHANCE_LOOSE,
    FORCE_CHANCE_OF_SHARE,
    Rule,
)

FEATURES = ("alike", "loose", "long", "share", "company")
"""What it hangs on, in the order of the weights."""
_LEAST_SHARE = 0.01
"""Of what counts as a share."""
_SURELY = 1e-12
"""Chance against what is certain."""
_SURE, _LOOSE = 0.001, 10.0
"""Relative standard errors beyond which more says nothing more."""


@dataclass(frozen=True, slots=True)
class Seen:
    """What is known of a name that stands apart.

    share : of the misfit that it takes off; others : the same of every other name. loosest : largest relative standard
    error of its parameters, nan where none is known. cycles : of the motion. company : share that it takes beside the
    other with which it leaves least.
    """

    share: float
    others: tuple[float, ...]
    loosest: float
    cycles: float
    company: float

    @property
    def features(self) -> FloatArray:
        """(5,). alike : sum of squares of the others' shares, in its own. loose : log of the loosest relative standard
        error. long : log of the cycles. share. company.
        """
        loosest = 1.0 if math.isnan(self.loosest) else min(max(self.loosest, _SURE), _LOOSE)
        relative = [max(one, 0.0) / max(self.share, _LEAST_SHARE) for one in self.others]
        return np.array(
            [
                sum(one**2 for one in relative),
                math.log(loosest),
                math.log(max(self.cycles, 1.0)),
                self.share,
                self.company,
            ]
        )


@dataclass(frozen=True, slots=True)
class Odds:
    """What a chance hangs on: an intercept and a weight for each feature. least : from which chance on it is named."""

    least: Rule
    intercept: float
    weights: tuple[float, ...]

    @classmethod
    def by(cls, least: Rule, intercept: Rule, *weights: Rule) -> "Odds":
        """As the rules have them."""
        return cls(least, intercept.value, tuple(rule.value for rule in weights))

    def chance(self, seen: Seen) -> float:
        """Of the name to be the main effect, on machines of which half have one."""
        return float(expit(self.intercept + seen.features @ np.array(self.weights)))


OF_MOTION = Odds.by(
    *(CHANCE, CHANCE_INTERCEPT, CHANCE_ALIKE, CHANCE_LOOSE, CHANCE_LONG, CHANCE_OF_SHARE, CHANCE_COMPANY)
)
"""Where the motion is followed."""
OF_FORCES = Odds.by(
    *(FORCE_CHANCE, FORCE_CHANCE_INTERCEPT, FORCE_CHANCE_ALIKE, FORCE_CHANCE_LOOSE, FORCE_CHANCE_LONG),
    *(FORCE_CHANCE_OF_SHARE, FORCE_CHANCE_COMPANY),
)
"""Where the force is fitted."""


def shared_out(chances: Mapping[str, float], first: str = "") -> dict[str, float]:
    """Probability of each name to be the main effect where at most one is, "" for none; most likely first.

    chances : of each by itself. By the odds of each beside one for none; ``first`` : whose chance is known beside the
    others, so that these share the rest.
    """
    odds = {name: p / max(1.0 - p, _SURELY) for name, p in chances.items() if name != first}
    rest = (1.0 - chances.get(first, 0.0)) / (1.0 + sum(odds.values()))
    found = {"": rest, **{name: rest * one for name, one in odds.items()}}
    found |= {first: chances[first]} if first else {}
    return dict(sorted(found.items(), key=lambda one: -one[1]))
