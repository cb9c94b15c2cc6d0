"""What is said of tables that stay: mechanisms, the refined model, prediction, what is left."""

from collections.abc import Mapping
from dataclasses import dataclass, replace

from harness.core.quantity import Quantity
from harness.diagnosis.fit.model_fit import Fit
from harness.diagnosis.fit.place import place_of
from harness.diagnosis.fit.standard_errors import base_parameters, unit_of
from harness.diagnosis.outcome import Grade, Holdout, Mechanism, Outcome, Prediction, Remainder, Surface, Table
from harness.diagnosis.problem import Problem
from harness.diagnosis.rules import TABLE_BETTER, TABLE_ERRORS, TABLE_OVER_NOISE, TABLE_WORDS
from harness.diagnosis.tables.selection import Tabulated
from harness.model.term import Slot, Term

RULES = (TABLE_OVER_NOISE, TABLE_BETTER, TABLE_ERRORS, TABLE_WORDS)
_NOT_FITTED = "the range that was swept"


@dataclass(frozen=True, slots=True)
class Modelled:
    """What a fit with tables comes to.

    kept : the rungs that stay, best first. refined : the fit. tables : curves of the best, with their places among the
    model's terms; surface : the same of what hangs on both. share : of the misfit beyond noise. gained : BIC. doubt :
    what else it may be, "" for nothing. predicted : what was held out; holdout : by channel.
    """

    kept: tuple[Tabulated, ...]
    refined: Fit
    tables: tuple[tuple[tuple[int, ...], Table], ...]
    surface: tuple[int, Surface] | None
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
    said = [(i, "; ".join((table.described, *_near(table)))) for numbers, table in found.tables for i in numbers]
    if found.surface is not None:
        said.append((found.surface[0], found.surface[1].described))
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
        tables=tuple(table for _, table in found.tables),
        surface=None if found.surface is None else found.surface[1],
    )


def curves(first: Tabulated, named: int) -> list[tuple[tuple[int, ...], str]]:
    """The tables of a rung that are curves: places among the model's terms, and what each is a function of."""
    found: list[tuple[tuple[int, ...], str]] = []
    for i, term in enumerate(first.rung.terms, start=named):
        assert term.known is not None
        if term.known.of == "-v":
            # the other direction of the one before
            found[-1] = ((*found[-1][0], i), found[-1][1])
        elif term.known.of != "x, v":
            found.append(((i,), _forms(term)))
    return found


def plane(first: Tabulated, named: int) -> int | None:
    """The place among the model's terms of a rung's table over both, None where it has none."""
    kinds = [term.known.of for term in first.rung.terms if term.known is not None]
    return named + kinds.index("x, v") if "x, v" in kinds else None


def _forms(term: Term) -> str:
    assert term.known is not None
    if term.slot is Slot.FRICTION_MODULATION:
        return "g(x) sgn v"
    return {"x": "f(x)", "v": "f(v)", "|v|": "f(|v|) sgn v"}[term.known.of]


def _plain(parameters: Mapping[str, Quantity]) -> dict[str, str]:
    return {name: f"{q.value:.3g} {q.unit}" for name, q in parameters.items()}


def _near(table: Table) -> list[str]:
    return [f"{name} comes nearest ({100.0 * share:.0f} % of it)" for name, share in table.nearest[:1]]


def doubt_of(problem: Problem) -> str:
    """What else than a law of the motion a free decay's table may be."""
    if problem.drive is not None or problem.parts_amplitude_from_time:
        return ""
    return "or it is something that changes with time: one decay cannot tell"
