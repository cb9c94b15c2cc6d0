"""The steps of a diagnosis one by one, for programs that look in between or do a step their own way.

``harness.diagnose`` takes them all and writes results; here each gives what the next one takes: prepare, fit_base,
search, judge, explain. Each value is frozen: ``dataclasses.replace`` changes one, such as the noise of a problem.
"""

from contextlib import AbstractContextManager
from typing import Any

import numpy as np

from harness.api import load
from harness.app.diagnose.options import DiagnoseOptions
from harness.app.diagnose.problem import Prepared, prepared
from harness.app.shared.reading import ReadOptions
from harness.core.recording import Recording
from harness.diagnosis import pipeline
from harness.diagnosis.explain.sentences import sentence_of
from harness.diagnosis.inverse_dynamics.validate import Judge
from harness.diagnosis.outcome import Outcome
from harness.diagnosis.problem import Problem
from harness.diagnosis.stages import Based, Found, Judged
from harness.suites import File

__all__ = [
    "Based",
    "Found",
    "Judge",
    "Judged",
    "Outcome",
    "Prepared",
    "Problem",
    "explain",
    "fit_base",
    "judge",
    "prepare",
    "search",
    "statement",
]


def prepare(
    recording: Recording | File,
    *,
    mass: float | None = None,
    horizon: float | None = None,
    restoring: str | None = None,
    zero: str | None = None,
) -> Prepared:
    """A recording made ready: its ``problem`` (channels, noise, what of it counts), with ``notes`` on what was done.

    mass (kg), horizon (s), restoring, zero : as for ``harness.diagnose``. Raises InputError for a recording or an
    option that cannot be used.
    """
    found = recording if isinstance(recording, Recording) else load(recording)
    with _quiet():
        return prepared(found, DiagnoseOptions.chosen(ReadOptions(), restoring, zero, (), mass=mass, horizon=horizon))


def fit_base(problem: Problem) -> Based[Any]:
    """Viscous and Coulomb friction fitted: ``fit`` with its model, chi-square and residual, and what was fitted to.

    Raises InputError where nothing swings, SimulationError where no model could be simulated.
    """
    with _quiet():
        return pipeline.fit_base(problem)


def search(based: Based[Any], other: Judge | None = None) -> Found:
    """The smallest model of the catalogue that explains the recording, or what comes nearest: ``search.chosen``.

    ``search.singles`` has every name alone, best first. other : where a force is fitted, ``Judge.of`` this recording
    and another one, which must confirm each term. Raises SimulationError.
    """
    with _quiet():
        return pipeline.search(based, other)


def judge(found: Found) -> Judged:
    """The verdict, with the rules that decided: ``judgement``; the grades of each name where none explains all."""
    with _quiet():
        return pipeline.judge(found)


def explain(judged: Judged) -> Outcome:
    """All that is said of a verdict: mechanisms with numbers and places, prediction of what was held out, warnings."""
    with _quiet():
        return pipeline.explain(judged)


def statement(outcome: Outcome) -> str:
    """The verdict in a sentence or two, with numbers."""
    return sentence_of(outcome)


def _quiet() -> AbstractContextManager[None]:
    """A fit tries values far out, sees that they overflow, and turns back: nothing to tell anybody."""
    return np.errstate(over="ignore", invalid="ignore")
