"""What has no name gets a model: the one step that a graded misfit goes through last."""

from dataclasses import replace

import numpy as np

from harness.diagnosis.explain.graded import prediction
from harness.diagnosis.explain.remainder import remainder
from harness.diagnosis.fit.model_fit import Fit, whitened
from harness.diagnosis.fit.parameters import base_of
from harness.diagnosis.grading.grade import Graded
from harness.diagnosis.grading.prediction import ratio
from harness.diagnosis.outcome import Holdout, Outcome
from harness.diagnosis.problem import Problem
from harness.diagnosis.rules import TABLE_OVER_NOISE
from harness.diagnosis.search.start_evidence import evidence
from harness.diagnosis.tables.drawn import Drawn
from harness.diagnosis.tables.fitted import TableFit
from harness.diagnosis.tables.selection import Tabulated, finished, improves, tabulated
from harness.diagnosis.tables.told import RULES, Modelled, doubt_of, told
from harness.fit.least_squares import Stop


def with_tables(outcome: Outcome, graded: Graded) -> Outcome:
    """The outcome with tables of what no name says, where they predict; as it is where none does."""
    left = outcome.remainder
    if left is None or left.over_noise <= TABLE_OVER_NOISE.value:
        return outcome
    named = graded.named[0] if graded.named else None
    main = named if outcome.verdict == "main_effect" else None
    start, held = (graded.misfit.base, graded.base_held) if main is None else (main.fit, main.held)
    if held is None:
        return outcome
    kept = tabulated(graded.misfit, start.model, base_of(start.free), held)
    # a name that was listed, or is a small part, is a model too
    rival = None if named is None or named is main else named.held
    if not kept or not (rival is None or improves(kept[0].held, rival)):
        return replace(outcome, rules=(*outcome.rules, *RULES))
    best = finished(kept[0], graded.misfit)
    return _told(outcome, graded, start, ratio(best.held, held), (best, *kept[1:]))


def _told(outcome: Outcome, graded: Graded, start: Fit, held: float, kept: tuple[Tabulated, ...]) -> Outcome:
    """The outcome with the best of the tables that stay; held : its held-out error over that of ``start``."""
    first, problem, misfit = kept[0], outcome.problem, graded.misfit
    found = first.fit
    refined = _as_fit(found, problem)
    seen = evidence(misfit.base, problem, outcome.scales)
    excess = max(outcome.base.chi2 - float(outcome.base.points), 1e-300)
    before = outcome.refined if start.model.terms else outcome.base
    predicted = prediction(graded.base_held, first.held)
    holdout = outcome.holdout
    if predicted is not None:
        holdout = Holdout(predicted.spans, predicted.baseline_rmse, predicted.refined_rmse)
    return told(
        outcome,
        Modelled(
            kept=kept,
            refined=refined,
            drawn=Drawn.of(first, start.model, problem, misfit.strokes, misfit.scales, held, seen),
            share=min(max((before.chi2 - refined.chi2) / excess, 0.0), 1.0),
            gained=float(before.bic - refined.bic - found.effective * np.log(max(refined.points, 2))),
            doubt=doubt_of(problem),
            predicted=predicted,
            holdout=holdout,
            remainder=remainder(outcome.base, refined, problem, float(outcome.base.points)),
        ),
    )


def _as_fit(found: TableFit, problem: Problem) -> Fit:
    """The fit under the problem's noise, by the base parameters, whose partials are what the tables cannot take over.

    So their standard errors count that the tables were fitted too.
    """
    shown, b = found.look.shown, len(found.free)
    assert shown is not None
    residual = whitened(problem, {c: y - shown.y[c] for c, y in problem.channels.items()})
    by = whitened(problem, shown.dy)
    return Fit(
        found.model,
        found.free,
        float(residual @ residual),
        problem.points,
        residual,
        found.beside(by[:, :b], by[:, b:] @ found.basis.free),
        shown,
        Stop.CONVERGED,
    )
