"""Do the parts of a recording ask for the same parameters as the whole (Nyblom 1989, in blocks)?

To first order a part's own fit takes from its residual what lies along the partials there. These are few directions,
and a model that only mimics an effect fails in them first, long before its residual looks structured.
"""

import math
from collections.abc import Mapping
from functools import partial

import numpy as np

from harness.core.arrays import FloatArray, IntArray
from harness.diagnosis.motion import Motion
from harness.diagnosis.residual_tests.cleaned import Channel
from harness.diagnosis.residual_tests.floor import over_floor, spared

_MOST_STRETCHES = 8
"""Of equal numbers of half-cycles, which are held against each other."""
_SEEN = 1e-6
"""Share of its power in a part from which a fitted direction is seen there."""


def constancy(
    channels: Mapping[str, Channel], t: FloatArray, motion: Motion, spare: float = 0.0
) -> list[tuple[str, float, float]]:
    """Tests of whether parameters depend on the part of a recording: what is tested, its p-value, mean square.

    t (n,) : s. spare : chi-square that may be left besides by what is no structure.
    """
    freedom = float(sum(one.freedom for one in channels.values()))
    out = []
    for name, part in _parts(t, motion).items():
        chi2, k = _taken(channels, part)
        if k >= 1.0:
            p = spared(partial(over_floor, k=k, m=freedom), chi2, spare)
            out.append((f"parameters that differ from {name} to {name}", p, chi2 / k))
    return out


def _parts(t: FloatArray, motion: Motion) -> dict[str, IntArray]:
    """The number of its part for every sample (n,), for each way to part a recording."""
    n = t.size
    turns = (t - t[0]) * motion.omega / (2.0 * math.pi)
    stretch = turns * _MOST_STRETCHES / max(float(turns[-1]), _MOST_STRETCHES)
    return {
        "half": 2 * np.arange(n) // n,
        "quarter": 4 * np.arange(n) // n,
        "cycle": np.minimum(stretch.astype(np.int64), _MOST_STRETCHES - 1),
        "direction": (motion.v > 0.0).astype(np.int64),
        "side": (motion.x > 0.0).astype(np.int64),
    }


def _taken(channels: Mapping[str, Channel], part: IntArray) -> tuple[float, float]:
    """Chi-square that the parts' own fits would take besides the common one, and its degrees of freedom."""
    fitted = next(iter(channels.values())).basis.shape[1]
    chi2, k = 0.0, -float(fitted)
    for number in range(int(part.max()) + 1):
        score, gram = np.zeros(fitted), np.zeros((fitted, fitted))
        for one in channels.values():
            inside = part[one.kept] == number
            score += one.basis[inside].T @ one.r[inside]
            gram += one.basis[inside].T @ one.basis[inside]
        values, vectors = np.linalg.eigh(gram)
        seen = values > _SEEN
        chi2 += float(np.sum((vectors.T @ score)[seen] ** 2 / values[seen]))
        k += float(np.count_nonzero(seen))
    return chi2, k
