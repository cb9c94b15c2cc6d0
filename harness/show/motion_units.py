"""Names and units of a motion as figures show it: of what slides, or of what turns."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any


@dataclass(frozen=True, slots=True)
class MotionUnits:
    """name, x, factor : of the position and what it is multiplied by. small : of a difference, times 1e3. v, a : SI."""

    name: str
    x: str
    factor: float
    small: str
    v: str
    a: str


SLIDES = MotionUnits("position", "mm", 1e3, "mm", "m/s", "m/s²")
TURNS = MotionUnits("angle", "rad", 1.0, "mrad", "rad/s", "rad/s²")


def units_of(scenario: Mapping[str, Any]) -> MotionUnits:
    """Those of a scenario's result: a pendulum turns."""
    turns = (scenario.get("model") or {}).get("restoring") == "pendulum"
    return TURNS if turns else SLIDES


def without_step(scenario: Mapping[str, Any]) -> str:
    """How the reference of a scenario's result moves: a slider by closed forms, any other model from event to event."""
    return "exact from event to event" if scenario.get("model") else "closed form"
