"""Names that a machine may hide: the plant's, load-dependent friction, and effects that no catalogue holds."""

from collections.abc import Mapping

from harness.proof.plant import catalogue as plant

FAMILY = {**plant.FAMILY, "load-dependent-friction": "friction"}
NAMES = tuple(FAMILY)

UNKNOWN = {
    "alien-position-viscous": ("damping",),
    "alien-warming-viscous": ("damping",),
    "alien-quintic-stiffness": ("stiffness",),
    "alien-parametric-stiffness": ("stiffness", "environment"),
    "alien-speed-stiffness": ("stiffness", "damping"),
    "alien-heating": ("friction",),
    "alien-inertial-load": ("friction",),
    "alien-hysteresis": ("friction", "damping", "stiffness"),
    "alien-random-force": ("environment",),
    "alien-eccentric-encoder": ("sensor",),
}
"""Effects of no catalogue, with the families that would not be wrong."""

STATIC = {
    "alien-magnet-well": ("stiffness", "environment"),
    "alien-soft-bumper": ("stiffness",),
    "alien-softening": ("stiffness",),
    "alien-bilinear-spring": ("stiffness",),
    "alien-eddy-brake": ("damping", "friction"),
    "alien-speed-hump": ("damping", "friction"),
    "alien-flow-transition": ("damping",),
    "alien-one-way-drag": ("damping",),
    "alien-sticky-patch": ("friction",),
    "alien-edge-rub": ("friction",),
    "alien-half-rub": ("friction",),
}
"""Static laws of no catalogue, which a tabulated force can hold."""

ALIENS = {**UNKNOWN, **STATIC}

NEEDS = {**plant.NEEDS, "alien-eccentric-encoder": "x"}
"""Channels without which an effect does not show at all."""

FROM_ZERO = ("constant-force", "end-stop", "backlash", "alien-soft-bumper")
"""Laws bound to the unstretched spring: where one is the main effect, x may well be measured from there."""

DRY = (
    "stribeck",
    "static-friction",
    "presliding",
    "regularised-friction",
    "position-dependent-friction",
    "friction-drift",
    "normal-load-variation",
    "load-dependent-friction",
    "alien-heating",
    "alien-inertial-load",
    "alien-sticky-patch",
    "alien-edge-rub",
    "alien-half-rub",
)
"""Laws that act through dry friction: without a level of it they are nothing."""


def compatible(first: str, second: str) -> bool:
    """Whether two effects can be hidden in one recording."""
    return plant.compatible(first, second)


def families(name: str) -> tuple[str, ...]:
    """Families of an effect that would not be wrong, its own first."""
    return ALIENS[name] if name in ALIENS else (FAMILY[name],)


PARTED_BY_AMPLITUDE = (("quadratic-drag", "load-dependent-friction"), ("stiffness-drift", "cubic-stiffness"))
"""Effects that a single decay does not tell apart once small ones are beside them."""

OF_A_DRIVE: Mapping[str, Mapping[str, float]] = {
    "stribeck": {"f_s": 2.5, "v_s": 0.1},
    "quadratic-drag": {"c2": 2.0},
    "asymmetric-viscous": {"c_diff": 1.2},
}
"""Effects of a slider of 2 kg under some 10 N, at strengths that leave some per cent of that; parameters in SI."""
