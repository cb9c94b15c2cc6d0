"""How long a run should last."""

import math

from harness.exact.decay import Decay, never_sticks, schedule

MOST_PERIODS = 200.0
"""Nothing that is worth watching lasts longer."""


def until_rest(decay: Decay) -> float:
    """A fifth longer than a free decay takes to stick, ten periods where that never comes, s; two digits."""
    period = 2.0 * math.pi / decay.omega_n
    if never_sticks(decay):
        return rounded_up(10.0 * period)
    time = schedule(decay, MOST_PERIODS * period).stick_time
    return rounded_up(MOST_PERIODS * period if time is None else 1.2 * time or period)


def rounded_up(value: float) -> float:
    """A positive number with two digits, not below ``value``."""
    exponent = math.floor(math.log10(value)) - 1
    return float(f"{math.ceil(value / 10.0**exponent)}e{exponent}")
