"""The line through a joint's friction at the speeds and loads of its log, where its friction is no line: the paste."""

import math
from dataclasses import replace

import numpy as np

from harness.core.arrays import FloatArray, IntArray
from harness.core.quantity import Quantity
from harness.diagnosis.inverse_dynamics.asked import inverse_force
from harness.diagnosis.kinds.known import kind_of
from harness.diagnosis.outcome import Outcome

_PARTS = 10
"""Of a log, from whose differences the errors are taken."""
_MOVING = 0.05
"""Of the largest speed: slower samples do not count, where friction's sign is not known."""
_SURE = 2.0
_LOSING = ("friction", "damping")


def shapes(outcome: Outcome) -> tuple[str, ...]:
    """Names of the refined model's laws beside which f_k and c are coefficients."""
    terms = outcome.refined.model.terms
    return tuple(dict.fromkeys(one.term.name for one in terms if one.term.family in _LOSING))


def line(outcome: Outcome, units: tuple[str, str]) -> tuple[Quantity, Quantity]:
    """Dry friction and damping that come nearest to what the joint loses, with errors from tenths of the log.

    Alone where the other is not surely above none: no robot's model takes less.
    """
    model = outcome.refined.model
    bare = replace(model, c=0.0, f_k=0.0, f_s=None).with_terms(
        *(one for one in model.terms if one.term.family not in _LOSING)
    )
    left = kind_of(outcome.problem).left_over(outcome.problem, outcome.refined, outcome.scales)
    t, x, v = left.t, left.at_x, left.at_v
    still = np.zeros_like(v)
    lost = inverse_force(model, t, x, v, still) - inverse_force(bare, t, x, v, still) + model.m * left.force
    kept = np.isfinite(lost) & (np.abs(v) > _MOVING * float(np.nanmax(np.abs(v))))
    columns = np.column_stack((np.sign(v), v, np.ones_like(v)))[kept]
    found, errors = _fitted(columns, lost[kept])
    unsure = next((i for i in (1, 0) if found[i] < _SURE * errors[i]), None)
    if unsure is not None:
        rest = [i for i in range(found.size) if i != unsure]
        found[unsure], errors[unsure] = 0.0, math.inf
        found[rest], errors[rest] = _fitted(columns[:, rest], lost[kept])
    return Quantity(float(found[0]), float(errors[0]), units[0]), Quantity(float(found[1]), float(errors[1]), units[1])


def _fitted(columns: FloatArray, y: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Numbers and standard errors (p,) of columns (n, p) in y (n,)."""
    rows: IntArray = np.arange(y.size)
    without = np.array(
        [
            np.linalg.lstsq(columns[others], y[others], rcond=None)[0]
            for others in (np.setdiff1d(rows, part) for part in np.array_split(rows, _PARTS))
        ]
    )
    spread = np.sum((without - without.mean(axis=0)) ** 2, axis=0)
    found = np.linalg.lstsq(columns, y, rcond=None)[0]
    errors = np.sqrt((_PARTS - 1) / _PARTS * spread)
    return np.asarray(found, dtype=np.float64), np.asarray(errors, dtype=np.float64)
