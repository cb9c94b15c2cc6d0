"""Dry friction: how high the level is (curve over speed, modulations) and by which law it acts."""

import math
from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import dataclass
from typing import final

Modulation = Callable[[float, float, float, float], float]
"""(t, x, net force without friction in N, work done against friction in J) -> factor on the level."""


@final
@dataclass(frozen=True, slots=True)
class Level:
    """The friction level, N.

    f_k : kinetic level. f_s : break-away level. v_s : Stribeck speed, m/s, or None for a flat curve.
    modulations : factors that multiply both levels; the product is never below 0.
    """

    f_k: float
    f_s: float
    v_s: float | None = None
    modulations: tuple[Modulation, ...] = ()

    def _factor(self, t: float, x: float, net: float, work: float) -> float:
        factor = 1.0
        for modulation in self.modulations:
            factor *= modulation(t, x, net, work)
        return max(factor, 0.0)

    def sliding(self, t: float, x: float, v: float, net: float, work: float) -> float:
        """Level while sliding at speed v, N."""
        level = self.f_k
        if self.v_s is not None:
            level += (self.f_s - self.f_k) * math.exp(-((v / self.v_s) ** 2))
        return level * self._factor(t, x, net, work) if self.modulations else level

    def break_away(self, t: float, x: float, net: float, work: float) -> float:
        """Level that holds the slider while stuck, N."""
        return self.f_s * self._factor(t, x, net, work) if self.modulations else self.f_s


class DryFriction(ABC):
    """A law by which a level acts. ``sticks`` tells whether the law is set-valued at v = 0."""

    level: Level

    @property
    @abstractmethod
    def sticks(self) -> bool:
        """Whether the slider can be held at v = 0 exactly."""

    @property
    @abstractmethod
    def states(self) -> int:
        """Number of states of the law."""

    @property
    @abstractmethod
    def rate(self) -> float:
        """Fastest rate in the law per newton of level and kilogram: see each law; 1/s."""

    @abstractmethod
    def act(self, level: float, v: float, d: float, free: float, z: float) -> tuple[float, float]:
        """Friction force in N and the rate of the law's state; free: acceleration without friction, m/s^2."""

    @abstractmethod
    def switch(self, v: float, free: float) -> float:
        """A function whose zeros are kinks of the law; constant where there are none."""


@final
@dataclass(frozen=True, slots=True)
class Coulomb(DryFriction):
    """f = level sgn(v) while sliding, whatever holds it up to the break-away level while stuck."""

    level: Level

    @property
    def sticks(self) -> bool:
        """True."""
        return True

    @property
    def states(self) -> int:
        """None."""
        return 0

    @property
    def rate(self) -> float:
        """Nothing faster than the motion."""
        return 0.0

    def act(self, level: float, v: float, d: float, free: float, z: float) -> tuple[float, float]:
        """level d."""
        return level * d, 0.0

    def switch(self, v: float, free: float) -> float:
        """No kink within sliding."""
        return 1.0


@final
@dataclass(frozen=True, slots=True)
class Bristle(DryFriction):
    """z' = v - sigma0 |v| z/level, f = sigma0 z + sigma1 z' (Dahl with sigma1 = 0; LuGre with a Stribeck level)."""

    level: Level
    sigma0: float
    sigma1: float

    @property
    def sticks(self) -> bool:
        """False: it creeps."""
        return False

    @property
    def states(self) -> int:
        """The bristle's deflection."""
        return 1

    @property
    def rate(self) -> float:
        """sqrt(sigma0): the frequency of a unit mass on the bristles."""
        return math.sqrt(self.sigma0)

    def act(self, level: float, v: float, d: float, free: float, z: float) -> tuple[float, float]:
        """sigma0 z + sigma1 z' and z'."""
        z_rate = v - self.sigma0 * d * v * z / max(level, 1e-300)
        return self.sigma0 * z + self.sigma1 * z_rate, z_rate

    def switch(self, v: float, free: float) -> float:
        """No kink but the reversal."""
        return 1.0


@final
@dataclass(frozen=True, slots=True)
class Regularised(DryFriction):
    """f = level sat((v + lead a0)/v_r), a0 the acceleration there would be without friction."""

    level: Level
    v_r: float
    lead: float

    @property
    def sticks(self) -> bool:
        """False: it creeps."""
        return False

    @property
    def states(self) -> int:
        """None."""
        return 0

    @property
    def rate(self) -> float:
        """level/v_r for a unit mass."""
        return self.level.f_k / self.v_r

    def act(self, level: float, v: float, d: float, free: float, z: float) -> tuple[float, float]:
        """The saturated line."""
        return level * min(max((v + self.lead * free) / self.v_r, -1.0), 1.0), 0.0

    def switch(self, v: float, free: float) -> float:
        """Where the line saturates."""
        return abs(v + self.lead * free) - self.v_r
