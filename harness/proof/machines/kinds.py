"""Kinds of machine: how large, how fast, how damped, how they are recorded, and what may be left out of their model.

Drawn in turn, and on each an effect that has not occurred often.
"""

from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from itertools import cycle, islice

import numpy as np

from harness.proof.plant.base import Base
from harness.proof.plant.effects import DRY, EFFECTS, STATIC, UNKNOWN

Range = tuple[float, float]
FRICTION = (
    *("stribeck", "presliding", "regularised-friction", "position-dependent-friction", "friction-drift"),
    *("normal-load-variation", "load-dependent-friction"),
)
DAMPING = ("quadratic-drag", "asymmetric-viscous", "power-law-damping", "viscoelastic")
STIFFNESS = ("cubic-stiffness", "quadratic-stiffness", "end-stop", "backlash", "stiffness-drift")
AROUND = ("force-ripple", "harmonic-force", "impulse", "attached-mode")
SENSORS = ("sensor-lag", "sensor-gain", "sensor-bias", "sensor-clipping")


@dataclass(frozen=True, slots=True)
class Kind:
    """A kind of machine. Ranges are drawn log-uniformly.

    restoring : "spring", "pendulum" or "none". channels : what may be recorded, such as "x" or "xa".
    angular : rad and not m. omega_n : rad/s. length : amplitude, m or rad. cycles : recorded. left : amplitude at the
    end over the first. dry : share of the decay that dry friction makes, where no hidden effect asks for more.
    per_cycle : samples. resolution : step of the sensor over the amplitude. stamps : how times may be written.
    names : catalogue effects that may be the main one. drive : of one whose force is measured, its slider with what
    drives it, in place of all but channels, resolution, stamps and names; None of a free decay.
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
    drive: Callable[[np.random.Generator], Base] | None = None

    @property
    def driven(self) -> bool:
        """Whether its force is measured."""
        return self.drive is not None

    def shows(self, name: str) -> tuple[str, ...]:
        """The channels in which an effect shows, all that it needs recorded."""
        return tuple(c for c in self.channels if name == "" or set(EFFECTS[name].needs) <= set(c))

    def has(self, name: str) -> bool:
        """Whether an effect of no catalogue can be the main one: it needs its channels, one of dry friction some."""
        return (self.driven or self.dry[1] > 0.3 or name not in DRY) and bool(self.shows(name))


STEADY, JITTER, ROUNDED, IRREGULAR = "steady", "jitter", "rounded", "irregular"
"""Times as they were; evenly spaced though they were not; rounded; uneven and true."""

SPRING_ARM = Kind(
    *("spring-arm", "spring", ("x",), True, (6.0, 60.0), (0.05, 0.6), (7.0, 18.0), (0.04, 0.4), (0.1, 0.6)),
    *((40.0, 300.0), (3e-4, 1e-2), (STEADY, JITTER, ROUNDED)),
    names=(*FRICTION, *DAMPING, *STIFFNESS, *AROUND, "constant-force", "pendulum-stiffness", "sensor-drift"),
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
    names=(*FRICTION, *DAMPING, *AROUND, "quadratic-stiffness", "end-stop", "stiffness-drift"),
)
TORSION_WHEEL = Kind(
    *("torsion-wheel", "spring", ("v",), True, (3.0, 20.0), (0.1, 0.8), (6.0, 16.0), (0.15, 0.7), (0.01, 0.4)),
    *((60.0, 350.0), (5e-4, 4e-3), (STEADY, JITTER)),
    names=(
        *("stribeck", "position-dependent-friction", "friction-drift", "load-dependent-friction", *DAMPING),
        *("cubic-stiffness", "quadratic-stiffness", "end-stop", "stiffness-drift", *AROUND),
    ),
)
CART = Kind(
    *("cart", "spring", ("xa",), False, (10.0, 60.0), (0.005, 0.12), (7.0, 18.0), (0.03, 0.4), (0.1, 0.6)),
    *((40.0, 140.0), (3e-4, 6e-3), (STEADY, JITTER, ROUNDED)),
    names=(*FRICTION, *DAMPING, *STIFFNESS, *AROUND, *SENSORS, "constant-force", "sensor-drift"),
)
RUBBER_STAGE = Kind(
    *("rubber-stage", "spring", ("a", "x", "xa"), False, (30.0, 300.0), (2e-4, 4e-3), (5.0, 10.0), (0.03, 0.25)),
    *((0.005, 0.15), (40.0, 200.0), (5e-4, 5e-3), (STEADY, JITTER)),
    names=(
        *(*DAMPING, "cubic-stiffness", "quadratic-stiffness", "end-stop", "backlash"),
        *(*AROUND, "sensor-bias", "sensor-clipping"),
    ),
)
AIR_STAGE = Kind(
    *("air-stage", "spring", ("x",), False, (3.0, 30.0), (0.005, 0.05), (25.0, 50.0), (0.1, 0.6), (0.002, 0.1)),
    *((30.0, 120.0), (1e-5, 1e-3), (STEADY, JITTER)),
    names=(
        *("quadratic-drag", "power-law-damping", "asymmetric-viscous", "cubic-stiffness", "quadratic-stiffness"),
        *("stiffness-drift", *AROUND, "sensor-drift"),
    ),
)
SERVO_PENDULUM = Kind(
    *("servo-pendulum", "pendulum", ("x",), True, (6.0, 12.0), (0.6, 1.9), (3.5, 9.0), (0.003, 0.1), (0.4, 0.9)),
    *((30.0, 120.0), (8e-4, 4e-3), (IRREGULAR, ROUNDED)),
    names=(*FRICTION, "quadratic-drag", "asymmetric-viscous", "viscoelastic", "force-ripple", "quadratic-stiffness"),
)

FREE = {
    kind.name: kind
    for kind in (
        *(SPRING_ARM, STRING_PENDULUM, ENCODER_PENDULUM, TORSION_WHEEL),
        *(CART, RUBBER_STAGE, AIR_STAGE, SERVO_PENDULUM),
    )
}
CLAIMED = {
    restoring: {name for kind in FREE.values() if kind.restoring == restoring for name in kind.names}
    for restoring in ("spring", "pendulum")
}
CLAIMED["spring"].add("static-friction")
"""Laws that may be claimed of a machine with such a restoring force, those of one that is driven among them."""

MAIN, CONTROL, UNNAMED, TABLE = "main", "machine-control", "unknown", "table"
"""One effect of the catalogue above small ones; small ones alone; one of no catalogue; a static one of no catalogue."""
GROUPS = (MAIN, CONTROL, UNNAMED, TABLE)


@dataclass(frozen=True, slots=True)
class Job:
    """A recording to be drawn. index : its place, from which its chance follows. main : "" in a control."""

    index: int
    group: str
    kind: Kind
    main: str


def plan(kinds: Sequence[Kind], mains: int, controls: int, unknown: int, tables: int, seed: int) -> list[Job]:
    """The recordings in random order; every kind occurs as often as any other in each group, give or take one."""
    rng = np.random.default_rng([seed, 0])
    used: Counter[str] = Counter()
    drafts: list[Job] = []
    for group, count in ((MAIN, mains), (CONTROL, controls), (UNNAMED, unknown), (TABLE, tables)):
        order = [kinds[int(i)] for i in rng.permutation(len(kinds))]
        for kind in islice(cycle(order), count):
            main = _least(possible(kind, group), used, rng)
            used[main] += 1
            drafts.append(Job(0, group, kind, main))
    return [replace(drafts[int(i)], index=index) for index, i in enumerate(rng.permutation(len(drafts)))]


def possible(kind: Kind, group: str) -> tuple[str, ...]:
    """Main effects of a group on a kind of machine."""
    if group == MAIN:
        return kind.names
    if group == CONTROL:
        return ("",)
    names = (*UNKNOWN, *STATIC) if group == UNNAMED else tuple(STATIC)
    return tuple(name for name in names if kind.has(name))


def _least(names: Sequence[str], used: Counter[str], rng: np.random.Generator) -> str:
    # not the rarest alone: a kind would get nothing but what no other kind has
    fewest = min(used[name] for name in names)
    rarest = [name for name in names if used[name] <= fewest + 1]
    return rarest[int(rng.integers(len(rarest)))]
