"""The steps of several free decays of one machine: whether they share their physics comes before what is missing."""

from collections.abc import Mapping, Sequence
from dataclasses import replace

from harness.core.recording import Recording
from harness.diagnosis.explain.holdout import periods_held_out
from harness.diagnosis.fit.another import as_started
from harness.diagnosis.inverse_dynamics.validate import Judge
from harness.diagnosis.kinds.free_decay import based
from harness.diagnosis.kinds.kind import Kind
from harness.diagnosis.outcome import Holdout
from harness.diagnosis.pooling.pooled import Pooled, shared_by, unmasked
from harness.diagnosis.pooling.repeated import own_of_each
from harness.diagnosis.pooling.said import sentences
from harness.diagnosis.prepare.together import together
from harness.diagnosis.problem import Problem
from harness.diagnosis.problems.together import Together
from harness.diagnosis.request import Asked
from harness.diagnosis.search.long_recordings import lifted
from harness.diagnosis.search.search import Search, search
from harness.diagnosis.stages import Based, Found, Judged
from harness.kernels.solve import Scales
from harness.model.model import Model, ModelTerm
from harness.model.place import Place


class DecaysTogether(Kind[Together]):
    """See Kind."""

    of = Together

    def suits(self, recording: Recording) -> bool:
        """No recording by itself."""
        return False

    def prepare(self, recording: Recording, asked: Asked) -> tuple[Problem, tuple[str, ...]]:
        """Of one recording there is nothing to pool."""
        return together([recording], asked)

    def fit_base(self, problem: Together) -> Based[Together]:
        """In means of neighbours where they are very long."""
        return based(problem)

    def search(self, based: Based[Together], other: Judge | None) -> Found:
        """First what the recordings share; a difference may also show only beside what is missing in all of them."""
        shared = shared_by(based.problem, based.fit, based.scales)
        scales = shared.scales
        found = search(shared.problem, shared.base, scales)
        more = unmasked(found, shared)
        while more is not None:
            shared, found = more, search(more.problem, more.base, scales)
            more = unmasked(found, shared)
        found, shared = own_of_each(found, shared)
        found = _said(found, shared)
        if based.problem.t.size < based.whole.t.size:
            levels = [one.problem.noise for one in shared.compared.alone]
            whole = replace(based.whole.with_own(shared.own).under_levels(levels), said=found.problem.choices)
            return Found(lifted(found, whole, scales), scales, found, pooled=shared)
        return Found(found, scales, found, pooled=shared)

    def hold_out(self, problem: Together, judged: Judged, acting: Sequence[tuple[ModelTerm, Place]]) -> Holdout:
        """Every second full period."""
        return periods_held_out(judged.found.coarse, judged.judgement, judged.found.scales, acting)

    def tried(self, problem: Together, models: Sequence[Model], scales: Scales) -> list[Mapping[str, float]]:
        """From their own starts."""
        return [as_started(model, problem, scales) for model in models]


def _said(found: Search, shared: Pooled[Together]) -> Search:
    problem = found.problem
    assert isinstance(problem, Together)
    return replace(found, problem=replace(problem, said=sentences(found.chosen, problem, shared, found.explained)))
