"""A number with its standard error and unit, or the reason why there is none."""

import math
from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Quantity:
    """An estimate.

    value : None when the estimate was refused. stderr : one standard error, None only with a reason.
    unit : SI symbol, "1" for a pure number. why : the reason for what is missing.
    """

    value: float | None
    stderr: float | None
    unit: str
    why: str | None = None

    def __post_init__(self) -> None:
        if self.value is not None and not math.isfinite(self.value):
            raise ValueError(f"a quantity is finite or refused, not {self.value}")
        if (self.value is None or self.stderr is None) and not self.why:
            raise ValueError("a quantity without value or standard error says why")

    @classmethod
    def refused(cls, unit: str, why: str) -> "Quantity":
        """An estimate that could not be made, with the reason."""
        return cls(None, None, unit, why)
