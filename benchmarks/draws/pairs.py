"""Two effects in a free decay, each worth at least 20 effective samples, the weaker log-uniform above."""

import math
from dataclasses import replace

import numpy as np

import harness
from benchmarks.draws.shared import Answer
from harness.core.errors import HarnessError
from harness.core.recording import Recording
from harness.diagnosis.fit.model_fit import fit
from harness.diagnosis.parameters import free_of
from harness.diagnosis.problems.free_decay import FreeDecay
from harness.diagnosis.problems.simulated import observe
from harness.estimate.noise import Noise
from harness.kernels.solve import Scales
from harness.model.model import Model, ModelTerm
from harness.model.registry import term
from harness.model.term import SINGLE

SENSOR = ("sensor-lag", "sensor-gain", "sensor-bias", "sensor-drift", "sensor-clipping")
_BASE = ("c", "k", "f_k", "x0", "v0")
_MOST_WORDS = 60.0
_LEAST, _MOST = 20.0, 200.0
"""Effective samples that the weaker is worth."""


class _Drawing:
    """Numbers of one draw."""

    def __init__(self, seed: int, number: int) -> None:
        self.r = np.random.default_rng([seed, number])

    def log(self, low: float, high: float) -> float:
        return float(np.exp(self.r.uniform(math.log(low), math.log(high))))

    def side(self) -> float:
        return float(self.r.choice([-1.0, 1.0]))

    def even(self, low: float, high: float) -> float:
        return float(self.r.uniform(low, high))

    def phase(self) -> float:
        return self.even(0.0, 2.0 * math.pi)


def _numbers(d: _Drawing, key: str, k: float, size: float, w: float, friction: float, span: float) -> dict[str, float]:
    """Numbers of a law in proportion to the slider. size : m. w : rad/s. friction : N. span : s."""
    force, speed = k * size, w * size

    def small(low: float = 1e-3, high: float = 0.2) -> float:
        return d.log(low, high)

    if key == "power-law-damping":
        exponent = d.even(0.25, 0.75)
        return {"c_p": force * small(1e-3, 0.1) / speed**exponent, "exponent": exponent}
    every = {
        "stribeck": lambda: {"f_s": friction * (1.0 + d.log(0.2, 2.0)), "v_s": speed * d.log(0.03, 0.3)},
        "presliding": lambda: {"sigma0": k * d.log(1.0, 12.0), "sigma1": 0.3 * math.sqrt(k)},
        "regularised-friction": lambda: {"v_r": speed * d.log(0.01, 0.12), "lead": 0.0},
        "position-dependent-friction": lambda: {"slope": d.side() * d.log(0.2, 0.95) / size},
        "position-dependent-friction:periodic": lambda: {
            "depth": d.log(0.2, 0.95),
            "period": size * d.log(0.3, 1.5),
            "phase": d.phase(),
        },
        "friction-drift": lambda: {"rate": d.log(0.3, 3.0) / span},
        "load-dependent-friction": lambda: {"gain": d.log(0.3, 3.0) / size},
        "normal-load-variation": lambda: {
            "depth": d.log(0.2, 0.9),
            "Omega": w * d.log(0.2, 3.0),
            "phase": d.phase(),
        },
        "quadratic-drag": lambda: {"c2": force * small() / speed**2},
        "asymmetric-viscous": lambda: {"c_diff": d.side() * force * small(1e-3, 0.05) / speed},
        "cubic-stiffness": lambda: {"k3": d.side() * force * small(1e-3, 0.3) / size**3},
        "quadratic-stiffness": lambda: {"k2": d.side() * force * small() / size**2},
        "end-stop": lambda: {"gap": size * d.even(0.5, 0.9), "k_stop": k * d.log(0.05, 2.0)},
        "backlash": lambda: {"gap": size * d.log(0.003, 0.1)},
        "stiffness-drift": lambda: {"rate": d.side() * d.log(1e-3, 0.1) / span},
        "constant-force": lambda: {"force": d.side() * force * small(1e-3, 0.1)},
        "harmonic-force": lambda: {"A": force * small(1e-3, 0.05), "Omega": w * d.log(0.3, 3.0), "phase": d.phase()},
        "impulse": lambda: {"time": span * d.even(0.15, 0.8), "impulse": d.side() * speed * d.log(0.01, 0.3)},
        "force-ripple": lambda: {
            "amplitude": force * small(1e-3, 0.05),
            "period": size * d.log(0.3, 1.2),
            "phase": d.phase(),
        },
        "viscoelastic": lambda: {"k_m": k * d.log(0.01, 0.3), "tau": d.log(0.1, 3.0) / w},
        "attached-mode": lambda: {
            "omega_2": w * d.log(1.4, 5.0),
            "mass_ratio": d.log(0.003, 0.1),
            "zeta_2": d.even(0.005, 0.05),
        },
        "sensor-lag": lambda: {"lag": d.side() * d.log(1e-3, 0.1) / w},
        "sensor-gain": lambda: {"gain": 1.0 + d.side() * d.log(3e-3, 0.1)},
        "sensor-bias": lambda: {"bias": d.side() * force * small(1e-3, 0.1)},
        "sensor-drift": lambda: {"rate": d.side() * size * small() / span},
        "sensor-clipping": lambda: {"limit": force * d.even(0.5, 0.95)},
    }
    return every[key]()


