"""Grades of a fitted force: which law is the main part of what the base model leaves of it."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from harness.core.arrays import BoolArray, FloatArray
from harness.diagnosis.baseline.base_fit import dominant_frequency
from harness.diagnosis.baseline.words import evidence
from harness.diagnosis.fit.model_fit import Fit
from harness.diagnosis.fit.standard_errors import leading, loosest
from harness.diagnosis.grading.clocks import in_step, on_the_swing
from harness.diagnosis.grading.contest import Contest, Finalist, decided
from harness.diagnosis.grading.grade import cells_of
from harness.diagnosis.grading.prediction import Predicted, blocks_of
from harness.diagnosis.inverse_dynamics.force_fit import ForceFit, as_fit, fit_force, simulated
from harness.diagnosis.inverse_dynamics.force_screen import seen_in
from harness.diagnosis.inverse_dynamics.holdout import left_out
from harness.diagnosis.inverse_dynamics.left_over import LeftOver
from harness.diagnosis.inverse_dynamics.strokes import ForceWords, force_words
from harness.diagnosis.outcome import Grade
from harness.diagnosis.problems.driven import InverseDynamics
from harness.diagnosis.problems.measured import Measured
from harness.diagnosis.problems.simulated import Observation
from harness.diagnosis.rules import CONFIRMED, FORCE_POSTERIOR, GAIN, SHARE_OF_EXCESS, Weights
from harness.diagnosis.search.against import in_company
from harness.kernels.solve import Scales
from harness.model.model import Model

_PREDICTED = 8
"""Names whose predictions are computed."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ForceGraded(Contest):
    """What a fitted force comes to where more than noise is left.

    measured : motion and force. base, best : the base model, with a constant force where that is not what is missing,
    and the best one found; ground, refined : both as fits.
    kept : whether that is what the search kept, and not a finalist. over : what it leaves beside noise. reference :
    whose level counts as noise.
    """

    measured: Measured
    base: ForceFit
    best: ForceFit
    reference: ForceFit
    ground: Fit
    fit: Fit
    kept: bool
    over: LeftOver
    counted: ForceWords

    @property
    def noise(self) -> float:
        """What of the squares of the force is noise."""
        return (self.over.noise or 0.0) * self.base.residual.size

    @property
    def excess(self) -> float:
        """What the base model leaves beyond it."""
        return max(self.base.squares - self.noise, 1e-300)

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
        return self.fit

    @property
    def weights(self) -> Weights:
        """Of a force."""
        return FORCE_POSTERIOR


@dataclass(frozen=True, slots=True)
class Fitted:
    """A recording with its force fitted. reference : whose level counts as noise; shown : the base's motion."""

    problem: InverseDynamics
    measured: Measured
    scales: Scales
    base: ForceFit
    reference: ForceFit
    shown: Observation

    def counted(self, one: ForceFit) -> Fit:
        """A force fit as a fit whose evidence counts alone: what it shows is the base's."""
        return as_fit(one, self.problem, self.measured, self.reference, self.shown)

    def seen(self, one: ForceFit) -> Fit:
        """A force fit as a fit with its own motion. Raises SimulationError."""
        shown = simulated(one, self.problem, self.scales)
        return as_fit(one, self.problem, self.measured, self.reference, shown)


def graded(fitted: Fitted, last: Fit, singles: Sequence[ForceFit], over: LeftOver, judged: bool) -> ForceGraded:
    """Grade what a base model leaves of a force.

    last : what the search came to, over : what that leaves. singles : one law more than the base each. judged : whether
    another recording decided what was kept. Raises SimulationError.
    """
    base, chosen, measured = fitted.base, fitted.reference, fitted.measured
    words = force_words(base, measured)
    block = blocks_of(words.pieces)
    ranked = _ranked(fitted, singles, over, words)
    first = [replace(f, held=held_out(one, measured, block)) for f, one in ranked[:_PREDICTED]]
    found = decided(
        ForceGraded(
            measured=measured, base=base, best=chosen, reference=chosen,
            ground=fitted.counted(base), fit=last, kept=True, over=over, counted=words,
            finalists=(*first, *(f for f, _ in ranked[_PREDICTED:])), base_held=held_out(base, measured, block),
        )
    )  # fmt: skip
    names = [entry.term.name for entry in chosen.model.terms[len(base.model.terms) :]]
    if judged:
        found = _by_judge(found, names)
    # what follows any other law by its clock is no better model than the largest part that has a name
    followed = {f.name for f in found.finalists if f.clock}.issuperset(names)
    if not found.named or found.named[0].name in names or (found.grade is Grade.MINOR and not followed):
        return found
    laws = {f.name: one for f, one in ranked}
    named = tuple(replace(f, fit=fitted.seen(laws[f.name])) for f in found.named)
    return replace(found, named=named, best=laws[named[0].name], fit=named[0].fit, kept=False)


