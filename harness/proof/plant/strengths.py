"""How strong a hidden effect is: random draws relative to the slider's own scales.

The ranges are wide on purpose; what is too plain or too faint is thrown away later (``accepted`` in cases.py).
"""

import math
from collections.abc import Callable
from typing import Any

import numpy as np

from harness.proof.plant.base import Base, log_uniform

Draw = Callable[[Base, np.random.Generator], dict[str, Any]]


def _signed(rng: np.random.Generator, low: float, high: float) -> float:
    return float(rng.uniform(low, high) * rng.choice([-1.0, 1.0]))


def _phase(rng: np.random.Generator) -> float:
    return float(rng.uniform(0.0, 2.0 * math.pi))


def stribeck(b: Base, rng: np.random.Generator) -> dict[str, Any]:
    """f_s 1.3 to 2.3 times f_k, v_s a fraction of the top speed."""
    return {"f_s": b.f_k * rng.uniform(1.3, 2.3), "v_s": b.speed * log_uniform(rng, 0.04, 0.3)}


def static_friction(b: Base, rng: np.random.Generator) -> dict[str, Any]:
    """f_s 1.1 to 1.8 times f_k."""
    return {"f_s": b.f_k * rng.uniform(1.1, 1.8)}


def presliding(b: Base, rng: np.random.Generator) -> dict[str, Any]:
    """Bristles 1 to 12 times as stiff as the spring; one in four without damping of their own (Dahl)."""
    sigma0 = b.k * log_uniform(rng, 1.0, 12.0)
    share = 0.0 if rng.random() < 0.25 else rng.uniform(0.1, 0.5)
    return {"sigma0": sigma0, "sigma1": share * math.sqrt(sigma0 * b.m)}


def regularised(b: Base, rng: np.random.Generator) -> dict[str, Any]:
    """v_r a fraction of the top speed; half of them with a lead."""
    lead = 0.0 if rng.random() < 0.5 else log_uniform(rng, 0.02, 0.15) / b.omega_n
    return {"v_r": b.speed * log_uniform(rng, 0.01, 0.12), "lead": lead}


def along(b: Base, rng: np.random.Generator) -> dict[str, Any]:
    """A slope, or a cosine over the travel."""
    if rng.random() < 0.5:
        return {"slope": _signed(rng, 0.3, 0.95) / b.length}
    return {"depth": rng.uniform(0.3, 0.95), "period": b.length * log_uniform(rng, 0.25, 1.5), "phase": _phase(rng)}


def friction_drift(b: Base, rng: np.random.Generator) -> dict[str, Any]:
    """Friction grows by half to two, or falls by a third to four fifths, over the recording."""
    change = rng.uniform(0.5, 2.0) if rng.random() < 0.6 else -rng.uniform(0.3, 0.8)
    return {"rate": change / b.duration}


def normal_load(b: Base, rng: np.random.Generator) -> dict[str, Any]:
    """Depth 0.3 to 0.9 at 0.2 to 4 times the slider's frequency."""
    return {"depth": rng.uniform(0.3, 0.9), "Omega": b.omega_n * log_uniform(rng, 0.2, 4.0), "phase": _phase(rng)}


def quadratic_drag(b: Base, rng: np.random.Generator) -> dict[str, Any]:
    """2 to 10 % of the spring's force at top speed."""
    return {"c2": b.m * rng.uniform(0.02, 0.1) / b.length}


def asymmetric(b: Base, rng: np.random.Generator) -> dict[str, Any]:
    """A difference of 0.4 to 1.5 % of m omega_n."""
    return {"c_diff": _signed(rng, 0.004, 0.015) * b.m * b.omega_n}


def power_law(b: Base, rng: np.random.Generator) -> dict[str, Any]:
    """0.6 to 3 % of the spring's force at top speed, exponent 0.2 to 0.8."""
    p = rng.uniform(0.2, 0.8)
    return {"c_p": rng.uniform(0.006, 0.03) * b.force / b.speed**p, "exponent": p}


