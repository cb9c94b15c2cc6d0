"""Metrics of the motion under a harmonic force."""

import math

import numpy as np

from harness.core.arrays import IntArray
from harness.core.events import Mode
from harness.core.trajectory import Trajectory
from harness.fidelity.metrics.crossings import highest

LAST = 4
"""Periods at the end of a run that are measured."""


def measure_harmonic(trace: Trajectory, omega: float) -> dict[str, float | None]:
    """Every metric of a run under a force of this frequency (rad/s)."""
    inside = last_periods(trace, omega)
    return {"amplitude_m": amplitude_m(trace, inside), "stop_fraction": stop_fraction(trace, inside)}


def last_periods(trace: Trajectory, omega: float) -> list[IntArray]:
    """Indices of the samples of each of the last whole periods."""
    period = 2.0 * math.pi / omega
    whole = math.floor(trace.duration / period * (1.0 + 1e-9))
    starts = [k * period for k in range(max(0, whole - LAST), whole)]
    late = 1e-9 * period
    return [np.flatnonzero((trace.t >= start - late) & (trace.t < start + period - late)) for start in starts]


def amplitude_m(trace: Trajectory, inside: list[IntArray]) -> float | None:
    """Half of the distance between the turning points in m, mean over the last periods. Good: Den Hartog's."""
    if not inside:
        return None
    return float(np.mean([0.5 * (highest(trace.x[one]) + highest(-trace.x[one])) for one in inside]))


def stop_fraction(trace: Trajectory, inside: list[IntArray]) -> float | None:
    """Share of the last periods in which the friction force is not at its limit: the slider stops, or creeps.

    Good: the exact share, 0 where the motion has no stops.
    """
    if trace.mode is None or not inside:
        return None
    return float(np.mean(trace.mode[np.concatenate(inside)] == int(Mode.STICK)))
