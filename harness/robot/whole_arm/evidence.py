"""How surely a column belongs to a model, on one scale whatever the number of columns and of tries."""

import math

import numpy as np
from scipy.special import gammaincc, gammaln, ndtri_exp

from harness.core.arrays import FloatArray

_FAR = 300.0
"""Half a chi-square beyond which its chance is too small for a float."""


def evidence(gain: float, columns: float, looks: float = 1.0) -> float:
    """Gain of one column that is as unlikely by chance as this one, (its estimate over its standard error) squared.

    gain : what a fit gains, twice the logarithm of its likelihood; chi-square of so many ``columns`` by chance alone.
    looks : independent settings of which it is the best. 0 where chance does as well.
    """
    if gain <= 0.0:
        return 0.0
    return evidence_of_chance(_log_tail(gain, columns), looks, gain)


def evidence_of_chance(log_chance: float, looks: float = 1.0, gain: float = 0.0) -> float:
    """The same from the logarithm of a chance of one setting.

    The best of many neighbours exceeds a gain more often than so many settings apart, as it may do so between them:
    by its square root (Davies 1987, Biometrika 74, 33).
    """
    between = math.sqrt(math.pi / 8.0) * (looks - 1.0) * math.sqrt(max(gain, 1.0))
    chance = log_chance + math.log1p(max(between, 0.0))
    return float(ndtri_exp(chance - math.log(2.0)) ** 2) if chance < 0.0 else 0.0


def _log_tail(gain: float, columns: float) -> float:
    """Logarithm of the chance that chi-square of so many degrees exceeds ``gain``."""
    half, x = columns / 2.0, gain / 2.0
    if x < _FAR:
        return math.log(max(float(gammaincc(half, x)), 1e-300))
    # leading terms for large x
    return -x + (half - 1.0) * math.log(x) - float(gammaln(half)) + math.log1p((half - 1.0) / x)


def looks(columns: FloatArray) -> float:
    """Independent settings among neighbours: the length of the way of their unit columns (n, s), in right angles.

    Neighbours that look alike count little more than one (Davies 1987: chance grows with that length).
    """
    size = np.sqrt(np.sum(columns**2, axis=0))
    unit = columns[:, size > 0.0] / size[size > 0.0]
    alike = np.clip(np.abs(np.sum(unit[:, 1:] * unit[:, :-1], axis=0)), 0.0, 1.0)
    return 1.0 + float(np.sum(np.arccos(alike))) / (math.pi / 2.0)
