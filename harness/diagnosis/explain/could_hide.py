"""What a recording that the base model explains could hide: how large each law could be, and what that would shift.

A law that was tried and not kept is not absent: it is no larger than what it was fitted at and two standard errors, and
base numbers go along with it.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from harness.core.quantity import Quantity
from harness.diagnosis.fit.model_fit import Fit
from harness.diagnosis.fit.standard_errors import unit_of
from harness.diagnosis.problem import Problem
from harness.diagnosis.search.look import Look
from harness.diagnosis.search.screen import Candidate
from harness.diagnosis.search.search import Search
from harness.kernels.solve import Scales
from harness.model.model import Model, Restoring
from harness.model.registry import NAMED
from harness.model.term import Term

_ERRORS = 2.0
"""Standard errors that a law could be larger than it was fitted."""


@dataclass(frozen=True, slots=True)
class Hidden:
    """A law that could hide. most : of its leading number, in ``unit``. shifts : of base numbers, by name."""

    name: str
    number: str
    most: float
    unit: str
    shifts: Mapping[str, float]


def could_hide(found: Search, scales: Scales) -> tuple[Hidden, ...]:
    """Laws of one number's strength that a recording could hide where the base model explains it."""
    if found.by_force:
        each = [_of_fit(one, found.base, found.problem) for one in found.singles if len(one.model.terms) == 1]
    else:
        laws = tuple(term for term in NAMED if term.amplitude is not None and term.phase is None)
        looked = Look.at(found.base, found.problem, scales, laws).found or ()
        each = [_of_look(one, found.base, found.problem) for one in looked]
    return tuple(one for one in each if one is not None)


def with_systematic(numbers: Mapping[str, Quantity], hidden: tuple[Hidden, ...]) -> dict[str, Quantity]:
    """Base numbers beside the most that a hidden law could shift each by."""
    most = {name: max((h.shifts[name] for h in hidden if name in h.shifts), default=None) for name in numbers}
    return {name: replace(one, systematic=most[name]) for name, one in numbers.items()}


def _of_fit(one: Fit, base: Fit, problem: Problem) -> Hidden | None:
    """By the covariance of the law's own fit."""
    (entry,) = one.model.terms
    at = next((i for i, f in enumerate(one.free) if f.by == (0, entry.term.amplitude)), None)
    if at is None:
        return None
    covariance = one.covariance()
    variance = float(covariance[at, at])
    if not (math.isfinite(variance) and variance > 0.0):
        return None
    most = abs(float(one.values[at])) + _ERRORS * math.sqrt(variance)
    along = covariance[:, at] / variance * most
    moved = {f.by: float(a) for f, a in zip(one.free, along, strict=True) if isinstance(f.by, str) and np.isfinite(a)}
    return _hidden(entry.term, most, base, moved, problem)


def _of_look(one: Candidate, base: Fit, problem: Problem) -> Hidden | None:
    """By a linear look at the law, which says how large it is, how surely, and what goes along."""
    entry = one.model.terms[-1]
    assert entry.term.amplitude is not None
    size = abs(entry.values[entry.term.amplitude])
    if size == 0.0 or one.gain <= 0.0:
        return None
    over = 1.0 + _ERRORS / math.sqrt(one.gain)
    names = (f.by for f in base.free if isinstance(f.by, str) and hasattr(base.model, f.by))
    moved = {name: over * float(getattr(one.model, name) - getattr(base.model, name)) for name in names}
    return _hidden(entry.term, over * size, base, moved, problem)


def _hidden(term: Term, most: float, base: Fit, moved: Mapping[str, float], problem: Problem) -> Hidden:
    assert term.amplitude is not None
    parameter = term.parameters[term.amplitude]
    usual, other = _numbers(base.model, {}), _numbers(base.model, moved)
    shifts = {name: abs(other[name] - usual[name]) for name in usual if math.isfinite(other[name])}
    return Hidden(term.name, parameter.name, most, unit_of(parameter.unit, problem), shifts)


def _numbers(model: Model, moved: Mapping[str, float]) -> dict[str, float]:
    """What results give of a base model, with some of its numbers moved; nan where they are none then."""
    m, c, k, f_k = (getattr(model, name) + moved.get(name, 0.0) for name in ("m", "c", "k", "f_k"))
    if model.restoring is Restoring.NONE:
        return {"mass": m, "c": c, "f_k": f_k}
    if m <= 0.0 or k <= 0.0:
        return dict.fromkeys(("omega_n", "zeta", "x_k"), math.nan)
    return {"omega_n": math.sqrt(k / m), "zeta": c / (2.0 * math.sqrt(k * m)), "x_k": f_k / k}
