"""What a machine may hide besides what a slider on a bench may, and how strong: a first draw, made stronger or weaker.

The strength of an effect of no catalogue is its ``size``; a static one is a curve of x or v, so that what a table finds
can be held against it.
"""

import math
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np

from harness.proof.plant.base import Base, log_uniform
from harness.proof.plant.effects import (
    BENCH,
    Curve,
    Draw,
    Effect,
    Pieces,
    Values,
)
from harness.proof.plant.effects import KNOWN as ON_A_BENCH
from harness.proof.plant.model import Branch, Force, ForceLaw

ECCENTRIC = "alien-eccentric-encoder"


def _sign(rng: np.random.Generator) -> float:
    return float(rng.choice([-1.0, 1.0]))


def _phase(rng: np.random.Generator) -> float:
    return float(rng.uniform(0.0, 2.0 * math.pi))


def _weak(b: Base) -> float:
    """A hundredth of the spring's force, N: the size of a first draw."""
    return 0.01 * b.force


def _signed(b: Base, rng: np.random.Generator) -> dict[str, Any]:
    return {"size": _sign(rng) * _weak(b)}


def _place(b: Base, rng: np.random.Generator) -> float:
    return b.length * float(rng.uniform(-0.6, 0.6))


def _force(law: ForceLaw, rate: float = 0.0) -> Pieces:
    return Pieces(forces=(Force(law, rate=rate),))


def _parametric(p: Values, b: Base) -> Pieces:
    return _force(lambda t, x, v, d: p["size"] * math.cos(p["Omega"] * t + p["phase"]) * x / b.length, rate=p["Omega"])


def _hysteresis(p: Values, b: Base) -> Pieces:
    """Internal friction of a material: f = size z, z' = (v - |v| z)/reach, beside the friction of the guide."""
    branch = Branch(
        start=lambda x0, v0: (0.0,),
        derivative=lambda x, v, own: ((v - abs(v) * own[0]) / p["reach"],),
        force=lambda x, v, own: p["size"] * own[0],
    )
    return Pieces(branches=(branch,))


UNKNOWN: dict[str, Effect] = {
    "alien-position-viscous": Effect(
        ("damping",), _signed, lambda p, b: _force(lambda t, x, v, d: p["size"] * (x / b.length) ** 2 * v / b.speed)
    ),
    "alien-warming-viscous": Effect(
        ("damping",),
        lambda b, rng: {**_signed(b, rng), "tau": b.duration * rng.uniform(0.1, 0.7)},
        lambda p, b: _force(lambda t, x, v, d: p["size"] * -math.expm1(-t / p["tau"]) * v / b.speed),
    ),
    "alien-quintic-stiffness": Effect(
        ("stiffness",), _signed, lambda p, b: _force(lambda t, x, v, d: p["size"] * (x / b.length) ** 5)
    ),
    "alien-parametric-stiffness": Effect(
        ("stiffness", "environment"),
        lambda b, rng: {"size": _weak(b), "Omega": b.omega_n * log_uniform(rng, 0.1, 3.0), "phase": _phase(rng)},
        _parametric,
    ),
    "alien-speed-stiffness": BENCH["alien-speed-stiffness"],
    "alien-heating": BENCH["alien-heating"],
    "alien-inertial-load": BENCH["alien-inertial-load"],
    "alien-hysteresis": Effect(
        ("friction", "damping", "stiffness"),
        lambda b, rng: {"size": _weak(b), "reach": b.length * log_uniform(rng, 0.05, 0.5)},
        _hysteresis,
    ),
    "alien-random-force": BENCH["alien-random-force"],
    # adds nothing to the motion: it is in what is read
    ECCENTRIC: Effect(
        ("sensor",),
        lambda b, rng: {
            "size": 0.005 * b.length,
            "period": b.length * log_uniform(rng, 0.4, 4.0),
            "phase": _phase(rng),
        },
        lambda p, b: Pieces(),
        needs="x",
    ),
}
"""Effects of no catalogue."""


