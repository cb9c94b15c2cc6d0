"""What is said of tables that stay: mechanisms, the refined model, prediction, what is left."""

from collections.abc import Mapping
from dataclasses import dataclass, replace

from harness.core.quantity import Quantity
from harness.diagnosis.fit.model_fit import Fit
from harness.diagnosis.fit.place import place_of
from harness.diagnosis.fit.standard_errors import base_parameters, unit_of
from harness.diagnosis.outcome import Grade, Holdout, Mechanism, Outcome, Prediction, Remainder, Table
from harness.diagnosis.problem import Problem
from harness.diagnosis.rules import TABLE_BAND, TABLE_BETTER, TABLE_ERRORS, TABLE_OVER_NOISE, TABLE_WORDS
from harness.diagnosis.tables.drawn import Drawn
from harness.diagnosis.tables.selection import Tabulated

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
