"""A fitted table over position and speed as a surface: what it says where the motion was, with one standard error."""

import numpy as np

from harness.core.arrays import BoolArray, FloatArray, IntArray
from harness.diagnosis.baseline.words import Strokes
from harness.diagnosis.outcome import Surface
from harness.diagnosis.tables.basis import partials
from harness.diagnosis.tables.curve import errors
from harness.diagnosis.tables.fitted import TableFit
from harness.kernels.solve import Scales

POINTS = 41
"""Along each side of a surface."""
_CELLS = 12
"""Along each side: a point is known where the motion was in its cell."""
_MOSTLY = 0.85
"""Share of squares from which a surface is called one of resistance, or one of a force."""


def surface_of(found: TableFit, strokes: Strokes, scales: Scales, number: int, held: float, angular: bool) -> Surface:
    """The table at a place among the model's terms, which is one over both.

    strokes : of the residual. held : held-out error with it, over that without. angular : rad and not m.
    """
    entry = found.model.terms[number]
    known = entry.term.known
    assert known is not None
    assert known.fast is not None
    low, high = known.ends(entry.values)
    fast = entry.values[known.fast]
    x, v = np.linspace(low, high, POINTS), np.linspace(-fast, fast, POINTS)
    mine = [c for c, (i, _) in enumerate(found.basis.places) if i == number]
    free = found.basis.free[mine]
    columns = partials(found.model, number, np.tile(x, POINTS), np.repeat(v, POINTS), scales) @ free
    seen = _seen(x, v, found.look.x, found.look.v)
    force = (columns @ found.at).reshape(POINTS, POINTS)
    size = float(np.sqrt(np.mean(force[seen] ** 2))) if np.any(seen) else 0.0
    stderr = errors(found, strokes, columns, size, held).reshape(POINTS, POINTS)
    said = described(x + found.model.offset, v, force, seen, "rad" if angular else "m")
    return Surface(x, v, force, stderr, seen, said)


def _seen(x: FloatArray, v: FloatArray, at_x: FloatArray, at_v: FloatArray) -> BoolArray:
    """Which points (k, m) of a grid lie in a cell in which the motion (n,) was."""

    def cell(y: FloatArray, side: FloatArray) -> IntArray:
        share = (y - side[0]) / (side[-1] - side[0])
        return np.asarray(np.clip(_CELLS * share, 0.0, _CELLS - 1.0), dtype=np.int64)

    was = np.zeros((_CELLS, _CELLS), dtype=np.bool_)
    was[cell(at_v, v), cell(at_x, x)] = True
    return np.asarray(was[np.ix_(cell(v, v), cell(x, x))], dtype=np.bool_)


def described(x: FloatArray, v: FloatArray, force: FloatArray, seen: BoolArray, unit: str) -> str:
    """Whether it resists or pushes, and where most; force, seen (k, m), at v (k,) and x (m,) as a sensor shows it."""
    both = seen & seen[::-1]
    odd, even = (np.where(both, 0.5 * (force + sign * force[::-1]), 0.0) for sign in (-1.0, 1.0))
    whole = float(np.sum(odd**2) + np.sum(even**2))
    if whole <= 0.0:
        return "nothing stands out"
    share = float(np.sum(odd**2)) / whole
    if share <= _MOSTLY:
        kind = "a force that is the same in both directions" if share < 1.0 - _MOSTLY else "a force"
        return f"{kind} that no sum of one of position and one of speed says"
    drag = np.sum(odd * np.sign(v)[:, None], axis=0) / np.maximum(np.sum(both, axis=0), 1)
    inside = np.sum(both, axis=0) > 0
    most = int(np.argmax(np.where(inside, drag, -np.inf)))
    return f"a resistance that depends on the place too, more than elsewhere about x = {x[most]:.2g} {unit}"
