"""Friction that is a curve over the sliding speed, as an engine is told of it."""

import numpy as np

from harness.core.arrays import FloatArray
from harness.core.jit import compiled
from harness.core.scenario import CurveBelt
from harness.core.slider import Slider
from harness.engines.forces import ForceLaw
from harness.engines.joint_words import JointWords, Kinds
from harness.model.term import Polynomial

# params of both: speed of the belt, f_k, f_s - f_k, v_s, c_2, c_3


@compiled
def level(t: float, x: float, v: float, state: FloatArray, params: FloatArray) -> float:
    """Level of dry friction at a speed v, N."""
    u = (v - params[0]) / params[3]
    return float(params[1] + params[2] * np.exp(-u * u))


@compiled
def viscous(t: float, x: float, v: float, state: FloatArray, params: FloatArray) -> float:
    """The polynomial, on the right-hand side, N."""
    u = v - params[0]
    return float(-u * (params[4] * abs(u) + params[5] * u * u))


def curve_of(slider: Slider, belt: CurveBelt, native: Kinds) -> tuple[ForceLaw, JointWords | None]:
    """What says a belt's curve to an engine whose joint, which lives in the belt's frame, has these native words.

    The level is a law that sets the limit of the engine's own friction in every step; the polynomial is said in words
    where the joint has them, else it is a force of that law.
    """
    numbers = np.array([belt.speed, slider.f_k, slider.break_away - slider.f_k, belt.v_s, belt.c_2, belt.c_3])
    if belt.c_2 == 0.0 == belt.c_3:
        return ForceLaw(None, level, params=numbers), None
    if Polynomial in native:
        return ForceLaw(None, level, params=numbers), JointWords(damping=(0.0, belt.c_2, belt.c_3))
    return ForceLaw(viscous, level, params=numbers), None
