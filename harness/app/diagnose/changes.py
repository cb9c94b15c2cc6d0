"""What to change in the user's simulation: parameters, terms, settings; and which parameter hides a missing term."""

import math

from harness.core.quantity import Quantity
from harness.diagnosis.attribution.attribute import Attribution
from harness.diagnosis.attribution.reading import BASE
from harness.diagnosis.fit.model_fit import Fit
from harness.diagnosis.fit.standard_errors import inflation, unit_of
from harness.diagnosis.outcome import Outcome
from harness.diagnosis.problem import Problem
from harness.diagnosis.rules import CHANGED, CHANGED_BY
from harness.model.model import Model, ModelTerm
from harness.results.diagnosis import ChangeResult

_UNITS = {"m": "kg", "c": "N s/m", "k": "N/m", "f_k": "N"}


def unit(name: str, problem: Problem) -> str:
    """Of a base parameter in this recording; per kg (kg m^2 of an angle) where no mass is known."""
    return unit_of(_UNITS[name], problem)


def parameters_of(found: Fit, problem: Problem) -> dict[str, Quantity]:
    """Base parameters of a fit with standard errors from its curvature, allowing for what it leaves."""
    at = {f.name: i for i, f in enumerate(found.free) if isinstance(f.by, str)}
    covariance, factor = found.covariance(), inflation(found)
    quantities = {}
    for name in BASE:
        value = float(getattr(found.model, name))
        if name == "m" and not problem.in_newtons:
            continue
        if name == "k" and value == 0.0:
            continue
        if name not in at:
            quantities[name] = Quantity(value, None, unit(name, problem), "given, not fitted")
            continue
        variance = float(covariance[at[name], at[name]])
        if value <= 0.0 or not math.isfinite(variance) or variance <= 0.0:
            quantities[name] = Quantity(value, None, unit(name, problem), "on a bound, or not determined")
            continue
        quantities[name] = Quantity(value, factor * math.sqrt(variance), unit(name, problem))
    return quantities


def changes_of(found: Attribution, outcome: Outcome, settings: list[tuple[str, str, str]]) -> list[ChangeResult]:
    """What to change, what moves most first: parameters, then terms to add or to take out, then settings."""
    refined, problem, user = outcome.refined.model, outcome.problem, found.configured
    right = parameters_of(outcome.refined, problem)
    changes = []
    for name in sorted(right, key=lambda one: -found.by_parameter.get(one, 0.0)):
        own, to = float(getattr(user, name)), right[name].value
        error = right[name].stderr or 0.0
        if to is None or abs(own - to) <= max(CHANGED.value * error, CHANGED_BY.value * abs(to)):
            continue
        changes.append(_parameter(name, own, to, right[name].unit))
    changes += _terms(user, refined, outcome)
    changes += [
        ChangeResult(kind="setting", name=name, before=before, after=after, said=f"set {name} to {after} (is {before})")
        for name, before, after in settings
    ]
    return changes


def _parameter(name: str, before: float, after: float, unit: str) -> ChangeResult:
    return ChangeResult(
        kind="parameter", name=name, before=before, after=after, unit=unit,
        said=f"{name}: {before:.4g} to {after:.4g} {unit}",
    )  # fmt: skip


def _terms(user: Model, refined: Model, outcome: Outcome) -> list[ChangeResult]:
    have, want = {e.term.key: e for e in user.terms}, {e.term.key: e for e in refined.terms}
    found = []
    for key, entry in want.items():
        if key not in have:
            found.append(
                ChangeResult(kind="term", name=key, before=None, after="present", said=f"add {_shown(entry, outcome)}")
            )
            continue
        for parameter, own, to in zip(entry.term.parameters, have[key].values, entry.values, strict=True):
            if abs(own - to) > 0.01 * abs(to):
                found.append(_parameter(f"{key}.{parameter.name}", own, to, unit_of(parameter.unit, outcome.problem)))
    found += [
        ChangeResult(kind="term", name=key, before="present", after=None, said=f"take {key} out")
        for key in have
        if key not in want
    ]
    return found


def _shown(entry: ModelTerm, outcome: Outcome) -> str:
    values = ", ".join(
        f"{p.name} = {v:.4g} {unit_of(p.unit, outcome.problem)}"
        for p, v in zip(entry.term.parameters, entry.values, strict=True)
    )
    return f"{entry.term.name}: {values}" if values else entry.term.name


def hidden(found: Attribution, outcome: Outcome) -> str | None:
    """That the parameters hide a missing term, with numbers; None where they do not."""
    if not found.hides or not found.by_parameter:
        return None
    name = max(found.by_parameter, key=lambda one: found.by_parameter[one])
    missing = [e.term.name for e in outcome.refined.model.terms if found.configured.find(e.term.key) is None]
    if not missing:
        return None
    own, right = (float(getattr(model, name)) for model in (found.configured, outcome.refined.model))
    return (
        f"Your {name} = {own:.3g} compensates for the missing {' and '.join(missing)}. Set {name} = {right:.3g} and add"
        f" {'it' if len(missing) == 1 else 'them'} together."
    )
