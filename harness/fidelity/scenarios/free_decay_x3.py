"""A box on the floor, let go three times as far away with three times the friction, until it lifts."""

from harness.fidelity.kinds.decay import DecayKind

SCENARIO = DecayKind(
    name="free-decay-x3",
    place=7,
    duration=3.5,
    shown=3.5,
    friction=3.0,
    reach=3.0,
    routes=("contact",),
)
