"""All that can be hidden in a plant: its families and the pieces it adds. Strengths stand in strengths.py."""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from harness.proof.plant.base import Base
from harness.proof.plant.model import (
    Branch,
    DryFriction,
    Force,
    ForceLaw,
    Knock,
    Level,
    Modulation,
    bristle,
    regularised,
)

Values = Mapping[str, Any]
"""Parameters of an effect by name, SI."""
Curve = Callable[[float], float]


@dataclass(frozen=True, slots=True)
class Pieces:
    """What one effect adds to the plant or to its sensors."""

    forces: tuple[Force, ...] = ()
    branches: tuple[Branch, ...] = ()
    knocks: tuple[Knock, ...] = ()
    modulations: tuple[Modulation, ...] = ()
    kinks: tuple[float, ...] = ()
    level: Mapping[str, float] = field(default_factory=dict)
    law: Callable[[Level], DryFriction] | None = None
    sensors: Mapping[str, float] = field(default_factory=dict)


Law = Callable[[Values, Base], Pieces]


@dataclass(frozen=True, slots=True)
class Effect:
    """families : its own; of one that no catalogue holds, those that would not be wrong. build : from its parameters.

    headline : parameters by which a finding is judged. needs : channels without which it does not show at all.
    curve : of a static law of no catalogue what it is a curve of, "f(x)", "f(v)" or "g(x) sgn v", and the curve, N.
    """

    families: tuple[str, ...]
    build: Law
    headline: tuple[str, ...] = ()
    needs: str = ""
    curve: tuple[str, Callable[[Values, Base], Curve]] | None = None


def _force(law: ForceLaw, kinks: tuple[float, ...] = (), rate: float = 0.0) -> Pieces:
    return Pieces(forces=(Force(law, kinks, rate),))


def _factor(law: Modulation, kinks: tuple[float, ...] = ()) -> Pieces:
    return Pieces(modulations=(law,), kinks=kinks)


def _sensor(name: str, parameter: str) -> Law:
    return lambda p, b: Pieces(sensors={name: p[parameter]})


def _friction_along(p: Values, b: Base) -> Pieces:
    """A slope, or a cosine over the travel."""
    if "slope" in p:
        return _factor(lambda t, x, net, work: 1.0 + p["slope"] * x)
    depth, number, phase = p["depth"], 2.0 * math.pi / p["period"], p["phase"]
    return _factor(lambda t, x, net, work: 1.0 + depth * math.cos(number * x + phase))


def _pulsing(p: Values, b: Base) -> Pieces:
    depth, omega, phase = p["depth"], p["Omega"], p["phase"]
    return _factor(lambda t, x, net, work: 1.0 + depth * math.cos(omega * t + phase))


def _power_law(p: Values, b: Base) -> Pieces:
    c_p, exponent = p["c_p"], p["exponent"]
    return _force(lambda t, x, v, d: c_p * d * abs(v) ** exponent)


def _maxwell(p: Values, b: Base) -> Pieces:
    """A Maxwell branch in parallel: force k_m y, y' = v - y/tau, relaxed at the start."""
    k_m, tau = p["k_m"], p["tau"]
    branch = Branch(
        start=lambda x0, v0: (0.0,),
        derivative=lambda x, v, own: (v - own[0] / tau,),
        force=lambda x, v, own: k_m * own[0],
    )
    return Pieces(branches=(branch,))


def _hysteresis(p: Values, b: Base) -> Pieces:
    """Internal friction of a material: f = size z, z' = (v - |v| z)/reach, beside the friction of the guide."""
    branch = Branch(
        start=lambda x0, v0: (0.0,),
        derivative=lambda x, v, own: ((v - abs(v) * own[0]) / p["reach"],),
        force=lambda x, v, own: p["size"] * own[0],
    )
    return Pieces(branches=(branch,))


