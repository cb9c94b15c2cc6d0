"""What presses a box on its floor, and the coefficient that makes of it a given friction."""

from harness.core.slider import Slider

GRAVITY = 9.81
"""Gravity of the contact models, m/s^2."""


def coefficient(slider: Slider, force: float | None = None) -> float:
    """Coefficient of friction that turns weight into ``force`` (N), f_k when not given: f / (m g)."""
    return (slider.f_k if force is None else force) / (slider.m * GRAVITY)
