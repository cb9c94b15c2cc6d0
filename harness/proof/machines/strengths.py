"""How strong an effect of a machine is: a first draw, and the same made stronger or weaker within what is plausible."""

import math
from collections.abc import Mapping
from typing import Any

import numpy as np

from harness.proof.plant import strengths as plant
from harness.proof.plant.base import Base, log_uniform
from harness.proof.plant.strengths import Draw

Values = Mapping[str, Any]


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


OWN: dict[str, Draw] = {
    "load-dependent-friction": plant.structural,
    "alien-position-viscous": _signed,
    "alien-quintic-stiffness": _signed,
    "alien-bilinear-spring": _signed,
    "alien-warming-viscous": lambda b, rng: {**_signed(b, rng), "tau": b.duration * rng.uniform(0.1, 0.7)},
    "alien-parametric-stiffness": lambda b, rng: {
        "size": _weak(b),
        "Omega": b.omega_n * log_uniform(rng, 0.1, 3.0),
        "phase": _phase(rng),
    },
    "alien-hysteresis": lambda b, rng: {"size": _weak(b), "reach": b.length * log_uniform(rng, 0.05, 0.5)},
    "alien-eccentric-encoder": lambda b, rng: {
        "size": 0.005 * b.length,
        "period": b.length * log_uniform(rng, 0.4, 4.0),
        "phase": _phase(rng),
    },
    "alien-magnet-well": lambda b, rng: {
        **_signed(b, rng),
        "place": _place(b, rng),
        "width": b.length * rng.uniform(0.08, 0.25),
    },
    "alien-soft-bumper": lambda b, rng: {
        "size": 10.0 * _weak(b),
        "gap": b.length * rng.uniform(0.2, 0.7),
        "side": _sign(rng),
    },
    "alien-softening": lambda b, rng: {**_signed(b, rng), "width": b.length * rng.uniform(0.08, 0.3)},
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
"""Laws that the plant of the blind proof does not have."""


def draw_strength(name: str, b: Base, rng: np.random.Generator) -> dict[str, Any]:
    """Parameters of an effect, SI, relative to the machine's own scales."""
    return (OWN[name] if name in OWN else plant.STRENGTH[name])(b, rng)


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
