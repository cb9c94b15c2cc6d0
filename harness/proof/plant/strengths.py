"""How strong each effect is drawn, relative to the slider's own scales, and how it is made stronger or weaker.

Ranges are wide on purpose: what is too plain or too faint is thrown away later (``accepted`` in cases.py, shares of
machines). The strength of an effect of no catalogue is its ``size``. The order of the numbers is that of their draw.
"""

import math
from collections.abc import Callable
from typing import Any

import numpy as np

from harness.proof.plant.base import Base, log_uniform
from harness.proof.plant.effects import ECCENTRIC, Values

Draw = Callable[[Base, np.random.Generator], dict[str, Any]]


def _sign(rng: np.random.Generator) -> float:
    return float(rng.choice([-1.0, 1.0]))


def _signed(rng: np.random.Generator, low: float, high: float) -> float:
    return float(rng.uniform(low, high) * rng.choice([-1.0, 1.0]))


def _phase(rng: np.random.Generator) -> float:
    return float(rng.uniform(0.0, 2.0 * math.pi))


def _weak(b: Base) -> float:
    """A hundredth of the spring's force, N: the size of a first draw."""
    return 0.01 * b.force


def _weak_either_way(b: Base, rng: np.random.Generator) -> dict[str, Any]:
    return {"size": _sign(rng) * _weak(b)}


def _place(b: Base, rng: np.random.Generator) -> float:
    return b.length * float(rng.uniform(-0.6, 0.6))


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
    if rng.random() < 0.5:
        return {"slope": _signed(rng, 0.3, 0.95) / b.length}
    return {"depth": rng.uniform(0.3, 0.95), "period": b.length * log_uniform(rng, 0.25, 1.5), "phase": _phase(rng)}


def _drifting(b: Base, rng: np.random.Generator) -> dict[str, Any]:
    """Friction grows by half to two, or falls by a third to four fifths, over the recording."""
    change = rng.uniform(0.5, 2.0) if rng.random() < 0.6 else -rng.uniform(0.3, 0.8)
    return {"rate": change / b.duration}


def _power(b: Base, rng: np.random.Generator) -> dict[str, Any]:
    """0.6 to 3 % of the spring's force at top speed."""
    p = rng.uniform(0.2, 0.8)
    return {"c_p": rng.uniform(0.006, 0.03) * b.force / b.speed**p, "exponent": p}


def _stops(b: Base, rng: np.random.Generator) -> dict[str, Any]:
    """Reached in the first few swings; the side is one that the slider reaches."""
    side = str(rng.choice(["upper", "both", "lower"], p=[0.45, 0.4, 0.15]))
    return {"gap": b.length * rng.uniform(0.6, 0.93), "k_stop": b.k * rng.uniform(0.1, 0.6), "side": side}


def _shaking(b: Base, rng: np.random.Generator) -> dict[str, Any]:
    """Away from the slider's own frequency."""
    ratio = rng.uniform(0.25, 0.6) if rng.random() < 0.25 else rng.uniform(1.6, 4.0)
    return {"amplitude": b.force * rng.uniform(0.003, 0.012), "Omega": b.omega_n * ratio, "phase": _phase(rng)}


def _outwards(b: Base, rng: np.random.Generator) -> dict[str, Any]:
    """Friction doubles to quintuples at the turning points, or at the largest acceleration."""
    return {"gain": rng.uniform(1.0, 4.0)}


def _warming(b: Base, rng: np.random.Generator) -> dict[str, Any]:
    """The work done against friction is in all some ten f_k X_0."""
    return {"gain": rng.uniform(0.05, 0.25) if rng.random() < 0.6 else -rng.uniform(0.03, 0.06)}


