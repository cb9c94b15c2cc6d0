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
from harness.diagnosis.rules import CHANCE
from harness.estimate.repeated import Conditions, Trend, spread, squares, trends, weighted
from harness.robot.friction_curve import splines


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
    chi2, freedom, between = squares(x, s), x.size - 1, spread(x, s)
    mean, error = weighted(x, s, between)
    chance = float(chdtrc(freedom, chi2))
    without = [weighted(np.delete(x, i), np.delete(s, i), 0.0) for i in range(x.size)]
    far = [abs(x[i] - others) / float(np.hypot(s[i], own)) for i, (others, own) in enumerate(without)]
    at, unit = [*there], next(iter(there.values())).unit
    given = {what: [all_of_it[i] for i in at] for what, all_of_it in conditions.items()}
    return Compared(
        joint, name, values, Quantity(mean, error, unit), chi2, freedom, chance, at[int(np.argmax(far))],
        chance < level, between, trends(given, x, s, unit, level),
    )  # fmt: skip
