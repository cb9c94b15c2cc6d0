"""What is decided of many contests and searches by hand, numbers at the limits of the rules among them, is what it was.

Why it is decided so is stated by the tests beside this one; here any change has to be meant. What writes them anew:
``PYTHONPATH=.:tests/support python tests/diagnosis/test_decisions.py``
"""

import sys
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from unchanged import differences, flat, known, noisy, write

from harness.diagnosis.baseline.base_fit import baseline
from harness.diagnosis.baseline.words import Strokes
from harness.diagnosis.grading.chance import OF_MOTION, Odds
from harness.diagnosis.grading.clocks import on_the_swing
from harness.diagnosis.grading.friction_split import resplit
from harness.diagnosis.grading.grade import Contest, Finalist, cells_of, decided, grade
from harness.diagnosis.grading.misfit import misfit
from harness.diagnosis.grading.prediction import Predicted
from harness.diagnosis.problems.free_decay import FreeDecay
from harness.diagnosis.residual_tests.structure import Left
from harness.diagnosis.rules import (
    APART,
    CHANCE,
    FLEXIBLE,
    GAIN,
    HELD_OUT,
    LEAST_CYCLES,
    LEAST_RATIO,
    MARGIN,
    RUN_BETTER,
    RUNS_ON_BETTER,
    SAME_CLOCK,
    SHARE_OF_EXCESS,
    SHARE_OF_MISFIT,
)
from harness.diagnosis.search.search import Search
from harness.diagnosis.search.start_evidence import evidence
from harness.diagnosis.verdict import judge, weighed
from harness.estimate.noise import Noise
from harness.kernels.solve import simulate
from harness.model.model import Model, ModelTerm
from harness.model.registry import term

FILE = Path(__file__).with_name("decisions.json")
CONTESTS, SEARCHES = 600, 200
SAME = 1e-4
"""Relative difference of numbers that are the same: where a fit to noise is done, more does not matter."""
NAMES = ("stribeck", "quadratic-drag", "cubic-stiffness", "presliding", "end-stop", "friction-drift")


@dataclass(frozen=True, slots=True, kw_only=True)
class ByHand(Contest):
    """A contest of which everything is given."""

    counts: tuple[float, float, float]
    likely: float

    @property
    def words(self) -> float:
        return self.counts[0]

    @property
    def cycles(self) -> float:
        return self.counts[1]

    @property
    def words_run(self) -> float:
        return self.counts[2]

    @property
    def refined(self) -> Any:
        return None

    @property
    def odds(self) -> Odds:
        return OF_MOTION

    def chance_of(self, first: Finalist) -> float:
        return self.likely


def _fit(name: str) -> Any:
    entry = SimpleNamespace(term=term(name), values=(0.0,) * len(term(name).parameters))
    return SimpleNamespace(model=SimpleNamespace(terms=(entry,)))


def _predicted(rng: np.random.Generator, rms: float, blocks: int) -> Predicted:
    """Missing that much over blocks, the same in all of them or not."""
    part = rng.dirichlet(np.ones(blocks)) if rng.random() < 0.5 else np.full(blocks, 1.0 / blocks)
    squares = {"x": rms**2 * part * 4.0, "a": np.zeros(blocks)}
    return Predicted(squares, np.ones(blocks), {"x": 2.0, "a": 3.0}, ((0.0, 1.0),) * blocks)


def _contest(rng: np.random.Generator) -> ByHand:
    def some(*values: float) -> float:
        return float(rng.choice(values))

    words = some(10.0, 40.0, 60.0)
    margin = max(MARGIN.value, words * float(np.log(LEAST_RATIO.value)))
    most = some(GAIN.value, GAIN.value - 1e-9, 20.0, 60.0)
    behind = np.cumsum(rng.choice([0.0, 1.0, 0.5 * margin, margin, margin - 1e-9, 0.5 * MARGIN.value, 12.0], 6))
    finalists = []
    for i in range(int(rng.integers(0, 7))):
        share = some(SHARE_OF_EXCESS.value, SHARE_OF_EXCESS.value - 1e-9, 0.1, 0.8, 0.9)
        of_all = some(SHARE_OF_MISFIT.value, SHARE_OF_MISFIT.value - 1e-9, 0.8, 0.9)
        held = some(HELD_OUT.value, HELD_OUT.value + 1e-9, 0.3, 0.31, 0.5, 1.1)
        limits = (rule.value + by for rule in (RUN_BETTER, HELD_OUT) for by in (0.0, 1e-9))
        run = some(*limits, RUNS_ON_BETTER.value, 0.01, 0.3)
        finalists.append(
            Finalist(
                _fit(NAMES[i]),
                most - float(behind[i]) if i else most,
                share,
                of_all,
                bool(rng.random() < 0.15),
                _predicted(rng, held, 6) if rng.random() < 0.9 else None,
                _predicted(rng, run, 1) if rng.random() < 0.9 else None,
            )
        )
    runs = rng.random() < 0.7
    return ByHand(
        finalists=tuple(finalists),
        base_held=_predicted(rng, 1.0, 6),
        base_run=_predicted(rng, 1.0, 1) if runs else None,
        counts=(words, some(LEAST_CYCLES.value, LEAST_CYCLES.value - 0.5, 30.0), some(1.0, 6.0, 24.0)),
        likely=some(CHANCE.value, CHANCE.value - 1e-9, 0.9),
    )


def _contests() -> Any:
    """Grade, names and rules of many."""
    rng = np.random.default_rng(11)
    said = []
    for _ in range(CONTESTS):
        found = decided(_contest(rng))
        names = ", ".join(f.name for f in found.named)
        said.append(f"{found.grade}: {names} by {', '.join(rule.name for rule in found.rules)}")
    return {str(i): one for i, one in enumerate(said)}


