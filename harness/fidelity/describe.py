"""A scenario as plain data, and back."""

from collections.abc import Mapping
from dataclasses import asdict
from typing import Any

from harness.core.errors import InputError
from harness.core.scenario import Belt, Harmonic, Hold, Scenario
from harness.core.slider import Slider


def describe(scenario: Scenario) -> dict[str, Any]:
    """A scenario as plain data; ``scenario_of`` turns it back."""
    slider, action = scenario.slider, scenario.action
    return {
        "name": scenario.name,
        "slider": {"m": slider.m, "c": slider.c, "k": slider.k, "f_k": slider.f_k, "f_s": slider.break_away},
        "release": {"x0": scenario.x0, "v0": scenario.v0},
        "duration_s": scenario.duration,
        "action": None if action is None else {"kind": type(action).__name__, **asdict(action)},
    }


_ACTIONS: dict[str, type[Harmonic] | type[Hold] | type[Belt]] = {kind.__name__: kind for kind in (Harmonic, Hold, Belt)}


def scenario_of(data: Mapping[str, Any]) -> Scenario:
    """The scenario that ``describe`` made this from; raises InputError when something is missing."""
    try:
        release, acting = data["release"], data.get("action")
        action = (
            None if acting is None else _ACTIONS[acting["kind"]](**{k: v for k, v in acting.items() if k != "kind"})
        )
        slider = Slider(**data["slider"])
        return Scenario(str(data["name"]), slider, release["x0"], release["v0"], data["duration_s"], action)
    except (KeyError, TypeError) as error:
        raise InputError(
            "scenario", f"incomplete ({error})", "a trace or row written by harness sweep is accepted"
        ) from None
