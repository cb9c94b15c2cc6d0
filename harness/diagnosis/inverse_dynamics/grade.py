"""Grades of a fitted force: which laws of the catalogue would take most off what inverse dynamics leave of it, and
which of them is the main part of what the base model leaves.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from harness.diagnosis.baseline.base_fit import dominant_frequency
from harness.diagnosis.baseline.words import evidence
from harness.diagnosis.fit.model_fit import Fit
from harness.diagnosis.fit.standard_errors import leading, loosest
from harness.diagnosis.grading.clocks import in_step, on_the_swing
from harness.diagnosis.grading.contest import Contest, Finalist, decided, shown_as_part
from harness.diagnosis.grading.grade import cells_of
from harness.diagnosis.grading.prediction import blocks_of
from harness.diagnosis.inverse_dynamics.left_over import LeftOver
from harness.diagnosis.inverse_dynamics.strokes import ForceWords, force_words
from harness.diagnosis.inverse_dynamics.validate import held_out
from harness.diagnosis.inverse_dynamics.waves import along_travel, in_time
from harness.diagnosis.outcome import Grade
from harness.diagnosis.problems.inverse import InverseDynamics
from harness.diagnosis.problems.measured import Measured
from harness.diagnosis.rules import CONFIRMED, FORCE_POSTERIOR, GAIN, SHARE_OF_EXCESS, Weights
from harness.diagnosis.search.against import in_company
from harness.diagnosis.search.look import Recorded, within
from harness.diagnosis.search.screen import direct, screen
from harness.kernels.solve import Scales
from harness.model.model import Model
from harness.model.registry import USUAL
from harness.model.term import Evidence, Slot, Term

_PREDICTED = 8
"""Names whose predictions are computed."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ForceGraded(Contest):
    """What a fitted force comes to where more than noise is left.

    problem : under the level that the search's end leaves. base, best : the base model, with a constant force where
    that is not what is missing, and the best one found. kept : whether that is what the search kept, and not a
    finalist. over : what it leaves beside noise. counted : words of what the base leaves.
    """

    problem: InverseDynamics
    base: Fit
    best: Fit
    kept: bool
    over: LeftOver
    counted: ForceWords

    @property
    def noise(self) -> float:
        """What of chi-square is noise."""
        return (self.over.noise or 0.0) * self.base.residual.size * self.problem.unit**2

    @property
    def excess(self) -> float:
        """What the base model leaves beyond it."""
        return max(self.base.chi2 - self.noise, 1e-300)

    @property
    def words(self) -> float:
        """Pieces of strokes."""
        return self.counted.words

    @property
    def cycles(self) -> float:
        """Two words each."""
        return 0.5 * self.counted.words

    @property
    def refined(self) -> Fit:
        """The best model found."""
        return self.best

    @property
    def weights(self) -> Weights:
        """Of a force."""
        return FORCE_POSTERIOR


def graded_by(
    base: Fit,
    last: Fit,
    singles: Sequence[Fit],
    problem: InverseDynamics,
    scales: Scales,
    over: LeftOver,
    *,
    judged: bool,
) -> ForceGraded:
    """Grade what a base model leaves of a force.

    last : what the search came to, over : what that leaves. singles : one law more than the base each. judged : whether
    another recording decided what was kept.
    """
    words = force_words(base.memory, problem.measured)
    block = blocks_of(words.pieces)
    found = ForceGraded(problem=problem, base=base, best=last, kept=True, over=over, counted=words)
    ranked = _ranked(found, singles, scales)
    first = [replace(f, held=held_out(f.fit, problem, block)) for f in ranked[:_PREDICTED]]
    finalists = (*first, *ranked[_PREDICTED:])
    found = decided(replace(found, finalists=finalists, base_held=held_out(base, problem, block)))
    names = [entry.term.name for entry in last.model.terms[len(base.model.terms) :]]
    if judged:
        found = _by_judge(found, names)
    # what follows any other law by its clock is no better model than the largest part that has a name
    followed = {f.name for f in found.finalists if f.clock}.issuperset(names)
    if found.named and found.named[0].name not in names and (found.grade is not Grade.MINOR or followed):
        found = replace(found, best=found.named[0].fit, kept=False)
    return shown_as_part(found)


