"""What several measurements of one number say together, and with what it changes.

Each measurement has the error of its recording; what they differ by more is the spread between them (a random effect:
DerSimonian and Laird 1986), and the value's own error counts both. Over a condition that was noted a number may lie on
a straight line.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.special import stdtr

from harness.core.arrays import FloatArray
from harness.core.quantity import Quantity

_STANDS_OUT = 0.05
"""Chance, over all of them, of lying so far from the others, below which one stands out: 6 errors of five, 38 of three
(two that agree by chance would make the third stand out)."""
_FEWEST = 3
"""Measurements from which one can stand out: of two either could."""


@dataclass(frozen=True, slots=True)
class Repeated:
    """value, stderr : of the number. within : error of a typical one. between : standard deviation of what they differ
    by beside their errors. outliers : indices of those that stand out.
    """

    value: float
    stderr: float
    within: float
    between: float
    outliers: tuple[int, ...] = ()


def repeated(values: Sequence[float], errors: Sequence[float]) -> Repeated:
    """Measurements (n,) of one number with their standard errors (n,), n >= 2, all finite, errors above zero."""
    y, e = np.asarray(values, dtype=np.float64), np.asarray(errors, dtype=np.float64)
    between = spread(y, e)
    mean, error = weighted(y, e, between)
    within = math.sqrt(float(np.mean(e**2)))
    out = tuple(i for i in range(y.size) if _chance(y, e, i) * y.size < _STANDS_OUT) if y.size >= _FEWEST else ()
    return Repeated(mean, error, within, between, out)


def weighted(y: FloatArray, e: FloatArray, between: float) -> tuple[float, float]:
    """Mean of measurements (n,) with errors (n,) and a spread between them, and its error."""
    weight = 1.0 / (e**2 + between**2)
    return float(weight @ y / np.sum(weight)), float(np.sum(weight) ** -0.5)


def squares(y: FloatArray, e: FloatArray) -> float:
    """Chi-square of measurements (n,) about their mean."""
    return float(np.sum(((y - weighted(y, e, 0.0)[0]) / e) ** 2))


def spread(y: FloatArray, e: FloatArray) -> float:
    """Standard deviation by which measurements (n,) differ beyond their errors (n,)."""
    weight = e**-2.0
    scale = float(np.sum(weight) - np.sum(weight**2) / np.sum(weight))
    return math.sqrt(max(squares(y, e) - (y.size - 1), 0.0) / scale)


def _chance(y: FloatArray, e: FloatArray, i: int) -> float:
    """That a measurement lies so far from the others, whose spread is known from them alone (Student's t)."""
    rest = np.arange(y.size) != i
    others, theirs = y[rest], e[rest]
    between = spread(others, theirs)
    mean, error = weighted(others, theirs, between)
    far = abs(float(y[i]) - mean) / math.sqrt(float(e[i]) ** 2 + between**2 + error**2)
    return 2.0 * float(stdtr(others.size - 1, -far))


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
