"""What has no name gets a model: the last step, of a misfit that was graded and of a force that was fitted."""

import math
from contextlib import suppress
from dataclasses import replace

import numpy as np

from harness.core.errors import SimulationError
from harness.core.quantity import Quantity
from harness.diagnosis.explain.mechanism import prediction, remainder, remainder_of_force
from harness.diagnosis.fit.model_fit import Fit, whitened
from harness.diagnosis.fit.standard_errors import base_parameters, unit_of
from harness.diagnosis.grading.grade import Graded
from harness.diagnosis.grading.prediction import Predicted, ratio
from harness.diagnosis.inverse_dynamics.grade import ForceGraded, seen_in
from harness.diagnosis.inverse_dynamics.validate import predicted_windows
from harness.diagnosis.motion import place_of
from harness.diagnosis.outcome import Grade, Holdout, Mechanism, Outcome, Prediction, Remainder, Surface, Table
from harness.diagnosis.parameters import base_of
from harness.diagnosis.problem import Problem
from harness.diagnosis.problems.inverse import InverseDynamics
from harness.diagnosis.problems.simulated import COARSE, observe
from harness.diagnosis.rules import TABLE_BAND, TABLE_BETTER, TABLE_ERRORS, TABLE_OVER_NOISE, TABLE_WORDS
from harness.diagnosis.search.look import evidence
from harness.diagnosis.tables.beside import ForceLeft, MotionLeft, Tabulated, improves
from harness.diagnosis.tables.drawn import Drawn, drawn
from harness.diagnosis.tables.fitted import TableFit
from harness.fit.least_squares import Stop

_RULES = (TABLE_OVER_NOISE, TABLE_BETTER, TABLE_ERRORS, TABLE_WORDS, TABLE_BAND)


def with_tables(outcome: Outcome, graded: Graded) -> Outcome:
    """The outcome with tables of what no name says, where they predict; as it is where none does."""
    before, misfit, problem = outcome.remainder, graded.misfit, outcome.problem
    if before is None or before.over_noise <= TABLE_OVER_NOISE.value:
        return outcome
    named = graded.named[0] if graded.named else None
    main = named if outcome.verdict == "main_effect" else None
    start, held = (misfit.base, graded.base_held) if main is None else (main.fit, main.held)
    if held is None:
        return outcome
    left = MotionLeft(misfit, start.model, base_of(start.free))
    kept = left.tabulated(held)
    # a name that was listed, or is a small part, is a model too
    rival = None if named is None or named is main else named.held
    if not kept or not (rival is None or improves(kept[0].held, rival)):
        return replace(outcome, rules=(*outcome.rules, *_RULES))
    kept = (left.finished(kept[0]), *kept[1:])
    first, seen = kept[0], evidence(misfit.base, problem, outcome.scales)
    refined = _as_fit(first.fit, problem)
    known = outcome.refined if start.model.terms else outcome.base
    predicted = prediction(graded.base_held, first.held)
    holdout = outcome.holdout
    if predicted is not None:
        holdout = Holdout(predicted.spans, predicted.baseline_rmse, predicted.refined_rmse)
    decay = problem.drive is None and not problem.parts_amplitude_from_time
    return _told(
        outcome,
        kept,
        drawn(first, start.model, problem, misfit.strokes, misfit.scales, ratio(first.held, held), seen),
        refined,
        share=(known.chi2 - refined.chi2) / max(outcome.base.chi2 - float(outcome.base.points), 1e-300),
        gained=float(known.bic - refined.bic - first.fit.effective * np.log(max(refined.points, 2))),
        doubt="or it is something that changes with time: one decay cannot tell" if decay else "",
        predicted=predicted,
        holdout=holdout,
        remainder=remainder(outcome.base, refined, problem),
    )


def _as_fit(found: TableFit, problem: Problem) -> Fit:
    """The fit under the problem's noise, by the base parameters, whose partials are what the tables cannot take over.

    So their standard errors count that the tables were fitted too.
    """
    shown, b = found.look.shown, len(found.free)
    assert shown is not None
    residual = whitened(problem, {c: y - shown.y[c] for c, y in problem.channels.items()})
    by = whitened(problem, shown.dy)
    beside = found.beside(by[:, :b], by[:, b:] @ found.basis.free)
    chi2 = float(residual @ residual)
    return Fit(found.model, found.free, chi2, problem.points, residual, beside, shown, Stop.CONVERGED)


def with_force_tables(outcome: Outcome, graded: ForceGraded) -> Outcome:
    """The outcome with tables of the force that no name says, where they predict; as it is where none does."""
    left, problem = outcome.remainder, outcome.problem
    if left is None or left.over_noise <= TABLE_OVER_NOISE.value or not isinstance(problem, InverseDynamics):
        return outcome
    main = outcome.verdict == "main_effect"
    # in the place of what was kept without a headline, or on top of it
    starts = [graded.best] if main or graded.best is graded.base else [graded.base, graded.best]
    for start in starts:
        beside = ForceLeft(start, graded.problem, graded.counted, outcome.scales)
        before = beside.predicted()
        kept = () if before is None else beside.tabulated(before)
        # what was listed, or is a small part, is a model too
        rival = None if graded.best is start else beside.predicted(graded.best)
        if before is not None and kept and (rival is None or improves(kept[0].held, rival)):
            with suppress(SimulationError):
                found = _of_force(outcome, graded, beside, before, kept, problem)
                if found is not None:
                    return found
    return replace(outcome, rules=(*outcome.rules, *_RULES))


