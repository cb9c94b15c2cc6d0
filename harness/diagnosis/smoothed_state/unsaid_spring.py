"""A spring where the user says that there is none: it takes nearly all off that the base leaves of the force."""

from dataclasses import dataclass

import numpy as np

from harness.core.arrays import FloatArray
from harness.diagnosis.smoothed_state.inverse_start import in_motion

MOST = 0.9
"""Share of the mean square left of the force that a spring takes off only where there is one: of 60 driven axes that
have none, with one effect or without, it takes .12 off at most, of twelve recordings of pneumatic cylinders .32."""


@dataclass(frozen=True, slots=True)
class Beside:
    """What a spring of stiffness k (N/m) takes off the mean square that the base leaves of the force."""

    k: float
    share: float

    @classmethod
    def of(cls, state: tuple[FloatArray, FloatArray, FloatArray], u: FloatArray, mass: float | None) -> "Beside":
        """By least squares over the samples in motion; state : x, v, a (n,), u : force (n,)."""
        x, v, a = state
        moving = in_motion(v)
        table = np.column_stack([v, np.sign(v), np.ones_like(v), *([a] if mass is None else [])])[moving]
        right = (u if mass is None else u - mass * a)[moving]
        without, _ = left_by(table, right)
        left, found = left_by(np.column_stack([table, x[moving]]), right)
        return cls(float(found[-1]), 1.0 - left / without if without > 0.0 else 0.0)

    @property
    def is_unsaid(self) -> bool:
        """Whether there is a spring."""
        return self.k > 0.0 and self.share > MOST


def left_by(table: FloatArray, right: FloatArray) -> tuple[float, FloatArray]:
    """Sum of squares that the columns (n, q) leave, and their factors (q,)."""
    size = np.sqrt(np.mean(table**2, axis=0))
    size[size == 0.0] = 1.0
    found = np.linalg.lstsq(table / size, right, rcond=None)[0] / size
    rest = right - table @ found
    return float(rest @ rest), found
