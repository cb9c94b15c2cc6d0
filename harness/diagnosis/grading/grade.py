"""A motion's misfit graded: every catalogue name alone on the base, and which is the main part of what that leaves.

Fits begin from other shares of dry and viscous friction, too: a law of damping may stand for either of them. How often
the slider turns before it sticks jumps with f_k, so that a descent that begins with the base model's friction ends
where that friction is, though the law that was added would do without it.
"""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

from scipy import special

from harness.core.cores import each
from harness.core.errors import SimulationError
from harness.diagnosis.fit.model_fit import Fit, fit
from harness.diagnosis.fit.standard_errors import loosest
from harness.diagnosis.grading.clocks import beat, on_the_swing
from harness.diagnosis.grading.contest import Contest, Finalist, decided, shown_as_part
from harness.diagnosis.grading.misfit import Misfit
from harness.diagnosis.grading.prediction import Predicted, free_run, held_out
from harness.diagnosis.outcome import Grade
from harness.diagnosis.parameters import base_of
from harness.diagnosis.problem import Problem
from harness.diagnosis.residual_tests.structure import UNNAMED
from harness.diagnosis.rules import DECISIVE, POSTERIOR, TAKEN, Weights
from harness.diagnosis.search.against import in_company
from harness.diagnosis.search.extend import extend
from harness.diagnosis.search.look import evidence as starting_evidence
from harness.diagnosis.search.search import freed, under
from harness.kernels.solve import Scales
from harness.model.model import Model
from harness.model.registry import USUAL
from harness.model.term import Evidence

_FIRST = 4
"""Names, most evidence first, whose standard errors are looked at."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Graded(Contest):
    """What a misfit comes to; the first name's fit is the best model found.

    ahead : by how much more than a margin the evidence of a smooth curve of no name, of the position, of the speed or a
    sum of both, is above the first name's.
    """

    misfit: Misfit
    ahead: float = -math.inf

    @property
    def posterior(self) -> dict[str, float]:
        """See Contest; a curve of no name has its part of what the names have, as its evidence beside theirs says."""
        likely = super(Graded, self).posterior
        named, share = 1.0 - likely[""], float(special.expit(0.5 * self.ahead))
        if not share:
            return likely
        each = {name: p * (1.0 - share if name else 1.0) for name, p in likely.items()} | {UNNAMED: share * named}
        return dict(sorted(each.items(), key=lambda one: -one[1]))

    @property
    def words(self) -> float:
        """Of the misfit."""
        return self.misfit.words

    @property
    def cycles(self) -> float:
        """Of the motion."""
        return self.misfit.strokes.cycles

    @property
    def refined(self) -> Fit:
        """The first name's."""
        return self.named[0].fit if self.named else self.misfit.base

    @property
    def weights(self) -> Weights:
        """Of a motion."""
        return POSTERIOR


def grade(misfit: Misfit, begun: Sequence[Model] = ()) -> Graded:
    """Grade the catalogue against a misfit; begun : models with one law each, to go on with. Raises SimulationError.

    What is named is held against what it was not fitted to.
    """
    alone = ranked(misfit, begun)
    nearest = min((f.fit for f in alone), key=lambda f: f.chi2, default=misfit.base)
    known = misfit.known(misfit.noise_left(nearest))
    found = _in_its_form(decided(Graded(misfit=misfit, finalists=tuple(alone), known=known)))
    if not found.named:
        return found
    predicted = each(lambda one: _predicted(one, misfit), (misfit.base, *(f.fit for f in found.named)))
    (base_held, base_run), *others = predicted
    named = tuple(replace(f, held=held, run=run) for f, (held, run) in zip(found.named, others, strict=True))
    return shown_as_part(replace(found, named=named, base_held=base_held, base_run=base_run))


def _in_its_form(found: Graded) -> Graded:
    """The first name in the form that says decidedly more than the catalogue's, by which it has its probability.

    What hides has rarely the catalogue's own formula, and beside a formula that is off the other numbers are.
    """
    if found.grade not in (Grade.MAIN, Grade.ONE_OF):
        return found
    misfit, first = found.misfit, found.named[0]
    bent = freed(first.fit, misfit.problem, misfit.scales)
    if bent is None or not bent.as_named:
        return found
    noise = misfit.noise_left(bent)
    usual, free = (misfit.evidence_of(one, noise) for one in (first.fit, bent))
    if free <= usual + DECISIVE.value:
        return found
    share = (misfit.base.chi2 - bent.chi2) / (misfit.base.chi2 - misfit.floor(noise))
    return replace(found, named=(replace(first, fit=bent, share=min(share, 1.0)), *found.named[1:]))


def _predicted(one: Fit, misfit: Misfit) -> tuple[Predicted | None, Predicted | None]:
    """Of blocks that are left out, and of the last part from the first."""
    return (
        held_out(one, misfit.problem, misfit.scales, misfit.strokes),
        free_run(one, misfit.problem, misfit.scales),
    )


