"""The steps of a run-down: those of a free decay without a hand, a zero of a spring and an engine's trace."""

import math

from harness.core.errors import InputError
from harness.diagnosis.inverse_dynamics.validate import Judge
from harness.diagnosis.kinds.free_decay import based
from harness.diagnosis.kinds.kind import Kind
from harness.diagnosis.problems.run_down import RunDown
from harness.diagnosis.search.long_recordings import lifted
from harness.diagnosis.search.search import search
from harness.diagnosis.stages import Based, Found

_STOPS = 5.0
"""Standard errors of dry friction from which a motion ends by it."""


class RunDowns(Kind[RunDown]):
    """See Kind."""

    of = RunDown

    def fit_base(self, problem: RunDown) -> Based[RunDown]:
        """In means of neighbours where it is very long.

        Raises InputError for a place that creeps to a level without stopping, unless somebody says that it runs down.
        """
        found = based(problem)
        if not problem.sure and "v" not in problem.channels:
            at = next(i for i, f in enumerate(found.fit.free) if f.name == "f_k")
            if found.fit.model.f_k <= _STOPS * math.sqrt(float(found.fit.covariance()[at, at])):
                what = "no dry friction stops what creeps to a level: a drifting sensor looks like this"
                raise InputError("recording", what, "a swing is accepted, or a run-down by --restoring none")
        return found

    def search(self, based: Based[RunDown], other: Judge | None) -> Found:
        """Then on all samples."""
        found = search(based.problem, based.fit, based.scales)
        in_means = based.problem.t.size < based.whole.t.size
        return Found(lifted(found, based.whole, based.scales) if in_means else found, based.scales, found)
