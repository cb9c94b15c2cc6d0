"""A constant load on a slider at rest with its spring relaxed: below break-away nothing moves, for ever."""

from harness.core.errors import InputError
from harness.core.scenario import Hold
from harness.core.slider import Slider


def creep(slider: Slider, hold: Hold) -> float:
    """Speed in m/s at which the load moves the slider: exactly 0.

    Raises InputError when the load exceeds the break-away force f_s, and the slider does not hold.
    """
    if abs(hold.force) > slider.break_away:
        accepted = f"a load of at most f_s = {slider.break_away:g} N is accepted"
        raise InputError("hold: force", f"{hold.force:g} N", accepted)
    return 0.0
