"""Figures at the two ends of each half-cycle follow a geometric recursion; weighted least squares on its few
unknowns.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from harness.core.arrays import FloatArray
from harness.fit.least_squares import Residual, Stop, Until, covariance_of, least_squares

Model = Callable[[FloatArray], tuple[FloatArray, FloatArray]]
"""Parameters (p,) to values (K,2) at start and end of each half-cycle, and their derivatives (K,2,p)."""
_ROUNDING = 1e-12
"""Share of the squares below which what a step takes off is lost in their rounding (1e-16 a value, many values)."""


@dataclass(frozen=True, slots=True)
class SequenceFit:
    """Parameters (p,), their covariance (p,p), and chi-square per degree of freedom (1 when there is none left)."""

    theta: FloatArray
    covariance: FloatArray
    scatter: float
    squares: float


def fit_sequence(values: FloatArray, whiten: FloatArray, model: Model, start: FloatArray) -> SequenceFit:
    """Fit ``values`` (K,2), weighted by ``whiten`` (K,2,2) (inverse Cholesky factors; zero rows leave a figure out),
    from ``start`` (p,).
    """
    clean = np.where(np.isfinite(values), values, 0.0)

    def evaluated(theta: FloatArray) -> Residual:
        predicted, slope = model(theta)
        left = np.einsum("kij,kj->ki", whiten, clean - predicted).ravel()
        return Residual(left, np.einsum("kij,kjp->kip", whiten, slope).reshape(left.size, -1))

    with np.errstate(over="ignore", invalid="ignore"):  # a trial may run away; it is then refused
        found = least_squares(evaluated, start.astype(np.float64), Until(share=1e-15, iterations=60))
    theta, squares = found.coordinates, found.point.squares
    if found.stop in (Stop.CONVERGED, Stop.NO_DESCENT):
        # squares are flat where they are least, half the digits of theta are rounding; their slope is not
        last = np.linalg.lstsq(found.point.partials, found.point.residual, rcond=None)[0]
        if float(found.point.residual @ found.point.partials @ last) < _ROUNDING * squares:
            theta = theta + last
    used = int(np.count_nonzero(np.any(whiten != 0.0, axis=2)))
    freedom = used - theta.size
    return SequenceFit(theta, covariance_of(found.point.partials), squares / freedom if freedom > 0 else 1.0, squares)


def whitening(covariance: FloatArray) -> FloatArray:
    """Inverse Cholesky factors (K,2,2) of covariances (K,2,2)."""
    first = np.sqrt(np.maximum(covariance[:, 0, 0], 1e-300))
    cross = covariance[:, 0, 1] / first
    second = np.sqrt(np.maximum(covariance[:, 1, 1] - cross**2, 1e-12 * covariance[:, 1, 1] + 1e-300))
    out = np.zeros_like(covariance)
    out[:, 0, 0] = 1.0 / first
    out[:, 1, 0] = -cross / (first * second)
    out[:, 1, 1] = 1.0 / second
    return out


def powers(q: float, count: int) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
    """q^k and 1 + q + .. + q^(k-1) for k < count, each with its derivative by q; arrays (count,)."""
    k = np.arange(count)
    power = q**k
    by_power = k * q ** np.maximum(k - 1, 0)
    total = np.concatenate([[0.0], np.cumsum(power[:-1])])
    by_total = np.concatenate([[0.0], np.cumsum(by_power[:-1])])
    return np.asarray(power, dtype=np.float64), np.asarray(by_power, dtype=np.float64), total, by_total


_SEEN = 3.0
"""Standard errors from which a loss, or the bend of it, is seen."""
_LIKELY = 2.0
"""Standard errors by which a loss may be more than it seems."""
_LOSS_ROUNDING = 1e-11
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
    error = math.sqrt(spread[first] + spread[last]) + _LOSS_ROUNDING * float(np.nanmax(np.abs(points)))
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
