"""When a named effect acts: time spans of a term that is bound to a place, the whole recording for the others."""

import math

import numpy as np

from harness.core.arrays import BoolArray, FloatArray
from harness.diagnosis.fit import Fit
from harness.diagnosis.outcome import Spans
from harness.diagnosis.problem import Problem
from harness.model.model import ModelTerm

_KNOCK_REACH = 0.25
"""Share of a period either side of a knock in which its mark on the motion is its own."""


def spans_where(t: FloatArray, inside: BoolArray) -> Spans:
    """Time spans (s) in which ``inside`` (n,) holds: each ends midway to the sample that is outside."""
    edges = np.flatnonzero(np.diff(np.concatenate(([False], inside, [False])).astype(np.int8)))
    between = np.concatenate((t[:1], 0.5 * (t[1:] + t[:-1]), t[-1:]))
    return tuple((float(between[a]), float(between[b])) for a, b in zip(edges[::2], edges[1::2], strict=True))


def spans_of(entry: ModelTerm, found: Fit, problem: Problem, omega: float) -> Spans:
    """When a term of a fitted model acts, by the model's own motion."""
    t, shown = problem.t, found.shown
    if entry.term.name == "end-stop":
        gap = entry.value("gap")
        sides = {"": np.abs(shown.x) > gap, "positive": shown.x > gap, "negative": shown.x < -gap}
        return spans_where(t, sides[entry.term.variant])
    if entry.term.name == "backlash":
        return spans_where(t, np.abs(shown.x) < entry.value("gap"))
    if entry.term.name == "sensor-clipping":
        return spans_where(t, np.abs(shown.y["a"]) >= entry.value("limit") * (1.0 - 1e-12))
    if entry.term.name == "impulse":
        reach = _KNOCK_REACH * 2.0 * math.pi / omega
        time = entry.value("time")
        return ((max(float(t[0]), time - reach), min(float(t[-1]), time + reach)),)
    return ((float(t[0]), float(t[-1])),)
