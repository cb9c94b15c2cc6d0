"""Does a smooth curve of the speed, of any shape, say more of held speeds than the law that was fitted to them?

A table of speeds and forces may be too short for any look at its residual's frequencies, and a law with two numbers
follows many a curve. So a curve that is free stands beside each law: a cubic smoothing spline (Wahba 1978, J. R. Stat.
Soc. B 40, 364), whose straight part is viscous and Coulomb friction themselves, over the speed and over its logarithm,
alike in both directions and in each by itself. Its evidence is the mean over these and over its size.
"""

import math

import numpy as np

from harness.core.arrays import FloatArray
from harness.diagnosis.fit.model_fit import Fit

UNNAMED = "unnamed-curve"
"""What is missing where such a curve is."""
_WAVES = 24
"""Cosines of a curve, which fall with the square of their number as a spline's do: a spline within a hundredth."""
_SIZES = np.geomspace(0.3, 3000.0, 19)
"""Of a curve over the noise, each as likely: from what cannot be seen to what no table is good enough to show."""


def evidence_of_curve(found: Fit) -> float:
    """Twice the log of how much likelier held speeds are with a curve beside a model than with the model alone.

    What was fitted is fitted anew beside each curve, but for numbers on a bound. The level of the noise is known to
    neither (as Jeffreys has it), so that by chance alone this ratio of likelihoods is at least so large in one of as
    many tables (Gruenwald, de Heide and Koolen 2024, J. R. Stat. Soc. B 86, 1091).
    """
    inside = [f.lower < value < f.upper for f, value in zip(found.free, found.values, strict=True)]
    jacobian = found.jacobian[:, inside]
    size = np.linalg.norm(jacobian, axis=0)
    held = np.linalg.qr(jacobian[:, size > 0.0] / size[size > 0.0])[0]
    y = found.residual - held @ (held.T @ found.residual)
    free = y.size - held.shape[1]
    whole = float(y @ y)
    if free < 1 or whole <= 0.0:
        return 0.0
    each: list[float] = []
    for curve in _curves(found.shown.v):
        directions, sizes, _ = np.linalg.svd(curve - held @ (held.T @ curve), full_matrices=False)
        seen = (directions.T @ y) ** 2
        grown = 1.0 + (_SIZES[:, None] * sizes) ** 2
        left = np.maximum(whole - np.sum(seen * (1.0 - 1.0 / grown), axis=1), 1e-300)
        each += (free * np.log(whole / left) - np.sum(np.log(grown), axis=1)).tolist()
    best = max(each)
    return best + 2.0 * math.log(float(np.mean(np.exp(0.5 * (np.array(each) - best)))))


def _curves(v: FloatArray) -> list[FloatArray]:
    """Shapes (n, k) of unit size: over speed and over its logarithm, alike in both directions, or not."""
    fast, side, found = np.abs(v), np.sign(v)[:, None], []
    low, high = float(np.min(fast)), float(np.max(fast))
    waves = np.arange(1.0, min(_WAVES, v.size) + 1.0)
    for along in (fast / high, np.log(fast / low) / max(math.log(high / low), 1e-9)):
        one = math.sqrt(2.0) * np.cos(math.pi * np.outer(along, waves)) / waves**2
        found.append(side * one)
        if np.ptp(side) > 0.0:
            found.append(np.hstack((np.where(side > 0.0, one, 0.0), np.where(side < 0.0, one, 0.0))))
    return found
