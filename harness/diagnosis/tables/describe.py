"""The shape of a table in words: only what the gauge does not decide, and what stands out of its own error."""

from itertools import pairwise

import numpy as np

from harness.core.arrays import BoolArray, FloatArray
from harness.diagnosis.outcome import Table
from harness.model.model import Model

_CLEAR = 2.0
"""Standard errors from which something counts."""
_MOSTLY = 0.85
"""Share of squares from which a table is called odd, even or one-sided, a surface one of resistance or of a force."""
_NARROW, _INSIDE, _END, _EDGE, _WIDE = 0.6, 0.45, 0.2, 0.15, 0.05
"""Of the range: wider than the first a bend is no place; to either side of its middle, as slopes of a spline's last
twentieth are loose; the end of it, whose slope is compared with the middle's; what rubs there rubs at the end; narrower
than the last a stretch is not worth a word."""
_ONE_WAY = 0.3
"""Of the longer side: a range that reaches less far to the other has one side."""
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
    words, at, slope = [], table.at, np.gradient(table.force, table.at)
    reach = min(-at[0], at[-1])
    if reach > _ONE_WAY * max(-at[0], at[-1]):
        f = np.interp(np.linspace(-reach, reach, at.size), at, table.force)
        odd, even = 0.5 * (f - f[::-1]), 0.5 * (f + f[::-1])
        share = _share(odd, even if table.has_constant else even - float(np.mean(even)))
        if share is not None:
            words.append("odd" if share > _MOSTLY else "even" if share < 1.0 - _MOSTLY else "neither odd nor even")
    bend, inside = np.gradient(slope, at), np.abs(at - at.mean()) < _INSIDE * np.ptp(at)
    total, low, high = float(np.sum(bend[inside] ** 2)), at[0], at[-1]
    for side, name in ((at > 0.0, "positive"), (at < 0.0, "negative")):
        if total > 0.0 and np.sum(bend[inside & side] ** 2) > _MOSTLY * total:
            words.append(f"one-sided: it bends on the {name} side alone")
    top = _peak(slope, inside)
    if top is not None and top[1] < _NARROW:
        where = f"x = {at[top[0]] + offset:.2g} {unit}"
        well = f"stiffer about {where}: a well there, or a spring that saturates beyond"
        words.append(well if top[2] > 0.0 else f"softer about {where}: something pushes away from there, or play")
    else:
        ends = 0.5 * (np.mean(slope[at > high - _END * (high - low)]) + np.mean(slope[at < low + _END * (high - low)]))
        words.append(f"it {'hardens' if ends > float(np.mean(slope[inside])) else 'softens'} towards the ends")
    return ", ".join(words)


def _resistance(table: Table, model: Model, unit: str) -> str:
    """A force of speed, with what friction and damping add: where it falls, whether it saturates or grows."""
    words, speed = [], np.abs(table.at)
    sides = [(np.ones(table.at.size, dtype=np.bool_), "")]
    whole = table.force + model.c * speed
    if table.of == "v":
        sides = [(table.at > 0.0, " forwards"), (table.at < 0.0, " backwards")]
        whole = np.sign(table.at) * table.force + model.c * speed
        parts = [float(np.sum(table.force[side] ** 2)) for side, _ in sides]
        share, less = parts[0] / max(sum(parts), 1e-300), 1.0 - _MOSTLY
        way = "forwards more than backwards" if share > _MOSTLY else "backwards more than forwards"
        words.append(f"it acts {way}" if not less <= share <= _MOSTLY else "it differs by direction")
    for side, name in sides:
        order = np.argsort(speed[side])
        s, f, e = (y[side][order] for y in (speed, whole, table.stderr))
        falls = np.concatenate(([False], np.gradient(f, s) < 0.0, [False]))
        edges = np.flatnonzero(np.diff(falls.astype(np.int8))).tolist()
        # the longest stretch in which it does
        i, j = max(list(pairwise(edges))[::2], key=lambda one: one[1] - one[0], default=(0, 1))
        j -= 1
        if s[j] - s[i] > _WIDE * s[-1] and f[i] - f[j] > _CLEAR * np.hypot(e[i], e[j]):
            begin = "" if i == 0 else f" from {s[i]:.2g}"
            words.append(f"it falls with speed{begin} up to {s[j]:.2g} {unit}{name}")
            continue
        first, last = _mean_slope(s, f, 0.0, 0.3), _mean_slope(s, f, 0.7, 1.0)
        if abs(last - first) * s[-1] > _CLEAR * float(np.median(e)):
            grows = "saturates with" if last < first else "grows faster than in proportion to"
            words.append(f"it {grows} speed{name}")
    return ", ".join(words) or "no feature stands out of its error"


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
        return f"it rubs most about x = {at[top] + offset:.2g} {unit}"
    return f"it rubs more on the {'positive' if at[top] > at.mean() else 'negative'} side"


def _peak(slope: FloatArray, inside: BoolArray) -> tuple[int, float, float] | None:
    """Where a slope stands out of its median most: place, width as a share of the range, sign; None at an end."""
    out = np.where(inside, slope - float(np.median(slope)), 0.0)
    place, places = int(np.argmax(np.abs(out))), np.flatnonzero(inside)
    if place <= places[0] + 1 or place >= places[-1] - 1:
        return None
    sign = float(np.sign(out[place]))
    half = sign * out > 0.5 * abs(out[place])
    left = place - int(np.argmax(~half[: place + 1][::-1]))
    right = place + int(np.argmax(~half[place:]))
    if half[: place + 1].all() or half[place:].all():
        return None
    return place, (right - left) / slope.size, sign


def _mean_slope(s: FloatArray, f: FloatArray, low: float, high: float) -> float:
    part = (s >= low * s[-1]) & (s <= high * s[-1])
    return float(np.polyfit(s[part], f[part], 1)[0])


def _share(odd: FloatArray, even: FloatArray) -> float | None:
    """Share of squares that is odd; None of nothing."""
    whole = float(np.sum(odd**2) + np.sum(even**2))
    return float(np.sum(odd**2)) / whole if whole > 0.0 else None


def plane_described(x: FloatArray, v: FloatArray, force: FloatArray, seen: BoolArray, unit: str) -> str:
    """Whether it resists or pushes, and where most; force, seen (k, m), at v (k,) and x (m,) as a sensor shows it."""
    both = seen & seen[::-1]
    odd, even = (np.where(both, 0.5 * (force + sign * force[::-1]), 0.0) for sign in (-1.0, 1.0))
    share = _share(odd, even)
    if share is None:
        return "nothing stands out"
    if share <= _MOSTLY:
        kind = "a force that is the same in both directions" if share < 1.0 - _MOSTLY else "a force"
        return f"{kind} that no sum of one of position and one of speed says"
    drag = np.sum(odd * np.sign(v)[:, None], axis=0) / np.maximum(np.sum(both, axis=0), 1)
    inside = np.sum(both, axis=0) > 0
    most = int(np.argmax(np.where(inside, drag, -np.inf)))
    return f"a resistance that depends on the place too, more than elsewhere about x = {x[most]:.2g} {unit}"
