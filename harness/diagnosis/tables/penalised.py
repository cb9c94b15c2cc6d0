"""Tables fitted to a motion that is followed: each step of the fit is a simulation with its partials."""

import numpy as np

from harness.core.arrays import FloatArray
from harness.diagnosis.fit.model_fit import evaluate
from harness.diagnosis.fit.observe import COARSE
from harness.diagnosis.fit.parameters import Free
from harness.diagnosis.problem import Problem
from harness.diagnosis.tables.basis import Basis
from harness.diagnosis.tables.fitted import Look, TableFit, minimised
from harness.kernels.solve import Effort, Scales
from harness.model.model import Model


def fit_tables(
    basis: Basis,
    start: Model,
    at: FloatArray,
    free: tuple[Free, ...],
    problem: Problem,
    scales: Scales,
    strength: float,
    penalty: FloatArray | None = None,
    iterations: int = 12,
    effort: Effort = COARSE,
) -> TableFit:
    """Fit base parameters and tables from a start; see ``minimised``.

    Raises SimulationError when the start cannot be simulated.
    """
    tables = tuple(Free(place, f"table {i}", -np.inf, np.inf, False) for i, place in enumerate(basis.places))

    def seen(model: Model) -> Look:
        residual, jacobian, shown = evaluate(model, problem, (*free, *tables), scales, effort)
        return Look(residual, jacobian, shown.x, shown.v, shown)

    return minimised(basis, start, at, free, seen, strength, penalty, iterations)
