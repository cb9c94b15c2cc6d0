"""What the best model found leaves of a misfit: how much, and what it hangs on."""

import math
from collections.abc import Mapping, Sequence

import numpy as np

from harness.core.arrays import FloatArray, IntArray
from harness.diagnosis.baseline.words import Strokes
from harness.diagnosis.fit.model_fit import Fit
from harness.diagnosis.outcome import Remainder
from harness.diagnosis.problem import Problem

_PARTS = 6
"""Parts of equal counts that a quantity's range is cut into."""
_SAID = {
    "x": "a force that depends on position, beyond the spring",
    "v": "a force that depends on speed, beyond friction and damping",
    "t": "something that changes with time",
    "direction": "a force that differs by direction",
    "amplitude": "something that changes with amplitude",
}
_CLEARLY = 0.25
"""Share from which one quantity is said."""


def remainder(base: Fit, refined: Fit, problem: Problem, floor: float) -> Remainder:
    """What ``refined`` leaves, beside ``base``; both fitted to the problem under the sensors' noise.

    floor : chi-square that noise alone leaves.
    """
    excess = max(base.chi2 - floor, 1e-300)
    share = min(max((refined.chi2 - floor) / excess, 0.0), 1.0)
    depends = depends_on(refined, problem)
    return Remainder(share, math.sqrt(refined.chi2 / max(refined.points, 1)), looks_like(depends), depends)


def looks_like(depends: Mapping[str, float]) -> str:
    """What hangs on single quantities, by these shares of it, in a sentence."""
    first = max(depends, key=lambda name: depends[name])
    if depends[first] >= _CLEARLY:
        return f"what is left looks like {_SAID[first]} ({100.0 * depends[first]:.0f} % of it)"
    return "what is left hangs on no single one of position, speed, time, direction and amplitude"


def depends_on(found: Fit, problem: Problem) -> dict[str, float]:
    """Share of a fit's residual that is a function of one quantity alone; see ``shares_of``."""
    n = problem.t.size
    rows = [found.residual[i * n : (i + 1) * n] for i in range(len(problem.channels))]
    return shares_of(rows, problem.t, found.shown.x, found.shown.v)


def shares_of(rows: Sequence[FloatArray], t: FloatArray, x: FloatArray, v: FloatArray) -> dict[str, float]:
    """Share of residuals, each (n,), that is a function of one quantity alone, corrected for what parts take by chance.

    t (s), x, v (n,) : of the motion.

    The correlation ratio of means over parts, with strokes counted as words (Kelley 1935, Proc. Natl. Acad. Sci. 21,
    554).
    """
    fastest, widest = float(np.max(np.abs(v))), float(np.max(np.abs(x)))
    size = np.hypot(x * fastest, v * widest)
    quantities = {"x": x, "v": v, "t": t, "direction": np.sign(v), "amplitude": size}
    words = max(2.0 * Strokes.by(v).count, 2.0 * _PARTS)
    return {name: _explained(rows, _parts_of(y), words) for name, y in quantities.items()}


def _parts_of(y: FloatArray) -> IntArray:
    values = np.unique(y)
    if values.size <= _PARTS:
        return np.searchsorted(values, y).astype(np.int64)
    edges = np.quantile(y, np.linspace(0.0, 1.0, _PARTS + 1)[1:-1])
    return np.searchsorted(edges, y).astype(np.int64)


def _explained(rows: Sequence[FloatArray], part: IntArray, words: float) -> float:
    """Correlation ratio squared over all channels, less chance."""
    total = sum(float(np.sum(r**2)) for r in rows)
    if total <= 0.0:
        return 0.0
    count = np.bincount(part)
    used = count > 0
    between = sum(float(np.sum(np.bincount(part, r)[used] ** 2 / count[used])) for r in rows)
    taken, k = between / total, float(np.count_nonzero(used))
    return float(min(max(1.0 - (1.0 - taken) * (words - 1.0) / max(words - k, 1.0), 0.0), 1.0))
