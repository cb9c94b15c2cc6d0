"""Which base parameter recordings do not share: each in turn is made every recording's own, and fitted."""

from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass, replace

import numpy as np

from harness.core.errors import SimulationError
from harness.diagnosis.baseline.words import Strokes, evidence, words_of
from harness.diagnosis.fit.model_fit import Fit, fit
from harness.diagnosis.fit.parameters import base_of, free_of
from harness.diagnosis.problems.together import Together
from harness.kernels.solve import Scales
from harness.model.elsewhere import Elsewhere, named
from harness.model.model import Model

CANDIDATES = ("m", "k", "c", "f_k")
SAID = {"m": "inertia", "k": "stiffness", "c": "viscous damping", "f_k": "dry friction"}
"""What may differ, and what it is called."""


@dataclass(frozen=True, slots=True)
class Freed:
    """A model with one more parameter of each recording's own. gain : evidence over the one without."""

    stem: str
    problem: Together
    fit: Fit
    gain: float


def freed(found: Fit, problem: Together, scales: Scales, ratios: Sequence[float]) -> list[Freed]:
    """Every parameter that may differ, alone, most evidence first.

    ratios : of each further recording's stiffness per mass over the first's, as the base fits alone say.
    """
    words = words_of(Strokes.between(problem.turns(found.shown.v), problem.t.size))
    seen = []
    for stem in CANDIDATES:
        if stem in problem.starts.own:
            continue
        with suppress(SimulationError):
            better = _fitted(found, problem, scales, stem, ratios)
            more = len(ratios)
            gain = evidence(found.chi2, better.chi2, words, more, float(len(CANDIDATES)))
            seen.append(Freed(stem, problem.with_own((*problem.starts.own, stem)), better, gain))
    return sorted(seen, key=lambda one: -one.gain)


def _fitted(found: Fit, problem: Together, scales: Scales, stem: str, ratios: Sequence[float]) -> Fit:
    best: Fit | None = None
    why: SimulationError | None = None
    for model in _begun(found.model, stem, ratios):
        names = [named(stem, r) for r in range(1, len(ratios) + 1)]
        try:
            one = fit(model, problem, free_of(model, (*base_of(found.free), *names)), scales, thorough=False)
        except SimulationError as error:
            why = error
            continue
        if best is None or one.chi2 < best.chi2:
            best = one
    if best is None:
        raise why or SimulationError("no start")
    return best


def _begun(model: Model, stem: str, ratios: Sequence[float]) -> list[Model]:
    """From where all are alike, and from where the frequencies that are seen alone would come of this parameter."""
    value = float(getattr(model, stem))
    alike = [value] * len(ratios)
    moved = {"m": [value / ratio for ratio in ratios], "k": [value * ratio for ratio in ratios]}.get(stem, alike)
    tries = [alike] if np.array_equal(alike, moved) else [alike, moved]
    return [_having(model, stem, values) for values in tries]


def _having(model: Model, stem: str, values: Sequence[float]) -> Model:
    further = [one.having(**{stem: v}) for one, v in zip(model.elsewhere, values, strict=True)]
    return replace(model, elsewhere=tuple(Elsewhere(one.values) for one in further))
