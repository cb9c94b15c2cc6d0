"""The probability of each name to be the main effect: its weights, how far it is true, and what it comes to.

P(name) goes with exp(w . features(name)), that of no main effect with 1. Weights are those of the largest likelihood,
with a prior about those of motion for a fitted force, of which draws are few; what they are worth is counted on draws
that took no part in them.
"""

from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from itertools import pairwise
from typing import Any

import numpy as np
from scipy.optimize import minimize

from benchmarks.calibrate.calibration import Calibration, stands
from benchmarks.calibrate.machine_draws import asked_of, based, drawn
from benchmarks.calibrate.plant_cases import seen
from benchmarks.recordings.driven import DRIVEN
from harness.app.diagnose.problem import prepared
from harness.core.arrays import FloatArray
from harness.core.recording import Recording
from harness.diagnosis.grading.contest import Contest, answered, softmax
from harness.diagnosis.grading.grade import Graded, grade
from harness.diagnosis.grading.misfit import misfit
from harness.diagnosis.inverse_dynamics.search import search_driven
from harness.diagnosis.outcome import Grade
from harness.diagnosis.problems.inverse import InverseDynamics
from harness.diagnosis.residual_tests.structure import Left, left_by
from harness.diagnosis.rules import (
    FORCE_POSTERIOR,
    LISTED_FROM,
    MAIN_FROM,
    OF_LIST,
    POSTERIOR,
    SAME_CLOCK,
    TIMES_NEXT,
    Weights,
)
from harness.proof.machines.kinds import CONTROL, MAIN, UNNAMED

_GROUPS = (MAIN, CONTROL, MAIN, UNNAMED, CONTROL, MAIN)
_FOLDS, _RIDGE = 5, 0.5
"""A prior of variance two of each weight but the first, features in units of their scatter."""
_BINS = (0.0, 0.2, 0.4, 0.6, 0.8, 1.01)
_CALIBRATED, _WRONG, _CLAIMED = 0.05, 0.02, 0.04
"""Calibration error, share of main effects called by a wrong name, and of controls claimed, that are borne."""
_WORTH_A_PLACE = 0.1
"""Share of true ones from which a kind of law is worth a place in lists: a name of four of which one is true is true in
a quarter, and one that is true less than half as often only makes them longer."""


_JUDGED = (MAIN_FROM, TIMES_NEXT, LISTED_FROM, OF_LIST, SAME_CLOCK)


@dataclass(frozen=True, slots=True)
class Row:
    """A recording: names, their features (m, p), which is the main effect (None: none is), its group.

    may_name : names that a control may be given. main : name of the main effect, whether it is among names or not.
    in_step : of each law with a clock on the swing that takes most, whether it is the main effect.
    """

    names: tuple[str, ...]
    features: FloatArray
    main: str | None
    may_name: frozenset[str]
    group: str
    in_step: tuple[bool, ...]

    @property
    def place(self) -> int:
        """Of what is right among none and the names."""
        return 1 + self.names.index(self.main) if self.main in self.names else 0


def _row(found: Contest | None, weights: Weights, group: str, main: str | None, may_name: Sequence[str]) -> Row | None:
    """None where the base leaves noise."""
    if found is None:
        return None
    each = [list(map(found.features(f).__getitem__, weights.values)) for f in found.standing]
    features = np.array(each).reshape(-1, len(weights.values))
    in_step = tuple(f.name == main for f in found.finalists if f.clock and f.large)
    return Row(tuple(f.name for f in found.standing), features, main, frozenset(may_name), group, in_step)


def graded_of(recording: Recording, truth: Mapping[str, Any]) -> Graded | None:
    """The grades of a recording; None where the base model leaves no structure. Raises HarnessError."""
    start = seen(*based(recording, truth))
    if left_by(start.base, start.problem, start.scales.omega, start.base) is not Left.STRUCTURE:
        return None
    return grade(misfit(start.problem, start.base, start.scales))


def measure(seed: int, index: int) -> Row | None:
    """A new recording of a machine: half with a main effect, a third with small ones alone, a sixth with one that no
    catalogue holds. None where the base leaves noise. Raises HarnessError.
    """
    group = _GROUPS[index % len(_GROUPS)]
    recording, truth = drawn(seed, index, group)
    main = truth["dominant"] if group == MAIN else None
    return _row(graded_of(recording, truth), POSTERIOR, group, main, truth["may_name"])


def measure_force(seed: int, index: int) -> Row | None:
    """The same of a driven machine; None also where its motion can be followed. Raises HarnessError."""
    group = _GROUPS[index % len(_GROUPS)]
    recording, truth = drawn(seed, index, group, DRIVEN)
    problem = prepared(recording, asked_of(truth)).problem
    if not isinstance(problem, InverseDynamics):
        return None
    main = truth["dominant"] if group == MAIN else None
    return _row(search_driven(problem).graded, FORCE_POSTERIOR, group, main, truth["may_name"])


