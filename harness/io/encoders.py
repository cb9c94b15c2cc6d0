"""Positions as encoders leave them: wrapped at the ends of a range, or stamped as a count changes."""

import math

import numpy as np

from harness.core.arrays import FloatArray

TURN = 2.0 * math.pi
_HALF, _QUARTER = 0.5, 0.25
"""Of the range: a step beyond what the motion says by more is a wrap; of a range, by which no other step may be off."""
_ALIKE = 0.05
"""Share of the range by which the wraps of one recording may differ."""
_WHOLE_TURNS = 8
"""Turns at which a range is looked for at most."""
_ERRORS, _LEAST_ERROR = 4.0, 1e-3
"""Times the wraps' scatter, and share of the range, within which it is a round one."""


def unwrapped(
    t: FloatArray, x: FloatArray, v: FloatArray | None = None, unit: float = 1.0
) -> tuple[FloatArray, str | None]:
    """A position of shape (n,), rad or m, in one course, and the sentence that says so; itself where nothing wraps.

    t : s. v : speed (n,), rad/s or m/s, which says how far each step should go; without it the steps beside do, and
    nothing less than a turn counts as a range. unit : the file's, in SI, in which a range is round.

    A wrap is a step that is off by more than half of all there is. The range is what all of them are off by; where they
    differ, or where another step is off by a quarter of it, the samples do not tell, and nothing is changed.
    """
    steps = np.diff(x)
    off = steps - (_beside_turns(steps, x) if v is None else 0.5 * (v[1:] + v[:-1]) * np.diff(t))
    reach = float(np.ptp(x))
    wraps = np.abs(off) > _HALF * reach
    if not np.any(wraps):
        return x, None
    span = _range_of(np.abs(off[wraps]), off[~wraps], unit)
    whole = x - span * np.concatenate(([0.0], np.cumsum(np.round(off / span))))
    left = off - span * np.round(off / span)
    apart = float(np.max(np.abs(np.abs(off[wraps]) - span)))
    if span < (1.0 - _ALIKE) * reach or apart > _ALIKE * span or float(np.max(np.abs(left))) > _QUARTER * span:
        told = v is not None or float(np.max(np.abs(steps))) <= _HALF * TURN
        jumps = "The angle jumps by more than half a turn between samples, and not by whole turns: left as it is."
        return x, None if told else jumps
    if v is None and span < (1.0 - _ALIKE) * TURN:
        return x, None
    whole = whole - span * np.round(np.median(whole) / span)  # the range in which it moves is none that was counted
    count = int(np.count_nonzero(wraps))
    times = f"{count} time{'s' if count > 1 else ''}"
    return whole, f"The position wraps {times} at a range of {span / unit:.6g}: put together to one course."


def _beside_turns(steps: FloatArray, x: FloatArray) -> FloatArray:
    """What the steps beside each one (n - 1,) say of it, the large ones apart."""
    usual = np.where(np.abs(steps) > _HALF * float(np.ptp(x)), np.nan, steps)
    padded = np.concatenate(([np.nan], usual, [np.nan]))
    both = np.stack((padded[:-2], padded[2:]))
    known = np.isfinite(both)
    mean: FloatArray = np.where(known, both, 0.0).sum(axis=0) / np.maximum(known.sum(axis=0), 1)
    return mean


def _range_of(sizes: FloatArray, others: FloatArray, unit: float) -> float:
    """The range (rad or m) that wraps of these sizes (k,) have: the nearest round one within what they scatter.

    others : by how much the other steps are off. Noise that crosses the end and back makes the sizes small, so that
    many of them know the range no better than one.
    """
    size = float(np.median(sizes))
    spread = 1.4826 * float(np.median(np.abs(others))) if others.size else 0.0
    error = max(_ERRORS * max(spread, float(np.std(sizes))), _LEAST_ERROR * size)
    digits = 10.0 ** (math.floor(math.log10(size / unit)) - 1)
    turns = [k * TURN for k in range(1, _WHOLE_TURNS + 1)]
    candidates = (*turns, digits * unit * round(size / unit / digits), 2.0 ** round(math.log2(size / unit)) * unit)
    nearest = min(candidates, key=lambda one: abs(one - size))
    return nearest if abs(nearest - size) <= error else size


_SAME, _ALL = 0.01, 0.99
"""Share of a step by which its numbers may be rounded, and share of the samples that lie one from the one before."""
_UNEVEN = 0.2
"""Scatter of the intervals, of their mean, from which no clock sampled: counts of a motion that turns."""


def at_edges(t: FloatArray, x: FloatArray) -> FloatArray | None:
    """Places (n - 1,) at times t[1:] of a count x (n,) that each stamp found one step on; None where a clock sampled.

    At its edge an encoder stands half way between the count before and the one that is written: as it stands, the count
    lags behind by half a step to either side, as play would.
    """
    steps, intervals = np.diff(x), np.diff(t)
    size = float(np.median(np.abs(steps))) if steps.size else 0.0
    if size == 0.0 or np.any(steps == 0.0) or not (np.any(steps > 0.0) and np.any(steps < 0.0)):
        return None
    alike = float(np.mean(np.abs(np.abs(steps) - size) < _SAME * size))
    if alike < _ALL or float(np.std(intervals)) < _UNEVEN * float(np.mean(intervals)):
        return None
    found: FloatArray = x[1:] - 0.5 * size * np.sign(steps)
    return found


_STANDS, _FEWEST, _ONE_WAY = 0.5, 50, 0.9
"""Share of samples, at least, at which a count stands as before, edges from which it is read by them, and steps that
are of one tick or two."""


def at_clocked_edges(t: FloatArray, x: FloatArray) -> tuple[FloatArray, FloatArray] | None:
    """Times and places (k,) at which a count x (n,), which a clock sampled at t (n,), s, went on; None where it hardly
    ever stands, goes back, or is no count.

    Half way in time to the sample at which it is first seen, as an encoder of a few marks stands at a mark: between two
    of them the count tells nothing that its edges do not.
    """
    steps = np.diff(x)
    moved = np.flatnonzero(steps != 0.0)
    if moved.size < _FEWEST or moved.size > (1.0 - _STANDS) * steps.size or np.ptp(np.sign(steps[moved])) > 0.0:
        return None
    size = float(np.min(np.abs(steps[moved])))
    ticks = np.abs(steps[moved]) / size
    whole = np.all(np.abs(ticks - np.round(ticks)) < _SAME) and np.mean(ticks < 2.0 + _SAME) >= _ONE_WAY
    if not whole:
        return None
    # of several marks since the last sample, the middle one
    places = x[moved] + 0.5 * (steps[moved] + size * np.sign(steps[moved]))
    return 0.5 * (t[moved] + t[moved + 1]), np.asarray(places, dtype=np.float64)
