"""Elements of terms as words of one joint: polynomials of stiffness and damping, and springs with a dead zone.

Measured in MuJoCo 4.0: stiffness "a b c" is a x + b x^2 + c x^3, damping "a b c" is a v + b v|v| + c v^3, and a fixed
tendon with springlength "low high" pulls back beyond either of the two.
"""

import math
from collections.abc import Iterable
from dataclasses import dataclass, replace
from typing import Final, TypeAlias

import numpy as np

from harness.core.arrays import FloatArray
from harness.core.slider import Slider
from harness.model.model import ModelTerm
from harness.model.registry import TERMS
from harness.model.term import Element, Polynomial, Zone

FAR: Final = 1e6
"""m; a spring length that is never reached."""
_SAME = 1e-12
"""Share by which the two ends of a dead zone may differ and be one number, written with every digit."""

Kinds: TypeAlias = frozenset[type[Element]]
JOINT: Final[Kinds] = frozenset({Polynomial, Zone})
"""Elements with words."""


@dataclass(frozen=True, slots=True)
class JointWords:
    """What a joint is given beside the spring and the damper it has: coefficients in SI units, and zones by name."""

    stiffness: tuple[float, float, float] = (0.0, 0.0, 0.0)
    damping: tuple[float, float, float] = (0.0, 0.0, 0.0)
    zones: tuple[tuple[str, Zone], ...] = ()

    def force(self, x: FloatArray, v: FloatArray) -> FloatArray:
        """Force on the left-hand side, N; x in m, v in m/s."""
        a, b, c = self.stiffness
        d, e, f = self.damping
        total: FloatArray = x * (a + x * (b + x * c)) + v * (d + np.abs(v) * e + v * v * f)
        for _, zone in self.zones:
            total = total + zone.stiffness * (x - np.clip(x, zone.low, zone.high))
        return total


def elements(entry: ModelTerm, k: float, kinds: Kinds) -> tuple[Element, ...]:
    """The elements that say all of a term, empty where it has none or one is not among ``kinds``; k in N/m."""
    said = () if entry.term.elements is None else entry.term.elements(entry.values, k)
    return said if all(type(element) in kinds for element in said) else ()


def words_of(terms: Iterable[ModelTerm], k: float) -> JointWords:
    """Words for terms that are made of what JOINT lists; k in N/m is the spring's. Raises ValueError for others."""
    stiffness, damping, zones = [0.0, 0.0, 0.0], [0.0, 0.0, 0.0], []
    for i, entry in enumerate(terms):
        said = elements(entry, k, JOINT)
        if not said:
            raise ValueError(f"{entry.term.name} has no words of a joint")
        for element in said:
            match element:
                case Polynomial():
                    stiffness = [sum(pair) for pair in zip(stiffness, element.stiffness, strict=True)]
                    damping = [sum(pair) for pair in zip(damping, element.damping, strict=True)]
                case Zone():
                    within = replace(element, low=max(element.low, -FAR), high=min(element.high, FAR))
                    zones.append((f"{entry.term.name.replace('-', '_')}_{i}", within))
    return JointWords((stiffness[0], stiffness[1], stiffness[2]), (damping[0], damping[1], damping[2]), tuple(zones))


def term_of(element: Element, value: float) -> ModelTerm:
    """The catalogue's term of one parameter that is made of ``element`` where the parameter is 1; value : of it, SI."""
    found = next(t for t in TERMS if len(t.names) == 1 and t.elements and t.elements((1.0,), 1.0) == (element,))
    return ModelTerm(found, (value,))


def dead_zone(k: float, gap: float) -> ModelTerm:
    """The catalogue's term of a spring (N/m) that pulls beyond ``gap`` (m) of its middle alone."""
    return _made_of((gap,), k, (Polynomial(stiffness=(-k, 0.0, 0.0)), Zone(k, -gap, gap)))


def stops(zone: Zone) -> list[ModelTerm]:
    """The catalogue's terms of a spring beside another, with a dead zone about zero: of both sides, or of each."""
    k, low, high = zone.stiffness, max(zone.low, -FAR), min(zone.high, FAR)
    if math.isclose(-low, high, rel_tol=_SAME):
        return [_made_of((high, k), k, (Zone(k, -high, high),))]
    sides = [Zone(k, high=high)] if high < FAR else []
    sides += [Zone(k, low=low)] if low > -FAR else []
    return [_made_of((one.high if math.isfinite(one.high) else -one.low, k), k, (one,)) for one in sides]


def _made_of(values: tuple[float, ...], k: float, said: tuple[Element, ...]) -> ModelTerm:
    known = (one for one in TERMS if one.searched and one.elements is not None and len(one.names) == len(values))
    return ModelTerm(next(one for one in known if one.elements and one.elements(values, k) == said), values)


GRAVITY = 9.81
"""Gravity of the contact models, m/s^2."""


def coefficient(slider: Slider, force: float | None = None) -> float:
    """Coefficient of friction that turns weight into ``force`` (N), f_k when not given: f / (m g)."""
    return (slider.f_k if force is None else force) / (slider.m * GRAVITY)
