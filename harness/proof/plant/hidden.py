"""From the name and the parameters of an effect to the pieces it adds to a plant."""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from harness.proof.plant import branches, modulations, smooth
from harness.proof.plant.base import Base
from harness.proof.plant.friction import Bristle, Coulomb, DryFriction, Level, Modulation, Regularised
from harness.proof.plant.model import PlantModel
from harness.proof.plant.pieces import Branch, Force, Knock
from harness.proof.plant.random_force import random_walk
from harness.proof.plant.sensors import Sensors

Values = Mapping[str, Any]


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


def _friction_along(p: Values, b: Base) -> Pieces:
    if "slope" in p:
        return Pieces(modulations=(modulations.along_slope(p["slope"]),))
    return Pieces(modulations=(modulations.along_cosine(p["depth"], p["period"], p["phase"]),))


def _random(p: Values, b: Base) -> Pieces:
    law, rate = random_walk(p["size"], p["interval"], b.duration, int(p["seed"]))
    return Pieces(forces=(Force(law, rate=rate),))


Law = Callable[[Values, Base], Pieces]

BUILD: dict[str, Law] = {
    "stribeck": lambda p, b: Pieces(level={"f_s": p["f_s"], "v_s": p["v_s"]}),
    "static-friction": lambda p, b: Pieces(level={"f_s": p["f_s"]}),
    "presliding": lambda p, b: Pieces(law=lambda level: Bristle(level, p["sigma0"], p["sigma1"])),
    "regularised-friction": lambda p, b: Pieces(law=lambda level: Regularised(level, p["v_r"], p["lead"])),
    "position-dependent-friction": _friction_along,
    "friction-drift": lambda p, b: Pieces(modulations=(modulations.drifting(p["rate"]),)),
    "normal-load-variation": lambda p, b: Pieces(
        modulations=(modulations.pulsing(p["depth"], p["Omega"], p["phase"]),)
    ),
    "quadratic-drag": lambda p, b: Pieces(forces=(smooth.quadratic_drag(p["c2"]),)),
    "asymmetric-viscous": lambda p, b: Pieces(forces=(smooth.asymmetric_viscous(p["c_diff"]),)),
    "power-law-damping": lambda p, b: Pieces(forces=(smooth.power_law_damping(p["c_p"], p["exponent"]),)),
    "viscoelastic": lambda p, b: Pieces(branches=(branches.maxwell(p["k_m"], p["tau"]),)),
    "cubic-stiffness": lambda p, b: Pieces(forces=(smooth.cubic_stiffness(p["k3"]),)),
    "quadratic-stiffness": lambda p, b: Pieces(forces=(smooth.quadratic_stiffness(p["k2"]),)),
    "pendulum-stiffness": lambda p, b: Pieces(forces=(smooth.pendulum_stiffness(b.k),)),
    "end-stop": lambda p, b: Pieces(forces=(smooth.end_stop(p["gap"], p["k_stop"], p["side"]),)),
    "backlash": lambda p, b: Pieces(forces=(smooth.backlash(b.k, p["gap"]),)),
    "stiffness-drift": lambda p, b: Pieces(forces=(smooth.stiffness_drift(b.k, p["rate"]),)),
    "constant-force": lambda p, b: Pieces(forces=(smooth.constant_force(p["force"]),)),
    "force-ripple": lambda p, b: Pieces(forces=(smooth.force_ripple(p["amplitude"], p["period"], p["phase"]),)),
    "harmonic-force": lambda p, b: Pieces(forces=(smooth.harmonic_force(p["amplitude"], p["Omega"], p["phase"]),)),
    "impulse": lambda p, b: Pieces(knocks=(Knock(p["time"], p["impulse"]),)),
    "attached-mode": lambda p, b: Pieces(
        branches=(branches.attached_mode(b.m, p["omega_2"], p["mass_ratio"], p["zeta_2"]),)
    ),
    "sensor-lag": lambda p, b: Pieces(sensors={"lag": p["lag"]}),
    "sensor-gain": lambda p, b: Pieces(sensors={"gain": p["gain"]}),
    "sensor-bias": lambda p, b: Pieces(sensors={"bias": p["bias"]}),
    "sensor-drift": lambda p, b: Pieces(sensors={"drift": p["rate"]}),
    "sensor-clipping": lambda p, b: Pieces(sensors={"limit": p["limit"]}),
    "alien-inertial-load": lambda p, b: Pieces(modulations=(modulations.loaded_by_inertia(p["gain"], b.force),)),
    "alien-structural-damping": lambda p, b: Pieces(
        modulations=(modulations.growing_outwards(p["gain"], b.length),), kinks=(0.0,)
    ),
    "alien-heating": lambda p, b: Pieces(modulations=(modulations.heated(p["gain"], b.f_k * b.length),)),
    "alien-random-force": _random,
    "alien-rattle": lambda p, b: Pieces(
        branches=(branches.rattle(b.m, p["mass_ratio"], p["clearance"], p["omega_c"], p["zeta_c"]),)
    ),
    "alien-speed-stiffness": lambda p, b: Pieces(forces=(_speed_stiffness(b.k, p["gain"], b.speed),)),
}


def _speed_stiffness(k: float, gain: float, speed: float) -> Force:
    return Force(lambda t, x, v, d: k * gain * (v / speed) ** 2 * x)


def build(base: Base, effects: Mapping[str, Values], laws: Mapping[str, Law] = BUILD) -> tuple[PlantModel, Sensors]:
    """The plant and its sensors with these effects, each a name with its parameters (SI); laws : what a name builds."""
    parts: Sequence[Pieces] = [laws[name](values, base) for name, values in effects.items()]
    level: dict[str, float] = {}
    sensors: dict[str, float] = {}
    for part in parts:
        level |= part.level
        sensors |= part.sensors
    changed = Level(
        f_k=base.f_k,
        f_s=level.get("f_s", base.f_k),
        v_s=level.get("v_s"),
        modulations=tuple(m for part in parts for m in part.modulations),
    )
    law = next((part.law for part in parts if part.law is not None), Coulomb)
    model = replace(
        base.model(),
        friction=law(changed),
        forces=tuple(f for part in parts for f in part.forces),
        branches=tuple(f for part in parts for f in part.branches),
        knocks=tuple(f for part in parts for f in part.knocks),
        kinks=tuple(f for part in parts for f in part.kinks),
    )
    return model, Sensors(**sensors)


def regions(effects: Mapping[str, Values], base: Base, x: Any, saturated: Any) -> list[list[float]] | None:
    """Time spans in which effects bound to a place act, or None when no effect is: end-stop, saturation, knock."""
    t, inside, bound = base.times, np.zeros(base.samples, dtype=bool), False
    for name, p in effects.items():
        if name == "end-stop":
            bound = True
            inside |= (x > p["gap"]) & (p["side"] != "lower") | (x < -p["gap"]) & (p["side"] != "upper")
        elif name == "sensor-clipping":
            bound = True
            inside |= saturated
        elif name == "impulse":
            bound = True
            inside |= np.abs(t - p["time"]) <= 0.5 * math.pi / base.omega_n
    if not bound:
        return None
    edges = np.flatnonzero(np.diff(np.concatenate([[0], inside.astype(np.int8), [0]])))
    ends = np.append(t, 2.0 * t[-1] - t[-2])
    return [[float(t[i]), float(ends[j])] for i, j in zip(edges[::2], edges[1::2], strict=True)]
