"""A free decay: released by a hand, simulated as a whole from one start, disturbed by its sensors alone."""

from dataclasses import dataclass

from harness.core.arrays import FloatArray, IntArray
from harness.diagnosis.problem import Problem
from harness.diagnosis.problems.turning_points import first_turn, turning_points


@dataclass(frozen=True, slots=True, kw_only=True)
class FreeDecay(Problem):
    """See Problem."""

    def misfit_begins(self) -> int:
        """After the first turning point: a hand at the release acts before it."""
        return first_turn(self.t, self.channels, turning_points(self.t, self.channels))

    def turns(self, v: FloatArray) -> IntArray:
        """Of the recorded swing itself, which no model need follow."""
        return turning_points(self.t, self.channels)
