"""Dispatch of laws by number; generated from the registry by harness.kernels.generate, do not edit."""

from harness.core.arrays import FloatArray
from harness.core.jit import lean
from harness.kernels.layout import BRISTLES, INTERNAL, LEVELS, MODULATIONS, SMOOTH, SMOOTHED, laws

(
    _stribeck,
    _stribeck_free,
    _stribeck_free_tail,
) = laws(
    LEVELS,
    "stribeck",
    "stribeck:free",
    "stribeck:free-tail",
)


@lean
def speed_level(number: int, v: float, theta: FloatArray, o: int, out: FloatArray) -> None:
    """Level of friction by speed, and its partials."""
    if number == 0:
        _stribeck(v, theta, o, out)
    elif number == 1:
        _stribeck_free(v, theta, o, out)
    elif number == 2:
        _stribeck_free_tail(v, theta, o, out)


(
    _position_dependent_friction,
    _load_dependent_friction,
    _load_dependent_friction_gravity,
    _load_dependent_friction_across,
    _position_dependent_friction_periodic,
    _friction_drift,
    _friction_drift_free,
    _normal_load_variation,
    _normal_load_variation_free,
    _tabulated_friction_position,
    _given_friction,
) = laws(
    MODULATIONS,
    "position-dependent-friction",
    "load-dependent-friction",
    "load-dependent-friction:gravity",
    "load-dependent-friction:across",
    "position-dependent-friction:periodic",
    "friction-drift",
    "friction-drift:free",
    "normal-load-variation",
    "normal-load-variation:free",
    "tabulated-friction:position",
    "given-friction",
)


@lean
def modulation(number: int, x: float, v: float, t: float, theta: FloatArray, o: int, out: FloatArray) -> None:
    """Factor on f_k and its partials."""
    if number == 0:
        _position_dependent_friction(x, v, theta, o, out)
    elif number == 1:
        _load_dependent_friction(x, v, theta, o, out)
    elif number == 2:
        _load_dependent_friction_gravity(x, v, theta, o, out)
    elif number == 3:
        _load_dependent_friction_across(x, v, theta, o, out)
    elif number == 4:
        _position_dependent_friction_periodic(x, v, theta, o, out)
    elif number == 5:
        _friction_drift(x, v, t, theta, o, out)
    elif number == 6:
        _friction_drift_free(x, v, t, theta, o, out)
    elif number == 7:
        _normal_load_variation(x, v, t, theta, o, out)
    elif number == 8:
        _normal_load_variation_free(x, v, t, theta, o, out)
    elif number == 9:
        _tabulated_friction_position(x, v, theta, o, out)
    elif number == 10:
        _given_friction(x, v, t, theta, o, out)


(
    _presliding,
    _presliding_free,
    _presliding_free_yield,
) = laws(
    BRISTLES,
    "presliding",
    "presliding:free",
    "presliding:free-yield",
)


@lean
def bristle_law(
    number: int, v: float, side: int, z: float, level: float, theta: FloatArray, o: int, out: FloatArray
) -> None:
    """Friction of a bristle (row 0), its rate, and partials."""
    if number == 0:
        _presliding(v, side, z, level, theta, o, out)
    elif number == 1:
        _presliding_free(v, side, z, level, theta, o, out)
    elif number == 2:
        _presliding_free_yield(v, side, z, level, theta, o, out)


(
    _regularised_friction,
    _regularised_friction_free,
) = laws(
    SMOOTHED,
    "regularised-friction",
    "regularised-friction:free",
)


@lean
def smoothed_law(number: int, v: float, a: float, level: float, theta: FloatArray, o: int, out: FloatArray) -> None:
    """Friction without stick and without a state, and its partials."""
    if number == 0:
        _regularised_friction(v, a, level, theta, o, out)
    elif number == 1:
        _regularised_friction_free(v, a, level, theta, o, out)


