"""Prediction of samples that took no part in the fits: every second full period, the trajectory running through."""

import math
from collections.abc import Sequence
from contextlib import suppress

import numpy as np

from harness.core.arrays import BoolArray
from harness.core.errors import SimulationError
from harness.diagnosis.evidence import evidence
from harness.diagnosis.fit import Fit, fit
from harness.diagnosis.observe import FINE, observe
from harness.diagnosis.outcome import Forced, Holdout, Spans
from harness.diagnosis.parameters import base_of, free_of
from harness.diagnosis.problem import Problem
from harness.diagnosis.screen import screen
from harness.diagnosis.spans import spans_of
from harness.kernels.solve import Scales
from harness.model.model import ModelTerm
from harness.model.registry import TERMS

_KEPT_IN = ("impulse", "sensor-clipping")
"""Effects whose own spans stay in the fit: nothing else in the recording shows them."""


def _held_out(problem: Problem, omega: float, keep: Spans) -> tuple[Spans, BoolArray]:
    """Spans of every second full period, and which samples lie in them and not in ``keep``."""
    t = problem.t
    period = 2.0 * math.pi / omega
    count = int((t[-1] - t[0]) / period)
    spans = [(float(t[0]) + i * period, float(t[0]) + (i + 1) * period) for i in range(1, count, 2)]
    out = np.zeros(t.size, dtype=bool)
    for low, high in spans:
        out |= (t >= low) & (t < high)
    for low, high in keep:
        out &= ~((t >= low) & (t <= high))
    return tuple(spans), out


def _rmse(found: Fit, problem: Problem, scales: Scales, out: BoolArray) -> dict[str, float]:
    """Root mean square of data minus prediction at the samples held out, fitted without them."""
    # where that fails the fit to all samples stands in; it can only flatter the side that failed
    with suppress(SimulationError):
        found = fit(found.model, problem.weighted(~out), found.free, scales, 15, thorough=False)
    shown = observe(found.model, problem, (), scales, FINE)
    return {c: float(np.sqrt(np.mean((y - shown.y[c])[out] ** 2))) for c, y in problem.channels.items()}


def _best_ranked(base: Fit, singles: Sequence[Fit], problem: Problem, scales: Scales) -> Fit | None:
    """The term that ranks first when nothing is missing: by BIC, else (no term was worth a fit) by its promise."""
    if singles:
        return singles[0]
    for candidate in screen(base, problem, evidence(base, problem, scales), scales, TERMS):
        with suppress(SimulationError):
            return fit(
                candidate.model, problem, free_of(candidate.model, base_of(base.free)), scales, 15, thorough=False
            )
    return None


def forced(base: Fit, singles: Sequence[Fit], problem: Problem, scales: Scales) -> Forced | None:
    """What the best-ranked term, forced into a base that needs none, does to the prediction of what was held out.

    singles : fits of one term each, best first. None when no term could be put in, or below two periods.
    """
    ranked = _best_ranked(base, singles, problem, scales)
    if ranked is None:
        return None
    entry = ranked.model.terms[-1]
    keep = spans_of(entry, ranked, problem, scales.omega) if entry.term.name in _KEPT_IN else ()
    _, out = _held_out(problem, scales.omega, keep)
    if not np.any(out):
        return None
    return Forced(entry.term.name, _rmse(base, problem, scales, out), _rmse(ranked, problem, scales, out))


def holdout(
    base: Fit, refined: Fit, problem: Problem, scales: Scales, acting: list[tuple[ModelTerm, Spans]]
) -> Holdout:
    """Held-out rmse by channel of the base model and the refined one; no spans below two periods."""
    keep = tuple(span for entry, spans in acting if entry.term.name in _KEPT_IN for span in spans)
    spans, out = _held_out(problem, scales.omega, keep)
    if not np.any(out):
        return Holdout((), {}, {})
    before = _rmse(base, problem, scales, out)
    after = before if refined is base else _rmse(refined, problem, scales, out)
    return Holdout(spans, before, after)
