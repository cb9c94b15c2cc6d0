"""What the time stamps of a recording are like, in sentences."""

import numpy as np

from harness.core.arrays import FloatArray

GAP = 5.0
"""An interval longer than this many medians is a gap."""
UNEVEN = 0.01
"""Intervals that vary by less than this share of their median are even."""


def sampling_notes(t: FloatArray) -> tuple[str, ...]:
    """Say what is irregular about times of shape (n,) in s, n >= 2; nothing when they are even."""
    steps = np.diff(t)
    median = float(np.median(steps))
    gaps = np.flatnonzero(steps > GAP * median)
    rest = steps[steps <= GAP * median]
    notes = []
    if rest.size and float(rest.max() - rest.min()) > UNEVEN * median + 4.0 * float(np.spacing(np.abs(t).max())):
        low, high = rest.min() * 1e3, rest.max() * 1e3
        notes.append(f"Sampling is irregular: intervals of {low:.3g} to {high:.3g} ms, median {median * 1e3:.3g} ms.")
    if gaps.size:
        longest = gaps[np.argmax(steps[gaps])]
        count = "is 1 gap" if gaps.size == 1 else f"are {gaps.size} gaps"
        notes.append(f"There {count} in time, the longest of {steps[longest]:.3g} s at t = {t[longest]:.4g} s.")
    return tuple(notes)
