"""One posterior over nothing and every name, in place of the gates: its weights, how far its probabilities are true.

P(name) goes with exp(w . features(name)), that of no main effect with 1 (a softmax; Guo et al. 2017, On Calibration of
Modern Neural Networks, for why probabilities are compared with what was right). Nothing of it moves a verdict yet: the
last lines say what it would name, list and claim beside what the grades do on the same draws.
"""

import math
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from scipy.optimize import minimize

from benchmarks.calibrate.calibration import Calibration
from benchmarks.calibrate.machine_draws import drawn
from benchmarks.calibrate.main_effect import graded_of
from harness.core.arrays import FloatArray
from harness.diagnosis.grading.grade import Finalist, Graded
from harness.diagnosis.outcome import Grade
from harness.diagnosis.rules import TAKEN
from harness.proof.machines.kinds import CONTROL, MAIN, UNNAMED

FEATURES = ("none", "share", "company", "loose", "easily", "cycles", "behind")
_GROUPS = (MAIN, CONTROL, MAIN, UNNAMED, CONTROL, MAIN)
_FOLDS, _RIDGE = 5, 0.5
"""A prior of variance two of each weight but the first, features in units of their scatter."""
_BINS = (0.0, 0.2, 0.4, 0.6, 0.8, 1.01)
_NAMED, _LISTED = (0.5, 0.6, 0.7, 0.8), (0.05, 0.1, 0.2)
"""Probabilities tried: of a name to be named, and of any main effect for a list."""
_OF_LIST, _MOST = 0.9, 4
"""Share of what is likely that a list holds, in at most so many names."""


@dataclass(frozen=True, slots=True)
class Row:
    """A recording: names, their features (m, 7), which is the main effect (None: none is), names that a control may be
    given, what the grades answer, and its group.
    """

    names: tuple[str, ...]
    features: FloatArray
    right: int | None
    may_name: frozenset[str]
    now: tuple[str, ...]
    claims: bool
    group: str


def features(f: Finalist, found: Graded) -> list[float]:
    """Of a name: 1; log of its share; share beside another; log of its loosest relative error; log of how often its law
    takes a misfit that it has not made; log of the cycles; evidence behind the best, a word.
    """
    loose = 1.0 if math.isnan(f.loosest) else min(max(f.loosest, 1e-3), 10.0)
    company = f.share if math.isnan(f.company) else f.company
    easily = max(f.fit.model.terms[-1].term.taken, TAKEN.value)
    best = max(one.gain for one in found.finalists if not one.clock)
    behind = (f.gain - best) / max(found.words, 4.0)
    return [
        1.0,
        math.log(max(f.share, 0.01)),
        company,
        math.log(loose),
        math.log(easily),
        math.log(found.cycles),
        behind,
    ]


def measure(seed: int, index: int) -> Row | None:
    """A new recording of a machine: half with a main effect, a third with small ones alone, a sixth with one that no
    catalogue holds. None where the base leaves noise. Raises HarnessError.
    """
    group = _GROUPS[index % len(_GROUPS)]
    recording, truth = drawn(seed, index, group)
    found = graded_of(recording, truth)
    if found is None:
        return None
    likely = [f for f in found.finalists if f.gain > 0.0 and not f.clock]
    names = tuple(f.name for f in likely)
    main = truth["dominant"] if group == MAIN else None
    told = found.grade in (Grade.MAIN, Grade.ONE_OF)
    return Row(
        names,
        np.array([features(f, found) for f in likely]).reshape(-1, len(FEATURES)),
        names.index(main) if main in names else None,
        frozenset(truth["may_name"]),
        tuple(f.name for f in found.named) if told else (),
        found.grade is Grade.MAIN,
        group,
    )


def probabilities(weights: FloatArray, x: FloatArray) -> FloatArray:
    """Of no main effect, then of each name with features x (m, p): (1 + m,)."""
    at = np.concatenate(([0.0], x @ weights))
    odds = np.exp(at - at.max())
    return np.asarray(odds / odds.sum())