def _static(
    form: str, families: tuple[str, ...], draw: Draw, make: Callable[[Values, Base], Curve], kink: str = ""
) -> Effect:
    """A static law. kink : where the curve is not smooth, "side" (at the gap of its side) or "middle"."""

    def build(p: Values, b: Base) -> Pieces:
        curve = make(p, b)
        if form == "f(x)":
            kinks = (p["side"] * p["gap"],) if kink == "side" else (0.0,) if kink == "middle" else ()
            return Pieces(forces=(Force(lambda t, x, v, d: curve(x), kinks=kinks),))
        if form == "f(v)":
            return _force(lambda t, x, v, d: curve(v))
        return Pieces(modulations=(lambda t, x, net, work: 1.0 + curve(x) / b.f_k,))

    return Effect(families, draw, build, curve=(form, make))


def _well(p: Values, b: Base) -> Curve:
    """A magnet that pulls towards x = place: size N at width from it, nothing far away."""
    place, width = p["place"], p["width"]
    return lambda x: p["size"] * (x - place) / width * math.exp(0.5 - 0.5 * ((x - place) / width) ** 2)


def _bumper(p: Values, b: Base) -> Curve:
    """size ((x - gap)/length)^2 beyond the gap, on one side."""
    side, gap = p["side"], p["gap"]
    return lambda x: side * p["size"] * (max(side * x - gap, 0.0) / b.length) ** 2


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


STATIC: dict[str, Effect] = {
    "alien-magnet-well": _static(
        "f(x)",
        ("stiffness", "environment"),
        lambda b, rng: {**_signed(b, rng), "place": _place(b, rng), "width": b.length * rng.uniform(0.08, 0.25)},
        _well,
    ),
    "alien-soft-bumper": _static(
        "f(x)",
        ("stiffness",),
        lambda b, rng: {"size": 10.0 * _weak(b), "gap": b.length * rng.uniform(0.2, 0.7), "side": _sign(rng)},
        _bumper,
        "side",
    ),
    # stiff about the middle, then saturated
    "alien-softening": _static(
        "f(x)",
        ("stiffness",),
        lambda b, rng: {**_signed(b, rng), "width": b.length * rng.uniform(0.08, 0.3)},
        lambda p, b: lambda x: float(p["size"] * math.tanh(x / p["width"])),
    ),
    # stiffer on one side
    "alien-bilinear-spring": _static(
        "f(x)", ("stiffness",), _signed, lambda p, b: lambda x: float(p["size"] * abs(x) / b.length), "middle"
    ),
    "alien-eddy-brake": _static(
        "f(v)",
        ("damping", "friction"),
        lambda b, rng: {"size": _weak(b), "v_c": b.speed * rng.uniform(0.1, 0.4)},
        _eddy,
    ),
    "alien-speed-hump": _static(
        "f(v)",
        ("damping", "friction"),
        lambda b, rng: {
            "size": _weak(b),
            "v_c": b.speed * rng.uniform(0.2, 0.6),
            "sharp": float(rng.uniform(2.0, 8.0)),
        },
        _hump,
    ),
    "alien-flow-transition": _static(
        "f(v)",
        ("damping",),
        lambda b, rng: {"size": 2.0 * _weak(b), "v_c": b.speed * rng.uniform(0.25, 0.6)},
        _transition,
    ),
    # drag in one direction alone
    "alien-one-way-drag": _static(
        "f(v)",
        ("damping",),
        lambda b, rng: {"size": 2.0 * _weak(b), "side": _sign(rng)},
        lambda p, b: lambda v: float(p["side"] * p["size"] * (max(p["side"] * v, 0.0) / b.speed) ** 2),
    ),
    # a place that rubs
    "alien-sticky-patch": _static(
        "g(x) sgn v",
        ("friction",),
        lambda b, rng: {"size": b.f_k, "place": _place(b, rng), "width": b.length * rng.uniform(0.1, 0.35)},
        lambda p, b: lambda x: float(p["size"] * math.exp(-(((x - p["place"]) / p["width"]) ** 2))),
    ),
    # the ends of the travel rub
    "alien-edge-rub": _static(
        "g(x) sgn v",
        ("friction",),
        lambda b, rng: {"size": 2.0 * b.f_k},
        lambda p, b: lambda x: float(p["size"] * (x / b.length) ** 4),
    ),
    # all beyond a place rubs
    "alien-half-rub": _static(
        "g(x) sgn v",
        ("friction",),
        lambda b, rng: {"size": b.f_k, "place": _place(b, rng), "width": b.length * rng.uniform(0.03, 0.2)},
        lambda p, b: lambda x: float(p["size"] / (1.0 + math.exp(-(x - p["place"]) / p["width"]))),
    ),
}
"""Static laws of no catalogue, which a tabulated force can hold."""

