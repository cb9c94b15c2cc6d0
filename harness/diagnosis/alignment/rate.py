"""Clocks of different rate: seconds of one trace for one of the other."""

import math

import numpy as np

from harness.core.quantity import Quantity
from harness.diagnosis.alignment.candidate import Candidate, refined
from harness.diagnosis.alignment.pair import Clock, Pair
from harness.diagnosis.rules import CLOCK_RATE

_SHOWS = 4.0
"""Standard errors from which clocks run differently: once in 16000 by chance."""
_MOST = 0.03
"""Largest difference of rate that is looked for; more is another motion."""
_STEP = 0.25
"""Periods by which the ends of the traces move between two rates that are tried."""
_MOST_TRIED = 41
"""Rates tried: bounds the work."""
_CLEARLY = 0.25
"""Share of the mean square that another rate must leave at most, as another shift (align)."""
_DIFFER = "the two differ by more than clocks do, and a clock that is fast cannot be told from a stiffer spring"


def rated(pair: Pair, taken: Candidate, period: float) -> tuple[Quantity, Candidate]:
    """The scale that lays the two over each other, and the candidate to compare with: with that scale only where it is
    significant and a clock's.

    Where the two show one motion the scale is fitted from 1 on. Where they differ, rates up to 3 % are tried, and one
    is told that leaves nothing but noise. A motion's own frequency looks the same as the rate of a clock: beyond what
    clocks differ by, a scale is applied only where a force that drives both proves it.
    """
    starts = [taken.clock] if taken.same else _starts(pair, taken, period)
    fits = [refined(pair, clock, period, rate=True) for clock in starts]
    found = [one for one in fits if one is not None and one.same]
    if not found:
        return Quantity.refused("1", _DIFFER), taken
    best = min(found, key=lambda one: one.saved)
    error = math.sqrt(float(best.covariance(period, True)[1, 1]))
    if not math.isfinite(error):
        return Quantity.refused("1", "the overlap is too short for it"), taken
    scale = Quantity(best.clock.scale, error, "1")
    better = taken.same or best.mean_log < taken.mean_log + math.log(_CLEARLY)
    clocks = not beyond_clocks(scale) or _by_force(pair, best, period)
    return scale, best if differs(scale) and better and clocks else taken


def differs(scale: Quantity) -> bool:
    """Whether two traces run at different rates, by more than chance."""
    return scale.value is not None and abs(scale.value - 1.0) > _SHOWS * (scale.stderr or 0.0)


def beyond_clocks(scale: Quantity) -> bool:
    """Whether the rates differ by more than two clocks do."""
    return differs(scale) and scale.value is not None and abs(scale.value - 1.0) > CLOCK_RATE.value


def _by_force(pair: Pair, best: Candidate, period: float) -> bool:
    """Whether the force alone, which no parameter of the motion changes, runs at the same other rate."""
    if not best.alike("u"):
        return False
    alone = refined(pair, best.clock, period, rate=True, names=("u",))
    if alone is None or not alone.alike("u"):
        return False
    errors = [math.sqrt(float(one.covariance(period, True)[1, 1])) for one in (alone, best)]
    scale = Quantity(alone.clock.scale, errors[0], "1")
    return beyond_clocks(scale) and abs(alone.clock.scale - best.clock.scale) < _SHOWS * math.hypot(*errors)


def _starts(pair: Pair, taken: Candidate, period: float) -> list[Clock]:
    """The few clocks that leave least, of all rates tried; the beginning of the overlap stays where it is."""
    t = pair.by_second(taken.clock)[pair.inside(pair.since(taken.clock))]
    span = float(t[-1] - t[0])
    step = max(_STEP * period / span, 2.0 * _MOST / (_MOST_TRIED - 1))
    rates = 1.0 + step * np.arange(-math.floor(_MOST / step), math.floor(_MOST / step) + 1)
    begin = float(t[0]) - taken.clock.shift - pair.origin
    clocks = [Clock(taken.clock.shift + (1.0 - rate) * begin, float(rate), pair.origin) for rate in rates]
    return sorted(clocks, key=lambda clock: _apart(pair, clock))[:3]


def _apart(pair: Pair, clock: Clock) -> float:
    keep = pair.inside(pair.since(clock))
    total = 0.0
    for c, noise in pair.noise.items():
        second, first, _, _ = pair.left(clock, c, keep)
        total += float(np.mean((second - first) ** 2)) / noise.sigma**2 if second.size else math.inf
    return total