(
    _quadratic_drag,
    _quadratic_drag_free,
    _asymmetric_viscous,
    _asymmetric_viscous_free,
    _power_law_damping,
    _power_law_damping_free,
    _power_law_damping_free_knee,
    _cubic_stiffness,
    _cubic_stiffness_free,
    _quadratic_stiffness,
    _quadratic_stiffness_free,
    _pendulum_stiffness,
    _end_stop,
    _end_stop_positive,
    _end_stop_negative,
    _end_stop_free,
    _end_stop_positive_free,
    _end_stop_negative_free,
    _backlash,
    _backlash_free,
    _stiffness_drift,
    _stiffness_drift_free,
    _constant_force,
    _force_ripple,
    _harmonic_force,
    _tabulated_stiffness,
    _tabulated_friction,
    _tabulated_friction_forward,
    _tabulated_friction_backward,
    _tabulated_force,
    _given_force,
    _given_damping,
) = laws(
    SMOOTH,
    "quadratic-drag",
    "quadratic-drag:free",
    "asymmetric-viscous",
    "asymmetric-viscous:free",
    "power-law-damping",
    "power-law-damping:free",
    "power-law-damping:free-knee",
    "cubic-stiffness",
    "cubic-stiffness:free",
    "quadratic-stiffness",
    "quadratic-stiffness:free",
    "pendulum-stiffness",
    "end-stop",
    "end-stop:positive",
    "end-stop:negative",
    "end-stop:free",
    "end-stop:positive-free",
    "end-stop:negative-free",
    "backlash",
    "backlash:free",
    "stiffness-drift",
    "stiffness-drift:free",
    "constant-force",
    "force-ripple",
    "harmonic-force",
    "tabulated-stiffness",
    "tabulated-friction",
    "tabulated-friction:forward",
    "tabulated-friction:backward",
    "tabulated-force",
    "given-force",
    "given-damping",
)


@lean
def smooth(number: int, x: float, v: float, t: float, theta: FloatArray, o: int, out: FloatArray) -> None:
    """Force on the left side and its partials."""
    if number == 0:
        _quadratic_drag(x, v, theta, o, out)
    elif number == 1:
        _quadratic_drag_free(x, v, theta, o, out)
    elif number == 2:
        _asymmetric_viscous(x, v, theta, o, out)
    elif number == 3:
        _asymmetric_viscous_free(x, v, theta, o, out)
    elif number == 4:
        _power_law_damping(x, v, theta, o, out)
    elif number == 5:
        _power_law_damping_free(x, v, theta, o, out)
    elif number == 6:
        _power_law_damping_free_knee(x, v, theta, o, out)
    elif number == 7:
        _cubic_stiffness(x, v, theta, o, out)
    elif number == 8:
        _cubic_stiffness_free(x, v, theta, o, out)
    elif number == 9:
        _quadratic_stiffness(x, v, theta, o, out)
    elif number == 10:
        _quadratic_stiffness_free(x, v, theta, o, out)
    elif number == 11:
        _pendulum_stiffness(x, v, theta, o, out)
    elif number == 12:
        _end_stop(x, v, theta, o, out)
    elif number == 13:
        _end_stop_positive(x, v, theta, o, out)
    elif number == 14:
        _end_stop_negative(x, v, theta, o, out)
    elif number == 15:
        _end_stop_free(x, v, theta, o, out)
    elif number == 16:
        _end_stop_positive_free(x, v, theta, o, out)
    elif number == 17:
        _end_stop_negative_free(x, v, theta, o, out)
    elif number == 18:
        _backlash(x, v, theta, o, out)
    elif number == 19:
        _backlash_free(x, v, theta, o, out)
    elif number == 20:
        _stiffness_drift(x, v, t, theta, o, out)
    elif number == 21:
        _stiffness_drift_free(x, v, t, theta, o, out)
    elif number == 22:
        _constant_force(x, v, theta, o, out)
    elif number == 23:
        _force_ripple(x, v, theta, o, out)
    elif number == 24:
        _harmonic_force(x, v, t, theta, o, out)
    elif number == 25:
        _tabulated_stiffness(x, v, theta, o, out)
    elif number == 26:
        _tabulated_friction(x, v, theta, o, out)
    elif number == 27:
        _tabulated_friction_forward(x, v, theta, o, out)
    elif number == 28:
        _tabulated_friction_backward(x, v, theta, o, out)
    elif number == 29:
        _tabulated_force(x, v, theta, o, out)
    elif number == 30:
        _given_force(x, v, t, theta, o, out)
    elif number == 31:
        _given_damping(x, v, t, theta, o, out)


(
    _viscoelastic,
    _viscoelastic_free,
    _attached_mode,
) = laws(
    INTERNAL,
    "viscoelastic",
    "viscoelastic:free",
    "attached-mode",
)


@lean
def internal(number: int, x: float, v: float, w0: float, w1: float, theta: FloatArray, o: int, out: FloatArray) -> None:
    """Force (row 0), rates of the states, and partials."""
    if number == 0:
        _viscoelastic(x, v, w0, w1, theta, o, out)
    elif number == 1:
        _viscoelastic_free(x, v, w0, w1, theta, o, out)
    elif number == 2:
        _attached_mode(x, v, w0, w1, theta, o, out)