def viscoelastic(b: Base, rng: np.random.Generator) -> dict[str, Any]:
    """A Maxwell branch of 3 to 30 % of the spring, relaxing in about a radian of the motion or more."""
    return {"k_m": b.k * log_uniform(rng, 0.03, 0.3), "tau": log_uniform(rng, 0.1, 8.0) / b.omega_n}


def cubic(b: Base, rng: np.random.Generator) -> dict[str, Any]:
    """1 to 5 % of the spring's force at the start."""
    return {"k3": _signed(rng, 0.01, 0.05) * b.k / b.length**2}


def quadratic(b: Base, rng: np.random.Generator) -> dict[str, Any]:
    """1 to 6 % of the spring's force at the start."""
    return {"k2": _signed(rng, 0.01, 0.06) * b.k / b.length}


def nothing(b: Base, rng: np.random.Generator) -> dict[str, Any]:
    """A law without parameters of its own."""
    return {}


def end_stop(b: Base, rng: np.random.Generator) -> dict[str, Any]:
    """Reached in the first few swings; the side is one that the slider reaches."""
    side = str(rng.choice(["upper", "both", "lower"], p=[0.45, 0.4, 0.15]))
    return {"gap": b.length * rng.uniform(0.6, 0.93), "k_stop": b.k * rng.uniform(0.1, 0.6), "side": side}


def backlash(b: Base, rng: np.random.Generator) -> dict[str, Any]:
    """A dead zone of 0.4 to 4 % of the start."""
    return {"gap": b.length * log_uniform(rng, 0.004, 0.04)}


def stiffness_drift(b: Base, rng: np.random.Generator) -> dict[str, Any]:
    """0.6 to 3 % over the recording."""
    return {"rate": _signed(rng, 0.006, 0.03) / b.duration}


def constant_force(b: Base, rng: np.random.Generator) -> dict[str, Any]:
    """0.4 to 2 % of the spring's force at the start."""
    return {"force": _signed(rng, 0.004, 0.02) * b.force}


def force_ripple(b: Base, rng: np.random.Generator) -> dict[str, Any]:
    """0.4 to 2.5 % of the spring's force, period 0.15 to 1.2 of the start."""
    return {
        "amplitude": b.force * rng.uniform(0.004, 0.025),
        "period": b.length * log_uniform(rng, 0.15, 1.2),
        "phase": _phase(rng),
    }


def harmonic_force(b: Base, rng: np.random.Generator) -> dict[str, Any]:
    """0.3 to 1.2 % of the spring's force, away from the slider's own frequency."""
    ratio = rng.uniform(0.25, 0.6) if rng.random() < 0.25 else rng.uniform(1.6, 4.0)
    return {"amplitude": b.force * rng.uniform(0.003, 0.012), "Omega": b.omega_n * ratio, "phase": _phase(rng)}


def impulse(b: Base, rng: np.random.Generator) -> dict[str, Any]:
    """1 to 5 % of the top speed, in the first three quarters."""
    return {"time": b.duration * rng.uniform(0.12, 0.7), "impulse": _signed(rng, 0.01, 0.05) * b.m * b.speed}


def attached_mode(b: Base, rng: np.random.Generator) -> dict[str, Any]:
    """A second mass of 1 to 8 % at 1.5 to 5 times the frequency."""
    return {
        "omega_2": b.omega_n * log_uniform(rng, 1.5, 5.0),
        "mass_ratio": log_uniform(rng, 0.01, 0.08),
        "zeta_2": log_uniform(rng, 0.003, 0.05),
    }


def sensor_lag(b: Base, rng: np.random.Generator) -> dict[str, Any]:
    """0.03 to 0.2 rad of the motion."""
    return {"lag": rng.uniform(0.03, 0.2) / b.omega_n}


def sensor_gain(b: Base, rng: np.random.Generator) -> dict[str, Any]:
    """3 to 9 % up or down."""
    return {"gain": 1.0 + _signed(rng, 0.03, 0.09)}


