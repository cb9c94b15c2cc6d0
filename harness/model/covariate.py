"""A column that was measured beside the motion and acts on it: a pressure, a load, a temperature."""

from dataclasses import dataclass
from enum import StrEnum

from harness.core.arrays import FloatArray


class Acts(StrEnum):
    """How a covariate enters the equation of motion."""

    FORCE = "force"
    FRICTION = "friction"
    DAMPING = "damping"


@dataclass(frozen=True, slots=True)
class Covariate:
    """A covariate P in a model; its values belong to a recording.

    acts : as a force that pushes the slider, gain (P - about), or on f_k or c, times 1 + gain (P - about).
    about : mean of P in the recording that was fitted. unit : of P, its name where the recording gives none.
    """

    name: str
    acts: Acts
    gain: float = 0.0
    about: float = 0.0
    unit: str = ""

    @property
    def parameter(self) -> str:
        """Name of the gain among the base parameters."""
        return f"gain_{self.name}"

    def effect(self, values: FloatArray) -> FloatArray:
        """gain (P - about) of values P (n,): N, or a share of f_k or c."""
        return self.gain * (values - self.about)

    @property
    def said(self) -> str:
        """The law in signs."""
        change = f"{self.parameter} ({self.name} - {self.about:.4g})"
        match self.acts:
            case Acts.FORCE:
                return f"a force {change} that pushes the slider"
            case Acts.FRICTION:
                return f"load-dependent friction, f_k (1 + {change})"
            case Acts.DAMPING:
                return f"damping c (1 + {change})"
