"""Dispatch of laws by number; generated from the registry by harness.kernels.generate, do not edit."""

from harness.core.arrays import FloatArray
from harness.core.jit import compiled
from harness.model.terms import (
    asymmetric_viscous,
    attached_mode,
    backlash,
    constant_force,
    cubic_stiffness,
    end_stop,
    force_ripple,
    friction_drift,
    harmonic_force,
    normal_load_variation,
    pendulum_stiffness,
    position_dependent_friction_cosine,
    position_dependent_friction_slope,
    power_law_damping,
    quadratic_drag,
    quadratic_stiffness,
    stiffness_drift,
    viscoelastic,
)

_position_dependent_friction = compiled(position_dependent_friction_slope.law, lean=True)
_position_dependent_friction_periodic = compiled(position_dependent_friction_cosine.law, lean=True)
_friction_drift = compiled(friction_drift.law, lean=True)
_normal_load_variation = compiled(normal_load_variation.law, lean=True)
_quadratic_drag = compiled(quadratic_drag.law, lean=True)
_asymmetric_viscous = compiled(asymmetric_viscous.law, lean=True)
_power_law_damping = compiled(power_law_damping.law, lean=True)
_cubic_stiffness = compiled(cubic_stiffness.law, lean=True)
_quadratic_stiffness = compiled(quadratic_stiffness.law, lean=True)
_pendulum_stiffness = compiled(pendulum_stiffness.law, lean=True)
_end_stop = compiled(end_stop.law_both, lean=True)
_end_stop_positive = compiled(end_stop.law, lean=True)
_end_stop_negative = compiled(end_stop.law_negative, lean=True)
_backlash = compiled(backlash.law, lean=True)
_stiffness_drift = compiled(stiffness_drift.law, lean=True)
_constant_force = compiled(constant_force.law, lean=True)
_force_ripple = compiled(force_ripple.law, lean=True)
_harmonic_force = compiled(harmonic_force.law, lean=True)
_viscoelastic = compiled(viscoelastic.law, lean=True)
_attached_mode = compiled(attached_mode.law, lean=True)


def _modulation(number: int, x: float, v: float, t: float, theta: FloatArray, o: int, out: FloatArray) -> None:
    """Factor on f_k and its partials."""
    if number == 0:
        _position_dependent_friction(x, v, t, theta, o, out)
    elif number == 1:
        _position_dependent_friction_periodic(x, v, t, theta, o, out)
    elif number == 2:
        _friction_drift(x, v, t, theta, o, out)
    elif number == 3:
        _normal_load_variation(x, v, t, theta, o, out)


modulation = compiled(_modulation, lean=True)


def _smooth(number: int, x: float, v: float, t: float, theta: FloatArray, o: int, out: FloatArray) -> None:
    """Force on the left side and its partials."""
    if number == 0:
        _quadratic_drag(x, v, t, theta, o, out)
    elif number == 1:
        _asymmetric_viscous(x, v, t, theta, o, out)
    elif number == 2:
        _power_law_damping(x, v, t, theta, o, out)
    elif number == 3:
        _cubic_stiffness(x, v, t, theta, o, out)
    elif number == 4:
        _quadratic_stiffness(x, v, t, theta, o, out)
    elif number == 5:
        _pendulum_stiffness(x, v, t, theta, o, out)
    elif number == 6:
        _end_stop(x, v, t, theta, o, out)
    elif number == 7:
        _end_stop_positive(x, v, t, theta, o, out)
    elif number == 8:
        _end_stop_negative(x, v, t, theta, o, out)
    elif number == 9:
        _backlash(x, v, t, theta, o, out)
    elif number == 10:
        _stiffness_drift(x, v, t, theta, o, out)
    elif number == 11:
        _constant_force(x, v, t, theta, o, out)
    elif number == 12:
        _force_ripple(x, v, t, theta, o, out)
    elif number == 13:
        _harmonic_force(x, v, t, theta, o, out)


smooth = compiled(_smooth, lean=True)


def _internal(
    number: int, x: float, v: float, w0: float, w1: float, theta: FloatArray, o: int, out: FloatArray
) -> None:
    """Force (row 0), rates of the states, and partials."""
    if number == 0:
        _viscoelastic(x, v, w0, w1, theta, o, out)
    elif number == 1:
        _attached_mode(x, v, w0, w1, theta, o, out)


internal = compiled(_internal, lean=True)
