"""Metrics that only a contact has."""

import numpy as np

from harness.core.slider import Slider
from harness.core.trajectory import Trajectory

GRAVITY = 9.81
"""Gravity of the contact models, m/s^2."""


def measure_contact(trace: Trajectory, slider: Slider) -> dict[str, float | None]:
    """Every metric of the contact itself; empty for a trace without one."""
    if "normal_force" not in trace.extra:
        return {}
    return {
        "lift_m": lift_m(trace),
        "normal_error": normal_error(trace, slider),
        "mu_v_over_g_s": mu_v_over_g(trace, slider),
    }


def lift_m(trace: Trajectory) -> float:
    """Largest height above where it rested at the start, m; a soft floor lets it rest below 0. Good: below 1e-6."""
    height = trace.extra["lift"]
    return float(np.max(height) - height[0])


def normal_error(trace: Trajectory, slider: Slider) -> float:
    """Largest |N/(m g) - 1|. Good: below 1e-3; 1 means that the box leaves the floor."""
    return float(np.max(np.abs(trace.extra["normal_force"] / (slider.m * GRAVITY) - 1.0)))


def mu_v_over_g(trace: Trajectory, slider: Slider) -> float:
    """Largest coefficient of friction x speed / g in s: a cone solved as one lifts a box at its rate."""
    return float(slider.f_k / (slider.m * GRAVITY) * np.max(np.abs(trace.v)) / GRAVITY)
