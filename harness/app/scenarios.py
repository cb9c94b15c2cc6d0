"""Scenarios by name, with the parameters somebody gave."""

import math
from collections.abc import Mapping
from typing import Any

from harness.core.errors import InputError
from harness.core.scenario import FREE_DECAY, Scenario
from harness.core.slider import Slider
from harness.exact.decay import Decay, never_sticks, schedule

NAMES = (FREE_DECAY.name,)
SLIDER = ("m", "c", "k", "f_k", "f_s")


def scenario_named(name: str, given: Mapping[str, float | None]) -> Scenario:
    """The scenario ``name`` with the values in ``given`` (m, c, k, f_k, f_s, x0, v0, duration) in place of its own.

    Without a duration, one that is not the paper's case lasts a fifth longer than it takes to stick, or ten periods.
    Raises InputError listing the scenarios for an unknown name, and for values that are not physical.
    """
    if name not in NAMES:
        raise InputError("scenario", repr(name), f"{', '.join(NAMES)} is accepted")
    chosen = {key: value for key, value in given.items() if value is not None}
    if not chosen:
        return FREE_DECAY
    base = FREE_DECAY.slider
    own = {"m": base.m, "c": base.c, "k": base.k, "f_k": base.f_k}
    slider = Slider(**{**own, **{key: value for key, value in chosen.items() if key in SLIDER}})
    x0, v0 = chosen.get("x0", FREE_DECAY.x0), chosen.get("v0", FREE_DECAY.v0)
    duration = chosen["duration"] if "duration" in chosen else _long_enough(Decay.of(slider, x0, v0))
    return Scenario(FREE_DECAY.name, slider, x0, v0, duration)


def _long_enough(decay: Decay) -> float:
    """A fifth longer than it takes to stick, ten periods where that never comes; rounded up to two digits."""
    ten_periods = 20.0 * math.pi / decay.omega_n
    if never_sticks(decay):
        return rounded_up(ten_periods)
    # nothing that is worth watching lasts longer than two hundred periods
    time = schedule(decay, 20.0 * ten_periods).stick_time
    return rounded_up(20.0 * ten_periods if time is None else 1.2 * time or 0.1 * ten_periods)


def rounded_up(value: float) -> float:
    """A positive number with two digits, not below ``value``."""
    exponent = math.floor(math.log10(value)) - 1
    return float(f"{math.ceil(value / 10.0**exponent)}e{exponent}")


def scenario_json(scenario: Scenario) -> dict[str, Any]:
    """A scenario as a result holds it."""
    slider = scenario.slider
    return {
        "name": scenario.name,
        "slider": {"m": slider.m, "c": slider.c, "k": slider.k, "f_k": slider.f_k, "f_s": slider.break_away},
        "truth": {"omega_n": slider.omega_n, "zeta": slider.zeta, "x_k": slider.x_k},
        "release": {"x0": scenario.x0, "v0": scenario.v0},
        "duration_s": scenario.duration,
    }


def scenario_of_json(data: Mapping[str, Any]) -> Scenario:
    """The scenario ``scenario_json`` made this from.

    Raises InputError when something is missing.
    """
    try:
        release = data["release"]
        slider = Slider(**data["slider"])
        return Scenario(str(data["name"]), slider, release["x0"], release["v0"], data["duration_s"])
    except (KeyError, TypeError) as error:
        raise InputError("scenario", f"incomplete ({error})", "a trace written by harness run is accepted") from None
