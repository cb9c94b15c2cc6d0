"""All that can be hidden in a plant: of each effect its families, the pieces it adds, how strong it is drawn.

Strengths are relative to the slider's own scales; their ranges are wide on purpose, and what is too plain or too faint
is thrown away later (``accepted`` in cases.py, shares in machines/cases.py).
"""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from harness.proof.plant.base import Base, log_uniform
from harness.proof.plant.friction import Bristle, DryFriction, Level, Modulation, Regularised
from harness.proof.plant.model import Branch, Force, ForceLaw, Knock

Values = Mapping[str, Any]
Draw = Callable[[Base, np.random.Generator], dict[str, Any]]


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
Curve = Callable[[float], float]


@dataclass(frozen=True, slots=True)
class Effect:
    """families : its own; of one that no catalogue holds, those that would not be wrong. draw : its parameters, SI.

    build : from its parameters to its pieces. headline : parameters by which a finding is judged. needs : channels
    without which it does not show at all. curve : of a static law of no catalogue what it is a curve of, "f(x)",
    "f(v)" or "g(x) sgn v", and the curve, N.
    """

    families: tuple[str, ...]
    draw: Draw
    build: Law
    headline: tuple[str, ...] = ()
    needs: str = ""
    curve: tuple[str, Callable[[Values, Base], Curve]] | None = None


def _force(law: ForceLaw, kinks: tuple[float, ...] = (), rate: float = 0.0) -> Pieces:
    """A force of (t, x, v, d), on the left of the equation of motion."""
    return Pieces(forces=(Force(law, kinks, rate),))


def _factor(law: Modulation, kinks: tuple[float, ...] = ()) -> Pieces:
    """A factor on the friction level, of (t, x, net force, work against friction)."""
    return Pieces(modulations=(law,), kinks=kinks)


def _branch(branch: Branch) -> Pieces:
    return Pieces(branches=(branch,))


def _sensor(name: str, value: float) -> Pieces:
    return Pieces(sensors={name: value})


def _signed(rng: np.random.Generator, low: float, high: float) -> float:
    return float(rng.uniform(low, high) * rng.choice([-1.0, 1.0]))


def _sign(rng: np.random.Generator) -> float:
    return float(rng.choice([-1.0, 1.0]))


def _phase(rng: np.random.Generator) -> float:
    return float(rng.uniform(0.0, 2.0 * math.pi))


def _bristles(b: Base, rng: np.random.Generator) -> dict[str, Any]:
    """1 to 12 times as stiff as the spring; one in four without damping of their own (Dahl)."""
    sigma0 = b.k * log_uniform(rng, 1.0, 12.0)
    share = 0.0 if rng.random() < 0.25 else rng.uniform(0.1, 0.5)
    return {"sigma0": sigma0, "sigma1": share * math.sqrt(sigma0 * b.m)}


def _steep(b: Base, rng: np.random.Generator) -> dict[str, Any]:
    """v_r a fraction of the top speed; half of them with a lead."""
    lead = 0.0 if rng.random() < 0.5 else log_uniform(rng, 0.02, 0.15) / b.omega_n
    return {"v_r": b.speed * log_uniform(rng, 0.01, 0.12), "lead": lead}


def _along(b: Base, rng: np.random.Generator) -> dict[str, Any]:
    """A slope, or a cosine over the travel."""
    if rng.random() < 0.5:
        return {"slope": _signed(rng, 0.3, 0.95) / b.length}
    return {"depth": rng.uniform(0.3, 0.95), "period": b.length * log_uniform(rng, 0.25, 1.5), "phase": _phase(rng)}


def _friction_along(p: Values, b: Base) -> Pieces:
    if "slope" in p:
        return _factor(lambda t, x, net, work: 1.0 + p["slope"] * x)
    depth, number, phase = p["depth"], 2.0 * math.pi / p["period"], p["phase"]
    return _factor(lambda t, x, net, work: 1.0 + depth * math.cos(number * x + phase))


def _drifting(b: Base, rng: np.random.Generator) -> dict[str, Any]:
    """Friction grows by half to two, or falls by a third to four fifths, over the recording."""
    change = rng.uniform(0.5, 2.0) if rng.random() < 0.6 else -rng.uniform(0.3, 0.8)
    return {"rate": change / b.duration}


def _pulsing(p: Values, b: Base) -> Pieces:
    depth, omega, phase = p["depth"], p["Omega"], p["phase"]
    return _factor(lambda t, x, net, work: 1.0 + depth * math.cos(omega * t + phase))


def _power(b: Base, rng: np.random.Generator) -> dict[str, Any]:
    """0.6 to 3 % of the spring's force at top speed, exponent 0.2 to 0.8."""
    p = rng.uniform(0.2, 0.8)
    return {"c_p": rng.uniform(0.006, 0.03) * b.force / b.speed**p, "exponent": p}


