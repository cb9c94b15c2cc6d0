"""The shape of a table in words: only what the gauge does not decide, and what stands out of its own error."""

from itertools import pairwise

import numpy as np

from harness.core.arrays import BoolArray, FloatArray
from harness.diagnosis.outcome import Table
from harness.model.model import Model

_CLEAR = 2.0
"""Standard errors from which something counts."""
_MOSTLY = 0.85
"""Share of squares from which a table is called odd, even or one-sided."""
_NARROW = 0.6
"""Of the range: wider than this a bend is no place."""
_INSIDE = 0.45
"""Of the range, to either side of its middle: slopes of a spline's last twentieth are loose."""
_END = 0.2
"""Of the range: the end of it, whose slope is compared with the middle's."""
_EDGE = 0.15
"""Of the range: what rubs there rubs at the end."""
_ONE_WAY = 0.3
"""Of the longer side: a range that reaches less far to the other has one side."""
_WIDE = 0.05
"""Of the range: narrower than this a stretch is not worth a word."""


_BASE = {
    ("x", "constant"): "no constant, which is the zero's",
    ("x", "level"): "no constant, which is the level's of the force that was given",
    ("x", "line"): "no straight line, which is the spring's",
    ("v", "line"): "nothing in proportion to speed, which is the damping's, and nothing at rest, which is friction's",
    ("g", "constant"): "no constant, which is f_k",
}


def gauge_of(table: Table) -> str:
    """What a table has none of over the motion, and whose it is."""
    kind = "g" if table.form.startswith("g") else table.of.strip("|")
    return " and ".join(_BASE[kind, one] for one in table.gauge) or "nothing is taken off"


def described(table: Table, model: Model, angular: bool) -> str:
    """In words, places as the sensor of x shows them. model : whose spring, damping and friction it stands beside."""
    unit = ("rad" if angular else "m") if table.of == "x" else ("rad/s" if angular else "m/s")
    if table.form.startswith("g"):
        return _rubbing(table, model.offset, unit)
    return _force(table, model.offset, unit) if table.of == "x" else _resistance(table, model, unit)


def _force(table: Table, offset: float, unit: str) -> str:
    """A force of position: symmetry, on which side it bends, where it is steep."""
    words = [_symmetry(table)]
    at, slope, bend = table.at, np.gradient(table.force, table.at), _bend(table)
    inside = np.abs(at - at.mean()) < _INSIDE * np.ptp(at)
    total = float(np.sum(bend[inside] ** 2))
    for side, name in ((at > 0.0, "positive"), (at < 0.0, "negative")):
        if total > 0.0 and np.sum(bend[inside & side] ** 2) > _MOSTLY * total:
            words.append(f"one-sided: it bends on the {name} side alone")
    low, high = (table.at[0], table.at[-1])
    top = _peak(slope, inside)
    if top is not None:
        place, width, sign = top
        where = f"x = {_short(at[place] + offset)} {unit}"
        if sign > 0.0 and width < _NARROW:
            words.append(f"stiffer about {where}: a well there, or a spring that saturates beyond")
        elif width < _NARROW:
            words.append(f"softer about {where}: something pushes away from there, or play")
    if len(words) == 1 or not words[-1].startswith(("stiffer", "softer")):
        ends = 0.5 * (np.mean(slope[at > high - _END * (high - low)]) + np.mean(slope[at < low + _END * (high - low)]))
        middle = float(np.mean(slope[inside]))
        words.append(f"it {'hardens' if ends > middle else 'softens'} towards the ends")
    return ", ".join(w for w in words if w)


def _resistance(table: Table, model: Model, unit: str) -> str:
    """A force of speed, with what friction and damping add: where it falls, whether it saturates or grows."""
    words = []
    if table.of == "v":
        words.append(_directions(table))
    speed = np.abs(table.at)
    whole = np.sign(table.at) * table.force + model.c * speed if table.of == "v" else table.force + model.c * speed
    for side, name in _sides(table):
        s, f, e = speed[side], whole[side], table.stderr[side]
        order = np.argsort(s)
        s, f, e = s[order], f[order], e[order]
        falling = _stretch(np.gradient(f, s) < 0.0)
        if falling is not None:
            i, j = falling
            drop = f[i] - f[j]
            if s[j] - s[i] > _WIDE * s[-1] and drop > _CLEAR * np.hypot(e[i], e[j]):
                begin = "" if i == 0 else f" from {_short(s[i])}"
                words.append(f"it falls with speed{begin} up to {_short(s[j])} {unit}{name}")
                continue
        first, last = _mean_slope(s, f, 0.0, 0.3), _mean_slope(s, f, 0.7, 1.0)
        if abs(last - first) * s[-1] > _CLEAR * float(np.median(e)):
            words.append(f"it {'saturates' if last < first else 'grows faster than'} with speed{name}")
    said = ", ".join(w for w in words if w) or "no feature stands out of its error"
    return said.replace("grows faster than with speed", "grows faster than in proportion to speed")


