"""What was asked of a diagnosis, beside its recording."""

from dataclasses import dataclass

from harness.core.checks import positive
from harness.model.model import Restoring


@dataclass(frozen=True, slots=True)
class Asked:
    """What was asked of a diagnosis: see the options of the same names; horizon in s, mass in kg."""

    restoring: Restoring = Restoring.SPRING
    zero_free: bool = False
    mass: float | None = None
    horizon: float | None = None

    def __post_init__(self) -> None:
        if self.horizon is not None:
            positive("--horizon", self.horizon, "s")
        if self.mass is not None:
            positive("--mass", self.mass, "kg")