def sensor_bias(b: Base, rng: np.random.Generator) -> dict[str, Any]:
    """1 to 3 % of the first acceleration."""
    return {"bias": _signed(rng, 0.01, 0.03) * b.length * b.omega_n**2}


def sensor_drift(b: Base, rng: np.random.Generator) -> dict[str, Any]:
    """1 to 5 % of the start over the recording."""
    return {"rate": _signed(rng, 0.01, 0.05) * b.length / b.duration}


def sensor_clipping(b: Base, rng: np.random.Generator) -> dict[str, Any]:
    """At 75 to 95 % of the first acceleration."""
    return {"limit": rng.uniform(0.75, 0.95) * b.length * b.omega_n**2}


def inertial_load(b: Base, rng: np.random.Generator) -> dict[str, Any]:
    """Friction doubles to quintuples at the largest acceleration."""
    return {"gain": rng.uniform(1.0, 4.0)}


def structural(b: Base, rng: np.random.Generator) -> dict[str, Any]:
    """Friction doubles to quintuples at the turning points."""
    return {"gain": rng.uniform(1.0, 4.0)}


def heating(b: Base, rng: np.random.Generator) -> dict[str, Any]:
    """Friction changes with the work done against it, which in all is some ten f_k X_0."""
    return {"gain": rng.uniform(0.05, 0.25) if rng.random() < 0.6 else -rng.uniform(0.03, 0.06)}


def random_force(b: Base, rng: np.random.Generator) -> dict[str, Any]:
    """0.3 to 1.2 % of the spring's force, wandering within a fraction of a period."""
    return {
        "size": b.force * rng.uniform(0.003, 0.012),
        "interval": rng.uniform(0.1, 0.4) * 2.0 * math.pi / b.omega_n,
        "seed": int(rng.integers(2**31)),
    }


def rattle(b: Base, rng: np.random.Generator) -> dict[str, Any]:
    """A loose mass of 1 to 5 % in a cage of 5 to 40 % of the start."""
    return {
        "mass_ratio": rng.uniform(0.01, 0.05),
        "clearance": b.length * rng.uniform(0.05, 0.4),
        "omega_c": b.omega_n * rng.uniform(15.0, 30.0),
        "zeta_c": rng.uniform(0.05, 0.3),
    }


def speed_stiffness(b: Base, rng: np.random.Generator) -> dict[str, Any]:
    """The spring stiffens or softens by 2 to 10 % at top speed."""
    return {"gain": _signed(rng, 0.02, 0.1)}


STRENGTH: dict[str, Draw] = {
    "stribeck": stribeck,
    "static-friction": static_friction,
    "presliding": presliding,
    "regularised-friction": regularised,
    "position-dependent-friction": along,
    "friction-drift": friction_drift,
    "normal-load-variation": normal_load,
    "quadratic-drag": quadratic_drag,
    "asymmetric-viscous": asymmetric,
    "power-law-damping": power_law,
    "viscoelastic": viscoelastic,
    "cubic-stiffness": cubic,
    "quadratic-stiffness": quadratic,
    "pendulum-stiffness": nothing,
    "end-stop": end_stop,
    "backlash": backlash,
    "stiffness-drift": stiffness_drift,
    "constant-force": constant_force,
    "force-ripple": force_ripple,
    "harmonic-force": harmonic_force,
    "impulse": impulse,
    "attached-mode": attached_mode,
    "sensor-lag": sensor_lag,
    "sensor-gain": sensor_gain,
    "sensor-bias": sensor_bias,
    "sensor-drift": sensor_drift,
    "sensor-clipping": sensor_clipping,
    "alien-inertial-load": inertial_load,
    "alien-structural-damping": structural,
    "alien-heating": heating,
    "alien-random-force": random_force,
    "alien-rattle": rattle,
    "alien-speed-stiffness": speed_stiffness,
}
