"""A plant: the base slider and everything that was hidden in it."""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

from harness.core.checks import finite, not_negative, positive
from harness.core.errors import InputError
from harness.proof.plant.friction import Coulomb, DryFriction, Level

ForceLaw = Callable[[float, float, float, float], float]
"""(t, x, v, d) -> force on the left of the equation of motion, N."""


@dataclass(frozen=True, slots=True)
class Force:
    """A force of (x, v, t), on the left of m x'' + c x' + k x + f = u.

    law : (t, x, v, d) -> N. kinks : positions at which the law is not smooth, m. rate : fastest frequency in it, rad/s.
    """

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
    """m x'' + c x' + restoring(x) + forces + branches + friction = drive.

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
            raise InputError("plant: restoring", self.restoring, "spring, pendulum or none is accepted")

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
    return PlantModel(m=m, c=c, k=k, friction=Coulomb(Level(f_k, f_k)), x0=x0, v0=v0)
