"""The steps of a driven recording whose force is fitted.

The steps of several driven recordings of one machine, whose force is fitted: whether they share it comes first.
"""

from dataclasses import replace

from harness.diagnosis.explain.force_map import ForceMap, measured_map
from harness.diagnosis.fit.model_fit import Fit
from harness.diagnosis.inverse_dynamics.search import force_baseline, left_said, moving, search_driven, under_noise
from harness.diagnosis.inverse_dynamics.validate import Judge, holdout_windows
from harness.diagnosis.kinds.kind import Kind
from harness.diagnosis.motion import Motion
from harness.diagnosis.outcome import Holdout
from harness.diagnosis.pooling.forces import shared_forces, unmasked_forces
from harness.diagnosis.pooling.pooled import Pooled
from harness.diagnosis.pooling.repeated import sentences
from harness.diagnosis.problems.forces_together import ForcesTogether
from harness.diagnosis.problems.inverse import InverseDynamics
from harness.diagnosis.search.search import under
from harness.diagnosis.stages import Based, Found, Judged
from harness.estimate.noise import channel_noise
from harness.kernels.solve import Scales

_JUDGED = (
    "terms were kept because the force error on the other recording falls with them, so that its errors took part in"
    " the choice"
)


class FittedForces(Kind[InverseDynamics]):
    """See Kind."""

    of = InverseDynamics

    def fit_base(self, problem: InverseDynamics) -> Based[InverseDynamics]:
        """By the force."""
        problem = under_noise(problem)
        base, scales = force_baseline(problem)
        level = problem.levelled(base.residual, base.memory.independent)
        return Based(problem, level, moving(under(base, level), level, scales), scales)

    def search(self, based: Based[InverseDynamics], other: Judge | None) -> Found:
        """A law is kept if it takes more off than chance does, or if another recording confirms it."""
        done = search_driven(based.whole, other)
        found = done.search
        left = left_said(found.problem, based.whole.drive, found.base.points, done.over)
        return Found(found, done.scales, found, None, (left, *((_JUDGED,) if other else ())), done.graded)

    def hold_out(self, judged: Judged) -> Holdout:
        """Every second window."""
        coarse = judged.found.coarse
        assert isinstance(coarse.problem, InverseDynamics)
        return holdout_windows(coarse.base, judged.judgement.refined, coarse.problem, judged.found.scales)

    def left_over(self, problem: InverseDynamics, base: Fit, scales: Scales, wander: float | None = None) -> ForceMap:
        """What is left of the measured force itself, where the slider moves."""
        measured = problem.measured
        left = (measured.u - measured.needed(base.model)) / base.model.m
        motion = Motion(measured.x, measured.v, ~measured.slides, scales.omega)
        return measured_map(measured.t, left, channel_noise(measured.t, left).sigma, motion)


class ForcesOfSeveral(FittedForces):
    """See Kind."""

    of: type[InverseDynamics] = ForcesTogether

    def search(self, based: Based[InverseDynamics], other: Judge | None) -> Found:
        """First what the recordings share; a difference may also show only beside what is missing in all of them."""
        assert isinstance(based.whole, ForcesTogether)
        shared = shared_forces(based.whole)
        found = self._searched(shared)
        more = unmasked_forces(found.search.chosen.model, shared)
        while more is not None:
            shared = more
            found = self._searched(shared)
            more = unmasked_forces(found.search.chosen.model, shared)
        problem = found.search.problem
        assert isinstance(problem, ForcesTogether)
        said = sentences(shared)
        search = replace(found.search, problem=replace(problem, said=said))
        return replace(found, search=search, coarse=search, pooled=shared)

    def _searched(self, shared: Pooled[ForcesTogether]) -> Found:
        problem: InverseDynamics = shared.problem
        based = Based(problem, problem, shared.base, shared.scales)
        return super().search(based, None)
