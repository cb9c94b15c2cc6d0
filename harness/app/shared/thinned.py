"""A free motion of more samples than anything could be learnt from: every so many of them are looked at.

What a fit takes in memory goes with its samples. Where neighbours that are left out say nothing that those kept do not,
but for the noise, thinning loses errors in the sixth digit and bounds what a command takes.
"""

from dataclasses import replace

import numpy as np

from harness.core.arrays import FloatArray
from harness.core.recording import Recording

MOST = 1_000_000
"""Samples that are looked at. A diagnosis takes 1.6 kB for each, a comparison 0.9 kB: docs/scale.md."""
_NOISE, _SMOOTH = 1.1, 1e-3
"""Samples half way between kept ones may lie off the line between these by so many times what neighbours do, or by so
much of what the channel moves: there are 70 a period then."""


def thinned(recording: Recording) -> Recording:
    """Every k-th sample of a recording of more than ``MOST``, with a note; the same where it is shorter.

    The same too where the motion is too fast for its sampling to be thinned, and where a force was measured: what that
    does between samples is part of what moved the machine.
    """
    step = -(-len(recording) // MOST)
    if step < 2 or "u" in recording:
        return recording
    if not all(_dense(values, step) for values in recording.channels.values()):
        return recording
    note = f"Of {len(recording)} samples each {step}th is looked at: those between lie on the line but for the noise."
    return replace(recording.cut(slice(None, None, step)), notes=(*recording.notes, note))


def _dense(y: FloatArray, step: int) -> bool:
    """Whether samples between each ``step``-th lie on the line between those, but for the noise."""
    next_to, between = (_off(y, lag) for lag in (1, max(step // 2, 1)))
    return bool(between**2 <= (_NOISE * next_to) ** 2 + (_SMOOTH * float(np.std(y))) ** 2)


def _off(y: FloatArray, lag: int) -> float:
    """How far samples lie off the middle of two neighbours ``lag`` away: all but one in a hundred, next to a jump."""
    off = y[lag:-lag] - 0.5 * (y[: -2 * lag] + y[2 * lag :])
    return float(np.quantile(np.abs(off), 0.99))
