"""The descent of a model's fitted numbers, whatever of a recording it is seen by."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Generic, TypeVar

import numpy as np

from harness.core.arrays import FloatArray
from harness.diagnosis.fit.parameters import Free, bounds_of, coordinates_of, values_of, with_coordinates
from harness.fit.least_squares import Descent, Until, least_squares
from harness.model.model import Model

S = TypeVar("S")


@dataclass(frozen=True, slots=True)
class At(Generic[S]):
    """A model beside its recording; coordinates are those of ``free``.

    residual (N,), jacobian (N, q) : data minus model and the model's partials by the fitted numbers. shown : what they
    were made from.
    """

    model: Model
    free: tuple[Free, ...]
    residual: FloatArray
    jacobian: FloatArray
    shown: S

    @property
    def squares(self) -> float:
        """Chi-square."""
        return float(self.residual @ self.residual)

    def normal_equations(self) -> tuple[FloatArray, FloatArray]:
        """By the coordinates that are fitted; infinite where a number has run away to a limit of its law."""
        values = values_of(self.model, self.free)
        with np.errstate(over="ignore", invalid="ignore"):
            j = self.jacobian * [f.slope(v) for f, v in zip(self.free, values, strict=True)]
            return j.T @ j, j.T @ self.residual


def downhill(
    model: Model,
    free: tuple[Free, ...],
    look: Callable[[Model], tuple[FloatArray, FloatArray, S]],
    until: Until,
) -> Descent[At[S]]:
    """From a model's own values to where ``look`` (residual, partials and what they were made from) leaves least.

    Raises SimulationError when even the start cannot be looked at.
    """

    def evaluated(at: FloatArray) -> At[S]:
        candidate = with_coordinates(model, free, at)
        return At(candidate, free, *look(candidate))

    return least_squares(evaluated, coordinates_of(model, free), until, bounds_of(free))
