"""What another form of a named law, or another name that is listed beside it, would shift the other numbers by.

A law is named by its mechanism; its formula is one of several that people publish, and beside another one what is left
to viscous and Coulomb friction is another share. The standard errors of a fit know nothing of that.
"""

import math
from collections.abc import Iterable

from harness.core.quantity import Quantity
from harness.diagnosis.fit.model_fit import Fit
from harness.diagnosis.fit.standard_errors import base_parameters, plain_parameters
from harness.diagnosis.problem import Problem
from harness.diagnosis.search.search import forms
from harness.kernels.solve import Scales
from harness.model.registry import other_forms_of


def shifted_by_form(
    refined: Fit, listed: Iterable[Fit], problem: Problem, scales: Scales, explained: bool
) -> dict[str, float]:
    """The most by which other forms of a model's laws, or listed ones, would shift each of its numbers, by name.

    A shift counts with as much of its error as it has beyond the number's own. Beside a form that is free already one
    that is free otherwise counts by what the one leaves beyond noise over what the other leaves, in rms: so far is what
    is true from either.
    """
    here, found = _numbers(refined, problem, scales, explained), dict[str, float]()
    # a free form has those of its law as special cases, and leaves no more
    freed = ((other, _nearer(refined, other)) for other in forms(refined, problem, scales, other_forms_of))
    whole = ((other, 1.0) for other in (*forms(refined, problem, scales), *listed))
    for other, share in (*whole, *freed):
        for name, there in _numbers(other, problem, scales, explained).items():
            by = _shift(here.get(name), there)
            if by is not None:
                found[name] = max(share * by, found.get(name, 0.0))
    return found


def _nearer(here: Fit, there: Fit) -> float:
    """What one fit leaves beyond noise over what another leaves, rms; 1 at most."""
    left, more = (max(one.chi2 - one.points, 0.0) for one in (here, there))
    return math.sqrt(left / more) if more > left else 1.0


def _numbers(found: Fit, problem: Problem, scales: Scales, explained: bool) -> dict[str, Quantity]:
    """As results give them, and as they stand in the model."""
    plain = plain_parameters(found, problem, scales.omega, explained)
    return plain | base_parameters(found, problem, scales.omega, explained)


def _shift(here: Quantity | None, there: Quantity) -> float | None:
    if here is None or here.value is None or there.value is None or here.stderr is None or there.stderr is None:
        return None
    return math.hypot(there.value - here.value, math.sqrt(max(there.stderr**2 - here.stderr**2, 0.0)))
