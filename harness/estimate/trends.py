"""With what a number that was measured several times changes: a straight line over a condition."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from harness.core.arrays import FloatArray
from harness.core.quantity import Quantity

Conditions = Mapping[str, Sequence[float | None]]
"""By name, one number a measurement, None where it is not known."""


@dataclass(frozen=True, slots=True)
class Trend:
    """With what a number changes.

    name : of the condition, its unit in brackets. slope : of the number over it. differs : from none.
    """

    name: str
    slope: Quantity
    differs: bool

    @property
    def said(self) -> str:
        """In words, behind the number's name."""
        return f"it changes with {self.name.partition('[')[0].strip()}: {self.slope}"


def trends(conditions: Conditions, x: FloatArray, s: FloatArray, unit: str, level: float) -> tuple[Trend, ...]:
    """Of values x (n,) with standard errors s (n,) over every condition, of which three values or more are known.

    level : chance below which one is said.
    """
    found = (_trend(name, given, x, s, unit, level) for name, given in conditions.items())
    return tuple(one for one in found if one is not None)


def _trend(
    name: str, given: Sequence[float | None], x: FloatArray, s: FloatArray, unit: str, level: float
) -> Trend | None:
    """A straight line through the values; its error is that of the scatter about it where that is larger.

    None for fewer than three with different conditions: two points always lie on a line.
    """
    from scipy.special import stdtr

    known = [i for i, value in enumerate(given) if value is not None]
    at = np.array([given[i] for i in known], dtype=np.float64)
    if np.unique(at).size < 3:
        return None
    x, s = x[known], s[known]
    columns = np.column_stack((np.ones_like(at), at - at.mean())) / s[:, None]
    inverse = np.linalg.inv(columns.T @ columns)
    line = inverse @ columns.T @ (x / s)
    freedom = at.size - 2
    scatter = float(np.sum((x / s - columns @ line) ** 2)) / freedom
    slope, error = float(line[1]), float(np.sqrt(inverse[1, 1] * max(scatter, 1.0)))
    differs = 2.0 * float(stdtr(freedom, -abs(slope) / error)) < level
    of = name.partition("[")[2].rstrip("] ") or name
    return Trend(name, Quantity(slope, error, f"per {of}" if unit == "1" else f"{unit} per {of}"), differs)