def _of_force(
    outcome: Outcome,
    graded: ForceGraded,
    beside: ForceLeft,
    before: Predicted,
    kept: tuple[Tabulated, ...],
    problem: InverseDynamics,
) -> Outcome | None:
    """With the best of the tables that stay; None where it cannot follow the motion as the base model does.

    before : what is missed without one. Raises SimulationError.
    """
    found, start, scales = kept[0].fit, beside.start, outcome.scales
    # windows that tables took no part in; what misses more of a channel than the base model does is no model of it
    windows = predicted_windows(problem, lambda part: beside.over(found, part), scales)
    most = outcome.holdout.baseline_rmse
    if windows is not None and any(size > most.get(channel, math.inf) for channel, size in windows.items()):
        return None
    # by its base parameters; its partials are what the tables cannot take over
    b, weight = len(found.free), beside.weight
    by = found.beside(found.jacobian[:, :b], found.jacobian[:, b:]) / weight
    motion, residual = observe(found.model, problem, (), scales, COARSE), found.residual / weight
    after = Fit(
        found.model, found.free, float(residual @ residual), problem.points, residual, by, motion, Stop.CONVERGED,
        problem.seams,
    )  # fmt: skip
    seen, independent = seen_in(start, problem, scales), float(problem.points)
    holdout = outcome.holdout
    if windows is None:
        holdout = Holdout.none("refined")
    elif holdout.spans:
        holdout = replace(holdout, refined_rmse=windows)
    # a path that repeats itself shows a place at one phase of the drive alone
    period = beside.words.period
    doubt = f"or it keeps time with the drive, which repeats itself every {period or 0.0:.3g} s"
    return _told(
        outcome,
        kept,
        drawn(kept[0], start.model, problem, beside.words.pieces, scales, ratio(kept[0].held, before), seen),
        after,
        share=(start.chi2 - after.chi2) / graded.excess,
        gained=start.bic_of(independent) - after.bic_of(independent) - found.effective * math.log(independent),
        doubt="" if period is None else doubt,
        predicted=prediction(before if start is graded.base else beside.predicted(graded.base), kept[0].held),
        holdout=holdout,
        remainder=remainder_of_force(replace(graded, best=after)),
    )


def _told(
    outcome: Outcome,
    kept: tuple[Tabulated, ...],
    looks: list[Drawn],
    refined: Fit,
    *,
    share: float,
    gained: float,
    doubt: str,
    predicted: Prediction | None,
    holdout: Holdout,
    remainder: Remainder,
) -> Outcome:
    """The outcome with the best of the tables that stay. The verdict stays: a table explains nothing.

    share : of the misfit beyond noise. gained : BIC. doubt : what else it may be, "" for nothing. predicted, holdout :
    what was held out, and by channel.
    """
    first, problem, omega = kept[0].rung, outcome.problem, outcome.scales.omega
    others = [one.rung.said for one in kept[1:] if one.rung.said not in first.on]
    doubts = [f"as {', '.join(others)} it predicts too" if others else "", doubt]
    mechanisms = []
    for numbers, one in looks:
        nearest = one.nearest[:1] if isinstance(one, Table) else ()
        near = [f"{name} comes nearest ({100.0 * of_it:.0f} % of it)" for name, of_it in nearest]
        words = "; ".join(w for w in ("; ".join((one.described, *near)), *doubts) if w)
        for entry in (refined.model.terms[i] for i in numbers):
            known, units = entry.term.known, [unit_of(p.unit, problem) for p in entry.term.parameters]
            assert known is not None
            ends = {
                entry.term.names[j]: Quantity(entry.values[j], None, units[j], "the range that was swept")
                for j in known.places
            }
            said = entry.term.say({name: f"{q.value:.3g} {q.unit}" for name, q in ends.items()})
            mechanisms.append(
                Mechanism(
                    entry=entry,
                    statement=f"{said.rstrip('.')}: {words}.",
                    parameters=ends,
                    delta_bic=gained,
                    place=place_of(entry, refined, problem, omega),
                    grade=Grade.TABULATED,
                    share=min(max(share, 0.0), 1.0),
                    held_out=predicted,
                )
            )
    return replace(
        outcome,
        refined=refined,
        mechanisms=(*outcome.mechanisms, *mechanisms),
        holdout=holdout,
        refined_parameters=base_parameters(refined, problem, omega, explained=False),
        remainder=remainder,
        rules=(*outcome.rules, *_RULES),
        tables=tuple(one for _, one in looks if isinstance(one, Table)),
        surface=next((one for _, one in looks if isinstance(one, Surface)), None),
    )
