"""Metrics of stick-slip on a belt."""

import numpy as np

from harness.core.arrays import FloatArray, IntArray
from harness.core.events import Mode
from harness.core.trajectory import Trajectory
from harness.fidelity.metrics.crossings import falling

NEAR = 0.01
"""Speeds within this share of the belt's count as riding along (near_belt_fraction)."""
SKIPPED = 2
"""Slips at the start that are left out: an engine may still be settling into its own cycle."""


def measure_belt(trace: Trajectory, speed: float) -> dict[str, float | None]:
    """Every metric of a run on a belt of this speed (m/s); None where the trace has no such figure."""
    slips = slip_times(trace)
    inside = whole_cycles(trace, slips)
    return {
        "period_s": period_s(slips),
        "stick_fraction": stick_fraction(trace, inside),
        "near_belt_fraction": near_belt_fraction(trace, inside, speed),
        "stick_deviation_m_s": stick_deviation_m_s(trace, speed),
        "amplitude_m": amplitude_m(trace, inside),
    }


def slip_times(trace: Trajectory) -> FloatArray:
    """Times in s at which the slider slips back through the middle of its range: one a cycle, shape (n,).

    Positions are used because a contact that chatters during a slip turns its speed round many times.
    """
    middle = 0.5 * (float(np.max(trace.x)) + float(np.min(trace.x)))
    return falling(trace.t, trace.x - middle)[SKIPPED:]


def whole_cycles(trace: Trajectory, slips: FloatArray) -> IntArray:
    """Indices of the samples between the first and the last slip that count; none when there are not two."""
    if slips.size < 2:
        return np.empty(0, dtype=np.int64)
    return np.flatnonzero((trace.t >= slips[0]) & (trace.t < slips[-1]))


def period_s(slips: FloatArray) -> float | None:
    """Mean time from slip to slip in s; None with fewer than two slips. Good: the exact period within a step.

    An engine whose break-away is decided by a speed threshold does not converge to the exact period.
    """
    return float((slips[-1] - slips[0]) / (slips.size - 1)) if slips.size >= 2 else None


def stick_fraction(trace: Trajectory, inside: IntArray) -> float | None:
    """Share of whole cycles in which the friction force is not at its limit. Good: the exact share, 0.2830 here."""
    if trace.mode is None or not inside.size:
        return None
    return float(np.mean(trace.mode[inside] == int(Mode.STICK)))


def near_belt_fraction(trace: Trajectory, inside: IntArray, speed: float) -> float | None:
    """Share of whole cycles in which v is within 1 % of the belt's speed. Good: the exact share, 0.286 here.

    It exceeds the stick fraction, since a slip begins and ends slowly, and it needs no contact state.
    """
    if not inside.size:
        return None
    return float(np.mean(np.abs(trace.v[inside] - speed) <= NEAR * speed))


def stick_deviation_m_s(trace: Trajectory, speed: float) -> float | None:
    """Median |v - belt speed| in m/s over the samples that stick; None when none does. Good: below 1e-6."""
    if trace.mode is None:
        return None
    stuck = trace.mode == int(Mode.STICK)
    return float(np.median(np.abs(trace.v[stuck] - speed))) if stuck.any() else None


def amplitude_m(trace: Trajectory, inside: IntArray) -> float | None:
    """Half of the distance between the turning points in m. Good: the exact amplitude within a step of motion."""
    return float(0.5 * np.ptp(trace.x[inside])) if inside.size else None
