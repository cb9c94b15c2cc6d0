"""Prediction of samples that took no part in the fits: every second full period, the trajectory running through.

The first period is among them where something is missing: from smaller swings to the largest is the hardest way to
predict. A term that is forced in where nothing is missing has no such claim, and with the first swing out nothing would
hold its amplitude: there the first period stays, and of the others each fifth takes its turn at being held out.
Samples next to a reversal are not compared there: on which side of the jump one lies is a matter of microseconds.
"""

import math
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import replace

import numpy as np

from harness.core.arrays import BoolArray, FloatArray
from harness.core.errors import SimulationError
from harness.diagnosis.fit.model_fit import Fit, fit
from harness.diagnosis.fit.observe import FINE, observe
from harness.diagnosis.fit.parameters import base_of, free_of
from harness.diagnosis.fit.place import place_of
from harness.diagnosis.fit.rmse import rmse
from harness.diagnosis.outcome import Forced, Holdout
from harness.diagnosis.problem import Problem
from harness.diagnosis.search.look import evidence
from harness.diagnosis.search.screen import screen
from harness.diagnosis.search.search import Search
from harness.diagnosis.verdict import Judgement
from harness.kernels.solve import Scales
from harness.model.model import Model, ModelTerm
from harness.model.registry import NAMED
from harness.model.term import Place, Spans

_TURNS = 5
"""Of five cycles one is held out, each in its turn."""
_SHOWN = 0.25
"""Share of its time in which an effect must act outside of what is held out, or its spans stay in the fit too."""


def _periods(problem: Problem, omega: float) -> Spans:
    """Every second full period, the first one included."""
    return _every(problem.t, 2.0 * math.pi / omega, 0, 2)


def _turns(problem: Problem, omega: float) -> list[Spans]:
    """Every fifth full period, from each of the second to the sixth one on."""
    return [_every(problem.t, 2.0 * math.pi / omega, begin, _TURNS) for begin in range(1, _TURNS + 1)]


def _every(t: FloatArray, width: float, begin: int, stride: int) -> Spans:
    """Stretches of a width (s) that lie whole within t (n,), s: number ``begin`` and every ``stride``-th from there."""
    count, start = int((t[-1] - t[0]) / width), float(t[0])
    return tuple((start + i * width, start + (i + 1) * width) for i in range(begin, count, stride))


def _held_out(problem: Problem, spans: Spans, keep: Spans) -> BoolArray:
    """Samples in spans, and not in ``keep``."""
    t = problem.t
    out = np.zeros(t.size, dtype=bool)
    for low, high in spans:
        out |= (t >= low) & (t < high)
    for low, high in keep:
        out &= ~((t >= low) & (t <= high))
    return out


def _predicted(
    found: Fit, problem: Problem, scales: Scales, out: BoolArray, other: Model | None = None
) -> dict[str, FloatArray] | None:
    """Channels (n,) as a model predicts them that is fitted without the samples held out; None where that fails.

    other : a second model to start from; the fit that is nearer to what is not held out predicts.
    """
    kept, fits = problem.weighted(~out), []
    for model in (found.model, other):
        if model is not None:
            with suppress(SimulationError):
                fits.append(fit(model, kept, found.free, scales, 15, thorough=False))
    # a fit to all samples must not stand in: it would flatter the side that failed
    if fits:
        with suppress(SimulationError):
            return observe(min(fits, key=lambda f: f.chi2).model, problem, (), scales, FINE).y
    return None


def _best_ranked(base: Fit, singles: Sequence[Fit], problem: Problem, scales: Scales) -> Fit | None:
    """The term that ranks first when nothing is missing: by BIC, else (no term was worth a fit) by its promise."""
    if singles:
        return singles[0]
    for candidate in screen(base, problem, evidence(base, problem, scales), scales, NAMED):
        with suppress(SimulationError):
            return fit(
                candidate.model, problem, free_of(candidate.model, base_of(base.free)), scales, 15, thorough=False
            )
    return None


