"""Free decays with viscous and Coulomb friction alone and the nuisances of real recordings: do errors hold the truth?

python -m benchmarks.coverage [--draws 300] [--seed S] [--of decays|phones|run-downs]

Phones: accelerations alone, with time stamps that jitter by .2 ms. Half of the run-downs
have a quadratic drag besides (benchmarks.draws.run_downs).

Clocks that jitter, noise that is coloured, quantised, a zero that is off; a plant of scipy's that shares no kernel.
"""

import argparse
import math
import sys
from collections.abc import Callable
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import solve_ivp
from scipy.interpolate import CubicSpline

from benchmarks.draws.run_downs import drawn, off_by
from harness import Recording, diagnose

Array = NDArray[np.float64]
Drawn: TypeAlias = Callable[[np.random.Generator], tuple[Recording, dict[str, float]]]
NUMBERS = ("omega_n", "zeta", "x_k")
_JITTER = 2e-4
"""Standard deviation of a phone's time stamps, s."""


def decay(t: Array, omega: float, zeta: float, x_k: float, x: float, of: int = 0) -> Array:
    """Position (n,) at t (n,), s, of a slider let go at x, which may come to rest; of : 0, or 2 for acceleration."""
    out, at, i = np.empty_like(t), float(t[0]), 0
    while abs(x) > x_k:
        side = math.copysign(1.0, x)

        def moved(_: float, y: Array, side: float = side) -> tuple[float, float]:
            return y[1], -(omega**2) * (y[0] - side * x_k) - 2.0 * zeta * omega * y[1]

        # half a damped period, in which the speed keeps its sign
        end = at + math.pi / (omega * math.sqrt(1.0 - zeta**2))
        run = solve_ivp(moved, (at, end), (x, 0.0), method="DOP853", rtol=1e-10, atol=1e-13, dense_output=True)
        j = int(np.searchsorted(t, end, side="right"))
        motion = run.sol(t[i:j])
        out[i:j] = motion[0] if of == 0 else moved(0.0, motion)[1]
        at, x, i = end, float(run.y[0, -1]), j
        if i >= t.size:
            return out
    out[i:] = x if of == 0 else 0.0
    return out


def carried(rng: np.random.Generator) -> tuple[Recording, dict[str, float]]:
    """Acceleration that a phone takes of a slider, and its true numbers."""
    omega, zeta, cycles = 2.0 * math.pi * rng.uniform(0.8, 4.0), rng.uniform(0.003, 0.02), rng.uniform(9.0, 22.0)
    size = rng.uniform(0.03, 0.2)
    x_k = size / (4.0 * cycles * rng.uniform(1.5, 4.0))
    t = np.arange(0.0, cycles * 2.0 * math.pi / omega, 1.0 / float(rng.choice([100.0, 200.0, 400.0])))
    taken = np.maximum(t + _JITTER * rng.standard_normal(t.size), 0.0)
    order = np.argsort(taken)
    a = np.empty_like(t)
    a[order] = decay(np.concatenate(([0.0], taken[order])), omega, zeta, x_k, size, of=2)[1:]
    a += rng.uniform(0.005, 0.03) * rng.standard_normal(t.size)
    return Recording(t, {"a": a}, "phone.csv"), {"omega_n": omega, "zeta": zeta, "x_k": x_k}


def recorded(rng: np.random.Generator) -> tuple[Recording, dict[str, float]]:
    """A recording, and its true numbers."""
    omega, zeta, cycles = 2.0 * math.pi * rng.uniform(0.8, 3.0), rng.uniform(0.003, 0.02), rng.uniform(9.0, 22.0)
    size = rng.uniform(0.03, 0.3) * rng.choice([-1.0, 1.0])
    x_k = abs(size) / (4.0 * cycles * rng.uniform(1.5, 4.0))
    t = np.arange(0.0, cycles * 2.0 * math.pi / omega, 2.0 * math.pi / omega / rng.integers(30, 60))
    fine = np.linspace(0.0, t[-1], 8 * t.size)
    late = rng.uniform(0.0, 0.1) * t[1] * rng.standard_normal(t.size) if rng.random() < 0.5 else np.zeros(t.size)
    x = CubicSpline(fine, decay(fine, omega, zeta, x_k, size))(np.clip(t + late, 0.0, t[-1]))
    phi = rng.uniform(0.5, 0.95) if rng.random() < 0.5 else 0.0
    sigma, noise = abs(size) * 10.0 ** rng.uniform(-3.7, -2.3), rng.standard_normal(t.size)
    for n in range(1, t.size):
        noise[n] = phi * noise[n - 1] + math.sqrt(1.0 - phi**2) * noise[n]
    x = x + sigma * noise + abs(size) * rng.uniform(-0.3, 0.3)
    if rng.random() < 0.5:
        step = sigma * rng.uniform(1.0, 8.0)
        x = step * np.round(x / step)
    return Recording(t, {"x": x}, "decay.csv"), {"omega_n": omega, "zeta": zeta, "x_k": x_k}


def main(arguments: list[str]) -> int:
    """The command."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.coverage", description=__doc__)
    parser.add_argument("--draws", type=int, default=300)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--of", choices=("decays", "phones", "run-downs"), default="decays")
    given = parser.parse_args(arguments)
    if given.of == "run-downs":
        off, wrong = _of_run_downs(given.draws, given.seed)
    else:
        off, wrong = _of_decays(given.draws, given.seed, carried if given.of == "phones" else recorded)
    for name, each in off.items():
        held = sum(z <= 2.0 for z in each)
        share = 100.0 * held / max(len(each), 1)
        print(f"{name}: two standard errors hold the truth in {held} of {len(each)} ({share:.1f} %)")
    print(f"another verdict: {wrong} of {given.draws}")
    return 0


def _of_decays(draws: int, seed: int, recorded: Drawn) -> tuple[dict[str, list[float]], int]:
    """By how many standard errors each number is off, and how many are not adequate."""
    off: dict[str, list[float]] = {name: [] for name in NUMBERS}
    named = 0
    for i in range(draws):
        recording, true = recorded(np.random.default_rng([seed, i]))
        result = diagnose(recording, engines=(), restoring="spring", zero="free" if "x" in recording else None)
        named += result.verdict != "adequate"
        for name in NUMBERS:
            one = result.baseline.parameters[name]
            if one.stderr and one.value is not None:
                off[name].append(abs(one.value - true[name]) / one.stderr)
    return off, named


def _of_run_downs(draws: int, seed: int) -> tuple[dict[str, list[float]], int]:
    """The same of run-downs, where what is hidden is named."""
    off: dict[str, list[float]] = {}
    wrong = 0
    for i in range(draws):
        one = drawn(seed, i, ("", "quadratic-drag")[i % 2])
        result = diagnose(one.recording, engines=())
        if [m.name for m in result.mechanisms] != ([one.effect] if one.effect else []):
            wrong += 1
            continue
        for name, z in off_by(result, one).items():
            off.setdefault(name, []).append(abs(z))
    return off, wrong


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
