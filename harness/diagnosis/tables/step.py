"""What has no name gets a model: the one step that a graded misfit goes through last.

What is said of tables that stay: mechanisms, the refined model, prediction, what is left.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from harness.core.quantity import Quantity
from harness.diagnosis.explain.graded import prediction
from harness.diagnosis.explain.mechanism import remainder
from harness.diagnosis.fit.model_fit import Fit, whitened
from harness.diagnosis.fit.parameters import base_of
from harness.diagnosis.fit.place import place_of
from harness.diagnosis.fit.standard_errors import base_parameters, unit_of
from harness.diagnosis.grading.grade import Graded
from harness.diagnosis.grading.prediction import ratio
from harness.diagnosis.outcome import Grade, Holdout, Mechanism, Outcome, Prediction, Remainder, Table
from harness.diagnosis.problem import Problem
from harness.diagnosis.rules import TABLE_BAND, TABLE_BETTER, TABLE_ERRORS, TABLE_OVER_NOISE, TABLE_WORDS
from harness.diagnosis.search.look import evidence
from harness.diagnosis.tables.drawn import Drawn
from harness.diagnosis.tables.fitted import TableFit
from harness.diagnosis.tables.selection import Tabulated, finished, improves, tabulated
from harness.fit.least_squares import Stop

RULES = (TABLE_OVER_NOISE, TABLE_BETTER, TABLE_ERRORS, TABLE_WORDS, TABLE_BAND)
_NOT_FITTED = "the range that was swept"


@dataclass(frozen=True, slots=True)
class Modelled:
    """What a fit with tables comes to.

    kept : the rungs that stay, best first. refined : the fit. drawn : what the best of them looks like. share : of the
    misfit beyond noise. gained : BIC. doubt : what else it may be, "" for nothing. predicted : what was held out;
    holdout : by channel.
    """

    kept: tuple[Tabulated, ...]
    refined: Fit
    drawn: Drawn
    share: float
    gained: float
    doubt: str
    predicted: Prediction | None
    holdout: Holdout
    remainder: Remainder


def told(outcome: Outcome, found: Modelled) -> Outcome:
    """The outcome with the best of the tables that stay. The verdict stays: a table explains nothing."""
    first, problem, refined = found.kept[0].rung, outcome.problem, found.refined
    others = [one.rung.said for one in found.kept[1:] if one.rung.said not in first.on]
    doubt = [f"as {', '.join(others)} it predicts too" if others else "", found.doubt]
    said = [(i, "; ".join((table.described, *_near(table)))) for numbers, table in found.drawn.tables for i in numbers]
    if found.drawn.surface is not None:
        said.append((found.drawn.surface[0], found.drawn.surface[1].described))
    mechanisms = []
    for i, described in said:
        entry = refined.model.terms[i]
        known = entry.term.known
        assert known is not None
        ends = {
            entry.term.names[j]: Quantity(
                entry.values[j], None, unit_of(entry.term.parameters[j].unit, problem), _NOT_FITTED
            )
            for j in known.places
        }
        words = "; ".join(w for w in (described, *doubt) if w)
        mechanisms.append(
            Mechanism(
                entry=entry,
                statement=f"{entry.term.say(_plain(ends)).rstrip('.')}: {words}.",
                parameters=ends,
                delta_bic=found.gained,
                place=place_of(entry, refined, problem, outcome.scales.omega),
                grade=Grade.TABULATED,
                share=found.share,
                held_out=found.predicted,
            )
        )
    return replace(
        outcome,
        refined=refined,
        mechanisms=(*outcome.mechanisms, *mechanisms),
        holdout=found.holdout,
        refined_parameters=base_parameters(refined, problem, outcome.scales.omega, explained=False),
        remainder=found.remainder,
        rules=(*outcome.rules, *RULES),
        tables=tuple(table for _, table in found.drawn.tables),
        surface=None if found.drawn.surface is None else found.drawn.surface[1],
    )


def _plain(parameters: Mapping[str, Quantity]) -> dict[str, str]:
    return {name: f"{q.value:.3g} {q.unit}" for name, q in parameters.items()}


def _near(table: Table) -> list[str]:
    return [f"{name} comes nearest ({100.0 * share:.0f} % of it)" for name, share in table.nearest[:1]]


def doubt_of(problem: Problem) -> str:
    """What else than a law of the motion a free decay's table may be."""
    if problem.drive is not None or problem.parts_amplitude_from_time:
        return ""
    return "or it is something that changes with time: one decay cannot tell"


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
