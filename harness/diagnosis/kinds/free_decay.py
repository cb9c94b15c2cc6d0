"""The steps of a free decay: a long one is searched in means, a hand may have let go late, an engine have made it.

The steps of several free decays of one machine: whether they share their physics comes before what is missing.
"""

from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import replace

from harness.core.errors import InputError, SimulationError
from harness.diagnosis.baseline.base_fit import baseline
from harness.diagnosis.baseline.residual_noise import likelihood, stamped
from harness.diagnosis.covariates.following import allowing, enter
from harness.diagnosis.fit.model_fit import fit
from harness.diagnosis.fit.rmse import only_started
from harness.diagnosis.integrator_maps import as_stepped
from harness.diagnosis.inverse_dynamics.validate import Judge
from harness.diagnosis.kinds.kind import Kind
from harness.diagnosis.parameters import base_of, free_of
from harness.diagnosis.pooling.pooled import shared_by, unmasked
from harness.diagnosis.pooling.repeated import own_of_each, sentences
from harness.diagnosis.problem import P
from harness.diagnosis.problems.free_decay import FreeDecay
from harness.diagnosis.problems.together import Together
from harness.diagnosis.residual_tests.structure import Left
from harness.diagnosis.search.extend import extend, settle
from harness.diagnosis.search.long_recordings import lifted, shortened
from harness.diagnosis.search.release_transient import after_hand, over_by
from harness.diagnosis.search.search import Search, noise_of, search, under
from harness.diagnosis.stages import Based, Found
from harness.kernels.solve import Scales
from harness.model.model import Model, Restoring

_LIKELIEST = 3
"""Laws, each alone, that are looked at again where stamps may jitter."""


class FreeDecays(Kind[FreeDecay]):
    """See Kind."""

    of = FreeDecay

    def fit_base(self, problem: FreeDecay) -> Based[FreeDecay]:
        """In means of neighbours where it is very long; covariates enter beside it."""
        plain = based(replace(problem, acting=()))
        return plain if not problem.acting else _entered(plain, problem)

    def search(self, based: Based[FreeDecay], other: Judge | None) -> Found:
        """Where it is doubtful, also without its beginning; then on all samples, and as the trace of an engine."""
        scales = based.scales
        notes: tuple[str, ...] = ()
        found = search(based.problem, based.fit, scales)
        late = self._under_stamps(found, based)
        if late is not None:
            found, based = late
            scales = based.scales
        otherwise = _entering_otherwise(found, based)
        if otherwise is not None:
            based = otherwise
            found = search(based.problem, based.fit, scales)
        zeroed = self._from_a_zero(found, based)
        if zeroed is not None:
            based, scales = zeroed, zeroed.scales
            found = search(based.problem, based.fit, scales)
            notes = ("zero offset fitted as well: on a spring a steady push and a zero offset are one",)
        over = over_by(found.chosen, found.problem, scales) if found.explained else None
        free = after_hand(found.problem, scales, over) if over is not None or not found.explained else None
        if free is not None:
            found, scales, touched = free
            left_out = f"skipped the first {touched:.2g} s (hand still in contact?)"
            notes = (*notes, left_out)
        elif over is not None:
            # what is over while a hand lets go is the hand's: nothing of what follows is explained by it
            found = replace(found, chosen=found.base, left=Left.STRUCTURE, without=())
        in_means = based.problem.t.size < based.whole.t.size
        every = lifted(found, based.whole, scales) if in_means else found
        # no engine is given a covariate
        trace = None if based.whole.acting else as_stepped(every, scales)
        if trace is None:
            return Found(every, scales, found, None, notes)
        return Found(trace[0], scales, trace[0], trace[1], notes)

    def _under_stamps(self, found: Search, based: Based[FreeDecay]) -> tuple[Search, Based[FreeDecay]] | None:
        """The search with samples that count as their stamps let them, where that is likelier; None where it is not.

        What is missing may leave more where the motion is fast, and stamps that jitter look like what is missing.
        """
        tried = (stamped(based.whole, one.model, based.scales) for one in (found.base, found.chosen))
        whole = next((one for one in tried if one is not based.whole), None)
        if whole is None:
            return None
        again = self.fit_base(whole)
        if not _likelier(found, again):
            return None
        # each law goes on from where it ended: what it says of the motion has hardly moved
        alone = extend(again.fit, again.problem, again.scales, begun=found.begun) if found.begun else None
        late = search(again.problem, again.fit, again.scales, alone=alone)
        one, other = (likelihood(f.chosen, f.problem, late.problem.weight) for f in (found, late))
        return None if one <= other else (late, again)

    def _from_a_zero(self, found: Search, based: Based[FreeDecay]) -> Based[FreeDecay] | None:
        """The base fit from an unknown zero, where nobody said and a push was found: on a spring they are one.

        What is missing may hide from the base fit where the zero is. None where a push is no such thing.
        """
        whole = based.whole
        pushed = any(entry.term.push is not None for entry in found.chosen.model.terms)
        open_to = whole.zero_chosen and not whole.zero_free and whole.restoring is Restoring.SPRING
        if not (pushed and open_to and "x" in whole.channels):
            return None
        with suppress(SimulationError, InputError):
            return self.fit_base(replace(whole, zero_free=True))
        return None

    def tried(self, problem: FreeDecay, models: Sequence[Model], scales: Scales) -> list[Mapping[str, float]]:
        """Released as its own base fit is."""
        own, scales = baseline(problem)
        return [only_started(model, problem, own.model, scales) for model in models]


