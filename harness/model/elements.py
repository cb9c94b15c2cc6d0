"""What a term is made of in words that modelling formats share; which of them an engine can say is the engine's affair.

Units SI, forces on the left-hand side of m x'' + c x' + k x + f = u.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import TypeAlias


@dataclass(frozen=True, slots=True)
class Polynomial:
    """A restoring force a x + b x^2 + c x^3 and a damping force a v + b v|v| + c v^3."""

    stiffness: tuple[float, float, float] = (0.0, 0.0, 0.0)
    damping: tuple[float, float, float] = (0.0, 0.0, 0.0)


@dataclass(frozen=True, slots=True)
class Zone:
    """A spring of this stiffness (N/m) that acts below ``low`` and above ``high`` (m)."""

    stiffness: float
    low: float = -math.inf
    high: float = math.inf


@dataclass(frozen=True, slots=True)
class Push:
    """A constant force (N) in the direction of x."""

    force: float


Element: TypeAlias = Polynomial | Zone | Push
MadeOf: TypeAlias = Callable[[tuple[float, ...], float], tuple[Element, ...]]
"""From the values of a term's parameters and the spring's stiffness k (N/m) to elements that say the whole term."""
