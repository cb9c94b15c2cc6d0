"""A log of a robot's joints as somebody recorded it, in SI units."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from types import MappingProxyType

from harness.core.arrays import FloatArray
from harness.core.checks import increasing, vector
from harness.core.errors import InputError

MINIMUM_SAMPLES = 50


@dataclass(frozen=True, slots=True)
class JointLog:
    """Positions, velocities and efforts of named joints over time; every array has shape (n,) and is read-only.

    t : s, increasing. position : rad or m, by joint. velocity : rad/s or m/s, effort : N m or N; joints that were not
    logged are not used. file : where it came from. sha256 : of that file. notes : what the reader did, one sentence
    each. goal : position that is asked of a servo, rad or m. voltage : of its supply, V. driven : 1 where it drives.
    temperature : of the joint, degC.

    Raises InputError for fewer than 50 samples, a value not finite, time that does not increase, or no position.
    """

    t: FloatArray
    position: Mapping[str, FloatArray]
    velocity: Mapping[str, FloatArray] = field(default_factory=dict)
    effort: Mapping[str, FloatArray] = field(default_factory=dict)
    file: str = "log"
    sha256: str = ""
    notes: tuple[str, ...] = ()
    goal: Mapping[str, FloatArray] = field(default_factory=dict)
    voltage: Mapping[str, FloatArray] = field(default_factory=dict)
    driven: Mapping[str, FloatArray] = field(default_factory=dict)
    temperature: Mapping[str, FloatArray] = field(default_factory=dict)

    def __post_init__(self) -> None:
        t = vector(f"{self.file}: time", self.t)
        if t.size < MINIMUM_SAMPLES:
            raise InputError(self.file, f"{t.size} samples", f"at least {MINIMUM_SAMPLES}")
        increasing(f"{self.file}: time", t)
        object.__setattr__(self, "t", t)
        if not self.position:
            raise InputError(self.file, "no joint's position", "a log with positions of joints")
        for kind in ("position", "velocity", "effort", "goal", "voltage", "driven", "temperature"):
            given = getattr(self, kind)
            kept = {name: vector(f"{self.file}: {name}.{kind}", y, t.size) for name, y in given.items()}
            object.__setattr__(self, kind, MappingProxyType(kept))

    @property
    def joints(self) -> tuple[str, ...]:
        """Names of the joints, as the log orders them."""
        return tuple(self.position)
