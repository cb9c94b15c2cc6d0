"""What happens between samples: reversals, sticking, break-away."""

from dataclasses import dataclass, field
from enum import IntEnum
from typing import Literal, TypeAlias

import numpy as np

from harness.core.arrays import BoolArray, FloatArray, IntArray
from harness.core.checks import vector
from harness.core.errors import InputError


class Mode(IntEnum):
    """State of the dry contact."""

    SLIP_NEGATIVE = -1
    STICK = 0
    SLIP_POSITIVE = 1


class EventKind(IntEnum):
    """Kinds of events, in the order of increasing specialty."""

    REVERSAL = 0
    STICK = 1
    BREAK_AWAY = 2
    KNOCK = 3


def _empty() -> FloatArray:
    return np.empty(0)


@dataclass(frozen=True, slots=True)
class Events:
    """Events of a trajectory in order of time; all arrays have shape (n,).

    t : s. kind : values of EventKind. x : position at the event, m.
    a_before, a_after : acceleration on either side, m/s^2 (the jump of Liang's eq. 11).
    """

    t: FloatArray = field(default_factory=_empty)
    kind: IntArray = field(default_factory=lambda: np.empty(0, dtype=np.int64))
    x: FloatArray = field(default_factory=_empty)
    a_before: FloatArray = field(default_factory=_empty)
    a_after: FloatArray = field(default_factory=_empty)

    def __post_init__(self) -> None:
        n = np.size(self.t)
        for name in ("t", "x", "a_before", "a_after"):
            object.__setattr__(self, name, vector(f"events: {name}", getattr(self, name), n))
        kind = np.ascontiguousarray(self.kind, dtype=np.int64)
        if kind.shape != (n,):
            raise InputError("events: kind", f"shape {kind.shape}", f"a vector of {n} kinds")
        kind.flags.writeable = False
        object.__setattr__(self, "kind", kind)

    @classmethod
    def sure(cls, t: FloatArray, kind: IntArray, x: FloatArray, a_before: FloatArray, a_after: FloatArray) -> "Events":
        """Of arrays that are vectors of one length already, finite, and nobody else's: nothing is looked at."""
        found = object.__new__(cls)
        for name, values in (("t", t), ("kind", kind), ("x", x), ("a_before", a_before), ("a_after", a_after)):
            values.flags.writeable = False
            object.__setattr__(found, name, values)
        return found

    def __len__(self) -> int:
        return int(self.t.size)

    def of(self, *kinds: EventKind) -> "Events":
        """Only the events of these kinds."""
        return self.where(np.isin(self.kind, [int(k) for k in kinds]))

    def between(self, low: float, high: float) -> "Events":
        """Only the events from ``low`` to ``high``, s."""
        return self.where((self.t >= low) & (self.t <= high))

    def where(self, keep: BoolArray) -> "Events":
        """Only those that keep (n,) says."""
        return Events(self.t[keep], self.kind[keep], self.x[keep], self.a_before[keep], self.a_after[keep])


Regime: TypeAlias = Literal[
    "reversal",
    "stick",
    "low-speed",
    "high-speed",
    "large-displacement",
    "one-direction",
    "one-side",
    "early",
    "late",
    "throughout",
    "channel",
]
