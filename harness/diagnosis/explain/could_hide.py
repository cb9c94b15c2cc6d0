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
from harness.model.registry import USUAL
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
        laws = tuple(term for term in USUAL if term.amplitude is not None and term.phase is None)
        looked = Look.at(found.base, found.problem, scales, laws).found or ()
        each = [_of_look(one, found.base, found.problem) for one in looked]
    return tuple(one for one in each if one is not None)


def most_shifted(hidden: tuple[Hidden, ...]) -> dict[str, float]:
    """The most that a hidden law could shift each number of a base model by, by name."""
    names = dict.fromkeys(name for one in hidden for name in one.shifts)
    return {name: max(one.shifts[name] for one in hidden if name in one.shifts) for name in names}


def with_systematic(numbers: Mapping[str, Quantity], shifts: Mapping[str, float]) -> dict[str, Quantity]:
    """Base numbers beside the most that a hidden law could shift each by."""
    return {name: replace(one, systematic=shifts.get(name)) for name, one in numbers.items()}


def _of_fit(one: Fit, base: Fit, problem: Problem) -> Hidden | None:
    """By the covariance of the law's own fit, what gives the law its shape held: that alone it may have at any size."""
    (entry,) = one.model.terms
    kept = [i for i, f in enumerate(one.free) if isinstance(f.by, str) or f.by == (0, entry.term.amplitude)]
    of_size = replace(one, free=tuple(one.free[i] for i in kept), jacobian=one.jacobian[:, kept])
    names = [f.by for f in of_size.free]
    size = np.array([float(not isinstance(name, str)) for name in names])
    if not np.any(size):
        return None
    if _above_sliding(entry.term):
        size[[i for i, name in enumerate(names) if name == "f_k"]] = -1.0
    covariance = of_size.covariance()
    variance = float(size @ covariance @ size)
    if not (math.isfinite(variance) and variance > 0.0):
        return None
    most = abs(float(size @ of_size.values)) + _ERRORS * math.sqrt(variance)
    along = covariance @ size / variance * most
    moved = {name: float(by) for name, by in zip(names, along, strict=True) if isinstance(name, str)}
    return _hidden(entry.term, most, base, moved, problem)


def _of_look(one: Candidate, base: Fit, problem: Problem) -> Hidden | None:
    """By a linear look at the law, which says how large it is, how surely, and what goes along."""
    entry = one.model.terms[-1]
    assert entry.term.amplitude is not None
    size = abs(entry.values[entry.term.amplitude] - (one.model.f_k if _above_sliding(entry.term) else 0.0))
    if size == 0.0 or one.gain <= 0.0:
        return None
    over = 1.0 + _ERRORS / math.sqrt(one.gain)
    names = (f.by for f in base.free if isinstance(f.by, str) and hasattr(base.model, f.by))
    moved = {name: over * float(getattr(one.model, name) - getattr(base.model, name)) for name in names}
    return _hidden(entry.term, over * size, base, moved, problem)


def _above_sliding(term: Term) -> bool:
    """Whether a law's size is a break-away force, which does nothing where it is f_k."""
    return term.amplitude is not None and term.parameters[term.amplitude].name == "f_s"


def _hidden(term: Term, size: float, base: Fit, moved: Mapping[str, float], problem: Problem) -> Hidden:
    assert term.amplitude is not None
    parameter = term.parameters[term.amplitude]
    # what a law takes the base had, and no more than that
    taken = [getattr(base.model, name) / -moved[name] for name in ("c", "f_k") if moved.get(name, 0.0) < 0.0]
    share = min([1.0, *taken])
    usual, other = _numbers(base.model, {}), _numbers(base.model, {name: share * by for name, by in moved.items()})
    shifts = {name: abs(other[name] - usual[name]) for name in usual if math.isfinite(other[name])}
    most = share * size + (base.model.f_k if _above_sliding(term) else 0.0)
    return Hidden(term.name, parameter.name, most, unit_of(parameter.unit, problem), shifts)


def _numbers(model: Model, moved: Mapping[str, float]) -> dict[str, float]:
    """What results give of a base model, with some of its numbers moved; nan where they are none then."""
    plain = {name: getattr(model, name) + moved.get(name, 0.0) for name in ("m", "c", "k", "f_k", "offset")}
    m, c, k, f_k, _ = plain.values()
    if model.restoring is Restoring.NONE:
        return {**plain, "mass": m}
    if m <= 0.0 or k <= 0.0:
        return {**plain, **dict.fromkeys(("omega_n", "zeta", "x_k"), math.nan)}
    return {**plain, "omega_n": math.sqrt(k / m), "zeta": c / (2.0 * math.sqrt(k * m)), "x_k": f_k / k}