def _end_stop(p: Values, b: Base) -> Pieces:
    """k_stop (x - gap) beyond gap; side is "upper", "lower" (beyond -gap) or "both"."""
    gap, k_stop = p["gap"], p["k_stop"]
    upper, lower = p["side"] in ("upper", "both"), p["side"] in ("lower", "both")

    def law(t: float, x: float, v: float, d: float) -> float:
        if upper and x > gap:
            return float(k_stop * (x - gap))
        if lower and x < -gap:
            return float(k_stop * (x + gap))
        return 0.0

    return _force(law, (gap,) * upper + (-gap,) * lower)


def _ripple(p: Values, b: Base) -> Pieces:
    amplitude, number, phase = p["amplitude"], 2.0 * math.pi / p["period"], p["phase"]
    return _force(lambda t, x, v, d: amplitude * math.cos(number * x + phase))


def _harmonic(p: Values, b: Base) -> Pieces:
    """A cos(Omega t + phase) on the right, hence with a minus here."""
    amplitude, omega, phase = p["amplitude"], p["Omega"], p["phase"]
    return _force(lambda t, x, v, d: -amplitude * math.cos(omega * t + phase), rate=omega)


def _second_mass(
    p: Values, b: Base, link: Callable[[float, float], float], rate: float, switches: tuple[Any, ...] = ()
) -> Pieces:
    """A mass m2 = mass_ratio m that a force ``link`` (of how far and how fast it is off) pulls back to the slider."""
    m2 = p["mass_ratio"] * b.m

    def pull(x: float, v: float, own: Sequence[float]) -> float:
        return link(own[0] - x, own[1] - v)

    branch = Branch(
        start=lambda x0, v0: (x0, v0),
        derivative=lambda x, v, own: (own[1], -pull(x, v, own) / m2),
        force=lambda x, v, own: -pull(x, v, own),
        switches=switches,
        rate=rate,
    )
    return Pieces(branches=(branch,))


def _attached_mode(p: Values, b: Base) -> Pieces:
    """It hangs on a spring, at rest at the start: omega_2 with the slider held, zeta_2 = c2/(2 sqrt(k2 m2))."""
    m2, omega_2 = p["mass_ratio"] * b.m, p["omega_2"]
    k2, c2 = m2 * omega_2**2, 2.0 * p["zeta_2"] * m2 * omega_2
    return _second_mass(p, b, lambda r, w: float(k2 * r + c2 * w), omega_2 * math.sqrt(1.0 + p["mass_ratio"]))


def _rattle(p: Values, b: Base) -> Pieces:
    """Loose in a cage of half-width ``clearance`` (m): free flight, and impacts on springs with dampers.

    omega_c : contact frequency of the loose mass on its wall, rad/s.
    """
    m2, clearance, omega_c = float(p["mass_ratio"] * b.m), float(p["clearance"]), float(p["omega_c"])
    k2, c2 = m2 * omega_c**2, 2.0 * float(p["zeta_c"]) * m2 * omega_c

    def push(r: float, w: float) -> float:
        if r > clearance:
            return max(0.0, k2 * (r - clearance) + c2 * w)
        if r < -clearance:
            return min(0.0, k2 * (r + clearance) + c2 * w)
        return 0.0

    walls = (lambda x, v, own: own[0] - x - clearance, lambda x, v, own: own[0] - x + clearance)
    return _second_mass(p, b, push, omega_c, walls)


