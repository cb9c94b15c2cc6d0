"""Words of a fitted force: its strokes, cut where they outlast what the residual remembers, repeats not counted."""

import math
from dataclasses import dataclass

import numpy as np

from harness.core.arrays import FloatArray, IntArray
from harness.diagnosis.baseline.words import Strokes
from harness.diagnosis.problems.measured import BLOCK, Measured
from harness.diagnosis.rules import DRIVE_REPEATS, MOST_WORDS, PERIODS_COUNTED, STROKE_CUT
from harness.fit.series import Memory

_LOOKED_AT = 2000
"""Values of the force in which a period is looked for."""
_APART = 0.5
"""Share of squares by which a force must first differ from itself; before, it has not moved yet."""
_EVEN = 0.05
"""Share of the interval by which times may differ for a period to be looked for."""


@dataclass(frozen=True, slots=True)
class ForceWords:
    """pieces : of strokes, over the blocks that count. words : independent ones, bounded. period : s, of the drive,
    the first of several that repeats itself; None where none does.
    """

    pieces: Strokes
    words: float
    period: float | None


def force_words(memory: Memory, measured: Measured) -> ForceWords:
    """Words of what a model leaves of a force; memory : of that."""
    t = measured.blocks(measured.t)
    strokes = _parted(Strokes.by(measured.blocks(measured.v)).of, measured.begins)
    of = _cut(strokes, STROKE_CUT.value * memory.time)
    periods = [period_of(one) for one in measured.each]
    counted = np.split(np.arange(t.size), measured.begins)
    last = [
        math.inf if period is None else float(t[own[0]]) + PERIODS_COUNTED.value * period
        for period, own in zip(periods, counted, strict=True)
    ]
    pieces = float(sum(np.unique(of[own][t[own] <= end]).size for own, end in zip(counted, last, strict=True)))
    period = next((one for one in periods if one is not None), None)
    words = max(min(pieces, memory.independent, MOST_WORDS.value), 1.0)
    return ForceWords(Strokes(of, int(of[-1]) + 1), words, period)


def _parted(stroke: IntArray, begins: tuple[int, ...]) -> IntArray:
    """Strokes (n,), numbered on, none of which reaches over the beginning of a further recording."""
    more = np.zeros(stroke.size, dtype=np.int64)
    for begin in begins:
        more[begin] = stroke[begin] == stroke[begin - 1]
    return np.asarray(stroke + np.cumsum(more), dtype=np.int64)


def _cut(stroke: IntArray, least: float) -> IntArray:
    """Pieces (n,) of strokes (n,), numbered on, each at least so many values long or a whole stroke."""
    counts = np.bincount(stroke)
    parts = np.maximum((counts / least).astype(np.int64), 1)
    begins = np.concatenate(([0], np.cumsum(counts)[:-1]))
    inside = np.arange(stroke.size) - begins[stroke]
    before = np.concatenate(([0], np.cumsum(parts)[:-1]))
    return np.asarray(before[stroke] + inside * parts[stroke] // counts[stroke], dtype=np.int64)


def period_of(measured: Measured) -> float | None:
    """The period (s) after which the force repeats itself, None where it does not within half of the recording."""
    t, u = (y.reshape(-1, BLOCK).mean(axis=1) for y in (measured.t, measured.u))
    step = np.diff(t)
    if np.ptp(step) > _EVEN * float(np.median(step)):
        return None
    apart = _differences(u)
    moved = np.flatnonzero(apart > _APART)
    if not moved.size:
        return None
    again = np.flatnonzero(apart[moved[0] :] < DRIVE_REPEATS.value)
    if not again.size:
        return None
    # the bottom of the first dip
    first = moved[0] + again[0]
    ends = np.flatnonzero(apart[first:] >= DRIVE_REPEATS.value)
    dip = apart[first : first + (ends[0] if ends.size else apart.size)]
    return float(np.median(step)) * float(first + np.argmin(dip))


def _differences(u: FloatArray) -> FloatArray:
    """Mean square between a series (n,) and itself each lag earlier, over twice its variance, up to half of it."""
    size, half = u.size, u.size // 2
    some = np.linspace(0, size - 1 - half, min(size - half, _LOOKED_AT)).astype(np.int64)
    spread = 2.0 * max(float(np.var(u)), 1e-300)
    return np.array([float(np.mean((u[some + lag] - u[some]) ** 2)) / spread for lag in range(half + 1)])
