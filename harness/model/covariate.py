"""A column that was measured beside the motion and acts on it: a pressure, a load, a temperature; and laws of it.

It pushes, or makes friction or damping more or less. Its laws are no names of the catalogue: what they are given is a
recording's. Behind its parameters each finds the place in theta of its table (``ModelTerm.given``): begin (s),
1 / step, number of values less 1, and the values, the column less its mean.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from enum import StrEnum
from typing import Final, Self

import numpy as np

from harness.core.arrays import FloatArray
from harness.core.jit import lean
from harness.model.law import D_PARAMETER, D_T, D_V, VALUE, VISCOUS
from harness.model.term import Parameter, Slot, Term


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


BEGIN, RATE, LAST, FIRST_VALUE = range(4)


@lean
def change(t: float, theta: FloatArray, at: int) -> tuple[float, float]:
    """Value and slope of a table at t, s, linear between its values and constant outside."""
    u = (t - theta[at + BEGIN]) * theta[at + RATE]
    last = theta[at + LAST]
    # nan too: it must not become a place in memory
    if not u > 0.0:
        return theta[at + FIRST_VALUE], 0.0
    if u >= last:
        return theta[at + FIRST_VALUE + int(last)], 0.0
    i = int(u)
    low, high = theta[at + FIRST_VALUE + i], theta[at + FIRST_VALUE + i + 1]
    return low + (u - i) * (high - low), (high - low) * theta[at + RATE]


def force(x: float, v: float, t: float, theta: FloatArray, o: int, out: FloatArray) -> None:
    """-(level + gain (P - mean)): it stands on the right side."""
    value, rate = change(t, theta, int(theta[o + 2]))
    out[VALUE] = -(theta[o + 1] + theta[o] * value)
    out[D_T] = -theta[o] * rate
    out[D_PARAMETER] = -value
    out[D_PARAMETER + 1] = -1.0


def friction(x: float, v: float, t: float, theta: FloatArray, o: int, out: FloatArray) -> None:
    """Factor 1 + gain (P - mean), never below 0."""
    value, rate = change(t, theta, int(theta[o + 1]))
    factor = 1.0 + theta[o] * value
    if factor > 0.0:
        out[VALUE] = factor
        out[D_T] = theta[o] * rate
        out[D_PARAMETER] = value


def damping(x: float, v: float, t: float, theta: FloatArray, o: int, out: FloatArray) -> None:
    """c gain (P - mean) v, which with c v is never below 0 times it."""
    value, rate = change(t, theta, int(theta[o + 1]))
    c, more = theta[VISCOUS], theta[o] * value
    if more > -1.0:
        out[VALUE] = c * more * v
        out[D_V] = c * more
        out[D_T] = c * theta[o] * rate * v
        out[D_PARAMETER] = c * value * v
    else:
        out[VALUE] = -c * v
        out[D_V] = -c


def _given(acts: Acts, family: str, slot: Slot, said: str, law: Callable[..., None], *more: Parameter) -> Term:
    parameters = (Parameter("gain", "1", none=0.0), *more)
    nothing = (0.0,) * len(parameters)
    return Term(f"given-{acts}", family, slot, parameters, said, law, example=nothing, searched=False)


_LEVEL = Parameter("level", "N", none=0.0)
GIVEN: Final = {
    Acts.FORCE: _given(Acts.FORCE, "environment", Slot.SMOOTH, "A measured column pushes the slider.", force, _LEVEL),
    Acts.FRICTION: _given(
        Acts.FRICTION, "friction", Slot.FRICTION_MODULATION, "Friction depends on a measured column.", friction
    ),
    Acts.DAMPING: _given(Acts.DAMPING, "damping", Slot.SMOOTH, "Damping depends on a measured column.", damping),
}
"""The law of each way in which a covariate may act."""
