"""What the noise of position, speed and force leaves of a force that is asked of a measured motion.

A second difference of a position's noise is blue: of neighbouring values one is too large where the next is too small,
so that long stretches tell far more of a force than their values one by one. Samples that do not count, as friction is
anything there, part them. Beside it stands what the force's own noise and a model leave, white.
"""

import math
from dataclasses import dataclass, replace

import numpy as np
from scipy.linalg import LinAlgError, cholesky_banded
from scipy.linalg.lapack import dtbtrs
from scipy.optimize import minimize
from scipy.sparse import csr_array, diags_array, eye_array

from harness.core.arrays import FloatArray
from harness.diagnosis.problems.differences import sloped
from harness.diagnosis.problems.measured import Measured
from harness.model.model import Model

_LEAST, _MOST = np.array([-2.0, -2.0, -1.0]), 0.5
"""Powers of ten of a residual's rms between which its parts lie, by the motion, by the force and what is left: smoothed
alike as they are, motion and force never agree better than to a tenth of what they differ by."""
_STARTS = ((-0.3, -1.5, -0.8), (-1.5, -0.3, -0.8), (-0.5, -0.5, -0.3))
"""The same, where the likeliest are looked for from: mostly the motion, mostly the force, mostly neither."""
_LEAST_EACH = np.array([-2.0, -4.0, -4.0])
"""The least of each sample, most of which the motion's noise makes."""
_STARTS_EACH = ((0.0, -3.0, -3.0), (-0.3, -1.0, -2.0), (-1.0, -0.3, -1.0))
"""The same of each sample: the motion alone, mostly the motion, mostly the force."""
_KNOWN = 1e-3
"""Of a force's rms, better than which none is known at any sample."""
_ENDS = {"xatol": 0.02, "fatol": 0.1, "maxfev": 120}
"""Where that ends: a hundredth moves nothing."""


@dataclass(frozen=True, slots=True)
class ForceCovariance:
    """What the noise of a force that is asked of a motion consists of.

    base : the model that asks for it. motion : noise of the position, m, or of the speed, m/s, that is
    differentiated. force : of the recorded force, N. left : N, of the values that are fitted, what remains, the same
    everywhere. sensors : N, as much of such as shakes means of what is smoothed as the noise of the motion and all
    scatter of the force do. usual : N, of most of these means by what there is of each, of which others are multiples.
    unlikely : -2 log L of what it was found by.
    """

    base: Model
    motion: float
    force: float
    left: float
    sensors: float
    usual: float
    unlikely: float = math.inf

    @classmethod
    def expected(cls, seen: Measured, base: Model, motion: float, scatter: float) -> "ForceCovariance":
        """As the noise of the channels by themselves lets expect it."""
        return _Units.of(seen, base).parts(motion, scatter, _least_known(seen), scatter)

    @classmethod
    def likeliest(cls, seen: Measured, base: Model, residual: FloatArray, scatter: float) -> "ForceCovariance":
        """The noise that a residual (m,), N, of a base model is likeliest with; scatter : N, of the recorded force.

        A force that scatters may be a controller's own, which the slider has felt, and a position finer than any noise
        that is looked for: what neighbouring values have in common tells either.
        """
        units = _Units.of(seen, base)
        size = math.sqrt(float(np.mean(residual**2)))
        per = size / np.sqrt([float(np.median(one[0])) for one in (units.motion, units.force)])
        lowest, begun = (_LEAST_EACH, _STARTS_EACH) if units.each_sample else (_LEAST, _STARTS)
        least = _least_known(seen) if units.each_sample else 0.0

        def sizes(powers: FloatArray) -> tuple[float, float, float]:
            motion, force, left = (10.0 ** np.clip(powers, lowest, _MOST) * [*per, size]).tolist()
            return motion, min(force, scatter), max(left, least)

        def unlikely(powers: FloatArray) -> float:
            try:
                factor = units.factor(*sizes(powers))
            except LinAlgError:
                return math.inf
            return 2.0 * float(np.sum(np.log(factor[0]))) + float(np.sum(white(factor, residual) ** 2))

        fits = (minimize(unlikely, one, method="Nelder-Mead", options=_ENDS) for one in begun)
        best = min(fits, key=lambda fit: float(fit.fun))
        return replace(units.parts(*sizes(best.x), scatter), unlikely=float(best.fun))

    def factor(self, seen: Measured) -> FloatArray:
        """Lower Cholesky factor over the values that count, by diagonals, in units of the usual deviation."""
        return _Units.of(seen, self.base).factor(self.motion, self.force, self.left) / self.usual


