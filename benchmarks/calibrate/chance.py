"""The chance that a name which stands apart is the main effect: its weights, and what they are worth on other draws."""

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from itertools import pairwise
from typing import Any

import numpy as np
from scipy.optimize import minimize
from scipy.special import expit

from benchmarks.calibrate.calibration import Calibration, stands
from benchmarks.calibrate.machine_draws import drawn
from benchmarks.calibrate.main_effect import graded_of
from harness.core.arrays import BoolArray, FloatArray
from harness.diagnosis.grading.chance import FEATURES, OF_MOTION, Odds
from harness.diagnosis.grading.grade import Contest
from harness.proof.machines.kinds import CONTROL, MAIN

_FOLDS = 10
_RIDGE = 1.0
"""Of the weights of features in units of their scatter: a prior of unit variance."""
_TRIED = (0.0, 0.5, 0.55, 0.6, 0.65, 0.7, 0.75, 0.8, 0.85, 0.9)
"""Chances tried."""
_BINS = (0.0, 0.4, 0.6, 0.75, 0.9, 1.01)
"""Chances between which is looked at what was right."""
_WELL = 0.1
"""What the chance said may be off by, over the draws that were told it."""
_CLAIMED = 0.02
"""Share of controls that may be said to have a main effect."""


@dataclass(frozen=True, slots=True)
class Row:
    """A recording: features (5,) of the name that stands apart, nan where none does; whether it is right; a control."""

    features: FloatArray
    right: bool
    control: bool

    @classmethod
    def of(cls, found: Contest | None, truth: Mapping[str, Any], control: bool) -> "Row":
        """What was graded. A name that a control has, and that takes most of it, is neither right nor wrong."""
        if found is None or found.chance is None or found.named[0].name in truth["may_name"]:
            return cls(np.full(len(FEATURES), np.nan), False, control)
        first = found.named[0]
        return cls(found.seen(first).features, first.name == truth["dominant"], control)


def measure(seed: int, index: int) -> Row:
    """A new recording, with a main effect or with small ones alone. Raises HarnessError."""
    control = index % 2 == 0
    recording, truth = drawn(seed, index, CONTROL if control else MAIN)
    return Row.of(graded_of(recording, truth), truth, control)


def fitted(x: FloatArray, right: BoolArray, weight: FloatArray) -> FloatArray:
    """Intercept and weights (1 + p,) by features (n, p): the largest likelihood with a small prior.

    weight : how often each counts, (n,).
    """
    middle, scatter = x.mean(axis=0), x.std(axis=0)
    z = np.column_stack((np.ones(len(x)), (x - middle) / scatter))
    side = np.where(right, 1.0, -1.0)

    def missed(w: FloatArray) -> tuple[float, FloatArray]:
        at = side * (z @ w)
        prior = np.concatenate(([0.0], w[1:]))
        slope = -(z.T @ (weight * side * expit(-at))) + _RIDGE * prior
        return float(weight @ np.logaddexp(0.0, -at) + 0.5 * _RIDGE * prior @ prior), slope

    w = minimize(missed, np.zeros(z.shape[1]), jac=True).x
    weights = w[1:] / scatter
    return np.concatenate(([w[0] - weights @ middle], weights))


def said(odds: Odds, rows: Sequence[Row]) -> Iterator[str]:
    """Weights, what they say of draws that took no part in them, and whether the rule of ``odds`` stands."""
    controls = sum(row.control for row in rows)
    mains, apart = len(rows) - controls, [row for row in rows if not np.isnan(row.features).any()]
    x, right = np.array([row.features for row in apart]), np.array([row.right for row in apart], dtype=bool)
    control = np.array([row.control for row in apart], dtype=bool)
    yield f"names that stand apart in {mains} recordings with a main effect: {right.sum()} right and"
    yield f"  {(~right & ~control).sum()} wrong; in {controls} controls: {control.sum()}"
    if min(right.sum(), (~right).sum()) < _FOLDS:
        yield stands(odds.least, False, "too few names stand apart")
        return
    # as if half had a main effect
    weight = np.where(control, 1.0, controls / max(mains, 1))
    whole = fitted(x, right, weight)
    yield f"intercept {whole[0]:.3f} (now {odds.intercept})"
    for name, one, now in zip(FEATURES, whole[1:], odds.weights, strict=True):
        yield f"{name:12s} {one:.3f} (now {now})"
    told = np.zeros(len(apart))
    fold = np.arange(len(apart)) % _FOLDS
    for k in range(_FOLDS):
        w = fitted(x[fold != k], right[fold != k], weight[fold != k])
        told[fold == k] = expit(w[0] + x[fold == k] @ w[1:])
    yield "by weights of the other draws, named where the chance is at least so much: right, wrong, controls claimed"
    enough = []
    for least in _TRIED:
        sure = told >= least
        counts = (sure & right).sum(), (sure & ~right & ~control).sum(), (sure & control).sum()
        enough += [least] if counts[2] <= _CLAIMED * controls else []
        yield f"{least:.2f} {counts[0]:4d}/{mains} {counts[1]:4d}/{mains} {counts[2]:4d}/{controls}"
    yield "chance said, and share that was right"
    off = 0.0
    for low, high in pairwise(_BINS):
        here = (told >= low) & (told < high)
        if here.sum() >= _FOLDS:
            mean, share = (float(np.average(one[here], weights=weight[here])) for one in (told, right))
            off = max(off, abs(mean - share))
            yield f"{mean:.2f} {share:.2f} of {here.sum()}"
    same = bool(np.allclose(whole, [odds.intercept, *odds.weights], atol=6e-4))
    first = min(enough, default=math.nan)
    yield f"the least chance that claims at most {100.0 * _CLAIMED:g} % of the controls: {first:.2f}"
    well = off <= _WELL and first == odds.least.value
    yield stands(odds.least, well, f"off by {off:.2f} at most; weights {'as' if same else 'other than'} they stand")


ABOUT = "how likely a name that stands apart is the main effect: the weights of what it hangs on"
CALIBRATION = Calibration(measure, partial(said, OF_MOTION), ABOUT)
