"""A run-down: a slider or a wheel let go in motion that nothing pulls back and nothing drives, until it stops.

It passes each place and each speed once, so that what acts in one direction, at one place or at one time is not parted
from what acts at one speed. Instead of swings it has equal stretches of time, of which each says a word of its own.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import ClassVar, Self

import numpy as np

from harness.core.arrays import FloatArray, IntArray
from harness.diagnosis.problem import Observation, Problem
from harness.diagnosis.problems.simulated import observe
from harness.fit.series import standing_out
from harness.kernels.solve import By, Effort, Scales
from harness.model.model import Model, Restoring

STRETCHES = 16
"""Of a run-down, two of which count as a cycle: four words for each of four numbers."""
WINDOWS = 32
"""In which the speed is read, two a stretch."""
_SHARES = (0.5, 0.1, 0.9)
"""Of the speed lost that is given to dry friction at a start."""
_FINE = 20_000
"""Samples that first looks are given: means of fewer would level out what repeats with the place."""
_FEWEST_CYCLES, _PEAKS = 3.0, 12
"""Cycles over the way of what repeats with the place, and periods that are tried."""
_PATIENT = 50
"""Times the steps of a swing."""
_LINE = 3
"""Samples that a slope needs."""


def patient(effort: Effort, model: Model) -> Effort:
    """With as many steps as what repeats with the place, or in time, or is a table may take.

    Others take so many only where they cannot be followed.
    """
    laws = [entry.term for entry in model.terms]
    if not any(law.known is not None or any(p.repeats for p in law.parameters) for law in laws):
        return effort
    return replace(effort, steps_per_cycle=_PATIENT * effort.steps_per_cycle)


@dataclass(frozen=True, slots=True)
class Course:
    """The speed of a motion in windows. t (m,), s : their middles. v (m,), m/s, with standard errors v_sd (m,)."""

    t: FloatArray
    v: FloatArray
    v_sd: FloatArray

    @classmethod
    def of(cls, t: FloatArray, channels: Mapping[str, FloatArray], windows: int = WINDOWS) -> "Course":
        """Of v where it was recorded, else as the slope of x; channels (n,) at t (n,), s."""
        name = "v" if "v" in channels else "x"
        y, rows = channels[name], []
        count = max(min(windows, t.size // _LINE), 1)
        for part in np.array_split(np.arange(t.size), count):
            s = t[part] - t[part].mean()
            line = np.column_stack((np.ones(s.size), s))
            found = np.linalg.lstsq(line, y[part], rcond=None)[0]
            level = math.sqrt(float(np.sum((y[part] - line @ found) ** 2)) / max(s.size - 2, 1))
            size = math.sqrt(s.size) if name == "v" else math.sqrt(max(float(s @ s), 1e-300))
            rows.append((float(t[part].mean()), float(found[0 if name == "v" else 1]), level / size))
        return cls(*np.array(rows).T)


@dataclass(frozen=True, slots=True, kw_only=True)
class RunDown(Problem):
    """See Problem; of x or v, or both."""

    restoring: Restoring = Restoring.NONE
    returns: ClassVar[bool] = False

    def shows(self, model: Model, by: tuple[By, ...], scales: Scales | None, effort: Effort) -> Observation:
        """By simulation; see ``patient``."""
        return observe(model, self, by, scales, patient(effort, model))

    @property
    def scales(self) -> Scales:
        """Its way, its first speed, and as many cycles as two of its stretches make."""
        course = Course.of(self.t, self.channels)
        way = self.channels["x"] if "x" in self.channels else np.cumsum(course.v) * self.duration / course.t.size
        omega = math.pi * STRETCHES / self.duration
        return Scales(float(np.ptp(way)), float(np.max(np.abs(course.v))), omega)

    @property
    def rough(self) -> tuple[Model, ...]:
        """By the speed it loses, which is given to dry friction and to damping in several shares."""
        course, m = Course.of(self.t, self.channels), self.mass or 1.0
        v0, span = float(course.v[0]), float(course.t[-1] - course.t[0])
        lost = max(abs(v0) - abs(float(course.v[-1])), 0.0)
        way = float(np.mean(np.abs(course.v))) * span
        x0 = float(self.channels["x"][0]) if "x" in self.channels else 0.0
        return tuple(
            Model(
                m, (1.0 - share) * m * lost / way, 0.0, share * m * lost / span, restoring=Restoring.NONE, x0=x0, v0=v0,
                t0=float(self.t[0]), mass_known=self.mass is not None,
            )
            for share in _SHARES
        )  # fmt: skip

    def periods(self, x: FloatArray, residual: FloatArray) -> tuple[float, ...]:
        """At which what is left of the first channel stands out over the places x (n,)."""
        return tuple(standing_out(x, residual[: x.size], _FEWEST_CYCLES, 0.5 * x.size)[:_PEAKS])

    def of_hand_free(self, fewest: int) -> tuple[Self, float]:
        """Itself: the hand's part is cut off where it was prepared."""
        return self, 0.0

    def turns(self, v: FloatArray) -> IntArray:
        """Where a stretch ends: a misfit says one thing in each."""
        ends = self.t[0] + self.duration * np.arange(1, STRETCHES) / STRETCHES
        found: IntArray = np.searchsorted(self.t, ends)
        return found

    def condensed(self, shown: Mapping[str, FloatArray], size: int) -> tuple[Self, float]:
        """In means that keep what repeats with the place."""
        size = min(size, self.t.size // _FINE)
        return (self, 1.0) if size < 2 else super(RunDown, self).condensed(shown, size)