KNOWN: dict[str, Effect] = {
    "stribeck": Effect(
        ("friction",), lambda p, b: Pieces(level={"f_s": p["f_s"], "v_s": p["v_s"]}), headline=("f_s", "v_s")
    ),
    "static-friction": Effect(("friction",), lambda p, b: Pieces(level={"f_s": p["f_s"]}), headline=("f_s",)),
    "presliding": Effect(
        ("friction",),
        lambda p, b: Pieces(law=lambda level: bristle(level, p["sigma0"], p["sigma1"])),
        headline=("sigma0",),
    ),
    "regularised-friction": Effect(
        ("friction",), lambda p, b: Pieces(law=lambda level: regularised(level, p["v_r"], p["lead"])), headline=("v_r",)
    ),
    "position-dependent-friction": Effect(("friction",), _friction_along, headline=("slope",)),
    "friction-drift": Effect(("friction",), lambda p, b: _factor(lambda t, x, net, work: 1.0 + p["rate"] * t)),
    "normal-load-variation": Effect(("friction",), _pulsing, headline=("Omega",)),
    "quadratic-drag": Effect(
        ("damping",), lambda p, b: _force(lambda t, x, v, d: p["c2"] * d * v * v), headline=("c2",)
    ),
    "asymmetric-viscous": Effect(
        ("damping",), lambda p, b: _force(lambda t, x, v, d: p["c_diff"] * d * v), headline=("c_diff",)
    ),
    "power-law-damping": Effect(("damping",), _power_law, headline=("exponent",)),
    "viscoelastic": Effect(("damping",), _maxwell, headline=("tau",)),
    "cubic-stiffness": Effect(
        ("stiffness",), lambda p, b: _force(lambda t, x, v, d: p["k3"] * x * x * x), headline=("k3",)
    ),
    "quadratic-stiffness": Effect(
        ("stiffness",), lambda p, b: _force(lambda t, x, v, d: p["k2"] * x * x), headline=("k2",)
    ),
    # with k x of the base the restoring force is k sin x
    "pendulum-stiffness": Effect(("stiffness",), lambda p, b: _force(lambda t, x, v, d: b.k * (math.sin(x) - x))),
    "end-stop": Effect(("stiffness",), _end_stop, headline=("gap",)),
    # with k x of the base a dead zone of the spring
    "backlash": Effect(
        ("stiffness",),
        lambda p, b: _force(lambda t, x, v, d: -b.k * min(max(x, -p["gap"]), p["gap"]), (p["gap"], -p["gap"])),
        headline=("gap",),
    ),
    "stiffness-drift": Effect(
        ("stiffness",), lambda p, b: _force(lambda t, x, v, d: b.k * p["rate"] * t * x), headline=("rate",)
    ),
    "constant-force": Effect(
        ("environment",), lambda p, b: _force(lambda t, x, v, d: -p["force"]), headline=("force",), needs="x"
    ),
    "force-ripple": Effect(("environment",), _ripple, headline=("period",)),
    "harmonic-force": Effect(("environment",), _harmonic, headline=("Omega",)),
    "impulse": Effect(
        ("environment",), lambda p, b: Pieces(knocks=(Knock(p["time"], p["impulse"]),)), headline=("time",)
    ),
    "attached-mode": Effect(("environment",), _attached_mode, headline=("omega_2",)),
    "sensor-lag": Effect(("sensor",), _sensor("lag", "lag"), headline=("lag",), needs="xa"),
    "sensor-gain": Effect(("sensor",), _sensor("gain", "gain"), headline=("gain",), needs="xa"),
    "sensor-bias": Effect(("sensor",), _sensor("bias", "bias"), needs="a"),
    "sensor-drift": Effect(("sensor",), _sensor("drift", "rate"), headline=("rate",), needs="x"),
    "sensor-clipping": Effect(("sensor",), _sensor("limit", "limit"), needs="a"),
}
"""What a slider on a bench may hide, in the order in which it is drawn."""


def _growing_outwards(p: Values, b: Base) -> Pieces:
    """1 + gain |x|/length: load-dependent friction; structural (hysteretic) damping beside Coulomb friction."""
    gain, length = p["gain"], b.length
    return _factor(lambda t, x, net, work: 1.0 + gain * abs(x) / length, (0.0,))


def _heated(p: Values, b: Base) -> Pieces:
    """Friction changes with the work done against it."""
    gain, energy = p["gain"], b.f_k * b.length
    return _factor(lambda t, x, net, work: 1.0 + gain * work / energy)


