"""Kinds of machine: how large, how fast, how damped, how they are recorded, and what may be left out of their model."""

from dataclasses import dataclass

from harness.proof.machines.effects import DRY, NEEDS

Range = tuple[float, float]
_FRICTION = (
    *("stribeck", "presliding", "regularised-friction", "position-dependent-friction", "friction-drift"),
    *("normal-load-variation", "load-dependent-friction"),
)
_DAMPING = ("quadratic-drag", "asymmetric-viscous", "power-law-damping", "viscoelastic")
_STIFFNESS = ("cubic-stiffness", "quadratic-stiffness", "end-stop", "backlash", "stiffness-drift")
_AROUND = ("force-ripple", "harmonic-force", "impulse", "attached-mode")
_SENSORS = ("sensor-lag", "sensor-gain", "sensor-bias", "sensor-clipping")


@dataclass(frozen=True, slots=True)
class Kind:
    """A kind of machine. Ranges are drawn log-uniformly.

    restoring : "spring", "pendulum" or "none". channels : what may be recorded, such as "x" or "xa".
    angular : rad and not m. omega_n : rad/s. length : amplitude, m or rad. cycles : recorded. left : amplitude at the
    end over the first. dry : share of the decay that dry friction makes, where no hidden effect asks for more.
    per_cycle : samples. resolution : step of the sensor over the amplitude. stamps : how times may be written.
    names : catalogue effects that may be the main one.
    """

    name: str
    restoring: str
    channels: tuple[str, ...]
    angular: bool
    omega_n: Range
    length: Range
    cycles: Range
    left: Range
    dry: Range
    per_cycle: Range
    resolution: Range
    stamps: tuple[str, ...]
    names: tuple[str, ...]
    driven: bool = False

    def has(self, name: str) -> bool:
        """Whether an effect of no catalogue can be the main one: it needs its channels, one of dry friction some."""
        dry = self.driven or self.dry[1] > 0.3
        return (dry or name not in DRY) and any(set(NEEDS.get(name, "")) <= set(c) for c in self.channels)


STEADY, JITTER, ROUNDED, IRREGULAR = "steady", "jitter", "rounded", "irregular"
"""Times as they were; evenly spaced though they were not; rounded; uneven and true."""