NAMES = (
    "stribeck", "presliding", "regularised-friction", "position-dependent-friction",
    "position-dependent-friction:periodic", "friction-drift", "load-dependent-friction", "normal-load-variation",
    "quadratic-drag", "asymmetric-viscous", "power-law-damping", "cubic-stiffness", "quadratic-stiffness", "end-stop",
    "backlash", "stiffness-drift", "constant-force", "harmonic-force", "impulse", "force-ripple", "viscoelastic",
    "attached-mode", *SENSOR,
)  # fmt: skip


def drawn(seed: int, number: int, *, sensor: bool) -> tuple[Recording, tuple[str, str], list[float]]:
    """A recording, its two names, and what each is worth in effective samples. sensor : whether one is a sensor's."""
    d = _Drawing(seed, number)
    while True:
        found = _tried(d, sensor=sensor)
        if found is not None:
            return found


def _tried(d: _Drawing, *, sensor: bool) -> tuple[Recording, tuple[str, str], list[float]] | None:
    w, size = 2.0 * math.pi * d.log(0.5, 20.0), d.log(1e-3, 1.0)
    zeta, cycles, k, held = d.log(0.002, 0.02), d.even(8.0, 25.0), w * w, size * d.log(0.002, 0.015)
    span, n = cycles * 2.0 * math.pi / w, int(cycles * d.even(25.0, 80.0))
    t = np.arange(n, dtype=np.float64) * (span / (n - 1))
    one, two = str(d.r.choice(SENSOR if sensor else NAMES)), str(d.r.choice(NAMES))
    channels = str(d.r.choice(["x", "a", "xa"], p=[0.3, 0.2, 0.5]))
    both = [term(one), term(two)]
    twice = both[0].name == both[1].name or (both[0].slot == both[1].slot and both[0].slot in SINGLE)
    unseen = not set().union(*(one.channels for one in both)) <= set(channels)
    if twice or unseen or (any("zero" in one.needs for one in both) and "x" not in channels):
        return None
    level = {"x": size * d.log(3e-4, 6e-3), "a": size * k * d.log(2e-3, 2e-2)}
    try:
        terms = tuple(ModelTerm.named(key, **_numbers(d, key, k, size, w, k * held, span)) for key in (one, two))
        model = Model(1.0, 2.0 * zeta * w, k, k * held, x0=size, terms=terms, mass_known=False)
        problem = FreeDecay(t, {c: np.zeros(n) for c in channels}, {c: Noise(level[c], True) for c in channels})
        scales = Scales.of(replace(model, terms=()))
        clean = observe(model, problem, (), scales)
        if np.abs(clean.x[-n // 8 :]).max() < 0.02 * size:
            return None
        recorded = {c: clean.y[c] + level[c] * d.r.standard_normal(n) for c in channels}
        problem = replace(problem, channels=recorded)
        whole = fit(model, problem, free_of(model, _BASE), scales, 10, thorough=False).chi2
        worth = []
        for other in reversed(terms):
            less = replace(model, terms=(other,))
            left = fit(less, problem, free_of(less, _BASE), scales, 15, thorough=False).chi2
            worth.append(min(_MOST_WORDS, 2.0 * cycles) * math.log(max(left / whole, 1.0)))
    except HarnessError:
        return None
    goal = d.log(_LEAST, _MOST)
    if min(worth) < _LEAST or not goal / 1.6 < min(worth) < goal * 1.6:
        return None
    return Recording(t, recorded, f"{one}+{two}"), (both[0].name, both[1].name), worth


def answer(seed: int, number: int, *, sensor: bool) -> Answer:
    """Right where both are named."""
    recording, names, worth = drawn(seed, number, sensor=sensor)
    told = f"{' + '.join(names)}, worth {worth[0]:.0f} and {worth[1]:.0f}"
    try:
        found = harness.diagnose(recording, zero="spring", engines=())
    except HarnessError as error:
        return Answer(False, f"{told}: {error}")
    named = [m.name for m in found.mechanisms if m.grade not in ("minor", "tabulated")]
    right = found.verdict == "missing_physics" and set(named) == set(names)
    chi2 = found.refined.chi2_per_point
    ended = ", ended by its budget" if found.bounded else ""
    return Answer(right, f"{told}: {found.verdict} {named}, chi2 {chi2 or math.nan:.3g}{ended}")
