"""What is said of a term that is named: its sentence, parameters, evidence, and what could stand in its place."""

from harness.core.quantity import Quantity
from harness.diagnosis.fit import Fit
from harness.diagnosis.numbers import AT_LEAST, term_parameters
from harness.diagnosis.outcome import Alternative, Mechanism
from harness.diagnosis.problem import Problem
from harness.diagnosis.search import Search
from harness.diagnosis.select import DECISIVE, key_of
from harness.model.model import ModelTerm

_MOST_ALTERNATIVES = 3


def mechanism(
    found: Search, index: int, entry: ModelTerm, problem: Problem, spans: tuple[tuple[float, float], ...]
) -> Mechanism:
    """All of a named term, the chosen model's number ``index``; spans : where it acts, s."""
    parameters = term_parameters(found.chosen, problem, index)
    return Mechanism(
        entry=entry,
        statement=_statement(entry, parameters, found.chosen),
        parameters=parameters,
        delta_bic=_lost_without(found, entry),
        spans=spans,
        alternatives=_alternatives(found, entry),
    )


def _lost_without(found: Search, entry: ModelTerm) -> float:
    """What BIC loses without a term: against the best of the models searched that lack its name."""
    lacking = [f.bic for f in (found.base, *found.singles, *found.rivals) if entry.term.name not in key_of(f)]
    others = tuple(sorted(e.term.name for e in found.chosen.model.terms if e is not entry))
    same = [f.bic for f in (found.base, *found.singles, *found.rivals) if key_of(f) == others]
    return min(same or lacking) - found.chosen.bic


def _alternatives(found: Search, entry: ModelTerm) -> tuple[Alternative, ...]:
    """Names that could stand in a term's place, by less than what is decisive."""
    rest = sorted(e.term.name for e in found.chosen.model.terms if e is not entry)
    near = []
    for rival in found.rivals:
        names = list(key_of(rival))
        delta = rival.bic - found.chosen.bic
        if delta >= DECISIVE or len(names) != len(rest) + 1:
            continue
        for name in rest:
            if name in names:
                names.remove(name)
        if len(names) == 1 and names[0] != entry.term.name:
            near.append(Alternative(names[0], delta))
    return tuple(sorted(near, key=lambda a: a.delta_bic)[:_MOST_ALTERNATIVES])


def _said(quantity: Quantity) -> str:
    """A number as a sentence shows it."""
    return f"at least {quantity}" if quantity.why == AT_LEAST else str(quantity)


def _statement(entry: ModelTerm, parameters: dict[str, Quantity], found: Fit) -> str:
    values = {name: _said(q) for name, q in parameters.items()}
    if entry.term.name == "constant-force" and found.model.k > 0.0:
        values["offset"] = f"{entry.value('force') / found.model.k:.4g}"
    elif entry.term.name == "constant-force":
        values["offset"] = "nothing, without a spring"
    return entry.term.say(values)