def _power_law(p: Values, b: Base) -> Pieces:
    c_p, exponent = p["c_p"], p["exponent"]
    return _force(lambda t, x, v, d: c_p * d * abs(v) ** exponent)


def _maxwell(p: Values, b: Base) -> Pieces:
    """A Maxwell branch in parallel: force k_m y, y' = v - y/tau, relaxed at the start."""
    k_m, tau = p["k_m"], p["tau"]
    return _branch(
        Branch(
            start=lambda x0, v0: (0.0,),
            derivative=lambda x, v, own: (v - own[0] / tau,),
            force=lambda x, v, own: k_m * own[0],
        )
    )


def _stops(b: Base, rng: np.random.Generator) -> dict[str, Any]:
    """Reached in the first few swings; the side is one that the slider reaches."""
    side = str(rng.choice(["upper", "both", "lower"], p=[0.45, 0.4, 0.15]))
    return {"gap": b.length * rng.uniform(0.6, 0.93), "k_stop": b.k * rng.uniform(0.1, 0.6), "side": side}


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


def _shaking(b: Base, rng: np.random.Generator) -> dict[str, Any]:
    """0.3 to 1.2 % of the spring's force, away from the slider's own frequency."""
    ratio = rng.uniform(0.25, 0.6) if rng.random() < 0.25 else rng.uniform(1.6, 4.0)
    return {"amplitude": b.force * rng.uniform(0.003, 0.012), "Omega": b.omega_n * ratio, "phase": _phase(rng)}


def _harmonic(p: Values, b: Base) -> Pieces:
    """A cos(Omega t + phase) on the right, hence with a minus here."""
    amplitude, omega, phase = p["amplitude"], p["Omega"], p["phase"]
    return _force(lambda t, x, v, d: -amplitude * math.cos(omega * t + phase), rate=omega)


def _attached_mode(p: Values, b: Base) -> Pieces:
    """A second mass m2 = mass_ratio m on a spring on the slider, at rest relative to it at the start.

    omega_2 = sqrt(k2/m2) with the slider held, zeta_2 = c2/(2 sqrt(k2 m2)).
    """
    m2, omega_2 = p["mass_ratio"] * b.m, p["omega_2"]
    k2, c2 = m2 * omega_2**2, 2.0 * p["zeta_2"] * m2 * omega_2

    def pull(x: float, v: float, own: Sequence[float]) -> float:
        return float(k2 * (own[0] - x) + c2 * (own[1] - v))

    return _branch(
        Branch(
            start=lambda x0, v0: (x0, v0),
            derivative=lambda x, v, own: (own[1], -pull(x, v, own) / m2),
            force=lambda x, v, own: -pull(x, v, own),
            rate=omega_2 * math.sqrt(1.0 + p["mass_ratio"]),
        )
    )


def _growing_outwards(p: Values, b: Base) -> Pieces:
    """1 + gain |x|/length: load-dependent friction; structural (hysteretic) damping beside Coulomb friction."""
    gain, length = p["gain"], b.length
    return _factor(lambda t, x, net, work: 1.0 + gain * abs(x) / length, (0.0,))


def _outwards(b: Base, rng: np.random.Generator) -> dict[str, Any]:
    """Friction doubles to quintuples at the turning points, or at the largest acceleration."""
    return {"gain": rng.uniform(1.0, 4.0)}


