"""How much a swing loses in all: what bounds damping and friction where a sequence of turning points cannot part them.

Neither is negative. So all of the loss is the most that either can have made; and where an exponential and a straight
line between the first swing and the last lie closer than their errors, that is also all that is known.
"""

import math
from dataclasses import dataclass

import numpy as np

from harness.core.arrays import FloatArray

_SEEN = 3.0
"""Standard errors from which a loss, or the bend of it, is seen."""
_LIKELY = 2.0
"""Standard errors by which a loss may be more than it seems."""
_ROUNDING = 1e-11
"""Share of a swing that is known at best: a double has 16 digits, of which a swing off its zero and a fit take some."""


@dataclass(frozen=True, slots=True)
class Loss:
    """beta : the most that -ln(q) / pi can be. size : the most that a half-cycle takes off the amplitude, its unit.

    seen : whether anything is lost. count : half-cycles over which it was looked at.
    """

    beta: float
    size: float
    seen: bool
    count: int

    def of(self, most: float) -> tuple[float, float]:
        """A number between nought and ``most``, and its standard error: none where no loss is seen, else the middle."""
        return (0.5 * most, most / math.sqrt(12.0)) if self.seen else (0.0, 0.5 * most)

    @property
    def said(self) -> str:
        """Why neither is told by itself."""
        if not self.seen:
            return f"no decay is seen over {self.count} half-cycles: damping and friction are none, within their errors"
        return (
            "the decay is too small to tell whether damping or friction makes it: each lies between none and twice its"
            " value"
        )


def loss_of(points: FloatArray, variance: FloatArray, beta_error: float) -> Loss | None:
    """The loss of a sequence of turning points (n,), signed, of these variances (n,), where it is all that is known.

    None where the sequence bends enough to part damping from friction, or grows. beta_error : as it was fitted. A
    constant in the points does no harm. nan : not seen.
    """
    swing = np.abs(np.diff(points))
    spread = variance[1:] + variance[:-1]
    at = np.flatnonzero(np.isfinite(swing) & (swing > 0.0))
    if at.size < 2:
        return None
    first, last = int(at[0]), int(at[-1])
    error = math.sqrt(spread[first] + spread[last]) + _ROUNDING * float(np.nanmax(np.abs(points)))
    begin, end, count = float(swing[first]), float(swing[last]), last - first
    fall = begin - end
    if fall < -_SEEN * error:
        return None
    bend = 0.125 * math.log(begin / end) ** 2 * begin
    most = max(fall, 0.0) + _LIKELY * error
    beta = -math.log1p(-min(most / begin, 1.0 - 1e-9)) / (math.pi * count)
    if bend > _SEEN * error and beta_error < beta / math.sqrt(12.0):
        return None
    return Loss(beta, 0.25 * most / count, fall > _SEEN * error, count)
