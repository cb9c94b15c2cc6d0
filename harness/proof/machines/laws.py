"""Laws that the plant of the blind proof does not have: each from its parameters to the pieces it adds.

Every one has its strength in ``size``; a static one is a curve of x or v, so that what a table finds can be held
against it.
"""

import math
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from harness.proof.plant import hidden
from harness.proof.plant.base import Base
from harness.proof.plant.hidden import Law, Pieces
from harness.proof.plant.modulations import growing_outwards
from harness.proof.plant.pieces import Branch, Force

Values = Mapping[str, Any]
Curve = Callable[[float], float]
ECCENTRIC = "alien-eccentric-encoder"


def _well(p: Values, b: Base) -> Curve:
    """A magnet that pulls towards x = place: size N at width from it, nothing far away."""
    place, width = p["place"], p["width"]
    return lambda x: p["size"] * (x - place) / width * math.exp(0.5 - 0.5 * ((x - place) / width) ** 2)


def _bumper(p: Values, b: Base) -> Curve:
    """size ((x - gap)/length)^2 beyond the gap, on one side."""
    side, gap = p["side"], p["gap"]
    return lambda x: side * p["size"] * (max(side * x - gap, 0.0) / b.length) ** 2


def _softening(p: Values, b: Base) -> Curve:
    """size tanh(x/width): stiff about the middle, then saturated."""
    return lambda x: float(p["size"] * math.tanh(x / p["width"]))


def _bilinear(p: Values, b: Base) -> Curve:
    """size |x|/length: stiffer on one side."""
    return lambda x: float(p["size"] * abs(x) / b.length)


def _eddy(p: Values, b: Base) -> Curve:
    """A magnetic brake: 2 size (v/v_c)/(1 + (v/v_c)^2), largest at v_c."""
    return lambda v: float(2.0 * p["size"] * (v / p["v_c"]) / (1.0 + (v / p["v_c"]) ** 2))


def _hump(p: Values, b: Base) -> Curve:
    """More drag about one speed: size (r exp((1 - r^2)/2))^sharp sgn v with r = |v|/v_c."""

    def curve(v: float) -> float:
        r = abs(v) / p["v_c"]
        return math.copysign(p["size"] * (r * math.exp(0.5 * (1.0 - r * r))) ** p["sharp"], v)

    return curve


def _transition(p: Values, b: Base) -> Curve:
    """Damping that sets in above v_c: size (|v| - v_c)/speed sgn v."""
    return lambda v: math.copysign(p["size"] * max(abs(v) - p["v_c"], 0.0) / b.speed, v)


def _one_way(p: Values, b: Base) -> Curve:
    """Drag in one direction alone: size (v/speed)^2."""
    return lambda v: float(p["side"] * p["size"] * (max(p["side"] * v, 0.0) / b.speed) ** 2)


def _patch(p: Values, b: Base) -> Curve:
    """A place that rubs: size exp(-((x - place)/width)^2)."""
    return lambda x: float(p["size"] * math.exp(-(((x - p["place"]) / p["width"]) ** 2)))


def _edge(p: Values, b: Base) -> Curve:
    """Rubs at the ends of the travel: size (x/length)^4."""
    return lambda x: float(p["size"] * (x / b.length) ** 4)


def _half(p: Values, b: Base) -> Curve:
    """Rubs beyond a place: size/(1 + exp(-(x - place)/width))."""
    return lambda x: float(p["size"] / (1.0 + math.exp(-(x - p["place"]) / p["width"])))


CURVES: dict[str, tuple[str, Callable[[Values, Base], Curve]]] = {
    "alien-magnet-well": ("f(x)", _well),
    "alien-soft-bumper": ("f(x)", _bumper),
    "alien-softening": ("f(x)", _softening),
    "alien-bilinear-spring": ("f(x)", _bilinear),
    "alien-eddy-brake": ("f(v)", _eddy),
    "alien-speed-hump": ("f(v)", _hump),
    "alien-flow-transition": ("f(v)", _transition),
    "alien-one-way-drag": ("f(v)", _one_way),
    "alien-sticky-patch": ("g(x) sgn v", _patch),
    "alien-edge-rub": ("g(x) sgn v", _edge),
    "alien-half-rub": ("g(x) sgn v", _half),
}
"""Static laws: what they are a curve of, and the curve, N."""


def _kinks(name: str, p: Values) -> tuple[float, ...]:
    if name == "alien-soft-bumper":
        return (p["side"] * p["gap"],)
    return (0.0,) if name == "alien-bilinear-spring" else ()


def _static(name: str) -> Law:
    form, make = CURVES[name]

    def law(p: Values, b: Base) -> Pieces:
        curve = make(p, b)
        if form == "f(x)":
            return Pieces(forces=(Force(lambda t, x, v, d: curve(x), kinks=_kinks(name, p)),))
        if form == "f(v)":
            return Pieces(forces=(Force(lambda t, x, v, d: curve(v)),))
        return Pieces(modulations=(lambda t, x, net, work: 1.0 + curve(x) / b.f_k,))

    return law


def _hysteresis(p: Values, b: Base) -> Branch:
    """Internal friction of a material: f = size z, z' = (v - |v| z)/reach, beside the friction of the guide."""
    return Branch(
        start=lambda x0, v0: (0.0,),
        derivative=lambda x, v, own: ((v - abs(v) * own[0]) / p["reach"],),
        force=lambda x, v, own: p["size"] * own[0],
    )


def _force(law: Callable[[float, float, float, float], float], rate: float = 0.0) -> Pieces:
    return Pieces(forces=(Force(law, rate=rate),))


def _parametric(p: Values, b: Base) -> Pieces:
    return _force(lambda t, x, v, d: p["size"] * math.cos(p["Omega"] * t + p["phase"]) * x / b.length, rate=p["Omega"])


LAWS: dict[str, Law] = {
    **{name: law for name, law in hidden.BUILD.items() if name not in ("alien-structural-damping", "alien-rattle")},
    "load-dependent-friction": lambda p, b: Pieces(modulations=(growing_outwards(p["gain"], b.length),), kinks=(0.0,)),
    "alien-position-viscous": lambda p, b: _force(lambda t, x, v, d: p["size"] * (x / b.length) ** 2 * v / b.speed),
    "alien-warming-viscous": lambda p, b: _force(
        lambda t, x, v, d: p["size"] * -math.expm1(-t / p["tau"]) * v / b.speed
    ),
    "alien-quintic-stiffness": lambda p, b: _force(lambda t, x, v, d: p["size"] * (x / b.length) ** 5),
    "alien-parametric-stiffness": _parametric,
    "alien-hysteresis": lambda p, b: Pieces(branches=(_hysteresis(p, b),)),
    ECCENTRIC: lambda p, b: Pieces(),
    **{name: _static(name) for name in CURVES},
}
"""What a name builds. An eccentric encoder adds nothing to the motion: it is in what is read."""


def table(
    name: str, p: Values, b: Base, x: tuple[float, float], v: tuple[float, float], points: int = 201
) -> dict[str, Any]:
    """The true curve of a static law over the swept range of x (m) or v (m/s); the force in N."""
    form, make = CURVES[name]
    curve = make(p, b)
    grid = np.linspace(*(v if form == "f(v)" else x), points)
    return {"form": form, "at": grid.tolist(), "force": [curve(float(one)) for one in grid]}