KNOWN: dict[str, Effect] = {
    "stribeck": Effect(
        ("friction",),
        lambda b, rng: {"f_s": b.f_k * rng.uniform(1.3, 2.3), "v_s": b.speed * log_uniform(rng, 0.04, 0.3)},
        lambda p, b: Pieces(level={"f_s": p["f_s"], "v_s": p["v_s"]}),
        ("f_s", "v_s"),
    ),
    "static-friction": Effect(
        ("friction",),
        lambda b, rng: {"f_s": b.f_k * rng.uniform(1.1, 1.8)},
        lambda p, b: Pieces(level={"f_s": p["f_s"]}),
        ("f_s",),
    ),
    "presliding": Effect(
        ("friction",),
        _bristles,
        lambda p, b: Pieces(law=lambda level: Bristle(level, p["sigma0"], p["sigma1"])),
        ("sigma0",),
    ),
    "regularised-friction": Effect(
        ("friction",), _steep, lambda p, b: Pieces(law=lambda level: Regularised(level, p["v_r"], p["lead"])), ("v_r",)
    ),
    "position-dependent-friction": Effect(("friction",), _along, _friction_along, ("slope",)),
    "friction-drift": Effect(
        ("friction",), _drifting, lambda p, b: _factor(lambda t, x, net, work: 1.0 + p["rate"] * t)
    ),
    "normal-load-variation": Effect(
        ("friction",),
        lambda b, rng: {
            "depth": rng.uniform(0.3, 0.9),
            "Omega": b.omega_n * log_uniform(rng, 0.2, 4.0),
            "phase": _phase(rng),
        },
        _pulsing,
        ("Omega",),
    ),
    "quadratic-drag": Effect(
        ("damping",),
        lambda b, rng: {"c2": b.m * rng.uniform(0.02, 0.1) / b.length},
        lambda p, b: _force(lambda t, x, v, d: p["c2"] * d * v * v),
        ("c2",),
    ),
    "asymmetric-viscous": Effect(
        ("damping",),
        lambda b, rng: {"c_diff": _signed(rng, 0.004, 0.015) * b.m * b.omega_n},
        lambda p, b: _force(lambda t, x, v, d: p["c_diff"] * d * v),
        ("c_diff",),
    ),
    "power-law-damping": Effect(("damping",), _power, _power_law, ("exponent",)),
    "viscoelastic": Effect(
        ("damping",),
        lambda b, rng: {"k_m": b.k * log_uniform(rng, 0.03, 0.3), "tau": log_uniform(rng, 0.1, 8.0) / b.omega_n},
        _maxwell,
        ("tau",),
    ),
    "cubic-stiffness": Effect(
        ("stiffness",),
        lambda b, rng: {"k3": _signed(rng, 0.01, 0.05) * b.k / b.length**2},
        lambda p, b: _force(lambda t, x, v, d: p["k3"] * x * x * x),
        ("k3",),
    ),
    "quadratic-stiffness": Effect(
        ("stiffness",),
        lambda b, rng: {"k2": _signed(rng, 0.01, 0.06) * b.k / b.length},
        lambda p, b: _force(lambda t, x, v, d: p["k2"] * x * x),
        ("k2",),
    ),
    # with k x of the base the restoring force is k sin x
    "pendulum-stiffness": Effect(
        ("stiffness",), lambda b, rng: {}, lambda p, b: _force(lambda t, x, v, d: b.k * (math.sin(x) - x))
    ),
    "end-stop": Effect(("stiffness",), _stops, _end_stop, ("gap",)),
    # with k x of the base a dead zone of the spring
    "backlash": Effect(
        ("stiffness",),
        lambda b, rng: {"gap": b.length * log_uniform(rng, 0.004, 0.04)},
        lambda p, b: _force(lambda t, x, v, d: -b.k * min(max(x, -p["gap"]), p["gap"]), (p["gap"], -p["gap"])),
        ("gap",),
    ),
    "stiffness-drift": Effect(
        ("stiffness",),
        lambda b, rng: {"rate": _signed(rng, 0.006, 0.03) / b.duration},
        lambda p, b: _force(lambda t, x, v, d: b.k * p["rate"] * t * x),
        ("rate",),
    ),
    "constant-force": Effect(
        ("environment",),
        lambda b, rng: {"force": _signed(rng, 0.004, 0.02) * b.force},
        lambda p, b: _force(lambda t, x, v, d: -p["force"]),
        ("force",),
        "x",
    ),
    "force-ripple": Effect(
        ("environment",),
        lambda b, rng: {
            "amplitude": b.force * rng.uniform(0.004, 0.025),
            "period": b.length * log_uniform(rng, 0.15, 1.2),
            "phase": _phase(rng),
        },
        _ripple,
        ("period",),
    ),
    "harmonic-force": Effect(("environment",), _shaking, _harmonic, ("Omega",)),
    "impulse": Effect(
        ("environment",),
        lambda b, rng: {
            "time": b.duration * rng.uniform(0.12, 0.7),
            "impulse": _signed(rng, 0.01, 0.05) * b.m * b.speed,
        },
        lambda p, b: Pieces(knocks=(Knock(p["time"], p["impulse"]),)),
        ("time",),
    ),
    "attached-mode": Effect(
        ("environment",),
        lambda b, rng: {
            "omega_2": b.omega_n * log_uniform(rng, 1.5, 5.0),
            "mass_ratio": log_uniform(rng, 0.01, 0.08),
            "zeta_2": log_uniform(rng, 0.003, 0.05),
        },
        _attached_mode,
        ("omega_2",),
    ),
    "sensor-lag": Effect(
        ("sensor",),
        lambda b, rng: {"lag": rng.uniform(0.03, 0.2) / b.omega_n},
        lambda p, b: _sensor("lag", p["lag"]),
        ("lag",),
        "xa",
    ),
    "sensor-gain": Effect(
        ("sensor",),
        lambda b, rng: {"gain": 1.0 + _signed(rng, 0.03, 0.09)},
        lambda p, b: _sensor("gain", p["gain"]),
        ("gain",),
        "xa",
    ),
    "sensor-bias": Effect(
        ("sensor",),
        lambda b, rng: {"bias": _signed(rng, 0.01, 0.03) * b.length * b.omega_n**2},
        lambda p, b: _sensor("bias", p["bias"]),
        needs="a",
    ),
    "sensor-drift": Effect(
        ("sensor",),
        lambda b, rng: {"rate": _signed(rng, 0.01, 0.05) * b.length / b.duration},
        lambda p, b: _sensor("drift", p["rate"]),
        ("rate",),
        "x",
    ),
    "sensor-clipping": Effect(
        ("sensor",),
        lambda b, rng: {"limit": rng.uniform(0.75, 0.95) * b.length * b.omega_n**2},
        lambda p, b: _sensor("limit", p["limit"]),
        needs="a",
    ),
}
"""What a slider on a bench may hide, in the order in which it is drawn."""


