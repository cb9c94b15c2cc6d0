"""A free decay: released by a hand, simulated as a whole from one start, disturbed by its sensors alone."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import ClassVar, Self

import numpy as np

from harness.core.arrays import FloatArray, IntArray
from harness.diagnosis.motion import motion_of
from harness.diagnosis.problem import Problem
from harness.diagnosis.problems.starts import InMotion
from harness.diagnosis.problems.turning_points import first_turn, turning_points

_FEWEST_TURNS = 3
"""Turning points whose distance gives the period."""


@dataclass(frozen=True, slots=True, kw_only=True)
class FreeDecay(Problem):
    """See Problem.

    enters : how covariates were found to enter, one sentence each. clock : by how much t is ahead of the recording's
    own times (m,), s, (m,), where its clock drifts.
    """

    enters: tuple[str, ...] = ()
    clock: tuple[FloatArray, FloatArray] | None = None
    provides: ClassVar[frozenset[str]] = frozenset({"one-clock"})

    @property
    def choices(self) -> tuple[str, ...]:
        """How covariates enter."""
        return self.enters

    def at_every_sample(self, t: FloatArray, channels: Mapping[str, FloatArray]) -> Problem:
        """See Problem; t (m,) by the recording's own clock."""
        return super(FreeDecay, self).at_every_sample(
            t if self.clock is None else t + np.interp(t, *self.clock), channels
        )

    def of_hand_free(self, fewest: int) -> tuple[Self, float]:
        """See Problem: a hand at the release acts before the first turning point."""
        turns = turning_points(self.t, self.channels)
        at = first_turn(self.t, self.channels, turns)
        if not at or self.t.size - at < fewest:
            return self, 0.0
        return self._begun_at(at, turns), float(self.t[at] - self.t[0])

    def _begun_at(self, sample: int, turns: IntArray) -> Self:
        """What follows a sample: a start within the motion, which has left its mark on what relaxes or bends."""
        if turns.size < _FEWEST_TURNS:
            return self.part(slice(sample, None))
        half = float(np.median(np.diff(self.t[turns])))
        v = motion_of(self.t, self.channels, math.pi / half).v[: sample + 1]
        last = v[self.t[: sample + 1] >= self.t[sample] - 0.5 * half]
        starts = InMotion(self.t[: sample + 1], v, float(last[np.argmax(np.abs(last))]))
        return replace(self.part(slice(sample, None)), starts=starts)

    def turns(self, v: FloatArray) -> IntArray:
        """Of the recorded swing itself, which no model need follow."""
        return turning_points(self.t, self.channels)
