"""Metrics of a free decay: what the estimators read from it."""

from harness.core.errors import InputError
from harness.core.scenario import Scenario
from harness.core.trajectory import Trajectory
from harness.estimate.every import estimate_all
from harness.estimate.result import Estimation

WIDE, NARROW = "acceleration", "acceleration-local"
"""Read outside a guard on each side of a reversal, and at the reversal itself."""


def recovered(trace: Trajectory, scenario: Scenario) -> dict[str, float | None]:
    """What the estimators read against what was put in; None where they refuse.

    Good: x_k_rel_error and zeta_rel_error below 1e-3. x_k_local_rel_error near 0 means that friction jumps at the
    reversal; near -1, that the engine spreads the jump so far that a sample before and one after do not see it.
    """
    slider = scenario.slider
    try:
        estimates = estimate_all(trace.t, trace.x, trace.v, trace.a)
    except InputError:  # nothing that an estimator could read
        return dict.fromkeys(("x_k_m", "zeta", "x_k_local_m"))
    x_k, local = _x_k(estimates, WIDE), _x_k(estimates, NARROW)
    zeta = estimates[WIDE].zeta.value
    found = {"x_k_m": x_k, "zeta": zeta, "x_k_local_m": local}
    if slider.zeta > 0.0:
        found["zeta_rel_error"] = None if zeta is None else zeta / slider.zeta - 1.0
    if slider.x_k > 0.0:
        found["x_k_rel_error"] = None if x_k is None else x_k / slider.x_k - 1.0
        found["x_k_local_rel_error"] = None if local is None else local / slider.x_k - 1.0
    return found


def _x_k(estimates: Estimation, method: str) -> float | None:
    return estimates[method].x_k.value
