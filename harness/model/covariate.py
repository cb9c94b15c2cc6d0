"""A column that was measured beside the motion and acts on it: a pressure, a load, a temperature."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from enum import StrEnum
from typing import Self

import numpy as np

from harness.core.arrays import FloatArray


class Acts(StrEnum):
    """How a covariate enters the equation of motion."""

    FORCE = "force"
    FRICTION = "friction"
    DAMPING = "damping"


_LEAST = 1e-3
"""Share of f_k or c that is left of it in any case, so that what it is times stays finite."""


@dataclass(frozen=True, slots=True)
class Covariate:
    """A covariate P in a model; its values belong to a recording.

    acts : as a force that pushes the slider, level + gain (P - about), or on f_k or c, times 1 + gain (P - about).
    about : mean of P in the recording that was fitted. unit : of P, its name where the recording gives none.
    level : of a force, N: where P has its mean; what is proportional to a pressure is not nil there. levelled : whether
    the level is fitted: it cannot be told from an unknown zero of a spring. known : whether the gain is given, as
    further recordings of the machine have told it.
    """

    name: str
    acts: Acts
    gain: float = 0.0
    about: float = 0.0
    unit: str = ""
    level: float = 0.0
    levelled: bool = True
    known: bool = False

    @property
    def parameter(self) -> str:
        """Name of the gain among the base parameters."""
        return f"gain_{self.name}"

    @property
    def fitted(self) -> Mapping[str, float]:
        """What is fitted, by its name among the base parameters: the gain, and the level of a force."""
        gain = {} if self.known else {self.parameter: self.gain}
        return {**gain, **({self._level: self.level} if self.has_level else {})}

    @property
    def has_level(self) -> bool:
        """Whether a constant force is fitted with the gain."""
        return self.acts is Acts.FORCE and self.levelled

    def at(self, name: str, value: float) -> "Covariate":
        """The same with another value of what ``fitted`` calls so."""
        return replace(self, gain=value) if name == self.parameter else replace(self, level=value)

    def recentred(self, about: float) -> Self:
        """The same law about another value of the column, where f_k or c are what they are there."""
        moved = self.gain * (about - self.about)
        if self.acts is Acts.FORCE:
            return replace(self, about=about, level=self.level + moved)
        return replace(self, about=about, gain=self.gain / max(1.0 + moved, _LEAST))

    @property
    def _level(self) -> str:
        return f"level_{self.name}"

    def effect(self, values: FloatArray) -> FloatArray:
        """level + gain (P - about) of values P (n,): N, or a share of f_k or c."""
        return self.level + self.gain * (values - self.about)

    def effect_by(self, name: str, values: FloatArray) -> FloatArray:
        """Partials (n,) of the effect by what ``fitted`` calls so."""
        return values - self.about if name == self.parameter else np.ones(values.shape)

    @property
    def said(self) -> str:
        """The law in signs."""
        change = f"{self.parameter} ({self.name} - {self.about:.4g})"
        match self.acts:
            case Acts.FORCE:
                return f"a force {f'{self._level} + ' if self.levelled else ''}{change} that pushes the slider"
            case Acts.FRICTION:
                return f"load-dependent friction, f_k (1 + {change})"
            case Acts.DAMPING:
                return f"damping c (1 + {change})"
