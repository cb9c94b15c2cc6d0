"""A free decay: released by a hand, simulated as a whole from one start, disturbed by its sensors alone."""

import math
from dataclasses import dataclass, replace
from typing import Self

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
    """See Problem."""

    def misfit_begins(self) -> int:
        """After the first turning point: a hand at the release acts before it."""
        return first_turn(self.t, self.channels, turning_points(self.t, self.channels))

    def begun_at(self, sample: int) -> Self:
        """See Problem: a start within the motion, which has left its mark on what relaxes or bends."""
        turns = turning_points(self.t, self.channels)
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
