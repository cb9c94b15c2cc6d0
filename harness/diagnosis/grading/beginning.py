"""Whether a free decay was free from its beginning on: a law says of the first half-swing what it says of the rest."""

import math
from contextlib import suppress
from dataclasses import replace

from harness.core.arrays import BoolArray, FloatArray
from harness.core.errors import SimulationError
from harness.diagnosis.fit.model_fit import Fit, fit
from harness.diagnosis.fit.parameters import base_of, free_of
from harness.diagnosis.grading.begun import from_within
from harness.diagnosis.grading.grade import Graded, grade
from harness.diagnosis.grading.misfit import misfit
from harness.diagnosis.outcome import Grade
from harness.diagnosis.problem import Problem
from harness.diagnosis.rules import BEGINS_ALIKE, LEAST_RATIO
from harness.diagnosis.search.release_transient import of_a_hand
from harness.diagnosis.search.search import Search
from harness.kernels.solve import Scales


def from_the_beginning(found: Search, later: Graded, scales: Scales) -> Graded | None:
    """A misfit graded from the release on, where from the first turning point on it comes to no name and no hand shows.

    What acts at the largest swings alone, a stop or a sensor that clips, acts there. found : of the whole recording;
    later : graded from the first turning point. Raises SimulationError.
    """
    if later.misfit.left_out == 0.0 or later.grade in (Grade.MAIN, Grade.ONE_OF):
        return None
    # what is over while a hand lets go says nothing of whether one was there
    seen_whole = (f for f in found.singles if f.shown.x.size == found.problem.t.size)
    lasting = next((f for f in seen_whole if not of_a_hand(f, found.problem, scales)), None)
    after = replace(later.misfit.problem, noise=found.problem.noise)
    if lasting is None or not _begins_alike(lasting, found.problem, after, scales):
        return None
    seen = grade(misfit(found.problem, found.base, scales, whole=True), found.begun)
    said = seen.grade in (Grade.MAIN, Grade.ONE_OF) and not of_a_hand(seen.named[0].fit, found.problem, scales)
    return replace(seen, rules=(*seen.rules, BEGINS_ALIKE)) if said else None


def _begins_alike(best: Fit, problem: Problem, later: Problem, scales: Scales) -> bool:
    """Whether no hand shows in what comes before ``later``.

    best : of one law more than the base, to the whole; later : under the same noise. It must leave of the beginning
    about what it leaves of the half-swing that follows, or of all that does, and of that no more than if it alone were
    fitted: a hand bends the whole fit.
    """
    first = problem.t < later.t[0]
    second = ~first & (problem.t < later.t[0] + math.pi / scales.omega)
    left = _squares(best, problem)
    usual = max(_mean(left, second), _mean(left, ~first))
    if _mean(left, first) > BEGINS_ALIKE.value**2 * usual:
        return False
    moved = from_within((best.model,), problem, float(later.t[0]), scales)
    names = tuple(dict.fromkeys((*base_of(best.free), *later.starts.names)))
    for model in moved:
        with suppress(SimulationError):
            own = _squares(fit(model, later, free_of(model, names), scales, thorough=False), later)
            return _mean(left, ~first) <= LEAST_RATIO.value * float(own.mean())
    return False


def _squares(shown: Fit, problem: Problem) -> FloatArray:
    """What a fit leaves of each sample (n,), over all channels in units of their noise."""
    left = {c: problem.even(c, y - shown.shown.y[c]) / problem.noise[c].sigma for c, y in problem.channels.items()}
    return sum((problem.weight[c] * r**2 for c, r in left.items()), start=0.0 * problem.t)


def _mean(values: FloatArray, where: BoolArray) -> float:
    return float(values[where].mean()) if where.any() else math.inf
