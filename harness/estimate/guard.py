"""The guard: how much beside a reversal must be left out because the jump is smeared there, found from the data.

Half-cycles are fitted from their middles and continued towards their edges. Where samples leave the continued form, in
time from the reversal and over all half-cycles together, is where something else than the base model acts.
"""

import numpy as np

from harness.core.arrays import FloatArray
from harness.core.jit import compiled
from harness.estimate.halfcycles import SeparateFit

WIDEST = 0.15
"""The guard is at most this share of a half-cycle on each side."""


def _edge_misfit(
    t: FloatArray,
    y: FloatArray,
    edges: FloatArray,
    c: FloatArray,
    inverse: FloatArray,
    sigma: float,
    omega: float,
    variance: float,
    reach: float,
    width: float,
    square: FloatArray,
    count: FloatArray,
) -> None:
    """Squares of residual over predicted deviation, by distance (bins of ``width`` s) from the nearest inner edge."""
    phi = np.empty(3)
    n = np.searchsorted(t, edges[0])
    for k in range(edges.size - 1):
        while n < t.size and t[n] < edges[k + 1]:
            s, rest = t[n] - edges[k], edges[k + 1] - t[n]
            # the outermost edges are a release, a stop or the record's end: no jump between two forms
            before, after = k + 2 < edges.size and rest <= reach, k > 0 and s < reach
            if before or after:
                e = np.exp(-sigma * s)
                phi[0], phi[1], phi[2] = e * np.cos(omega * s), e * np.sin(omega * s), 1.0
                r, spread = y[n], 1.0
                for i in range(3):
                    r -= phi[i] * c[k, i]
                    for j in range(3):
                        spread += phi[i] * inverse[k, i, j] * phi[j]
                bin_ = min(int((rest if before else s) / width), square.size - 1)
                square[bin_] += r * r / (variance * spread)
                count[bin_] += 1.0
            n += 1


_compiled_misfit = compiled(_edge_misfit)


def find_guard(t: FloatArray, y: FloatArray, fit: SeparateFit, variance: float) -> float:
    """Guard in s for a channel y (n,) from a fit made with the widest guard; 0 when the jumps are sharp.

    variance : of one sample, the larger of the noise's and the fit's own. Both sides are judged together.
    """
    half = float(np.median(np.diff(fit.edges)))  # the fitted frequency can be far off in much noise
    reach = WIDEST * half
    interval = float(np.median(np.diff(t)))
    # bins of a sample, but few enough for each to hold several half-cycles' worth
    width = max(interval, reach / 60.0)
    bins = max(int(np.ceil(reach / width)), 1)
    square, count = np.zeros(bins), np.zeros(bins)
    _compiled_misfit(t, y, fit.edges, fit.c, fit.inverse, fit.sigma, fit.omega, variance, reach, width, square, count)
    excess = square - count - 4.5 * np.sqrt(2.0 * count) - 8.0 * (count > 0)
    bad = np.flatnonzero(excess > 0.0)
    if bad.size == 0:
        return 0.0
    return float(min((bad[-1] + 1) * width, reach))