def _random_walk(p: Values, b: Base) -> Pieces:
    """A random walk of knots ``interval`` (s) apart, joined by smooth steps, without mean, of rms ``size`` (N)."""
    size, interval = float(p["size"]), float(p["interval"])
    rng = np.random.default_rng(int(p["seed"]))
    knots = np.cumsum(rng.standard_normal(math.ceil(b.duration / interval) + 2))
    knots -= knots.mean()
    levels: list[float] = (knots * (size / math.sqrt(float(np.mean(knots**2))))).tolist()

    def law(t: float, x: float, v: float, d: float) -> float:
        place = t / interval
        i = min(int(place), len(levels) - 2)
        s = place - i
        return -(levels[i] + (levels[i + 1] - levels[i]) * s * s * (3.0 - 2.0 * s))

    return _force(law, rate=math.pi / interval)


OUTSIDE: dict[str, Effect] = {
    "alien-inertial-load": Effect(
        ("friction",), lambda p, b: _factor(lambda t, x, net, work: 1.0 + p["gain"] * abs(net) / b.force)
    ),
    "alien-structural-damping": Effect(("friction", "damping"), _growing_outwards),
    "alien-heating": Effect(("friction",), _heated),
    "alien-random-force": Effect(("environment",), _random_walk),
    "alien-rattle": Effect(("environment", "stiffness"), _rattle),
    # the spring stiffens or softens at top speed
    "alien-speed-stiffness": Effect(
        ("stiffness", "damping"), lambda p, b: _force(lambda t, x, v, d: b.k * p["gain"] * (v / b.speed) ** 2 * x)
    ),
}
"""What no catalogue holds, on a bench."""


def _parametric(p: Values, b: Base) -> Pieces:
    return _force(lambda t, x, v, d: p["size"] * math.cos(p["Omega"] * t + p["phase"]) * x / b.length, rate=p["Omega"])


ECCENTRIC = "alien-eccentric-encoder"
UNKNOWN: dict[str, Effect] = {
    "alien-position-viscous": Effect(
        ("damping",), lambda p, b: _force(lambda t, x, v, d: p["size"] * (x / b.length) ** 2 * v / b.speed)
    ),
    "alien-warming-viscous": Effect(
        ("damping",), lambda p, b: _force(lambda t, x, v, d: p["size"] * -math.expm1(-t / p["tau"]) * v / b.speed)
    ),
    "alien-quintic-stiffness": Effect(
        ("stiffness",), lambda p, b: _force(lambda t, x, v, d: p["size"] * (x / b.length) ** 5)
    ),
    "alien-parametric-stiffness": Effect(("stiffness", "environment"), _parametric),
    "alien-speed-stiffness": OUTSIDE["alien-speed-stiffness"],
    "alien-heating": OUTSIDE["alien-heating"],
    "alien-inertial-load": OUTSIDE["alien-inertial-load"],
    "alien-hysteresis": Effect(("friction", "damping", "stiffness"), _hysteresis),
    "alien-random-force": OUTSIDE["alien-random-force"],
    # adds nothing to the motion: it is in what is read
    ECCENTRIC: Effect(("sensor",), lambda p, b: Pieces(), needs="x"),
}
"""What no catalogue holds, on a machine."""


def _static(
    form: str, families: tuple[str, ...], make: Callable[[Values, Base], Curve], kinks: Callable[[Values], float] | None
) -> Effect:
    """A static law of no catalogue, which a tabulated force can hold. kinks : where a curve of x is not smooth, m."""

    def build(p: Values, b: Base) -> Pieces:
        curve = make(p, b)
        if form == "f(x)":
            return _force(lambda t, x, v, d: curve(x), () if kinks is None else (kinks(p),))
        if form == "f(v)":
            return _force(lambda t, x, v, d: curve(v))
        return _factor(lambda t, x, net, work: 1.0 + curve(x) / b.f_k)

    return Effect(families, build, curve=(form, make))


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


