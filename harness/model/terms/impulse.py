"""One knock: the speed jumps by impulse/m."""

import math

from harness.core.events import Regime
from harness.model.term import Evidence, Parameter, Place, Probe, Seen, Slot, Term


def probes(e: Evidence) -> list[Probe]:
    """Linear in the impulse; times at which the residual changes most abruptly."""
    return [(float(time), 0.0) for time in e.knock_times]


_REACH = 0.25
"""Share of a period either side of a knock in which its mark on the motion is its own."""


def place(values: Probe, seen: Seen) -> Place:
    """About its time."""
    time, (first, last) = values[0], (float(seen.t[0]), float(seen.t[-1]))
    reach = _REACH * 2.0 * math.pi / seen.omega
    regime: Regime = "late" if time > 0.5 * (first + last) else "early"
    return Place(regime, f"from t = {time:.4g} s on", ((max(first, time - reach), min(last, time + reach)),))


TERM = Term(
    "impulse",
    "environment",
    Slot.EVENT,
    (Parameter("time", "s", moment=True), Parameter("impulse", "N s", none=0.0)),
    "Something knocked the slider at {time}, with an impulse of {impulse}.",
    probes=probes,
    amplitude=1,
    example=(0.8, 4.0),
    several=True,
    place=place,
    only_there=True,
    formula="At the given time v jumps by impulse/m.",
    needs=("one-clock",),
    taken=0.06,
    order=220,
)
