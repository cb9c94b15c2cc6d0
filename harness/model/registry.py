"""The catalogue by name: every term, in a fixed order that the compiled dispatch follows."""

from harness.core.errors import InputError
from harness.model.term import Slot, Term
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
    impulse,
    normal_load_variation,
    pendulum_stiffness,
    position_dependent_friction_cosine,
    position_dependent_friction_slope,
    power_law_damping,
    presliding,
    quadratic_drag,
    quadratic_stiffness,
    regularised_friction,
    sensor_bias,
    sensor_clipping,
    sensor_drift,
    sensor_gain,
    sensor_lag,
    static_friction,
    stiffness_drift,
    stribeck,
    viscoelastic,
)

TERMS: tuple[Term, ...] = (
    stribeck.TERM,
    static_friction.TERM,
    presliding.TERM,
    regularised_friction.TERM,
    position_dependent_friction_slope.TERM,
    position_dependent_friction_cosine.TERM,
    friction_drift.TERM,
    normal_load_variation.TERM,
    quadratic_drag.TERM,
    asymmetric_viscous.TERM,
    power_law_damping.TERM,
    viscoelastic.TERM,
    cubic_stiffness.TERM,
    quadratic_stiffness.TERM,
    pendulum_stiffness.TERM,
    end_stop.TERM,
    end_stop.TERM_POSITIVE,
    end_stop.TERM_NEGATIVE,
    backlash.TERM,
    stiffness_drift.TERM,
    constant_force.TERM,
    force_ripple.TERM,
    harmonic_force.TERM,
    impulse.TERM,
    attached_mode.TERM,
    sensor_lag.TERM,
    sensor_gain.TERM,
    sensor_bias.TERM,
    sensor_drift.TERM,
    sensor_clipping.TERM,
)

_BY_KEY = {term.key: term for term in TERMS}


def term(key: str) -> Term:
    """The term of this key ("end-stop", "end-stop:positive"); InputError lists the names there are."""
    found = _BY_KEY.get(key)
    if found is None:
        raise InputError("term", f"{key!r} is not in the catalogue", f"one of {', '.join(_BY_KEY)} is accepted")
    return found


def of_slot(slot: Slot) -> tuple[Term, ...]:
    """The terms of one slot, in catalogue order: the order of their numbers in the compiled dispatch."""
    return tuple(t for t in TERMS if t.slot is slot)


def catalogue_names() -> tuple[str, ...]:
    """Catalogue names without variants, in order."""
    return tuple(dict.fromkeys(t.name for t in TERMS))