def fitted(rows: Sequence[Row], middle: FloatArray | None = None) -> FloatArray:
    """Weights (p,) of the largest likelihood with a small prior, about ``middle`` (p,), or none."""
    rows = [row for row in rows if row.names]
    every = np.concatenate([row.features for row in rows])
    scatter, mean = every.std(axis=0), every.mean(axis=0)
    scatter[0], mean[0] = 1.0, 0.0
    scatter[scatter == 0.0] = 1.0
    prior = np.zeros(every.shape[1]) if middle is None else middle * scatter
    x, sizes = (every - mean) / scatter, np.array([len(row.names) for row in rows])
    first = np.cumsum(sizes) - sizes
    right = np.array([start + row.place - 1 for start, row in zip(first, rows, strict=True) if row.place])

    def missed(w: FloatArray) -> tuple[float, FloatArray]:
        """Minus the logarithm of what is likely, and its gradient (p,)."""
        odds, away = x @ w, np.append(0.0, (w - prior)[1:])
        most = np.maximum(np.maximum.reduceat(odds, first), 0.0)
        parts = np.exp(-most) + np.add.reduceat(np.exp(odds - np.repeat(most, sizes)), first)
        whole = most + np.log(parts)
        slope = x.T @ np.exp(odds - np.repeat(whole, sizes)) - x[right].sum(axis=0) + _RIDGE * away
        return float(whole.sum() - odds[right].sum() + 0.5 * _RIDGE * away @ away), slope

    w: FloatArray = minimize(missed, prior, jac=True, method="BFGS").x / scatter
    w[0] -= w[1:] @ mean[1:]
    return w


def counted(rows: Sequence[Row], likely: Sequence[FloatArray]) -> Counter[str]:
    """Named, listed, wrong of those with a main effect; claimed and listed of controls and of unknown effects."""
    count: Counter[str] = Counter()
    for row, p in zip(rows, likely, strict=True):
        grade, names = answered(dict(zip(("", *row.names), map(float, p), strict=True)))
        if grade is None:
            continue
        claims = grade is Grade.MAIN
        if row.group == MAIN:
            right, wrong = ("named", "wrong") if claims else ("listed", "listed without it")
            count[right if row.main in names else wrong] += 1
        elif not row.may_name & set(names):
            count[f"{row.group} {'claimed' if claims else 'listed'}"] += 1
    return count


def said(weights: Weights, middle: FloatArray | None, rows: Sequence[Row | None]) -> Iterator[str]:
    """Weights, what probabilities by weights of other draws were worth, and what is said by them."""
    there = [row for row in rows if row is not None and row.names]
    if len(there) < 2 * _FOLDS or all(row.place == 0 for row in there):
        yield from (stands(rule, False, "too few draws") for rule in _JUDGED)
        return
    whole = fitted(there, middle)
    for (name, now), weight in zip(weights.values.items(), whole, strict=True):
        yield f"{name:10s} {weight:.3f} (now {now})"
    p: list[FloatArray] = [np.empty(0)] * len(there)
    for k in range(_FOLDS):
        w = fitted([row for i, row in enumerate(there) if i % _FOLDS != k], middle)
        for i in range(k, len(there), _FOLDS):
            p[i] = softmax(list(there[i].features @ w))
    each = np.concatenate([one[1:] for one in p])
    right = np.concatenate([np.arange(1, one.size) == row.place for row, one in zip(there, p, strict=True)])
    yield "by weights of the other draws: probability said, and share that was right"
    off = 0.0
    for low, high in pairwise(_BINS):
        here = (each >= low) & (each < high)
        if here.any():
            mean, share = float(each[here].mean()), float(right[here].mean())
            off += abs(mean - share) * float(here.mean())
            yield f"{mean:.2f} {share:.2f} of {here.sum()}"
    yield f"expected calibration error {off:.3f}"
    groups, count = Counter(row.group for row in rows if row is not None), counted(there, p)
    yield f"{', '.join(f'{key} {n}' for key, n in sorted(count.items()))} (of {dict(groups)})"
    same = bool(np.allclose(whole, list(weights.values.values()), atol=6e-4))
    borne = count["wrong"] <= _WRONG * groups[MAIN] and count[f"{CONTROL} claimed"] <= _CLAIMED * groups[CONTROL]
    why = f"off by {off:.3f}; weights {'as' if same else 'other than'} they stand"
    for rule in _JUDGED[:-1]:
        yield stands(rule, off <= _CALIBRATED and borne, why)
    clocks = [right for row in rows if row is not None for right in row.in_step]
    seldom = sum(clocks) < _WORTH_A_PLACE * len(clocks) or not clocks
    yield stands(SAME_CLOCK, seldom, f"of {len(clocks)} laws in step that could be listed {sum(clocks)} are true")


def _calibration(
    measured: Callable[[int, int], Row | None], weights: Weights, middle: FloatArray | None
) -> Calibration:
    about = f"{weights.moves}: its weights, how far it is true, what it comes to"
    return Calibration(measured, partial(said, weights, middle), about)


CALIBRATION = _calibration(measure, POSTERIOR, None)
FORCE = _calibration(
    measure_force, FORCE_POSTERIOR, np.array([POSTERIOR.values[name] for name in FORCE_POSTERIOR.values])
)
