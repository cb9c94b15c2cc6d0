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
from harness.diagnosis.fit.rmse import rmse
from harness.diagnosis.motion import place_of
from harness.diagnosis.outcome import Forced, Holdout
from harness.diagnosis.parameters import base_of, free_of
from harness.diagnosis.problem import Problem
from harness.diagnosis.problems.simulated import FINE, observe
from harness.diagnosis.search.look import evidence
from harness.diagnosis.search.screen import screen
from harness.diagnosis.stages import Judged
from harness.kernels.solve import Scales
from harness.model.model import Model
from harness.model.registry import USUAL
from harness.model.term import Spans

_TURNS = 5
"""Of five cycles one is held out, each in its turn."""
_SHOWN = 0.25
"""Share of its time in which an effect must act outside of what is held out, or its spans stay in the fit too."""


def periods_held_out(judged: Judged) -> Holdout:
    """Rmse by channel of what was held out, of the base and the refined model, and of one term too many where none is
    needed.

    No spans below two periods, nor where one of them cannot be fitted without what is held out, which is then said.
    """
    found, judgement, scales = judged.found.coarse, judged.judgement, judged.found.scales
    problem, base = found.problem, found.base
    refined = found.chosen if judgement.refined.model.terms else base
    prediction = Holdout.none()
    spans = _every(problem, scales, 0, 2)
    taken, keep = _inside(problem.t, spans), np.zeros(problem.t.size, dtype=bool)
    for entry in judgement.refined.model.terms:
        acts = _inside(
            problem.t, place_of(entry, judgement.refined, judged.found.search.problem, scales.omega).spans, True
        )
        # what is left of the recording would show too little of it to predict it elsewhere
        if entry.term.only_there or np.sum(acts & ~taken) < _SHOWN * np.sum(acts):
            keep |= acts
    out = taken & ~keep
    if np.any(out):
        before = _predicted(base, problem, scales, out)
        after = before if refined is base or before is None else _predicted(refined, problem, scales, out)
        if before is None or after is None:
            prediction = Holdout.none("base" if before is None else "refined")
        else:
            prediction = Holdout(spans, rmse(before, problem, out), rmse(after, problem, out))
    if judgement.verdict == "adequate":
        prediction = replace(prediction, forced=_forced(base, found.singles, problem, scales))
    return prediction


def _forced(base: Fit, singles: Sequence[Fit], problem: Problem, scales: Scales) -> Forced | None:
    """What the best-ranked term, forced into a base that needs none, does to the prediction of what was held out.

    singles : fits of one term each, best first. None when no term could be put in, below two periods, or
    where one of the two cannot be fitted without what is held out.
    """
    ranked = singles[0] if singles else _most_promising(base, problem, scales)
    if ranked is None:
        return None
    entry = ranked.model.terms[-1]
    turns = [_inside(problem.t, _every(problem, scales, begin, _TURNS)) for begin in range(1, _TURNS + 1)]
    if entry.term.only_there:
        turns = [out & ~_inside(problem.t, place_of(entry, ranked, problem, scales.omega).spans, True) for out in turns]
    after_events = np.searchsorted(problem.t, base.shown.events.t)
    beside = np.clip(np.concatenate([after_events, after_events - 1]), 0, problem.t.size - 1)
    every = np.any(turns, axis=0)
    every[beside] = False
    if not np.any(every):
        return None
    before, after = ({c: y.copy() for c, y in problem.channels.items()} for _ in range(2))
    # the base with the term at no effect, from where a fit can only improve on it; none where no value has none
    idle = next((i for i, p in enumerate(entry.term.parameters) if p.none is not None), None)
    other = None
    if idle is not None:
        values = [*entry.values]
        values[idle] = entry.term.parameters[idle].none or 0.0
        other = replace(base.model, terms=(replace(entry, values=tuple(values)),))
    for out in (out for out in turns if np.any(out)):
        one, two = _predicted(base, problem, scales, out), _predicted(ranked, problem, scales, out, other)
        if one is None or two is None:
            return None
        for c in problem.channels:
            before[c][out], after[c][out] = one[c][out], two[c][out]
    return Forced(entry.term.name, rmse(before, problem, every), rmse(after, problem, every))


def _most_promising(base: Fit, problem: Problem, scales: Scales) -> Fit | None:
    """A fit of the term that promises most where none was worth one."""
    for candidate in screen(base, problem, evidence(base, problem, scales), scales, USUAL):
        free = free_of(candidate.model, base_of(base.free))
        with suppress(SimulationError):
            return fit(candidate.model, problem, free, scales, 15, thorough=False)
    return None


def _every(problem: Problem, scales: Scales, begin: int, stride: int) -> Spans:
    """Full periods that lie whole within a recording: number ``begin`` and every ``stride``-th from there."""
    t, width = problem.t, 2.0 * math.pi / scales.omega
    start = float(t[0])
    return tuple(
        (start + i * width, start + (i + 1) * width) for i in range(begin, int((t[-1] - start) / width), stride)
    )


def _inside(t: FloatArray, spans: Spans, closed: bool = False) -> BoolArray:
    """Samples (n,) of t (n,), s, in spans; closed : whether a sample at the end of one counts."""
    found = np.zeros(t.size, dtype=bool)
    for low, high in spans:
        found |= (t >= low) & ((t <= high) if closed else (t < high))
    return found


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
