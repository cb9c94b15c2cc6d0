"""Time stamps as loggers write them: counted since 1970, in s, ms, us or ns, repeated, or written down late."""

from datetime import UTC, datetime

import numpy as np

from harness.core.arrays import BoolArray, FloatArray
from harness.io.units import Unit

_EPOCHS: tuple[tuple[float, float, str, float], ...] = (
    (3e8, 1e10, "s", 1.0),
    (3e11, 1e13, "ms", 1e-3),
    (3e14, 1e16, "us", 1e-6),
    (3e17, 1e19, "ns", 1e-9),
)
"""Stamps of 1979 to 2286 in each unit; no two overlap, and no experiment lasts ten years."""

_OFF, _COARSE = 2.0, 0.9
"""Steps of a coarse clock that its stamps of even samples lie apart at most, half of one at either side and as much
again; and the quantile of the steps that is the clock's, above which there may be gaps."""


def since_first(t: FloatArray, unit: Unit) -> tuple[FloatArray, str | None]:
    """Stamps of shape (n,) as read, in s: from the first where they count from 1970, and the sentence that says so.

    unit : what the header says; where it says nothing, the size of the stamps tells.
    """
    first = float(t[0]) if t.size else 0.0
    for low, high, name, factor in _EPOCHS:
        told = not unit.text or np.isclose(unit.factor, factor, rtol=1e-9, atol=0.0)
        if told and low <= first < high:
            when = datetime.fromtimestamp(first * factor, UTC).strftime("%Y-%m-%d %H:%M:%S")
            said = f"Stamps count {name} since 1970: t is counted from the first, {when} UTC."
            return (t - first) * factor, said
    return t * unit.factor, None


def rising(t: FloatArray) -> BoolArray:
    """Which of the times (n,) come after all before them: a row that was written twice and a clock that was set back
    leave few that do not.
    """
    before = np.maximum.accumulate(np.concatenate(([-np.inf], t[:-1])))
    found: BoolArray = t > before
    return found


def even_rate(t: FloatArray) -> float | None:
    """The rate in Hz of samples whose times (n,), s, stand still but never go back; None where they are not even.

    A clock that is too coarse is never further off an even one than its own step; a gap is.
    """
    steps = np.diff(t)
    if not np.any(steps == 0.0) or float(steps.min()) < 0.0 or t[-1] <= t[0]:
        return None
    coarse = float(np.quantile(steps[steps > 0.0], _COARSE))
    count = np.arange(t.size) - 0.5 * (t.size - 1)
    interval = float(count @ t) / float(count @ count)
    return 1.0 / interval if float(np.ptp(t - interval * count)) <= _OFF * coarse else None


def whole_numbers(t: FloatArray, unit: Unit) -> str | None:
    """A caution where times without a unit are whole numbers and count no seconds, as samples or ms would."""
    if unit.text or t.size < 2 or float(np.median(np.diff(t))) < 1.0 or np.any(t != np.round(t)):
        return None
    return "Times are whole numbers without a unit, read as s; --columns with t=NAME[ms], or --rate, says otherwise."