DRAWS: dict[str, Draw] = {
    "stribeck": lambda b, rng: {"f_s": b.f_k * rng.uniform(1.3, 2.3), "v_s": b.speed * log_uniform(rng, 0.04, 0.3)},
    "static-friction": lambda b, rng: {"f_s": b.f_k * rng.uniform(1.1, 1.8)},
    "presliding": _bristles,
    "regularised-friction": _steep,
    "position-dependent-friction": _along,
    "friction-drift": _drifting,
    "normal-load-variation": lambda b, rng: {
        "depth": rng.uniform(0.3, 0.9),
        "Omega": b.omega_n * log_uniform(rng, 0.2, 4.0),
        "phase": _phase(rng),
    },
    "load-dependent-friction": _outwards,
    "quadratic-drag": lambda b, rng: {"c2": b.m * rng.uniform(0.02, 0.1) / b.length},
    "asymmetric-viscous": lambda b, rng: {"c_diff": _signed(rng, 0.004, 0.015) * b.m * b.omega_n},
    "power-law-damping": _power,
    "viscoelastic": lambda b, rng: {
        "k_m": b.k * log_uniform(rng, 0.03, 0.3),
        "tau": log_uniform(rng, 0.1, 8.0) / b.omega_n,
    },
    "cubic-stiffness": lambda b, rng: {"k3": _signed(rng, 0.01, 0.05) * b.k / b.length**2},
    "quadratic-stiffness": lambda b, rng: {"k2": _signed(rng, 0.01, 0.06) * b.k / b.length},
    "pendulum-stiffness": lambda b, rng: {},
    "end-stop": _stops,
    "backlash": lambda b, rng: {"gap": b.length * log_uniform(rng, 0.004, 0.04)},
    "stiffness-drift": lambda b, rng: {"rate": _signed(rng, 0.006, 0.03) / b.duration},
    "constant-force": lambda b, rng: {"force": _signed(rng, 0.004, 0.02) * b.force},
    "force-ripple": lambda b, rng: {
        "amplitude": b.force * rng.uniform(0.004, 0.025),
        "period": b.length * log_uniform(rng, 0.15, 1.2),
        "phase": _phase(rng),
    },
    "harmonic-force": _shaking,
    "impulse": lambda b, rng: {
        "time": b.duration * rng.uniform(0.12, 0.7),
        "impulse": _signed(rng, 0.01, 0.05) * b.m * b.speed,
    },
    "attached-mode": lambda b, rng: {
        "omega_2": b.omega_n * log_uniform(rng, 1.5, 5.0),
        "mass_ratio": log_uniform(rng, 0.01, 0.08),
        "zeta_2": log_uniform(rng, 0.003, 0.05),
    },
    "sensor-lag": lambda b, rng: {"lag": rng.uniform(0.03, 0.2) / b.omega_n},
    "sensor-gain": lambda b, rng: {"gain": 1.0 + _signed(rng, 0.03, 0.09)},
    "sensor-bias": lambda b, rng: {"bias": _signed(rng, 0.01, 0.03) * b.length * b.omega_n**2},
    "sensor-drift": lambda b, rng: {"rate": _signed(rng, 0.01, 0.05) * b.length / b.duration},
    "sensor-clipping": lambda b, rng: {"limit": rng.uniform(0.75, 0.95) * b.length * b.omega_n**2},
    "alien-inertial-load": _outwards,
    "alien-structural-damping": _outwards,
    "alien-heating": _warming,
    "alien-random-force": lambda b, rng: {
        "size": b.force * rng.uniform(0.003, 0.012),
        "interval": rng.uniform(0.1, 0.4) * 2.0 * math.pi / b.omega_n,
        "seed": int(rng.integers(2**31)),
    },
    # a mass of 1 to 5 % in a cage of 5 to 40 % of the start
    "alien-rattle": lambda b, rng: {
        "mass_ratio": rng.uniform(0.01, 0.05),
        "clearance": b.length * rng.uniform(0.05, 0.4),
        "omega_c": b.omega_n * rng.uniform(15.0, 30.0),
        "zeta_c": rng.uniform(0.05, 0.3),
    },
    "alien-speed-stiffness": lambda b, rng: {"gain": _signed(rng, 0.02, 0.1)},
    "alien-position-viscous": _weak_either_way,
    "alien-warming-viscous": lambda b, rng: {**_weak_either_way(b, rng), "tau": b.duration * rng.uniform(0.1, 0.7)},
    "alien-quintic-stiffness": _weak_either_way,
    "alien-parametric-stiffness": lambda b, rng: {
        "size": _weak(b),
        "Omega": b.omega_n * log_uniform(rng, 0.1, 3.0),
        "phase": _phase(rng),
    },
    "alien-hysteresis": lambda b, rng: {"size": _weak(b), "reach": b.length * log_uniform(rng, 0.05, 0.5)},
    ECCENTRIC: lambda b, rng: {
        "size": 0.005 * b.length,
        "period": b.length * log_uniform(rng, 0.4, 4.0),
        "phase": _phase(rng),
    },
    "alien-magnet-well": lambda b, rng: {
        **_weak_either_way(b, rng),
        "place": _place(b, rng),
        "width": b.length * rng.uniform(0.08, 0.25),
    },
    "alien-soft-bumper": lambda b, rng: {
        "size": 10.0 * _weak(b),
        "gap": b.length * rng.uniform(0.2, 0.7),
        "side": _sign(rng),
    },
    "alien-softening": lambda b, rng: {**_weak_either_way(b, rng), "width": b.length * rng.uniform(0.08, 0.3)},
    "alien-bilinear-spring": _weak_either_way,
    "alien-eddy-brake": lambda b, rng: {"size": _weak(b), "v_c": b.speed * rng.uniform(0.1, 0.4)},
    "alien-speed-hump": lambda b, rng: {
        "size": _weak(b),
        "v_c": b.speed * rng.uniform(0.2, 0.6),
        "sharp": float(rng.uniform(2.0, 8.0)),
    },
    "alien-flow-transition": lambda b, rng: {"size": 2.0 * _weak(b), "v_c": b.speed * rng.uniform(0.25, 0.6)},
    "alien-one-way-drag": lambda b, rng: {"size": 2.0 * _weak(b), "side": _sign(rng)},
    "alien-sticky-patch": lambda b, rng: {
        "size": b.f_k,
        "place": _place(b, rng),
        "width": b.length * rng.uniform(0.1, 0.35),
    },
    "alien-edge-rub": lambda b, rng: {"size": 2.0 * b.f_k},
    "alien-half-rub": lambda b, rng: {
        "size": b.f_k,
        "place": _place(b, rng),
        "width": b.length * rng.uniform(0.03, 0.2),
    },
}
"""From a slider to parameters of an effect, SI."""

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
    elif name == "backlash":
        said["gap"] = min(factor * values["gap"], 0.15 * b.length)
    elif name not in ("pendulum-stiffness", "sensor-clipping"):
        key = next((key for key in _STRENGTH if key in values), "gain")
        most = _most(name, key, b)
        said[key] = min(max(factor * values[key], -most), most)
    if name == "friction-drift":
        said["rate"] = max(said["rate"], -0.9 / b.duration)
    return said


def _most(name: str, key: str, b: Base) -> float:
    """The largest plausible value of a strength."""
    of_effect = {"alien-inertial-load": 8.0, "load-dependent-friction": 8.0}
    of_effect |= {"friction-drift": 3.0 / b.duration, "stiffness-drift": 0.15 / b.duration}
    of_effect |= dict.fromkeys(("alien-sticky-patch", "alien-edge-rub", "alien-half-rub"), 6.0 * b.f_k)
    of_parameter = {"mass_ratio": 0.2, "slope": 0.95 / b.length, "depth": 0.95, "v_r": 0.4 * b.speed}
    return of_effect.get(name, of_parameter.get(key, math.inf))