def _one_way(p: Values, b: Base) -> Curve:
    """Drag in one direction alone."""
    return lambda v: float(p["side"] * p["size"] * (max(p["side"] * v, 0.0) / b.speed) ** 2)


def _softening(p: Values, b: Base) -> Curve:
    """Stiff about the middle, then saturated."""
    return lambda x: float(p["size"] * math.tanh(x / p["width"]))


def _bilinear(p: Values, b: Base) -> Curve:
    """Stiffer on one side."""
    return lambda x: float(p["size"] * abs(x) / b.length)


def _patch(p: Values, b: Base) -> Curve:
    """A place that rubs."""
    return lambda x: float(p["size"] * math.exp(-(((x - p["place"]) / p["width"]) ** 2)))


def _edges(p: Values, b: Base) -> Curve:
    """The ends of the travel rub."""
    return lambda x: float(p["size"] * (x / b.length) ** 4)


def _half(p: Values, b: Base) -> Curve:
    """All beyond a place rubs."""
    return lambda x: float(p["size"] / (1.0 + math.exp(-(x - p["place"]) / p["width"])))


STATIC: dict[str, Effect] = {
    "alien-magnet-well": _static("f(x)", ("stiffness", "environment"), _well, None),
    "alien-soft-bumper": _static("f(x)", ("stiffness",), _bumper, lambda p: float(p["side"] * p["gap"])),
    "alien-softening": _static("f(x)", ("stiffness",), _softening, None),
    "alien-bilinear-spring": _static("f(x)", ("stiffness",), _bilinear, lambda p: 0.0),
    "alien-eddy-brake": _static("f(v)", ("damping", "friction"), _eddy, None),
    "alien-speed-hump": _static("f(v)", ("damping", "friction"), _hump, None),
    "alien-flow-transition": _static("f(v)", ("damping",), _transition, None),
    "alien-one-way-drag": _static("f(v)", ("damping",), _one_way, None),
    "alien-sticky-patch": _static("g(x) sgn v", ("friction",), _patch, None),
    "alien-edge-rub": _static("g(x) sgn v", ("friction",), _edges, None),
    "alien-half-rub": _static("g(x) sgn v", ("friction",), _half, None),
}
"""Static laws of no catalogue."""

BENCH = {**KNOWN, **OUTSIDE}
OF_MACHINES = {
    **KNOWN,
    "load-dependent-friction": replace(OUTSIDE["alien-structural-damping"], families=("friction",)),
}
"""What of the catalogue a machine may hide."""
EFFECTS = {**OF_MACHINES, **OUTSIDE, **UNKNOWN, **STATIC}
KINDS = tuple(KNOWN)
FAMILY, FAMILY_OF_MACHINES = ({name: one.families[0] for name, one in known.items()} for known in (KNOWN, OF_MACHINES))
ALIENS = {name: one.families for name, one in OUTSIDE.items()}

FROM_ZERO = ("constant-force", "end-stop", "backlash", "alien-soft-bumper")
"""Laws bound to the unstretched spring: where one is the main effect, x may well be measured from there."""
DRY = frozenset(name for name, one in EFFECTS.items() if one.families == ("friction",))
"""Laws that act through dry friction: without a level of it they are nothing."""
ONE_OF = (
    frozenset({"presliding", "regularised-friction"}),
    frozenset({"stribeck", "static-friction"}),
    frozenset({"presliding", "static-friction"}),
    frozenset({"regularised-friction", "static-friction"}),
    frozenset({"regularised-friction", "stribeck"}),
    frozenset({"cubic-stiffness", "pendulum-stiffness"}),
)
"""Pairs that fill the same slot, or of which one takes away what the other acts on."""


def compatible(first: str, second: str) -> bool:
    """Whether two effects can be hidden in one recording."""
    return first != second and frozenset({first, second}) not in ONE_OF
