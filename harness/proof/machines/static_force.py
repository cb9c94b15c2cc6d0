"""The whole static force of a machine over position or speed: what a table of it measures, main effect and small ones.

A table cannot tell a spring's curve from that of a small effect that hangs on the position too. What counts is found by
asking each law: where it answers alike whatever else is varied, it is a curve.
"""

import math
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np

from harness.core.arrays import FloatArray
from harness.proof.machines.laws import LAWS
from harness.proof.plant.base import Base

Law4 = Callable[[float, float, float, float], float]
_ELSE = ((0.3, 0.7), (1.9, -0.4))
"""What else is varied, in units of the machine's own scales."""
_ALIKE = 1e-12


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
    base, table = base_of(truth), truth["table"]
    at = np.array(table["at"])
    parts = {name: LAWS[name](values, base) for name, values in truth["plant"].items()}
    t0, x0, v0 = 1.0 / base.omega_n, base.length, base.speed
    if table["form"] == "g(x) sgn v":
        factor = np.ones(at.size)
        for modulation in (m for one in parts.values() for m in one.modulations):
            ways = [(t * t0, net * base.force, abs(net) * base.force * x0) for t, net in _ELSE]
            seen = [np.array([modulation(t, x, net, work) for x in at]) for t, net, work in ways]
            factor *= seen[0] if _alike(seen) else 1.0
        return base.f_k * (np.maximum(factor, 0.0) - 1.0)
    total = np.zeros(at.size)
    by_place = table["form"] == "f(x)"
    for law in (force.law for one in parts.values() for force in one.forces):
        seen = [_along(law, at, t * t0, other * (v0 if by_place else x0), by_place) for t, other in _ELSE]
        # one that hangs on nothing belongs to the zero of the position
        if _alike(seen) and (by_place or np.ptp(seen[0]) > 0.0):
            total += seen[0]
    return total if by_place else total + _stribeck(truth["plant"], base, at)


def _along(law: Law4, at: FloatArray, t: float, other: float, by_place: bool) -> FloatArray:
    if by_place:
        return np.array([law(t, x, other, math.copysign(1.0, other)) for x in at])
    return np.array([law(t, other, v, math.copysign(1.0, v)) for v in at])


def _alike(seen: Sequence[FloatArray]) -> bool:
    size = float(np.max(np.abs(seen[0])))
    return size > 0.0 and float(np.max(np.abs(seen[0] - seen[1]))) <= _ALIKE * size


def _stribeck(plant: Mapping[str, Any], base: Base, v: FloatArray) -> FloatArray:
    """What friction is above its kinetic level, with the sign of the speed."""
    said = plant.get("stribeck")
    if said is None:
        return np.zeros(v.size)
    return np.asarray(np.sign(v) * (said["f_s"] - base.f_k) * np.exp(-((v / said["v_s"]) ** 2)))
