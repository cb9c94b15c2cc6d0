"""Several run-downs of one slider; where they go in both directions, a push is told from dry friction."""

import math
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from harness.core.arrays import FloatArray
from harness.diagnosis.problem import Observation, Problem
from harness.diagnosis.problems.run_down import RunDown, patient
from harness.diagnosis.problems.simulated import observe
from harness.diagnosis.problems.together import Together
from harness.kernels.solve import By, Effort, Scales
from harness.model.model import Model, Restoring


@dataclass(frozen=True, slots=True, kw_only=True)
class RunDownsTogether(Together):
    """See Together."""

    restoring: Restoring = Restoring.NONE
    returns: ClassVar[bool] = False
    piece: ClassVar[type[Problem]] = RunDown

    def shows(self, model: Model, by: tuple[By, ...], scales: Scales | None, effort: Effort) -> Observation:
        """By simulation, as of one."""
        return observe(model, self, by, scales, patient(effort))

    @property
    def both_ways(self) -> bool:
        """Whether some go the other way."""
        name = "v" if "v" in self.channels else "x"
        y = self.channels[name]
        ways = {bool((np.mean(y[at]) if name == "v" else y[at][-1] - y[at][0]) > 0.0) for at in self.places}
        return len(ways) > 1

    @property
    def given(self) -> frozenset[str]:
        """A push is told where both directions are."""
        return super(RunDownsTogether, self).given | (frozenset({"zero"}) if self.both_ways else frozenset())

    @property
    def scales(self) -> Scales:
        """The longest way, the fastest speed, and what is ordinary in time."""
        each = [one.scales for one in self.alone if one.scales is not None]
        omega = math.exp(float(np.mean([math.log(one.omega) for one in each])))
        return Scales(max(one.x for one in each), max(one.v for one in each), omega)

    def periods(self, x: FloatArray, residual: FloatArray) -> tuple[float, ...]:
        """Those that stand out in the longest, where all count places from one zero: nowhere without a place."""
        if "x" not in self.channels:
            return ()
        at = max(self.places, key=lambda one: one.stop - one.start)
        return self._one(next(s for s in self.starts.stretches if s.start == at.start)).periods(x[at], residual[at])
