"""Den Hartog's case of a harmonic force, without stops."""

from harness.fidelity.figure import Figure, exact
from harness.fidelity.kinds.harmonic import HarmonicKind

SCENARIO = HarmonicKind(
    name="harmonic",
    place=5,
    drive=lambda sliders: sliders.drive,
    figures=(Figure("forced", "amplitude_m", exact("amplitude_m"), "amplitude without stops (Den Hartog)"),),
)