def _by_judge(found: ForceGraded, names: Sequence[str]) -> ForceGraded:
    """What another recording confirms is named, whatever its share here; what it does not is no main effect."""
    named = tuple(f for f in found.finalists if f.name in names[:1])
    if named:
        return replace(found, grade=Grade.MAIN, named=named, rules=(CONFIRMED,))
    if found.grade in (Grade.MAIN, Grade.ONE_OF):
        return replace(found, grade=Grade.MINOR, named=found.named[:1], rules=(CONFIRMED, GAIN, SHARE_OF_EXCESS))
    return found


def _ranked(graded: ForceGraded, singles: Sequence[Fit], scales: Scales) -> list[Finalist]:
    """Every catalogue name alone, the best law of each, most evidence first."""
    problem, base, words = graded.problem, graded.base, graded.counted
    measured, excess = problem.measured, base.chi2 - graded.noise
    span = float(measured.t[-1] - measured.t[0])
    cells = cells_of(seen_in(base, problem, scales))
    clocks = [scales.omega, *(dominant_frequency(m.t, m.x) for m in measured.each)]
    reach = float(np.max(np.abs(measured.x - base.model.offset)))
    speed = float(np.max(np.abs(measured.v)))
    best: dict[str, Finalist] = {}
    for one in singles:
        entry, taken = one.model.terms[-1], base.chi2 - one.chi2
        more, name = len(one.free) - len(base.free), one.model.terms[-1].term.name
        gain = evidence(base.chi2, one.chi2, words.words, more, cells[name])
        if not one.model.as_named(reach, speed) or (name in best and gain <= best[name].gain):
            continue
        clock = any(on_the_swing(entry, omega, span) for omega in clocks)
        clock |= words.period is not None and in_step(entry, words.period, span)
        share = min(taken / excess, 1.0) if excess > 0.0 else 0.0
        best[name] = Finalist(one, gain, share, clock)
    alone = sorted(best.values(), key=lambda found: -found.gain)
    return alone if excess <= 0.0 else [_looked_at(f, alone, base, excess, problem, scales) for f in alone]


def _looked_at(
    one: Finalist, alone: Sequence[Finalist], base: Fit, excess: float, problem: InverseDynamics, scales: Scales
) -> Finalist:
    """With its errors under what the force leaves over, and its share beside whichever other.

    A law with a clock on the drive follows any.
    """
    index = len(one.fit.model.terms) - 1
    company = in_company(one.fit, [other.fit for other in alone if other is not one and not other.clock], base)
    return replace(
        one,
        loosest=loosest(one.fit, problem, index, scales.omega),
        leading=leading(one.fit, problem, index, scales.omega),
        company=company / excess,
    )


_SLOTS = frozenset({Slot.SMOOTH, Slot.FRICTION_LAW, Slot.FRICTION_LEVEL, Slot.FRICTION_MODULATION, Slot.INTERNAL})


def sayable(term: Term) -> bool:
    """Whether a law's force follows from the recorded motion: no event, no sensor."""
    return term.slot in _SLOTS


def seen_in(found: Fit, problem: InverseDynamics, scales: Scales) -> Evidence:
    """What the laws choose their starts from: the recorded motion, and frequencies at which the residual stands out."""
    measured = problem.measured
    x, v = measured.x, measured.v
    return Evidence(
        x_scale=float(np.max(np.abs(x))),
        v_scale=float(np.max(np.abs(v))),
        peak_a=float(np.max(np.abs(measured.a))),
        low=float(x.min()),
        high=float(x.max()),
        f_k=found.model.f_k,
        k=found.model.k,
        omega=scales.omega,
        duration=float(measured.t[-1] - measured.t[0]),
        frequencies=in_time(problem, found.residual, of_friction=False),
        of_friction=in_time(problem, found.residual, of_friction=True),
        knock_times=np.empty(0),
        driven=True,
        angular=problem.angular,
        periods=tuple(along_travel(problem, found.residual)),
    )


def whole_in(model: Model, measured: Measured) -> bool:
    """Whether a period, the relaxation, or the bending of a model's last law lies in the recording whole."""
    return within(model.terms[-1], model.f_k, Recorded.of(measured.t, measured.x, driven=True))


def starts(found: Fit, problem: InverseDynamics, scales: Scales) -> list[Model]:
    """The model with one more law each, at its best probes; first those of which no look can tell."""
    evidence = seen_in(found, problem, scales)
    terms = [term for term in USUAL if sayable(term)]
    looked = (*direct(found, problem, evidence, terms), *screen(found, problem, evidence, scales, terms))
    return [candidate.model for candidate in looked]