def forced(base: Fit, singles: Sequence[Fit], problem: Problem, scales: Scales) -> Forced | None:
    """What the best-ranked term, forced into a base that needs none, does to the prediction of what was held out.

    singles : fits of one term each, best first. None when no term could be put in, below two periods, or
    where one of the two cannot be fitted without what is held out.
    """
    ranked = _best_ranked(base, singles, problem, scales)
    if ranked is None:
        return None
    entry = ranked.model.terms[-1]
    keep = place_of(entry, ranked, problem, scales.omega).spans if entry.term.only_there else ()
    outs = [_held_out(problem, spans, keep) for spans in _turns(problem, scales.omega)]
    every = np.any(outs, axis=0) & ~_beside(problem.t, base.shown.events.t)
    if not np.any(every):
        return None
    before, after = ({c: y.copy() for c, y in problem.channels.items()} for _ in range(2))
    idle = _idle(ranked, base)
    for out in (out for out in outs if np.any(out)):
        one, other = _predicted(base, problem, scales, out), _predicted(ranked, problem, scales, out, idle)
        if one is None or other is None:
            return None
        for c in problem.channels:
            before[c][out], after[c][out] = one[c][out], other[c][out]
    return Forced(entry.term.name, rmse(before, problem, every), rmse(after, problem, every))


def _beside(t: FloatArray, events: FloatArray) -> BoolArray:
    """The samples (n,) of t (n,), s, on either side of each event (s)."""
    found = np.zeros(t.size, dtype=bool)
    after = np.searchsorted(t, events)
    found[np.clip(after, 0, t.size - 1)] = True
    found[np.clip(after - 1, 0, t.size - 1)] = True
    return found


def _idle(ranked: Fit, base: Fit) -> Model | None:
    """The base with a term at no effect, from where a fit can only improve on it; None where no value has none."""
    entry = ranked.model.terms[-1]
    none = next(((i, p.none) for i, p in enumerate(entry.term.parameters) if p.none is not None), None)
    if none is None:
        return None
    values = (*entry.values[: none[0]], none[1], *entry.values[none[0] + 1 :])
    return replace(base.model, terms=(replace(entry, values=values),))


def _shown_nowhere_else(entry: ModelTerm, place: Place, problem: Problem, taken: BoolArray) -> bool:
    """Whether what is left of a recording shows too little of an effect to predict it elsewhere."""
    acts = np.zeros(problem.t.size, dtype=bool)
    for low, high in place.spans:
        acts |= (problem.t >= low) & (problem.t <= high)
    return entry.term.only_there or bool(np.sum(acts & ~taken) < _SHOWN * np.sum(acts))


def holdout(
    base: Fit, refined: Fit, problem: Problem, scales: Scales, acting: Sequence[tuple[ModelTerm, Place]]
) -> Holdout:
    """Held-out rmse by channel of the base model and the refined one.

    No spans below two periods, nor where one of them cannot be fitted without what is held out, which is then said.
    """
    spans = _periods(problem, scales.omega)
    taken = _held_out(problem, spans, ())
    keep = tuple(span for entry, own in acting if _shown_nowhere_else(entry, own, problem, taken) for span in own.spans)
    out = _held_out(problem, spans, keep)
    if not np.any(out):
        return Holdout.none()
    before = _predicted(base, problem, scales, out)
    if before is None:
        return Holdout.none("base")
    after = before if refined is base else _predicted(refined, problem, scales, out)
    if after is None:
        return Holdout.none("refined")
    return Holdout(spans, rmse(before, problem, out), rmse(after, problem, out))


def periods_held_out(
    found: Search, judgement: Judgement, scales: Scales, acting: Sequence[tuple[ModelTerm, Place]]
) -> Holdout:
    """What was held out, predicted by the base and the refined model, and by one term too many where none is needed."""
    problem = found.problem
    refined = found.base if judgement.refined.model.terms == () else found.chosen
    prediction = holdout(found.base, refined, problem, scales, acting)
    if judgement.verdict == "adequate":
        prediction = replace(prediction, forced=forced(found.base, found.singles, problem, scales))
    return prediction