def _rubbing(table: Table, offset: float, unit: str) -> str:
    """Friction along the way: where it is most."""
    at, f, e = table.at, table.force, table.stderr
    top, least = int(np.argmax(f)), int(np.argmin(f))
    if f[top] - f[least] < _CLEAR * np.hypot(e[top], e[least]):
        return "no place stands out of its error"
    edge = _EDGE * float(np.ptp(at))
    ends = [float(np.mean(f[at < at[0] + edge])), float(np.mean(f[at > at[-1] - edge]))]
    middle = float(np.mean(f[np.abs(at - at.mean()) < edge]))
    if min(ends) > middle and min(ends) - middle > 0.5 * (max(ends) - middle):
        return "it rubs most at both ends of the way"
    if at[0] + edge < at[top] < at[-1] - edge:
        return f"it rubs most about x = {_short(at[top] + offset)} {unit}"
    return f"it rubs more on the {'positive' if at[top] > at.mean() else 'negative'} side"


def _symmetry(table: Table) -> str:
    reach = min(-table.at[0], table.at[-1])
    if reach <= _ONE_WAY * max(-table.at[0], table.at[-1]):
        return ""
    grid = np.linspace(-reach, reach, table.at.size)
    f = np.interp(grid, table.at, table.force)
    odd, even = 0.5 * (f - f[::-1]), 0.5 * (f + f[::-1])
    even = even if table.has_constant else even - float(np.mean(even))
    whole = float(np.sum(odd**2) + np.sum(even**2))
    if whole <= 0.0:
        return ""
    share = float(np.sum(odd**2)) / whole
    return "odd" if share > _MOSTLY else "even" if share < 1.0 - _MOSTLY else "neither odd nor even"


def _directions(table: Table) -> str:
    parts = [float(np.sum(table.force[side] ** 2)) for side, _ in _sides(table)]
    share = parts[0] / max(sum(parts), 1e-300)
    if share > _MOSTLY:
        return "it acts forwards more than backwards"
    return "it acts backwards more than forwards" if share < 1.0 - _MOSTLY else "it differs by direction"


def _sides(table: Table) -> list[tuple[BoolArray, str]]:
    if table.of == "v":
        return [(table.at > 0.0, " forwards"), (table.at < 0.0, " backwards")]
    return [(np.ones(table.at.size, dtype=np.bool_), "")]


def _bend(table: Table) -> FloatArray:
    return np.gradient(np.gradient(table.force, table.at), table.at)


def _peak(slope: FloatArray, inside: BoolArray) -> tuple[int, float, float] | None:
    """Where a slope stands out of its median most: place, width as a share of the range, sign; None at an end."""
    out = np.where(inside, slope - float(np.median(slope)), 0.0)
    place = int(np.argmax(np.abs(out)))
    places = np.flatnonzero(inside)
    if place <= places[0] + 1 or place >= places[-1] - 1:
        return None
    sign = float(np.sign(out[place]))
    half = sign * out > 0.5 * abs(out[place])
    left = place - int(np.argmax(~half[: place + 1][::-1]))
    right = place + int(np.argmax(~half[place:]))
    if half[: place + 1].all() or half[place:].all():
        return None
    return place, (right - left) / slope.size, sign


def _stretch(inside: BoolArray) -> tuple[int, int] | None:
    """The longest stretch in which something holds."""
    edges = np.flatnonzero(np.diff(np.concatenate(([False], inside, [False])).astype(np.int8)))
    spans = [(int(a), int(b) - 1) for a, b in list(pairwise(edges.tolist()))[::2]]
    return max(spans, key=lambda one: one[1] - one[0], default=None)


def _mean_slope(s: FloatArray, f: FloatArray, low: float, high: float) -> float:
    part = (s >= low * s[-1]) & (s <= high * s[-1])
    return float(np.polyfit(s[part], f[part], 1)[0])


def _short(value: float) -> str:
    return f"{value:.2g}"
