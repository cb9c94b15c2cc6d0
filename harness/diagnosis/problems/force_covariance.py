"""What the noise of position, speed and force leaves of a force that is asked of a measured motion.

A second difference of a position's noise is blue: of neighbouring means one is too large where the next is too small,
so that long stretches tell far more of a force than their means one by one. Near a reversal, where a motion is smoothed
over few samples, a mean is many times as uncertain as elsewhere. Beside both stands what a model leaves, of which
nothing is known but how large it is.
"""

import math
from dataclasses import dataclass

import numpy as np
from scipy.linalg import LinAlgError, cholesky_banded, solve_banded
from scipy.optimize import minimize
from scipy.sparse import csr_array, eye_array

from harness.core.arrays import FloatArray
from harness.diagnosis.problems.differences import sloped
from harness.diagnosis.problems.measured import Measured
from harness.model.model import Model

_LEAST, _MOST = np.array([-2.0, -2.0, -1.0]), 0.5
"""Powers of ten of a residual's rms between which its parts lie, by the motion, by the force and what is left: smoothed
alike as they are, motion and force never agree better than to a tenth of what they differ by."""
_STARTS = ((-0.3, -1.5, -0.8), (-1.5, -0.3, -0.8), (-0.5, -0.5, -0.3))
"""The same, where the likeliest are looked for from: mostly the motion, mostly the force, mostly neither."""
_ENDS = {"xatol": 0.02, "fatol": 0.1, "maxfev": 120}
"""Where that ends: a hundredth moves nothing."""


@dataclass(frozen=True, slots=True)
class ForceCovariance:
    """What the noise of a force that is asked of a motion consists of.

    base : the model that asks for it. motion : noise of the position, m, or of the speed, m/s, that is
    differentiated. force : of the recorded force, N. left : N, of means over blocks, what remains, the same everywhere.
    sensors : N, deviation of most means by the noise of the motion and all scatter of the force. usual : N, by what
    there is of each, of which others are multiples.
    """

    base: Model
    motion: float
    force: float
    left: float
    sensors: float
    usual: float

    @classmethod
    def likeliest(cls, seen: Measured, base: Model, residual: FloatArray, scatter: float) -> "ForceCovariance":
        """The noise that a residual (m,), N, of a base model is likeliest with; scatter : N, of the recorded force.

        A force that scatters may be a controller's own, which the slider has felt, and a position finer than any noise
        that is looked for: what neighbouring means have in common tells either.
        """
        of_motion, of_force = _of_units(seen, base)
        size = math.sqrt(float(np.mean(residual**2)))
        units = size / np.sqrt([float(np.median(one.diagonal())) for one in (of_motion, of_force)])

        def sizes(powers: FloatArray) -> tuple[float, float, float]:
            motion, force, left = (10.0 ** np.clip(powers, _LEAST, _MOST) * [*units, size]).tolist()
            return motion, min(force, scatter), left

        def bands(powers: FloatArray) -> FloatArray:
            motion, force, left = sizes(powers)
            return _bands(motion**2 * of_motion + force**2 * of_force, left)

        def unlikely(powers: FloatArray) -> float:
            try:
                factor = cholesky_banded(bands(powers), lower=True)
            except LinAlgError:
                return math.inf
            return 2.0 * float(np.sum(np.log(factor[0]))) + float(np.sum(white(factor, residual) ** 2))

        fits = (minimize(unlikely, one, method="Nelder-Mead", options=_ENDS) for one in _STARTS)
        powers = min(fits, key=lambda fit: float(fit.fun)).x
        motion, force, left = sizes(powers)
        usual = math.sqrt(float(np.median(bands(powers)[0])))
        most = motion**2 * of_motion.diagonal() + scatter**2 * of_force.diagonal()
        sensors = math.sqrt(float(np.median(most)))
        return cls(base, motion, force, left, sensors, usual)

    def factor(self, seen: Measured) -> FloatArray:
        """Lower Cholesky factor over the blocks that count, by diagonals, in units of the usual deviation."""
        of_motion, of_force = _of_units(seen, self.base)
        bands = _bands(self.motion**2 * of_motion + self.force**2 * of_force, self.left)
        return np.asarray(cholesky_banded(bands / self.usual**2, lower=True))


def white(factor: FloatArray, values: FloatArray) -> FloatArray:
    """Values (m,) or (m, q) through the inverse of a factor."""
    return np.asarray(solve_banded((factor.shape[0] - 1, 0), factor, values))


def white_backwards(factor: FloatArray, values: FloatArray) -> FloatArray:
    """Values (m,) through the inverse of the transpose of a factor."""
    widest = factor.shape[0] - 1
    upper = np.zeros_like(factor)
    for d in range(factor.shape[0]):
        upper[widest - d, d:] = factor[d, : factor.shape[1] - d]
    return np.asarray(solve_banded((0, widest), upper, values))


def _of_units(seen: Measured, base: Model) -> tuple[csr_array, csr_array]:
    """Covariances (m, m) of the means that count of the force that a base model asks for: by noise of unit variance of
    the position, or speed, that is differentiated, and of the recorded force."""
    (passed,) = seen.filters
    mean, slope, same = passed.noise[np.flatnonzero(seen.moving)], sloped(seen.t), eye_array(seen.t.size)
    of_place = base.m * slope @ slope + base.c * slope + base.k * same
    asked = mean @ (base.m * slope + base.c * same if seen.by == "v" else of_place)
    return csr_array(asked @ asked.T), csr_array(mean @ mean.T)


def _bands(covariance: csr_array, left: float) -> FloatArray:
    """Diagonals (w, m) from the main one down, with a further variance on it."""
    table = covariance.tocoo()
    below = table.row >= table.col
    row, column, value = table.row[below], table.col[below], table.data[below]
    wide = int(np.max(row - column, initial=0))
    bands = np.zeros((wide + 1, covariance.shape[0]))
    np.add.at(bands, (row - column, column), value)
    bands[0] += left**2
    return bands