@dataclass(frozen=True, slots=True)
class _Units:
    """What noise of unit variance does to the force that a base model asks for.

    motion, force (w, m) : covariance of the values that count, of that of the position, or speed, that is
    differentiated, and of the recorded force, by diagonals. of_motion, of_force : deviation of most means over blocks
    of what is smoothed, of either. each_sample : whether a value is a sample.
    """

    base: Model
    motion: FloatArray
    force: FloatArray
    of_motion: float
    of_force: float
    each_sample: bool

    @classmethod
    def of(cls, seen: Measured, base: Model) -> "_Units":
        """Of a recording by itself."""
        (passed,) = seen.filters
        slope, same = sloped(seen.t), csr_array(eye_array(seen.t.size))
        if seen.by == "v":
            asked = csr_array(base.m * slope + base.c * same)
        else:
            asked = csr_array(base.m * slope @ slope + base.c * slope + base.k * same)
        means = csr_array(passed.means @ asked)
        each_sample, counted = seen.moving.size == seen.t.size, np.flatnonzero(seen.moving)
        if each_sample:
            # a reading that stays as it is tells no more than one
            motion, force = csr_array(asked[counted] @ diags_array(np.sqrt(seen.repeats))), same[counted]
        else:
            motion, force = means[counted], passed.means[counted]
        of_motion, of_force = (math.sqrt(float(np.median(m.multiply(m).sum(axis=1)))) for m in (means, passed.means))
        bands = [_bands(csr_array(one @ one.T)) for one in (motion, force)]
        return cls(base, bands[0], bands[1], of_motion, of_force, each_sample)

    def factor(self, motion: float, force: float, left: float) -> FloatArray:
        """Lower Cholesky factor by diagonals, N."""
        bands = np.zeros((max(len(self.motion), len(self.force)), self.motion.shape[1]))
        bands[: len(self.motion)] += motion**2 * self.motion
        bands[: len(self.force)] += force**2 * self.force
        bands[0] += left**2
        return np.asarray(cholesky_banded(bands, lower=True))

    def parts(self, motion: float, force: float, left: float, scatter: float) -> ForceCovariance:
        """With these, and a force of which so much was seen to scatter."""
        means = self.of_force if self.each_sample else 1.0
        usual = math.sqrt((motion * self.of_motion) ** 2 + (force * self.of_force) ** 2 + (left * means) ** 2)
        sensors = math.hypot(motion * self.of_motion, scatter * self.of_force) / means
        return ForceCovariance(self.base, motion, force, left, sensors, usual)


def _least_known(seen: Measured) -> float:
    """What is not known of the force at any sample, N, at least."""
    return _KNOWN * float(np.sqrt(np.mean(seen.u**2)))


def white(factor: FloatArray, values: FloatArray) -> FloatArray:
    """Values (m,) or (m, q) through the inverse of a factor."""
    found: FloatArray = dtbtrs(factor, values, uplo="L")[0]
    return found.reshape(values.shape)


def white_backwards(factor: FloatArray, values: FloatArray) -> FloatArray:
    """Values (m,) through the inverse of the transpose of a factor."""
    found: FloatArray = dtbtrs(factor, values, uplo="L", trans="T")[0]
    return found.reshape(values.shape)


def _bands(covariance: csr_array) -> FloatArray:
    """Diagonals (w, m) from the main one down."""
    table = covariance.tocoo()
    below = table.row >= table.col
    row, column, value = table.row[below], table.col[below], table.data[below]
    wide = int(np.max(row - column, initial=0))
    bands = np.zeros((wide + 1, covariance.shape[0]))
    np.add.at(bands, (row - column, column), value)
    return bands
