"""Least squares for residuals that are dear: Levenberg and Marquardt, the partials by differences taken seldom.

Between two sets of differences the partials follow Broyden's rank-one rule (Mathematics of Computation 19, 1965), so
that a fit of seven numbers costs some twenty simulations and not a hundred.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from harness.core.arrays import FloatArray

Residual = Callable[[FloatArray], FloatArray]
FIRST_DAMPING, MOST_DAMPING = 1e-4, 1e6
POOR = 0.25
"""Share of a promised gain below which partials that are not fresh are taken anew."""


@dataclass(frozen=True, slots=True)
class Descent:
    """Where a descent ended: z (q,), the residual there (N,), its partials (N, q) as last known, chi-square."""

    z: FloatArray
    residual: FloatArray
    slopes: FloatArray
    chi2: float


def differences(residual: Residual, z: FloatArray, here: FloatArray, step: float) -> FloatArray:
    """Partials (N, q) by forward differences."""
    return np.column_stack([(residual(z + step * e) - here) / step for e in np.eye(z.size)])


def descend(
    residual: Residual,
    z: FloatArray,
    step: float,
    iterations: int,
    slopes: FloatArray | None = None,
    bounds: tuple[float, float] = (-math.inf, math.inf),
) -> Descent:
    """Least squares from z; a step that promises less than half a unit of chi-square is the last.

    step : of the differences. slopes : partials (N, q) near z, if they are known. bounds : chi-square below which there
    is no point in going on, and chi-square above which a tenth of what lies above is not worth a step.
    """
    enough, plenty = bounds
    here = residual(z)
    chi2 = float(here @ here)
    fresh = slopes is None
    j = differences(residual, z, here, step) if slopes is None else slopes
    damping = FIRST_DAMPING
    for _ in range(iterations):
        if chi2 < enough:
            break
        size = np.sqrt(np.einsum("ij,ij->j", j, j))
        size[size == 0.0] = 1.0
        scaled = j / size
        normal, gradient = scaled.T @ scaled, scaled.T @ here
        move = -np.linalg.lstsq(normal + damping * np.eye(z.size), gradient, rcond=1e-12)[0]
        promised = -float(2.0 * move @ gradient + move @ normal @ move)
        if promised < max(0.5, 0.1 * (chi2 - plenty)) or damping > MOST_DAMPING:
            if fresh or chi2 > plenty:
                break
            j, fresh, damping = differences(residual, z, here, step), True, FIRST_DAMPING
            continue
        shift = move / size
        # a step far astray ends in infinities, and is not taken
        with np.errstate(over="ignore", invalid="ignore"):
            there = residual(z + shift)
            new = float(there @ there)
        gained = (chi2 - new) / promised
        if gained > 0.0:
            j = j + np.outer((there - here - j @ shift) / float(shift @ shift), shift)
            z, here, chi2, fresh = z + shift, there, new, False
            damping *= 0.1 if gained > 0.75 else 1.0
        else:
            damping = max(10.0 * damping, 1e-3)
        if gained < POOR and not fresh:
            j, fresh = differences(residual, z, here, step), True
    return Descent(z, here, j, chi2)