def ranked(misfit: Misfit, begun: Sequence[Model] = ()) -> list[Finalist]:
    """Every catalogue name alone, the best law of each that is what the name says, most evidence first.

    What explains everything may bend its law; of the part of a misfit that a law takes, the name is all that is said.
    """
    problem, base, scales = misfit.problem, misfit.base, misfit.scales
    usual = [model for model in begun if model.terms[-1].term in USUAL]
    extended = resplit(extend(base, problem, scales, USUAL, begun=usual).fits, problem, scales)
    fits = [f for f in extended if f.as_named]
    if not fits:
        return []
    noise = misfit.noise_left(min(fits, key=lambda f: f.chi2))
    excess = base.chi2 - misfit.floor(noise)
    cells = cells_of(starting_evidence(base, problem, scales))
    span, rate = problem.duration, beat(base, problem, scales.omega)
    best: dict[str, Finalist] = {}
    for one in fits:
        entry = one.model.terms[-1]
        taken = base.chi2 - one.chi2
        # evidence is twice a logarithm: what takes a misfit by chance so many times more often counts that squared
        easily = max(1.0, entry.term.taken / TAKEN.value) ** 2
        found = Finalist(
            one,
            misfit.evidence_of(one, noise, easily * cells[entry.term.name]),
            min(taken / excess, 1.0) if excess > 0.0 else 0.0,
            on_the_swing(entry, rate, span),
        )
        if entry.term.name not in best or found.gain > best[entry.term.name].gain:
            best[entry.term.name] = found
    alone = sorted(best.values(), key=lambda f: -f.gain)

    def seen(f: Finalist) -> Finalist:
        # beside whichever other: a law with a clock on the swing follows any
        beside = in_company(f.fit, [o.fit for o in alone if o is not f and not o.clock], base)
        return replace(f, company=beside / excess if excess > 0.0 else math.nan)

    def with_errors(f: Finalist) -> Finalist:
        # under the sensors' noise, as a result gives them
        problem = misfit.sensed(misfit.noise_left(f.fit))
        return replace(f, loosest=loosest(under(f.fit, problem), problem, len(f.fit.model.terms) - 1, scales.omega))

    all_seen = [seen(f) for f in alone]
    return [*each(with_errors, all_seen[:_FIRST]), *all_seen[_FIRST:]]


def cells_of(seen: Evidence) -> dict[str, float]:
    """Places that each name's parameters are scanned over: its probes, a cosine and a sine counted as one."""
    cells: dict[str, float] = {}
    for term in USUAL:
        probes = len(term.probes(seen)) / (1.0 if term.phase is None else 2.0)
        cells[term.name] = cells.get(term.name, 0.0) + max(probes, 1.0)
    return cells


_DRY = (0.0, 0.5)
"""Shares of the dry friction that is kept; the rest becomes viscous."""
_GIVEN = 0.5
"""Share of the damping that becomes dry where there is no dry friction."""
_NONE = 0.05
"""Share of the damping below which dry friction is none."""
_NEAR = 0.5
"""Fits that leave more than the first by this share of what it takes off are too far behind to catch up."""
_MOST = 8
_ITERATIONS = 20
_ROUNDS, _WORTH = 4, 0.9
"""Rounds at most, and the share of the squares below which a round has come nearer, so that another may."""
"""Fits that are tried again, and iterations of each: they bound the work."""


def resplit(fits: Sequence[Fit], problem: Problem, scales: Scales) -> list[Fit]:
    """The same laws, each from where its fit leaves least; fits : best first, one a law."""
    if not fits:
        return []
    base = max(f.chi2 for f in fits)
    least = min(f.chi2 for f in fits)
    near = sorted(fits, key=lambda f: f.chi2)[:_MOST]
    reached = [f for f in near if f.chi2 <= least + _NEAR * (base - least)]
    return [_best(f, problem, scales) if any(f is r for r in reached) else f for f in fits]


def _best(found: Fit, problem: Problem, scales: Scales) -> Fit:
    if "f_k" not in base_of(found.free):
        return found
    for _ in range(_ROUNDS):
        before = found.chi2
        found = _nearer(found, problem, scales)
        if found.chi2 > _WORTH * before:
            break
    return found


def _nearer(found: Fit, problem: Problem, scales: Scales) -> Fit:
    best = found
    for model in _others(found.model, scales):
        try:
            again = fit(model, problem, found.free, scales, _ITERATIONS, thorough=False)
        except SimulationError:
            continue
        if again.chi2 < best.chi2:
            best = again
    return best


def _others(model: Model, scales: Scales) -> Iterator[Model]:
    """Models of equal loss over a cycle of half the amplitude: 4 f_k X = pi c omega X^2."""
    dry_as_viscous = 4.0 / (math.pi * scales.omega * 0.5 * scales.x)
    viscous_as_dry = 1.0 / dry_as_viscous
    if model.f_k < _NONE * model.c * viscous_as_dry:
        yield replace(model, c=(1.0 - _GIVEN) * model.c, f_k=_GIVEN * model.c * viscous_as_dry)
        return
    for share in _DRY:
        yield replace(model, c=model.c + (1.0 - share) * model.f_k * dry_as_viscous, f_k=share * model.f_k)
