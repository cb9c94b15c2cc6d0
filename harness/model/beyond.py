"""Motions that leave the range over which a table of a model is known."""

import numpy as np

from harness.core.arrays import FloatArray
from harness.model.model import Model, ModelTerm


def beyond(model: Model, x: FloatArray, v: FloatArray) -> list[str]:
    """A sentence for each table that a motion x (n,), m, v (n,), m/s, leaves; none where all that acts is known."""
    return [said for entry in model.terms if (said := _beyond(entry, x, v))]


def _beyond(entry: ModelTerm, x: FloatArray, v: FloatArray) -> str:
    known = entry.term.known
    if known is None:
        return ""
    if known.reach is not None:
        return _out(entry, known.reach, x, v)
    low, high = known.ends(entry.values)
    motion = {"x": x, "|v|": np.abs(v), "v": np.maximum(v, 0.0), "-v": np.maximum(-v, 0.0)}[known.of]
    least, most = float(np.min(motion)), float(np.max(motion))
    if low <= least and most <= high:
        return ""
    unit = "m" if known.of == "x" else "m/s"
    reached = most if most > high else least
    return (
        f"{entry.term.name} is known from {known.of} = {low:.4g} to {high:.4g} {unit}, and the motion reaches"
        f" {reached:.4g} {unit}: what acts beyond is not known, and the table keeps its last value."
    )


def _out(entry: ModelTerm, reach: int, x: FloatArray, v: FloatArray) -> str:
    known = entry.term.known
    assert known is not None
    out, most = known.out(entry.values, x, v), entry.values[reach]
    worst = int(np.argmax(out))
    if out[worst] <= most:
        return ""
    return (
        f"{entry.term.name} is known over an oval of x and v, and the motion leaves it (x = {x[worst]:.4g} m at"
        f" v = {v[worst]:.4g} m/s, {out[worst] / most:.3g} times as far out): what acts there is not known, and the"
        " table keeps its last value."
    )