def _warming(b: Base, rng: np.random.Generator) -> dict[str, Any]:
    """Friction changes with the work done against it, which in all is some ten f_k X_0."""
    return {"gain": rng.uniform(0.05, 0.25) if rng.random() < 0.6 else -rng.uniform(0.03, 0.06)}


def _heated(p: Values, b: Base) -> Pieces:
    gain, energy = p["gain"], b.f_k * b.length
    return _factor(lambda t, x, net, work: 1.0 + gain * work / energy)


def _wandering(b: Base, rng: np.random.Generator) -> dict[str, Any]:
    """0.3 to 1.2 % of the spring's force, wandering within a fraction of a period."""
    return {
        "size": b.force * rng.uniform(0.003, 0.012),
        "interval": rng.uniform(0.1, 0.4) * 2.0 * math.pi / b.omega_n,
        "seed": int(rng.integers(2**31)),
    }


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


def _loose(b: Base, rng: np.random.Generator) -> dict[str, Any]:
    """A loose mass of 1 to 5 % in a cage of 5 to 40 % of the start."""
    return {
        "mass_ratio": rng.uniform(0.01, 0.05),
        "clearance": b.length * rng.uniform(0.05, 0.4),
        "omega_c": b.omega_n * rng.uniform(15.0, 30.0),
        "zeta_c": rng.uniform(0.05, 0.3),
    }


def _rattle(p: Values, b: Base) -> Pieces:
    """A loose mass in a cage of half-width ``clearance`` (m): free flight, and impacts on springs with dampers.

    omega_c : contact frequency of the loose mass on its wall, rad/s.
    """
    m2, clearance, omega_c = float(p["mass_ratio"] * b.m), float(p["clearance"]), float(p["omega_c"])
    k2, c2 = m2 * omega_c**2, 2.0 * float(p["zeta_c"]) * m2 * omega_c

    def push(x: float, v: float, own: Sequence[float]) -> float:
        r, w = own[0] - x, own[1] - v
        if r > clearance:
            return max(0.0, k2 * (r - clearance) + c2 * w)
        if r < -clearance:
            return min(0.0, k2 * (r + clearance) + c2 * w)
        return 0.0

    return _branch(
        Branch(
            start=lambda x0, v0: (x0, v0),
            derivative=lambda x, v, own: (own[1], -push(x, v, own) / m2),
            force=lambda x, v, own: -push(x, v, own),
            switches=(lambda x, v, own: own[0] - x - clearance, lambda x, v, own: own[0] - x + clearance),
            rate=omega_c,
        )
    )


OUTSIDE: dict[str, Effect] = {
    "alien-inertial-load": Effect(
        ("friction",),
        _outwards,
        lambda p, b: _factor(lambda t, x, net, work: 1.0 + p["gain"] * abs(net) / b.force),
    ),
    "alien-structural-damping": Effect(("friction", "damping"), _outwards, _growing_outwards),
    "alien-heating": Effect(("friction",), _warming, _heated),
    "alien-random-force": Effect(("environment",), _wandering, _random_walk),
    "alien-rattle": Effect(("environment", "stiffness"), _loose, _rattle),
    # the spring stiffens or softens by 2 to 10 % at top speed
    "alien-speed-stiffness": Effect(
        ("stiffness", "damping"),
        lambda b, rng: {"gain": _signed(rng, 0.02, 0.1)},
        lambda p, b: _force(lambda t, x, v, d: b.k * p["gain"] * (v / b.speed) ** 2 * x),
    ),
}
"""What no catalogue holds, on a bench."""
BENCH = {**KNOWN, **OUTSIDE}
FAMILY = {name: one.families[0] for name, one in KNOWN.items()}
KINDS = tuple(KNOWN)
ALIENS = {name: one.families for name, one in OUTSIDE.items()}
HEADLINE = {name: one.headline for name, one in KNOWN.items()}

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


def families(names: tuple[str, ...]) -> list[str]:
    """Families of the effects, in their order, each once."""
    return list(dict.fromkeys(family for name in names for family in BENCH[name].families))
