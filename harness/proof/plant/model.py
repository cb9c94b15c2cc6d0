"""A plant: the base slider, its dry friction, and everything that was hidden in it.

m x'' + c x' + restoring(x) + forces + branches + friction = drive.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

from harness.core.checks import finite, not_negative, positive
from harness.core.errors import InputError

ForceLaw = Callable[[float, float, float, float], float]
"""(t, x, v, direction of sliding) -> force on the left of the equation of motion, N."""
Modulation = Callable[[float, float, float, float], float]
"""(t, x, net force without friction in N, work done against friction in J) -> factor on the level of friction."""


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


@dataclass(frozen=True, slots=True)
class DryFriction:
    """A law by which a level acts.

    act : (level in N, v, direction, acceleration without friction in m/s^2, state z) -> force in N and z'.
    sticks : whether it is set-valued at v = 0, so that the slider can be held there; a law that does not creeps.
    states : how many of its own. rate : of the fastest motion of a unit mass on it, 1/s. switch : (v, acceleration
    without friction) -> a function whose zeros are kinks of the law within sliding.
    """

    level: Level
    act: Callable[[float, float, float, float, float], tuple[float, float]]
    sticks: bool = True
    states: int = 0
    rate: float = 0.0
    switch: Callable[[float, float], float] | None = None


def coulomb(level: Level) -> DryFriction:
    """f = level sgn(v) while sliding, whatever holds it up to the break-away level while stuck."""
    return DryFriction(level, lambda height, v, d, free, z: (height * d, 0.0))


def bristle(level: Level, sigma0: float, sigma1: float) -> DryFriction:
    """z' = v - sigma0 |v| z/level, f = sigma0 z + sigma1 z' (Dahl with sigma1 = 0; LuGre with a Stribeck level)."""

    def act(height: float, v: float, d: float, free: float, z: float) -> tuple[float, float]:
        z_rate = v - sigma0 * d * v * z / max(height, 1e-300)
        return sigma0 * z + sigma1 * z_rate, z_rate

    return DryFriction(level, act, sticks=False, states=1, rate=math.sqrt(sigma0))


def regularised(level: Level, v_r: float, lead: float) -> DryFriction:
    """f = level sat((v + lead a0)/v_r), a0 the acceleration there would be without friction."""

    def act(height: float, v: float, d: float, free: float, z: float) -> tuple[float, float]:
        return height * min(max((v + lead * free) / v_r, -1.0), 1.0), 0.0

    return DryFriction(
        level, act, sticks=False, rate=level.f_k / v_r, switch=lambda v, free: abs(v + lead * free) - v_r
    )


@dataclass(frozen=True, slots=True)
class Force:
    """A force on the left. kinks : positions at which the law is not smooth, m. rate : fastest frequency, rad/s."""

    law: ForceLaw
    kinks: tuple[float, ...] = ()
    rate: float = 0.0


@dataclass(frozen=True, slots=True)
class Branch:
    """Something with states of its own that hangs on the slider.

    start : (x0, v0) -> states at the start. derivative : (x, v, own) -> time derivatives of its states.
    force : (x, v, own) -> force on the left, N. switches : (x, v, own) -> functions whose zeros are kinks.
    rate : fastest frequency in it, rad/s.
    """

    start: Callable[[float, float], Sequence[float]]
    derivative: Callable[[float, float, Sequence[float]], Sequence[float]]
    force: Callable[[float, float, Sequence[float]], float]
    switches: tuple[Callable[[float, float, Sequence[float]], float], ...] = ()
    rate: float = 0.0


@dataclass(frozen=True, slots=True)
class Knock:
    """One blow at ``time`` (s): the momentum jumps by ``impulse`` (N s)."""

    time: float
    impulse: float


@dataclass(frozen=True, slots=True)
class Drive:
    """The measured force: (t, x, v) -> N, on the right; it may close a loop. rate : fastest frequency, rad/s."""

    law: Callable[[float, float, float], float]
    rate: float = 0.0


@dataclass(frozen=True, slots=True)
class PlantModel:
    """A slider with all that is hidden in it.

    m : kg. c : N s/m. k : N/m. restoring : "spring" (k x), "pendulum" (k sin x) or "none".
    friction : the law with its level. release : the slider is held at x0 until then, s. x0 : m, v0 : m/s.
    kinks : positions at which a modulation of friction is not smooth. length : scale of the motion, m.
    """

    m: float
    c: float
    k: float
    friction: DryFriction
    x0: float
    v0: float = 0.0
    restoring: str = "spring"
    forces: tuple[Force, ...] = ()
    branches: tuple[Branch, ...] = ()
    knocks: tuple[Knock, ...] = ()
    drive: Drive | None = None
    release: float = 0.0
    kinks: tuple[float, ...] = ()
    length: float | None = None

    def __post_init__(self) -> None:
        positive("plant: m", self.m, "kg")
        not_negative("plant: c", self.c, "N s/m")
        not_negative("plant: k", self.k, "N/m")
        finite("plant: x0", self.x0)
        finite("plant: v0", self.v0)
        if self.restoring not in ("spring", "pendulum", "none"):
            raise InputError("plant: restoring", self.restoring, "spring, pendulum or none")

    @property
    def omega_n(self) -> float:
        """sqrt(k/m), rad/s; 0 on a free axis."""
        return math.sqrt(self.k / self.m) if self.restoring != "none" else 0.0

    @property
    def scale(self) -> float:
        """Length to which tolerances are relative, m."""
        return self.length if self.length is not None else max(abs(self.x0), 1e-12)


def base_model(m: float, c: float, k: float, f_k: float, x0: float, v0: float = 0.0) -> PlantModel:
    """Viscous and Coulomb friction on a linear spring, and nothing else."""
    return PlantModel(m=m, c=c, k=k, friction=coulomb(Level(f_k, f_k)), x0=x0, v0=v0)
