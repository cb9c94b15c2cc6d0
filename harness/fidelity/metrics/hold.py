"""Metrics of a static hold."""

from harness.core.trajectory import Trajectory


def measure_hold(trace: Trajectory) -> dict[str, float | None]:
    """Every metric of a hold."""
    return {"creep_m_s": creep_m_s(trace), "drift_m": drift_m(trace)}


def creep_m_s(trace: Trajectory) -> float:
    """Mean velocity in m/s over the later half of the hold, when what a soft contact needs to build up is over.

    Good: 0. MuJoCo creeps at F (1 - d0)/(d0 b m), in proportion to the load.
    """
    half = len(trace) // 2
    return float((trace.x[-1] - trace.x[half]) / (trace.t[-1] - trace.t[half]))


def drift_m(trace: Trajectory) -> float:
    """Distance in m from the start at the end, elastic give included. Good: 0."""
    return float(trace.x[-1] - trace.x[0])
