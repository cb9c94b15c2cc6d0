"""What each of several recordings says alone under the model that was found for all of them."""

from collections.abc import Sequence
from contextlib import suppress
from dataclasses import replace

from harness.core.errors import SimulationError
from harness.core.quantity import Quantity
from harness.diagnosis.fit.model_fit import Fit, fit
from harness.diagnosis.fit.parameters import free_of
from harness.diagnosis.fit.standard_errors import base_parameters, term_parameters
from harness.diagnosis.pooling.compared import Alone
from harness.diagnosis.pooling.forces import force_alone
from harness.diagnosis.problem import Problem
from harness.diagnosis.problems.forces_together import ForcesTogether
from harness.diagnosis.problems.free_decay import FreeDecay
from harness.diagnosis.problems.inverse_dynamics import InverseDynamics
from harness.diagnosis.problems.together import Together
from harness.diagnosis.residual_tests.structure import Left, left_by
from harness.kernels.solve import Scales
from harness.model.model import Model


def alone_under(found: Fit, problem: Together | ForcesTogether, scales: Scales, base: Sequence[Alone]) -> list[Alone]:
    """Each recording with the named terms of a model, all of it fitted anew; the base where there are none.

    base : the recordings under the base model. What cannot be simulated alone is as it was there.
    """
    terms = tuple(entry for entry in found.model.terms if entry.term.searched)
    if not terms:
        return list(base)
    read = list(base)
    alone: Sequence[Problem] = problem.each if isinstance(problem, ForcesTogether) else problem.alone
    for i, one in enumerate(alone):
        model = replace(found.model.of_recording(i), terms=terms)
        with suppress(SimulationError):
            if isinstance(one, FreeDecay):
                read[i] = _decay(one, model, scales)
            elif isinstance(one, InverseDynamics):
                read[i] = force_alone(one, model, scales)
    return read


def _decay(problem: FreeDecay, model: Model, scales: Scales) -> Alone:
    found = fit(model, problem, free_of(model, problem.base_names), scales)
    explained = left_by(found, problem, scales.omega, found) is Left.NOISE
    return Alone(problem, found, scales, explained, base_parameters(found, problem, scales.omega, explained))


def parameters_of(one: Alone) -> dict[str, Quantity]:
    """Its numbers by name, those of a term as "quadratic-drag.c2"."""
    read = dict(one.parameters)
    for i, entry in enumerate(one.fit.model.terms):
        numbers = term_parameters(one.fit, one.problem, i, one.scales.omega, one.explained)
        read |= {f"{entry.term.key}.{name}": number for name, number in numbers.items()}
    return read