def _by_judge(found: ForceGraded, names: Sequence[str]) -> ForceGraded:
    """What another recording confirms is named, whatever its share here; what it does not is no main effect."""
    named = tuple(f for f in found.finalists if f.name in names[:1])
    if named:
        return replace(found, grade=Grade.MAIN, named=named, rules=(CONFIRMED,))
    if found.grade in (Grade.MAIN, Grade.ONE_OF):
        return replace(found, grade=Grade.MINOR, named=found.named[:1], rules=(CONFIRMED, GAIN, SHARE_OF_EXCESS))
    return found


def _ranked(
    fitted: Fitted, singles: Sequence[ForceFit], over: LeftOver, words: ForceWords
) -> list[tuple[Finalist, ForceFit]]:
    """Every catalogue name alone, the best law of each, most evidence first."""
    problem, measured, scales, base = fitted.problem, fitted.measured, fitted.scales, fitted.base
    noise = 0.0 if over.noise is None else over.noise * base.residual.size
    excess, span = base.squares - noise, float(measured.t[-1] - measured.t[0])
    cells = cells_of(seen_in(base, measured, problem, scales))
    clocks = [scales.omega, *(dominant_frequency(m.t, m.x) for m in measured.each)]
    reach = float(np.max(np.abs(measured.x - base.model.offset)))
    speed = float(np.max(np.abs(measured.v)))
    best: dict[str, tuple[Finalist, ForceFit]] = {}
    for one in singles:
        entry, taken = one.model.terms[-1], base.squares - one.squares
        more, name = len(one.free) - len(base.free), one.model.terms[-1].term.name
        gain = evidence(base.squares, one.squares, words.words, more, cells[name])
        if not one.model.as_named(reach, speed) or (name in best and gain <= best[name][0].gain):
            continue
        clock = any(on_the_swing(entry, omega, span) for omega in clocks)
        clock |= words.period is not None and in_step(entry, words.period, span)
        share = min(taken / excess, 1.0) if excess > 0.0 else 0.0
        best[name] = Finalist(fitted.counted(one), gain, share, clock), one
    alone = sorted(best.values(), key=lambda found: -found[0].gain)
    if excess <= 0.0:
        return alone
    return [
        (
            replace(
                f, loosest=_loosest(f, fitted), leading=_leading(f, fitted), company=_company(one, alone, base) / excess
            ),
            one,
        )
        for f, one in alone
    ]


def _loosest(one: Finalist, fitted: Fitted) -> float:
    """Under what the force leaves over."""
    return loosest(one.fit, fitted.problem, len(one.fit.model.terms) - 1, fitted.scales.omega)


def _leading(one: Finalist, fitted: Fitted) -> float:
    """Of the number that says how much of a law there is."""
    return leading(one.fit, fitted.problem, len(one.fit.model.terms) - 1, fitted.scales.omega)


def _company(one: ForceFit, alone: Sequence[tuple[Finalist, ForceFit]], base: ForceFit) -> float:
    """Beside whichever other, by their force; a law with a clock on the drive follows any."""
    return in_company(one, [other for f, other in alone if other is not one and not f.clock], base)


def held_out(found: ForceFit, measured: Measured, block: FloatArray) -> Predicted | None:
    """The force error over blocks of strokes left out of the fit; None where the others cannot be fitted."""

    def refitted(keep: BoolArray) -> Model:
        train = measured.moving.copy()
        train[train] = keep
        return fit_force(found.model, measured.part(train), found.free).model

    return left_out(measured, block, refitted)