KNOWN = {
    **ON_A_BENCH,
    "load-dependent-friction": replace(BENCH["alien-structural-damping"], families=("friction",)),
}
ALIENS = {**UNKNOWN, **STATIC}
EFFECTS = {**KNOWN, **ALIENS}
FAMILY = {name: one.families[0] for name, one in KNOWN.items()}

NEEDS = {name: one.needs for name, one in EFFECTS.items()}
"""Channels without which an effect does not show at all."""

FROM_ZERO = ("constant-force", "end-stop", "backlash", "alien-soft-bumper")
"""Laws bound to the unstretched spring: where one is the main effect, x may well be measured from there."""
DRY = frozenset(name for name, one in EFFECTS.items() if one.families == ("friction",))
"""Laws that act through dry friction: without a level of it they are nothing."""


def curve_of(name: str) -> tuple[str, Callable[[Values, Base], Curve]]:
    """What a static law of no catalogue is a curve of, and the curve."""
    found = STATIC[name].curve
    assert found is not None
    return found


def table(
    name: str, p: Values, b: Base, x: tuple[float, float], v: tuple[float, float], points: int = 201
) -> dict[str, Any]:
    """The true curve of a static law over the swept range of x (m) or v (m/s); the force in N."""
    form, make = curve_of(name)
    curve = make(p, b)
    grid = np.linspace(*(v if form == "f(v)" else x), points)
    return {"form": form, "at": grid.tolist(), "force": [curve(float(one)) for one in grid]}


_STRENGTH = (
    *("size", "c2", "c_diff", "c_p", "k_m", "k3", "k2", "k_stop", "rate", "force", "amplitude", "impulse"),
    *("mass_ratio", "lag", "bias", "slope", "depth", "v_r"),
)
"""Parameters to which an effect is about proportional, whatever its name."""


def three_digits(factor: float) -> float:
    """A factor rounded, so that what follows is the same though another processor rounds otherwise."""
    return float(f"{factor:.3g}")


def scaled(name: str, values: Values, factor: float, b: Base) -> dict[str, Any]:
    """The effect made ``factor`` times as strong, or as strong as is plausible."""
    said = dict(values)
    if name in ("stribeck", "static-friction"):
        said["f_s"] = b.f_k + min(factor * (values["f_s"] - b.f_k), 2.5 * b.f_k)
    elif name == "sensor-gain":
        said["gain"] = 1.0 + min(max(factor * (values["gain"] - 1.0), -0.1), 0.1)
    elif name == "presliding":
        stiffer = min(max(1.0 / factor, 0.5 * b.k / values["sigma0"]), 60.0 * b.k / values["sigma0"])
        said |= {"sigma0": stiffer * values["sigma0"], "sigma1": math.sqrt(stiffer) * values["sigma1"]}
    elif name in ("pendulum-stiffness", "sensor-clipping"):
        pass
    elif name == "backlash":
        said["gap"] = min(factor * values["gap"], 0.15 * b.length)
    else:
        key = next((key for key in _STRENGTH if key in values), "gain")
        most = _most(name, key, b)
        said[key] = min(max(factor * values[key], -most), most)
    if name == "friction-drift":
        said["rate"] = max(said["rate"], -0.9 / b.duration)
    return said


def _most(name: str, key: str, b: Base) -> float:
    """The largest plausible value of a strength."""
    bound = {"alien-inertial-load": 8.0, "load-dependent-friction": 8.0}
    bound |= dict.fromkeys(("alien-sticky-patch", "alien-edge-rub", "alien-half-rub"), 6.0 * b.f_k)
    if name in bound:
        return bound[name]
    drift = {"friction-drift": 3.0 / b.duration, "stiffness-drift": 0.15 / b.duration}
    if key == "rate" and name in drift:
        return drift[name]
    return {"mass_ratio": 0.2, "slope": 0.95 / b.length, "depth": 0.95, "v_r": 0.4 * b.speed}.get(key, math.inf)
