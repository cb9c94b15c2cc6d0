"""The whole static force of a machine over position or speed: what a table of it measures, main effect and small ones.

A table cannot tell a spring's curve from that of a small effect that hangs on the position too. What counts is found by
asking each law: where it answers alike whatever else is varied, it is a curve.
"""

import math
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from harness.core.arrays import FloatArray
from harness.proof.plant.base import Base
from harness.proof.plant.effects import EFFECTS
from harness.proof.plant.model import ForceLaw, Level, Modulation

_ELSE = ((0.3, 0.7), (1.9, -0.4))
"""What else is varied, in units of the machine's own scales."""
_ALIKE = 1e-12
"""Of the largest answer: rounding."""


def base_of(truth: Mapping[str, Any]) -> Base:
    """The machine of an answer, of a free decay: released at the scale of its motion."""
    options = dict(zip(truth["options"][::2], truth["options"][1::2], strict=True))
    return Base(
        m=truth["m"],
        omega_n=truth["omega_n"],
        zeta=truth["zeta"],
        x_k=truth["x_k"],
        x0=truth["x0"],
        v0=0.0,
        length=abs(truth["x0"]),
        duration=1.0,
        samples=2,
        restoring=options.get("--restoring", "spring"),
    )


def static_force(truth: Mapping[str, Any]) -> FloatArray:
    """All static forces (n,) in N of the form of ``truth["table"]`` at its places: of x, of v, or friction by x."""
    base, form, at = base_of(truth), truth["table"]["form"], np.array(truth["table"]["at"])
    parts = [EFFECTS[name].build(values, base) for name, values in truth["plant"].items()]
    if form == "g(x) sgn v":
        modulations = tuple(m for one in parts for m in one.modulations if _is_curve(_modulation(m, base), at))
        level = Level(base.f_k, base.f_k, modulations=modulations)
        return np.array([level.sliding(0.0, x, 0.0, 0.0, 0.0) - base.f_k for x in at])
    along = _by_place if form == "f(x)" else _by_speed
    curves = [along(force.law, base) for one in parts for force in one.forces]
    if form == "f(v)":
        curves += [_falling(base, one.level) for one in parts if "v_s" in one.level]
    return np.asarray(
        sum((_values(curve, at, _ELSE[0]) for curve in curves if _is_curve(curve, at)), np.zeros(at.size))
    )


Curve = Callable[[float, tuple[float, float]], float]
"""What a law answers at a place or speed; then what else is varied, two numbers in the machine's own scales."""


def _by_place(law: ForceLaw, base: Base) -> Curve:
    return lambda x, other: law(other[0] / base.omega_n, x, other[1] * base.speed, math.copysign(1.0, other[1]))


def _by_speed(law: ForceLaw, base: Base) -> Curve:
    """Less what it answers at rest: that belongs to the zero of the position."""

    def curve(v: float, other: tuple[float, float]) -> float:
        t, x = other[0] / base.omega_n, other[1] * base.length
        return law(t, x, v, math.copysign(1.0, v)) - law(t, x, 0.0, 0.0)

    return curve


def _modulation(factor: Modulation, base: Base) -> Curve:
    def curve(x: float, other: tuple[float, float]) -> float:
        net = other[1] * base.force
        return factor(other[0] / base.omega_n, x, net, abs(net) * base.length)

    return curve


def _falling(base: Base, said: Mapping[str, float]) -> Curve:
    """What friction by speed is above its kinetic level, with the sign of the speed."""
    level = Level(base.f_k, said["f_s"], said["v_s"])
    return lambda v, other: math.copysign(level.sliding(0.0, 0.0, v, 0.0, 0.0) - base.f_k, v)


def _values(curve: Curve, at: FloatArray, other: tuple[float, float]) -> FloatArray:
    return np.array([curve(one, other) for one in at.tolist()])


def _is_curve(curve: Curve, at: FloatArray) -> bool:
    """Whether it answers alike whatever else is varied."""
    one, another = (_values(curve, at, other) for other in _ELSE)
    return bool(np.max(np.abs(one - another)) <= _ALIKE * np.max(np.abs(one)))
