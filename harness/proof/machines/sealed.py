"""A machine as a sealed answer has it: what fits decide may come out otherwise on another processor.

Fits set how strong its effects are, how large its noise is, and whether a draw is taken. One that ends elsewhere makes
another recording of the same seed. With what was sealed in place of these it is the same to rounding, or it does not
follow from the seed. Of 600 machines that another processor drew, nine had another strength, by 1.7 % in the median and
by a factor of 1.9 at most, two another noise, and one was not taken.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Self

from harness.core.errors import InputError
from harness.proof.machines.effects import scaled
from harness.proof.machines.rigs import Effects
from harness.proof.plant.base import Base
from harness.proof.plant.effects import Values

MOST_MOVED = 2.0
"""Factor within which a strength, or a noise, is the same on two processors."""
SAME = 1e-6
"""Relative difference that another processor may make in every other number."""


@dataclass(frozen=True, slots=True)
class Sealed:
    """What a sealed answer says that fits decide. noise : standard deviation by channel, jittered times included."""

    effects: Effects
    noise: Mapping[str, float]

    @classmethod
    def of(cls, answer: Mapping[str, Any]) -> Self:
        """From an answer; InputError where it is not one of a machine."""
        effects, noise = answer.get("plant"), answer.get("noise")
        parts = [effects, noise, *(effects.values() if isinstance(effects, dict) else ())]
        if not all(isinstance(part, dict) for part in parts):
            raise InputError("answer", "no effects and noise of a machine", "those of a sealed answer are accepted")
        assert isinstance(effects, dict)
        assert isinstance(noise, dict)
        return cls(effects, noise)

    def holds(self, effects: Effects, base: Base) -> bool:
        """Whether these are its effects, but for how strong they are."""
        return effects.keys() == self.effects.keys() and all(
            _is_same(name, effects[name], self.effects[name], base) for name in effects
        )

    def in_place_of(self, effects: Effects) -> Effects:
        """Its effects, in the order of those that came out."""
        return {name: dict(self.effects[name]) for name in effects}

    def sigma(self, channel: str, own: float, late: float) -> float:
        """Standard deviation of what is added to a channel, to three digits as it was drawn; own where it is another.

        late : what jittered times add to the channel.
        """
        total = self.noise.get(channel)
        if not isinstance(total, int | float) or not late <= total:
            return own
        said = math.sqrt(total**2 - late**2)
        return float(f"{said:.3g}") if own / MOST_MOVED <= said <= own * MOST_MOVED else own


def _is_same(name: str, own: Values, sealed: Values, base: Base) -> bool:
    if own.keys() != sealed.keys():
        return False
    weak, strong = (scaled(name, own, factor, base) for factor in (1.0 / MOST_MOVED, MOST_MOVED))
    return all(_is_within(sealed[key], *_reach(own[key], weak[key], strong[key])) for key in own)


def _reach(own: float, weak: float, strong: float) -> tuple[float, float]:
    """Where a number may lie: that of a strength anywhere between weaker and stronger, any other where it is."""
    return (own, own) if weak == strong else (min(own, weak, strong), max(own, weak, strong))


def _is_within(said: Any, low: float, high: float) -> bool:
    return isinstance(said, int | float) and low - SAME * abs(low) <= said <= high + SAME * abs(high)
