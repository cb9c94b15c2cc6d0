"""What was asked of a diagnosis, beside its recording."""

from dataclasses import dataclass

from harness.model.model import Restoring


@dataclass(frozen=True, slots=True)
class Asked:
    """What was asked of a diagnosis: see the options of the same names, which are checked there; s, kg."""

    restoring: Restoring = Restoring.SPRING
    zero_free: bool = False
    mass: float | None = None
    horizon: float | None = None
