"""The steps of a run-down: those of a free decay without a hand, a zero of a spring and an engine's trace.

Of several run-downs: those of several decays.
"""

from harness.diagnosis.inverse_dynamics.validate import Judge
from harness.diagnosis.kinds.free_decay import DecaysTogether, based
from harness.diagnosis.kinds.kind import Kind
from harness.diagnosis.problems.run_down import RunDown
from harness.diagnosis.problems.together import RunDownsTogether
from harness.diagnosis.search.long_recordings import lifted
from harness.diagnosis.search.search import search
from harness.diagnosis.stages import Based, Found


class RunDowns(Kind[RunDown]):
    """See Kind."""

    of = RunDown

    def fit_base(self, problem: RunDown) -> Based[RunDown]:
        """In means of neighbours where it is very long."""
        return based(problem)

    def search(self, based: Based[RunDown], other: Judge | None) -> Found:
        """Then on all samples."""
        found = search(based.problem, based.fit, based.scales)
        in_means = based.problem.t.size < based.whole.t.size
        return Found(lifted(found, based.whole, based.scales) if in_means else found, based.scales, found)


class SeveralRunDowns(DecaysTogether):
    """See Kind."""

    of = RunDownsTogether
