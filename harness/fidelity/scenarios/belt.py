"""Stick-slip on a belt."""

from harness.fidelity.figure import Figure, belt_speed, exact, one
from harness.fidelity.kinds.belt import BeltKind

SCENARIO = BeltKind(
    name="belt",
    place=4,
    figures=(
        Figure("belt period", "period_s", exact("period_s"), "period of stick-slip"),
        Figure("stick share", "stick_fraction", one, "share of the period that sticks, difference"),
        Figure("stick speed", "stick_deviation_m_s", belt_speed, "speed against the belt while it sticks"),
    ),
)