def fitted(rows: Sequence[Row]) -> FloatArray:
    """Weights (p,) of the largest likelihood with a small prior."""
    every = np.concatenate([row.features for row in rows])
    scatter = np.where(every.std(axis=0) > 0.0, every.std(axis=0), 1.0)
    middle = np.where(every.std(axis=0) > 0.0, every.mean(axis=0), 0.0)

    def missed(w: FloatArray) -> float:
        likely = (probabilities(w, (row.features - middle) / scatter)[_place(row)] for row in rows)
        return -sum(math.log(max(p, 1e-12)) for p in likely) + 0.5 * _RIDGE * float(w[1:] @ w[1:])

    w: FloatArray = minimize(missed, np.zeros(len(FEATURES)), method="BFGS").x / scatter
    return np.concatenate(([w[0] - w[1:] @ middle[1:]], w[1:]))


def _place(row: Row) -> int:
    return 0 if row.right is None else 1 + row.right


def answered(row: Row, p: FloatArray, named: float, listed: float) -> tuple[tuple[str, ...], bool]:
    """Names, and whether the first is claimed as the main effect."""
    order = np.argsort(-p[1:])
    if not order.size or 1.0 - p[0] < listed:
        return (), False
    if p[1 + order[0]] >= named:
        return (row.names[order[0]],), True
    before = np.cumsum(p[1 + order]) - p[1 + order]
    count = max(int(np.count_nonzero(before < _OF_LIST * (1.0 - p[0]))), 2)
    return tuple(row.names[i] for i in order[: min(count, _MOST)]), False


def counted(rows: Sequence[Row], answers: Sequence[tuple[tuple[str, ...], bool]]) -> str:
    """Named, listed, wrong of those with a main effect; claimed and listed of controls and of unknown effects."""
    count: Counter[str] = Counter()
    for row, (names, claims) in zip(rows, answers, strict=True):
        if not names:
            continue
        if row.group == MAIN:
            there = row.right is not None and row.names[row.right] in names
            right, wrong = ("named", "wrong") if claims else ("listed", "listed without it")
            count[right if there else wrong] += 1
        elif not row.may_name & set(names):
            count[f"{row.group} {'claimed' if claims else 'listed'}"] += 1
    told = ", ".join(f"{key} {n}" for key, n in sorted(count.items()))
    groups = Counter(row.group for row in rows)
    return f"{told} (of {', '.join(f'{n} {group}' for group, n in sorted(groups.items()))})"


def said(rows: Sequence[Row]) -> Iterator[str]:
    """Weights, what probabilities of weights from other draws were worth, and answers beside those of the grades."""
    rows = [row for row in rows if row.names]
    if len(rows) < 2 * _FOLDS or all(row.right is None for row in rows):
        yield "too few draws"
        return
    for name, weight in zip(FEATURES, fitted(rows), strict=True):
        yield f"{name:10s} {weight:.3f}"
    p: list[FloatArray] = [np.empty(0)] * len(rows)
    for k in range(_FOLDS):
        weights = fitted([row for i, row in enumerate(rows) if i % _FOLDS != k])
        for i in range(k, len(rows), _FOLDS):
            p[i] = probabilities(weights, rows[i].features)
    each = np.concatenate([one[1:] for one in p])
    right = np.concatenate([np.arange(len(row.names)) == row.right for row in rows])
    yield "by weights of the other draws: probability said, and share that was right"
    off = 0.0
    for low, high in pairwise(_BINS):
        here = (each >= low) & (each < high)
        if here.any():
            mean, share = float(each[here].mean()), float(right[here].mean())
            off += abs(mean - share) * here.mean()
            yield f"{mean:.2f} {share:.2f} of {here.sum()}"
    yield f"expected calibration error {off:.3f}"
    yield f"grades: {counted(rows, [(row.now, row.claims) for row in rows])}"
    for named in _NAMED:
        for listed in _LISTED:
            answers = [answered(row, one, named, listed) for row, one in zip(rows, p, strict=True)]
            yield f"named from {named}, listed from {listed}: {counted(rows, answers)}"


ABOUT = "one posterior over nothing and every name: its weights, its calibration, and its answers beside the grades'"
CALIBRATION = Calibration(measure, said, ABOUT)