def _likelier(found: Search, again: Based[FreeDecay]) -> bool:
    """Whether a likely model of a search is likelier than the one it chose once samples count otherwise."""
    problem = again.problem
    least = likelihood(found.chosen, found.problem, problem.weight)
    for one in (found.base, found.chosen, *found.singles[:_LIKELIEST]):
        with suppress(SimulationError):
            now = likelihood(fit(one.model, problem, one.free, again.scales, thorough=False), problem, problem.weight)
            if now < least:
                return True
    return False


def _entered(plain: Based[FreeDecay], problem: FreeDecay) -> Based[FreeDecay]:
    """A base fit with the covariates of a problem beside it; plain : without them."""
    found, scales = enter(plain.fit, replace(plain.problem, acting=problem.acting), plain.scales), plain.scales
    enters = problem.enters or found.said
    short = replace(plain.problem, acting=found.acting, enters=enters)
    short = allowing(replace(short, noise=noise_of(found.fit, short, scales.omega)), found.fit)
    whole = replace(problem, acting=found.acting, enters=enters)
    return Based(whole, short, settle(under(found.fit, short), short, scales), scales)


def _entering_otherwise(found: Search, based: Based[FreeDecay]) -> Based[FreeDecay] | None:
    """The base fit with covariates as they enter beside what was found missing; None where that is as they entered.

    A law that is left out moves what a covariate seems to do.
    """
    open_to = [one for one in based.whole.acting if not one.asked]
    if not open_to or not found.chosen.model.terms:
        return None
    with suppress(SimulationError, InputError):
        problem = replace(based.problem, noise=found.problem.noise)
        rivals = tuple(one if one.asked else replace(one, acts=None) for one in based.whole.acting)
        bare = replace(found.chosen.model, covariates=())
        start = fit(bare, problem, free_of(bare, _alone(based)), based.scales)
        again = enter(start, replace(problem, acting=rivals), based.scales)
        if [one.acts for one in again.acting] == [one.acts for one in based.whole.acting]:
            return None
        bare = replace(based.fit.model, covariates=())
        plain = fit(bare, based.problem, free_of(bare, _alone(based)), based.scales)
        whole = replace(based.whole, acting=again.acting, enters=again.said)
        return _entered(Based(whole, based.problem, plain, based.scales), whole)
    return None


def _alone(based: Based[FreeDecay]) -> tuple[str, ...]:
    """What of a base fit is fitted besides its covariates."""
    given = {name for one in based.fit.model.covariates for name in one.fitted}
    return tuple(name for name in base_of(based.fit.free) if name not in given)


def based(problem: P) -> Based[P]:
    """A free decay, or several, with the base model and the noise that it leaves; in means where very long."""
    short, base, scales = shortened(problem)
    short = replace(short, noise=noise_of(base, short, scales.omega))
    return Based(problem, short, settle(under(base, short), short, scales), scales)


class DecaysTogether(Kind[Together]):
    """See Kind."""

    of = Together

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
        problem = found.problem
        assert isinstance(problem, Together)
        said = sentences(shared)
        found = replace(found, problem=replace(problem, said=said))
        if based.problem.t.size < based.whole.t.size:
            levels = [one.problem.noise for one in shared.compared.alone]
            whole = replace(based.whole.with_own(shared.own).under_levels(levels), said=problem.said)
            return Found(lifted(found, whole, scales), scales, found, pooled=shared)
        return Found(found, scales, found, pooled=shared)
