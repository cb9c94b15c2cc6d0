"""Terms that a joint of MuJoCo has words for: polynomials of stiffness and damping, and springs with a dead zone.

Measured in MuJoCo 4.0: stiffness "a b c" is a x + b x^2 + c x^3, damping "a b c" is a v + b v|v| + c v^3, and a fixed
tendon with springlength "low high" pulls back beyond either of the two.
"""

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Final

import numpy as np

from harness.core.arrays import FloatArray
from harness.model.model import ModelTerm

FAR: Final = 1e6
"""m; a spring length that is never reached."""

NAMES: Final = frozenset({"quadratic-stiffness", "cubic-stiffness", "quadratic-drag", "end-stop", "backlash"})
"""Catalogue names with words."""


@dataclass(frozen=True, slots=True)
class Zone:
    """A spring of this stiffness (N/m) that acts below ``low`` and above ``high`` (m)."""

    name: str
    stiffness: float
    low: float
    high: float


@dataclass(frozen=True, slots=True)
class JointWords:
    """What a joint is given beside the spring and the damper it has: coefficients in SI units, and zones."""

    stiffness: tuple[float, float, float] = (0.0, 0.0, 0.0)
    damping: tuple[float, float, float] = (0.0, 0.0, 0.0)
    zones: tuple[Zone, ...] = ()

    def force(self, x: FloatArray, v: FloatArray) -> FloatArray:
        """Force on the left-hand side, N; x in m, v in m/s."""
        a, b, c = self.stiffness
        d, e, f = self.damping
        total: FloatArray = x * (a + x * (b + x * c)) + v * (d + np.abs(v) * e + v * v * f)
        for zone in self.zones:
            total = total + zone.stiffness * (x - np.clip(x, zone.low, zone.high))
        return total


def words_of(terms: Iterable[ModelTerm], k: float) -> JointWords:
    """Words for terms of NAMES; k in N/m is the spring's, which a backlash takes over."""
    stiffness, damping, zones = [0.0, 0.0, 0.0], [0.0, 0.0, 0.0], []
    for i, entry in enumerate(terms):
        match entry.term.name:
            case "quadratic-stiffness":
                stiffness[1] += entry.value("k2")
            case "cubic-stiffness":
                stiffness[2] += entry.value("k3")
            case "quadratic-drag":
                damping[1] += entry.value("c2")
            case "end-stop":
                gap, side = entry.value("gap"), entry.term.variant
                low, high = -FAR if side == "positive" else -gap, FAR if side == "negative" else gap
                zones.append(Zone(f"end_stop_{i}", entry.value("k_stop"), low, high))
            case "backlash":
                stiffness[0] -= k
                zones.append(Zone(f"backlash_{i}", k, -entry.value("gap"), entry.value("gap")))
            case name:
                raise ValueError(f"{name} has no words of a joint")
    return JointWords((stiffness[0], stiffness[1], stiffness[2]), (damping[0], damping[1], damping[2]), tuple(zones))