def _search(rng: np.random.Generator) -> Search:
    """One of made fits; only what is looked at is there."""
    count = int(rng.integers(0, 3))
    families = ("friction", "damping", "stiffness")

    def fit(chi2: float, laws: int) -> Any:
        entries = tuple(
            SimpleNamespace(
                term=SimpleNamespace(family=str(rng.choice(families)), slot=None),
                values=(1.0,) * int(rng.choice([1, FLEXIBLE.count - 1, FLEXIBLE.count])),
            )
            for _ in range(laws)
        )
        shown = SimpleNamespace(v=np.zeros(1000))
        return SimpleNamespace(
            model=SimpleNamespace(terms=entries),
            chi2=chi2,
            bic=chi2,
            free=(0,) * 7,
            shown=shown,
            explains_as_named=True,
        )

    turns = np.linspace(1, 998, int(rng.choice([6, 20, 90]))).astype(np.int64)
    problem: Any = SimpleNamespace(
        t=np.arange(1000) * 1e-3, duration=1.0, turns=lambda v: turns, zero_free=False, on_bench=True
    )
    rivals = tuple(fit(1000.0 + float(rng.choice([APART.value, APART.value - 1e-9, 5.0])), 2) for _ in range(2))
    left = list(Left)[int(rng.integers(0, len(Left)))]
    by_force = bool(rng.random() < 0.2)
    base = fit(float(rng.choice([1100.0, 1700.0, 5000.0])), 0)
    return Search(problem, base, fit(1000.0, count), (), rivals, left, by_force=by_force)


def _searches() -> Any:
    """Verdict, whether the base stands, the rival, and rules of many."""
    rng, said = np.random.default_rng(12), {}
    for i in range(SEARCHES):
        found = weighed(_search(rng), 60.0)
        graded: Any = SimpleNamespace(grade=None, refined=found.base, rules=(GAIN,)) if rng.random() < 0.3 else None
        judged = judge(found, graded)
        rules = ", ".join(rule.name for rule in judged.rules)
        at = None if judged.rival is None else found.rivals.index(judged.rival)
        said[str(i)] = f"{found.left}: {judged.verdict}, base {judged.refined is found.base}, rival {at}, by {rules}"
    return said


def _graded(channels: str, law: ModelTerm, hand: float) -> Any:
    """A misfit that has a crowd of small things beside a law, in numbers."""
    t = np.linspace(0.0, 7.0, 700)
    run = simulate(Model(1.0, 0.15, 88.4, 0.3, x0=1.0, v0=0.4 * hand, terms=(law,)), t)
    x = run.x * (1.0 + 1e-3 * np.sin(5.1 * t)) + hand * np.exp(-30.0 * t)
    clean = {"x": x, "a": run.a * (1.0 + 2e-3 * np.cos(3.3 * t))}
    sigma = {"x": 2e-4, "a": 0.02}
    noise = {c: Noise(sigma[c], True) for c in channels}
    problem = FreeDecay(t, {c: noisy(clean[c], sigma[c], 5) for c in channels}, noise)
    base, scales = baseline(problem)
    seen = misfit(problem, base, scales)
    found = grade(seen)
    cells = cells_of(evidence(seen.base, seen.problem, seen.scales))
    split = resplit([f.fit for f in found.finalists], seen.problem, seen.scales)
    return {
        "misfit": [seen.words, seen.left_out, seen.strokes.count, seen.base.chi2],
        "sensors": {c: [n.sigma, seen.problem.noise[c].sigma] for c, n in seen.noise.items()},
        "left": {c: n.sigma for c, n in seen.noise_left(found.finalists[0].fit).items()},
        "floor": seen.floor(seen.noise),
        "finalists": {f.name: [f.gain, f.share, f.of_all, f.clock] for f in found.finalists},
        "predicted": {f.name: [p and p.by_span for p in (f.held, f.run)] for f in found.finalists},
        "base": [p and p.by_span for p in (found.base_held, found.base_run)],
        "numbers": {f.name: f.fit.values for f in found.finalists},
        "split": [f.chi2 for f in split],
        "cells": cells,
        "came to": f"{found.grade}: {', '.join(f.name for f in found.named)}",
        "words of the run": found.words_run,
    }


def _clocks() -> Any:
    """At which rates a law of its own clock keeps time with the swing."""
    entry = term("harmonic-force")
    width, omega, span = SAME_CLOCK.value * 2.0 * np.pi / 20.0, 9.0, 20.0

    def at(rate: float) -> ModelTerm:
        return ModelTerm(entry, tuple(rate if name == "Omega" else 0.1 for name in entry.names))

    return [
        on_the_swing(at(m * omega + by * width), omega, span)
        for m in range(1, 6)
        for by in (-1.0, -0.999, 0.0, 0.999, 1.0)
    ]


CASES: dict[str, Callable[[], Any]] = {
    "contests": _contests,
    "searches": _searches,
    "drag": lambda: _graded("x", ModelTerm(term("quadratic-drag"), (0.25,)), 0.0),
    "a cube, pulled": lambda: _graded("xa", ModelTerm(term("cubic-stiffness"), (9.0,)), 0.02),
    "clocks": _clocks,
    "strokes": lambda: [Strokes.between(np.array([2, 5]), 9).of, Strokes.by(np.array([1.0, 2.0, -1.0, -2.0, 3.0])).of],
}


@pytest.mark.parametrize("name", CASES)
def test_every_decision_is_what_it_was(name: str) -> None:
    assert differences(flat(CASES[name]()), known(FILE)[name], SAME) == []


if __name__ == "__main__":
    write(FILE, CASES)
    sys.stdout.write(f"{FILE}\n")
