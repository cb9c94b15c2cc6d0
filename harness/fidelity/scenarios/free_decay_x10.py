"""A box on the floor, let go ten times as far away with ten times the friction, until it lifts."""

from harness.fidelity.kinds.decay import DecayKind

SCENARIO = DecayKind(
    name="free-decay-x10",
    place=8,
    duration=3.5,
    shown=3.5,
    friction=10.0,
    reach=10.0,
    routes=("contact",),
)
