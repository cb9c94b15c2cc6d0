"""What has no name gets a model: the one step that a graded misfit goes through last."""

from dataclasses import replace

import numpy as np

from harness.core.quantity import Quantity
from harness.diagnosis.explain.graded import prediction
from harness.diagnosis.explain.place import place_of
from harness.diagnosis.explain.remainder import remainder
from harness.diagnosis.fit.model_fit import Fit, whitened
from harness.diagnosis.fit.parameters import base_of
from harness.diagnosis.fit.standard_errors import base_parameters, unit_of
from harness.diagnosis.grading.grade import Graded
from harness.diagnosis.grading.prediction import ratio
from harness.diagnosis.outcome import Grade, Holdout, Mechanism, Outcome, Table
from harness.diagnosis.problem import Problem
from harness.diagnosis.rules import TABLE_BETTER, TABLE_ERRORS, TABLE_OVER_NOISE, TABLE_WORDS
from harness.diagnosis.search.start_evidence import evidence
from harness.diagnosis.tables.curve import table_of
from harness.diagnosis.tables.describe import described
from harness.diagnosis.tables.nearest import nearest
from harness.diagnosis.tables.penalised import TableFit
from harness.diagnosis.tables.selection import Tabulated, finished, improves, tabulated
from harness.fit.covariance import inverse_of
from harness.fit.least_squares import Stop

_RULES = (TABLE_OVER_NOISE, TABLE_BETTER, TABLE_ERRORS, TABLE_WORDS)
_NOT_FITTED = "the range that was swept"


def with_tables(outcome: Outcome, graded: Graded) -> Outcome:
    """The outcome with tables of what no name says, where they predict; as it is where none does.

    The verdict stays: a table explains nothing.
    """
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
        return replace(outcome, rules=(*outcome.rules, *_RULES))
    best = finished(kept[0], graded.misfit)
    return _told(outcome, graded, start, ratio(best.held, held), (best, *kept[1:]))


def _told(outcome: Outcome, graded: Graded, start: Fit, held: float, kept: tuple[Tabulated, ...]) -> Outcome:
    """The outcome with the best of the tables that stay; held : its held-out error over that of ``start``."""
    first, problem, omega = kept[0], outcome.problem, graded.misfit.scales.omega
    found = first.fit
    refined = _as_fit(found, problem)
    named = len(start.model.terms)
    groups = _curves(first, named)
    seen = evidence(graded.misfit.base, problem, outcome.scales)
    tables = []
    for numbers, form in groups:
        table = table_of(found, graded.misfit, numbers, form, held)
        near = nearest(table, start.model, problem, outcome.scales, seen)
        tables.append(replace(table, described=described(table, found.model, problem.angular), nearest=near))
    excess = max(outcome.base.chi2 - float(outcome.base.points), 1e-300)
    before = outcome.base if not named else outcome.refined
    share = min(max((before.chi2 - refined.chi2) / excess, 0.0), 1.0)
    gained = before.bic - refined.bic - found.effective * np.log(max(refined.points, 2))
    predicted = prediction(graded.base_held, first.held)
    others = [one.rung.said for one in kept[1:] if one.rung.said not in first.rung.on]
    mechanisms = []
    for (numbers, _), table in zip(groups, tables, strict=True):
        for i in numbers:
            entry = found.model.terms[i]
            known = entry.term.known
            assert known is not None
            ends = [j for j in (known.low, known.high) if j is not None]
            parameters = {
                entry.term.names[j]: Quantity(
                    entry.values[j], None, unit_of(entry.term.parameters[j].unit, problem), _NOT_FITTED
                )
                for j in ends
            }
            mechanisms.append(
                Mechanism(
                    entry=entry,
                    statement=_statement(entry.term.say(_plain(parameters)), table, problem, others),
                    parameters=parameters,
                    delta_bic=float(gained),
                    place=place_of(entry, refined, problem, omega),
                    grade=Grade.TABULATED,
                    share=share,
                    held_out=predicted,
                )
            )
    holdout = outcome.holdout
    if predicted is not None:
        holdout = Holdout(predicted.spans, predicted.baseline_rmse, predicted.refined_rmse)
    return replace(
        outcome,
        refined=refined,
        mechanisms=(*outcome.mechanisms, *mechanisms),
        holdout=holdout,
        refined_parameters=base_parameters(refined, problem, omega, explained=False),
        remainder=remainder(outcome.base, refined, problem, float(outcome.base.points)),
        rules=(*outcome.rules, *_RULES),
        tables=tuple(tables),
    )


def _curves(first: Tabulated, named: int) -> list[tuple[tuple[int, ...], str]]:
    """The tables of a rung as curves: places among the model's terms, and what each is a function of."""
    terms = first.rung.terms
    numbers = tuple(range(named, named + len(terms)))
    kinds = [t.known.of for t in terms if t.known is not None]
    if set(kinds) == {"v", "-v"}:
        return [(numbers, first.rung.said)]
    if len(numbers) == 1:
        return [(numbers, first.rung.said)]
    return [((i,), "f(x)" if of == "x" else "f(|v|) sgn v") for i, of in zip(numbers, kinds, strict=True)]


def _plain(parameters: dict[str, Quantity]) -> dict[str, str]:
    return {name: f"{q.value:.3g} {q.unit}" for name, q in parameters.items()}


def _statement(sentence: str, table: Table, problem: Problem, others: list[str]) -> str:
    """What a table is, in a sentence or two."""
    doubt = [f"as {', '.join(others)} it predicts too" if others else ""]
    if problem.drive is None:
        doubt.append("or it is something that changes with time: one decay cannot tell")
    near = [f"{name} comes nearest ({100.0 * share:.0f} % of it)" for name, share in table.nearest[:1]]
    said = "; ".join(w for w in (table.described, *near, *doubt) if w)
    return f"{sentence.rstrip('.')}: {said}."


def _as_fit(found: TableFit, problem: Problem) -> Fit:
    """The fit under the problem's noise, by the base parameters, whose partials are what the tables cannot take over.

    So their standard errors count that the tables were fitted too.
    """
    shown, b = found.shown, len(found.free)
    residual = whitened(problem, {c: y - shown.y[c] for c, y in problem.channels.items()})
    by = whitened(problem, shown.dy)
    base, tables = by[:, :b], by[:, b:] @ found.basis.free
    scale = float(np.sum(tables**2)) / max(float(np.sum(found.jacobian[:, b:] ** 2)), 1e-300)
    rough = found.strength * scale * (found.penalty.T @ found.penalty)
    along = tables @ (inverse_of(tables.T @ tables + rough) @ (tables.T @ base))
    return Fit(
        found.model,
        found.free,
        float(residual @ residual),
        problem.points,
        residual,
        base - along,
        shown,
        Stop.CONVERGED,
    )
