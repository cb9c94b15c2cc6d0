"""What a simulation is given besides the model: a drive, scales of the motion, and how hard to try."""

import math
from dataclasses import dataclass, replace

import numpy as np

from harness.core.arrays import FloatArray
from harness.core.checks import increasing, vector
from harness.core.errors import InputError
from harness.model.model import Model, Restoring
from harness.model.term import Slot

TOLERANCE = 1e-9
"""Default error per step relative to the scale of the motion."""


@dataclass(frozen=True, slots=True)
class Drive:
    """A measured force: knots t (k,) in s and values u (k,) in N (per unit mass when the mass is unknown).

    Linear between the knots, or held from each to the next as a sampled controller's; constant outside them. Raises
    InputError for times that do not increase, lengths that differ, or a value that is not finite.
    """

    t: FloatArray
    u: FloatArray
    held: bool = False

    def __post_init__(self) -> None:
        object.__setattr__(self, "t", vector("drive: t", self.t))
        object.__setattr__(self, "u", vector("drive: u", self.u, self.t.size))
        if self.t.size == 0:
            raise InputError("drive", "no knots", "at least one is accepted")
        increasing("drive: t", self.t)

    def within(self, begin: float, end: float) -> tuple[FloatArray, FloatArray]:
        """The knots that decide the force from ``begin`` to ``end`` (s)."""
        first = max(int(np.searchsorted(self.t, begin, side="right")) - 1, 0)
        last = int(np.searchsorted(self.t, end, side="left")) + 1
        return self.t[first:last], self.u[first:last]

    def over(self, begin: float, end: float) -> "Drive":
        """The same force, in time since ``begin`` (s), up to ``end``."""
        at, force = self.within(begin, end)
        return replace(self, t=at - begin, u=force)

    @property
    def straight(self) -> "Drive":
        """In straight lines that pass on as much momentum: of a force that is held, half an interval later."""
        if not self.held:
            return self
        return Drive(np.append(0.5 * (self.t[1:] + self.t[:-1]), self.t[-1]), self.u)

    def at(self, t: FloatArray) -> FloatArray:
        """The force (n,), N, at times t (n,), s; of a step what holds after it."""
        if not self.held:
            return np.interp(t, self.t, self.u)
        return np.asarray(self.u[np.maximum(np.searchsorted(self.t, t, side="right") - 1, 0)], dtype=np.float64)

    def felt(self, t: FloatArray) -> FloatArray:
        """The force (n,), N, at times t (n,), s, as a motion's differences show it: of a step the mean of its sides."""
        if not self.held:
            return np.interp(t, self.t, self.u)
        sides = (np.searchsorted(self.t, t, side=side) - 1 for side in ("left", "right"))
        before, after = (self.u[np.maximum(i, 0)] for i in sides)
        return np.asarray(0.5 * (before + after), dtype=np.float64)


@dataclass(frozen=True, slots=True)
class Scales:
    """What counts as ordinary in a motion: displacement (m), speed (m/s), and an angular frequency (rad/s)."""

    x: float
    v: float
    omega: float

    @classmethod
    def of(cls, model: Model, drive: Drive | None = None) -> "Scales":
        """From the model itself: its release, its frequency, what pushes and knocks it."""
        omega = math.sqrt(model.k / model.m) if model.restoring is not Restoring.NONE else 0.0
        push = float(np.max(np.abs(drive.u))) if drive is not None else 0.0
        push += sum(abs(e.values[e.term.push]) for e in model.terms if e.term.push is not None)
        if omega == 0.0:
            # without a spring: the time in which viscous damping stops it, at least the recording's own scale
            span = float(drive.t[-1] - drive.t[0]) if drive is not None and drive.t.size > 1 else 1.0
            omega = max(model.c / model.m, 6.0 / span)
        speed = abs(model.v0) + sum(abs(e.values[1]) / model.m for e in model.in_slot(Slot.EVENT))
        inside = max((abs(w) for e in model.terms for w in e.internal0), default=0.0)
        x = max(abs(model.x0), speed / omega, push / model.m / omega**2, inside, 1e-12)
        return cls(x, max(speed, x * omega), omega)


@dataclass(frozen=True, slots=True)
class Effort:
    """How hard to try: error per step relative to the scales, and the most steps a cycle of the motion may take."""

    tolerance: float = TOLERANCE
    steps_per_cycle: int = 4000
