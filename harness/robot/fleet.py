"""Parameters of joints over several logs of one robot: whether they differ by more than their errors, and with what.

A parameter that is the same in n logs scatters about its weighted mean so that the sum of squares over its errors is
chi-square of n - 1 (Birge 1932). All parameters of all joints are asked at once, so that each may be off by its share
of the chance alone (Bonferroni).
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType
from typing import Protocol

import numpy as np

from harness.core.arrays import FloatArray
from harness.core.quantity import Quantity
from harness.diagnosis.rules import Rule
from harness.robot.friction_curve import splines

CHANCE = Rule(
    "fleet-chance",
    0.01,
    "probability",
    "a parameter of a joint is said to differ between logs, or to change with a condition",
    "by chance alone one fleet in a hundred has one; the sum over all parameters of all joints is meant (Bonferroni)",
)


@dataclass(frozen=True, slots=True)
class Trend:
    """With what a parameter changes. name : of the condition. slope : of the parameter over it. differs : from none."""

    name: str
    slope: Quantity
    differs: bool


@dataclass(frozen=True, slots=True)
class Compared:
    """One parameter of one joint over the logs.

    values : one a log, None where that says nothing. mean : weighted. chi2, freedom, chance : of being the same in all;
    chance is the probability of such a scatter. apart : the number of the log farthest from the others' mean, in its
    and their errors. differs : by more than errors allow, all that is asked counted. between : standard deviation
    of the logs beyond their errors, which the mean's error has in it (DerSimonian and Laird 1986, Control. Clin. Trials
    7, 177).
    """

    joint: str
    parameter: str
    values: tuple[Quantity | None, ...]
    mean: Quantity
    chi2: float
    freedom: int
    chance: float
    apart: int
    differs: bool
    between: float = 0.0
    trends: tuple[Trend, ...] = ()


Values = Mapping[str, Mapping[str, Quantity]]
"""Of one log, by joint and by parameter."""


class Curve(Protocol):
    """Friction over speed with a band of 95 %, as curves of joints and their results have it."""

    @property
    def v(self) -> Sequence[float] | FloatArray: ...
    @property
    def friction(self) -> Sequence[float] | FloatArray: ...
    @property
    def low(self) -> Sequence[float] | FloatArray: ...
    @property
    def high(self) -> Sequence[float] | FloatArray: ...
    @property
    def unit(self) -> str: ...


SLOW, MIDDLE, FAST = "slow", "middle", "fast"
"""Speeds at which curves are compared: the ends of what all of them cover, and between."""
_WIDE = 3.92
"""Errors in a band of 95 %."""


def over_speed(curves: Sequence[Curve | None]) -> tuple[dict[str, float], list[dict[str, Quantity]]]:
    """Speeds that all curves of a joint cover, by name, and of each log friction at them, mean of both directions.

    Nothing where fewer than two logs have a curve, or they have no speeds in common.
    """
    knots = {i: np.asarray(one.v)[len(one.v) // 2 :] for i, one in enumerate(curves) if one is not None}
    none: list[dict[str, Quantity]] = [{} for _ in curves]
    if len(knots) < 2:
        return {}, none
    slow, fast = max(float(k[0]) for k in knots.values()), min(float(k[-1]) for k in knots.values())
    if slow >= fast:
        return {}, none
    speeds = {SLOW: slow, MIDDLE: math.sqrt(slow * fast), FAST: fast}
    at = np.array(list(speeds.values()))
    for i, own in knots.items():
        one = curves[i]
        assert one is not None
        on = splines(at, np.ones_like(at), own)
        size = (on - on[:, ::-1]) @ np.asarray(one.friction) / 2.0
        wide = (np.asarray(one.high) - np.asarray(one.low)) / _WIDE
        both = np.hypot(wide[own.size :], wide[: own.size][::-1]) / 2.0
        errors = np.interp(at, own, both)
        none[i] = {
            name: Quantity(float(x), float(e), one.unit) for name, x, e in zip(speeds, size, errors, strict=True)
        }
    return speeds, none


Conditions = Mapping[str, Sequence[float | None]]
"""By name, one number a log, None where it is not known."""


def compared(logs: Sequence[Values], conditions: Conditions = MappingProxyType({})) -> tuple[Compared, ...]:
    """Every parameter that at least two logs have with an error: what has none cannot be compared."""
    kept = []
    for joint in dict.fromkeys(joint for log in logs for joint in log):
        for name in dict.fromkeys(name for log in logs for name in log.get(joint, {})):
            found = [log.get(joint, {}).get(name) for log in logs]
            values = tuple(q if q is not None and q.value is not None and q.stderr else None for q in found)
            if sum(q is not None for q in values) > 1:
                kept.append((joint, name, values))
    level = CHANCE.value / max(len(kept) * (1 + len(conditions)), 1)
    return tuple(_compared(*one, conditions, level) for one in kept)


def _compared(
    joint: str, name: str, values: tuple[Quantity | None, ...], conditions: Conditions, level: float
) -> Compared:
    from scipy.special import chdtrc

    there = {i: q for i, q in enumerate(values) if q is not None}
    x, s = (np.array([getattr(q, what) for q in there.values()], dtype=np.float64) for what in ("value", "stderr"))
    mean, _ = _mean(x, s)
    chi2, freedom = float(np.sum(((x - mean) / s) ** 2)), x.size - 1
    between = _between(chi2, s)
    mean, error = _mean(x, np.hypot(s, between))
    chance = float(chdtrc(freedom, chi2))
    without = [_mean(np.delete(x, i), np.delete(s, i)) for i in range(x.size)]
    far = [abs(x[i] - others) / float(np.hypot(s[i], spread)) for i, (others, spread) in enumerate(without)]
    at, unit = [*there], next(iter(there.values())).unit
    trends = (_trend(what, [given[i] for i in at], x, s, unit, level) for what, given in conditions.items())
    return Compared(
        joint, name, values, Quantity(mean, error, unit), chi2, freedom, chance, at[int(np.argmax(far))],
        chance < level, between, tuple(one for one in trends if one is not None),
    )  # fmt: skip


def _mean(x: FloatArray, s: FloatArray) -> tuple[float, float]:
    """Weighted mean and its error."""
    weights = 1.0 / s**2
    return float(weights @ x / weights.sum()), float(weights.sum() ** -0.5)


def _between(chi2: float, s: FloatArray) -> float:
    """Standard deviation between logs that such a scatter has beyond errors (k,)."""
    w = 1.0 / s**2
    beyond = chi2 - (s.size - 1)
    return math.sqrt(max(beyond, 0.0) / float(w.sum() - np.sum(w**2) / w.sum()))


def _trend(
    name: str, given: Sequence[float | None], x: FloatArray, s: FloatArray, unit: str, level: float
) -> Trend | None:
    """A straight line through the values; its error is that of the scatter about it where that is larger.

    None for fewer than three logs with different conditions: two points always lie on a line.
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
    return Trend(name, Quantity(slope, error, f"{unit} per {name}"), differs)
