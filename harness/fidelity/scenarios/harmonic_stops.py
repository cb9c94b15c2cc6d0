"""A weaker and slower harmonic force: the slider stops twice a period."""

from harness.fidelity.figure import Figure, exact, one
from harness.fidelity.kinds.harmonic import HarmonicKind

SCENARIO = HarmonicKind(
    name="harmonic-stops",
    place=6,
    drive=lambda sliders: sliders.stopping,
    figures=(
        Figure("forced, stops", "amplitude_m", exact("amplitude_m"), "amplitude with two stops a period"),
        Figure("stop share", "stop_fraction", one, "share of the period that stops, difference"),
    ),
)
