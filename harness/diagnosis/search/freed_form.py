"""The form of a law freed by one number, before a second name is looked for: one effect in another form is one name."""

from collections.abc import Iterator
from dataclasses import replace

from harness.core.errors import SimulationError
from harness.diagnosis.fit.model_fit import Fit, fit
from harness.diagnosis.fit.parameters import base_of, free_of
from harness.diagnosis.problem import Problem
from harness.diagnosis.search.extend import settle
from harness.kernels.solve import Scales
from harness.model.model import ModelTerm
from harness.model.registry import forms_of


def freed(found: Fit, problem: Problem, scales: Scales) -> Fit | None:
    """A model of one law with its form free, fitted from where that law ended; None where its form is its name."""
    best = min(_fitted(found, problem, scales), key=lambda f: f.bic, default=None)
    return None if best is None else settle(best, problem, scales)


def _fitted(found: Fit, problem: Problem, scales: Scales) -> Iterator[Fit]:
    (entry,) = found.model.terms
    base = base_of(found.free)
    for form in forms_of(entry.term.key):
        assert form.freed is not None
        for values in form.freed(entry.values, problem.duration):
            model = replace(found.model, terms=(ModelTerm(form, values),))
            try:
                yield fit(model, problem, free_of(model, base), scales, thorough=False)
            except SimulationError:
                continue