SPRING_ARM = Kind(
    *("spring-arm", "spring", ("x",), True, (6.0, 60.0), (0.05, 0.6), (7.0, 18.0), (0.04, 0.4), (0.1, 0.6)),
    *((40.0, 300.0), (3e-4, 1e-2), (STEADY, JITTER, ROUNDED)),
    names=(*_FRICTION, *_DAMPING, *_STIFFNESS, *_AROUND, "constant-force", "pendulum-stiffness", "sensor-drift"),
)
STRING_PENDULUM = Kind(
    *("string-pendulum", "pendulum", ("x",), True, (2.5, 7.0), (0.25, 1.2), (20.0, 60.0), (0.15, 0.5), (0.005, 0.1)),
    *((9.0, 30.0), (1e-3, 1e-2), (JITTER, ROUNDED, IRREGULAR)),
    names=(
        *("quadratic-drag", "power-law-damping", "asymmetric-viscous", "cubic-stiffness", "stiffness-drift"),
        *("quadratic-stiffness", "attached-mode", "impulse", "harmonic-force", "sensor-drift"),
    ),
)
ENCODER_PENDULUM = Kind(
    *("encoder-pendulum", "pendulum", ("x",), True, (4.0, 12.0), (0.3, 1.6), (7.0, 25.0), (0.03, 0.4), (0.1, 0.5)),
    *((60.0, 350.0), (5e-4, 6e-3), (STEADY, ROUNDED)),
    names=(*_FRICTION, *_DAMPING, *_AROUND, "quadratic-stiffness", "end-stop", "stiffness-drift"),
)
TORSION_WHEEL = Kind(
    *("torsion-wheel", "spring", ("v",), True, (3.0, 20.0), (0.1, 0.8), (6.0, 16.0), (0.15, 0.7), (0.01, 0.4)),
    *((60.0, 350.0), (5e-4, 4e-3), (STEADY, JITTER)),
    names=(
        *("stribeck", "position-dependent-friction", "friction-drift", "load-dependent-friction", *_DAMPING),
        *("cubic-stiffness", "quadratic-stiffness", "end-stop", "stiffness-drift", *_AROUND),
    ),
)
CART = Kind(
    *("cart", "spring", ("xa",), False, (10.0, 60.0), (0.005, 0.12), (7.0, 18.0), (0.03, 0.4), (0.1, 0.6)),
    *((40.0, 140.0), (3e-4, 6e-3), (STEADY, JITTER, ROUNDED)),
    names=(*_FRICTION, *_DAMPING, *_STIFFNESS, *_AROUND, *_SENSORS, "constant-force", "sensor-drift"),
)
RUBBER_STAGE = Kind(
    *("rubber-stage", "spring", ("a", "x", "xa"), False, (30.0, 300.0), (2e-4, 4e-3), (5.0, 10.0), (0.03, 0.25)),
    *((0.005, 0.15), (40.0, 200.0), (5e-4, 5e-3), (STEADY, JITTER)),
    names=(
        *(*_DAMPING, "cubic-stiffness", "quadratic-stiffness", "end-stop", "backlash"),
        *(*_AROUND, "sensor-bias", "sensor-clipping"),
    ),
)
AIR_STAGE = Kind(
    *("air-stage", "spring", ("x",), False, (3.0, 30.0), (0.005, 0.05), (25.0, 50.0), (0.1, 0.6), (0.002, 0.1)),
    *((30.0, 120.0), (1e-5, 1e-3), (STEADY, JITTER)),
    names=(
        *("quadratic-drag", "power-law-damping", "asymmetric-viscous", "cubic-stiffness", "quadratic-stiffness"),
        *("stiffness-drift", *_AROUND, "sensor-drift"),
    ),
)
SERVO_PENDULUM = Kind(
    *("servo-pendulum", "pendulum", ("x",), True, (6.0, 12.0), (0.6, 1.9), (3.5, 9.0), (0.003, 0.1), (0.4, 0.9)),
    *((30.0, 120.0), (8e-4, 4e-3), (IRREGULAR, ROUNDED)),
    names=(*_FRICTION, "quadratic-drag", "asymmetric-viscous", "viscoelastic", "force-ripple", "quadratic-stiffness"),
)
_DRIVEN_NAMES = (*_FRICTION, "static-friction", *_DAMPING, *_AROUND, "constant-force")
SPRING_AXIS = Kind(
    *("spring-axis", "spring", ("x", "xa"), False, (6.0, 60.0), (0.01, 0.2), (0.0, 0.0), (0.0, 0.0), (0.0, 0.0)),
    *((40.0, 160.0), (1e-5, 1e-3), (STEADY,)),
    names=(*_DRIVEN_NAMES, *_STIFFNESS, "pendulum-stiffness", *_SENSORS, "sensor-drift"),
    driven=True,
)
BALL_SCREW = Kind(
    *("ball-screw", "none", ("x", "xa"), False, (3.0, 20.0), (0.03, 0.3), (0.0, 0.0), (0.0, 0.0), (0.0, 0.0)),
    *((100.0, 300.0), (1e-5, 3e-4), (STEADY,)),
    names=(*(name for name in _DRIVEN_NAMES if name != "load-dependent-friction"), "end-stop", *_SENSORS),
    driven=True,
)
CYLINDER = Kind(
    *("cylinder", "none", ("x",), False, (3.0, 12.0), (0.01, 0.06), (0.0, 0.0), (0.0, 0.0), (0.0, 0.0)),
    *((60.0, 200.0), (3e-5, 1e-3), (STEADY, ROUNDED)),
    names=tuple(name for name in _DRIVEN_NAMES if name not in ("load-dependent-friction", "viscoelastic")),
    driven=True,
)

FREE = {
    kind.name: kind
    for kind in (
        *(SPRING_ARM, STRING_PENDULUM, ENCODER_PENDULUM, TORSION_WHEEL),
        *(CART, RUBBER_STAGE, AIR_STAGE, SERVO_PENDULUM),
    )
}
DRIVEN = {kind.name: kind for kind in (SPRING_AXIS, BALL_SCREW, CYLINDER)}
KINDS = {**FREE, **DRIVEN}
