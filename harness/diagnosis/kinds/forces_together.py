"""The steps of several driven recordings of one machine, whose force is fitted: whether they share it comes first."""

from dataclasses import replace

from harness.core.recording import Recording
from harness.diagnosis.inverse_dynamics.together import forces_together
from harness.diagnosis.inverse_dynamics.validate import Judge
from harness.diagnosis.kinds.inverse_dynamics import FittedForces
from harness.diagnosis.pooling.forces import shared_forces, unmasked_forces
from harness.diagnosis.pooling.pooled import Pooled
from harness.diagnosis.pooling.said import sentences
from harness.diagnosis.problems.forces_together import ForcesTogether
from harness.diagnosis.problems.inverse_dynamics import InverseDynamics
from harness.diagnosis.request import Asked
from harness.diagnosis.stages import Based, Found


class ForcesOfSeveral(FittedForces):
    """See Kind."""

    of: type[InverseDynamics] = ForcesTogether

    def prepare(self, recording: Recording, asked: Asked) -> tuple[ForcesTogether, tuple[str, ...]]:
        """Of one recording there is nothing to pool."""
        return forces_together([recording], asked)

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
        said = sentences(found.search.chosen, problem, shared, found.search.explained)
        search = replace(found.search, problem=replace(problem, said=said))
        return replace(found, search=search, coarse=search, pooled=shared)

    def _searched(self, shared: Pooled[ForcesTogether]) -> Found:
        problem: InverseDynamics = shared.problem
        based = Based(problem, problem, shared.base, shared.scales)
        return super().search(based, None)
