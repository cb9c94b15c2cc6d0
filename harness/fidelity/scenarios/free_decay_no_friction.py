"""The same slider without dry friction: what the integrator alone gets wrong."""

from harness.fidelity.figure import Figure, release
from harness.fidelity.kinds.decay import DecayKind

SCENARIO = DecayKind(
    name="free-decay-no-friction",
    place=1,
    duration=3.0,
    shown=3.0,
    friction=0.0,
    figures=(Figure("integrator", "max_error_m", release, "position error without friction, over the release"),),
)
