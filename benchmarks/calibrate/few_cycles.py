"""Random misfit: how often does a law of one parameter pass gain and share where there is nothing to find?

What is left is of its own amplitude and phase in each stroke. Laws answer to first order, as in the screen. Beside it
the rate where a stroke says one word alone, as evidence counts them, and laws are directions by chance: an upper bound,
since laws resemble each other and the base, and a stroke says more.
"""

import math
from collections.abc import Iterator, Mapping, Sequence

import numpy as np
from scipy.stats import beta

from benchmarks.calibrate.calibration import Calibration, stands
from harness.diagnosis.baseline.base_fit import baseline
from harness.diagnosis.baseline.words import Strokes, evidence
from harness.diagnosis.grading.misfit import misfit
from harness.diagnosis.problems.free_decay import FreeDecay
from harness.diagnosis.rules import GAIN, LEAST_CYCLES, SHARE_OF_EXCESS
from harness.diagnosis.search.look import evidence as starting_evidence
from harness.diagnosis.search.screen import screen
from harness.estimate.noise import channel_noise
from harness.model.registry import NAMED
from harness.proof.plant.base import Base
from harness.proof.plant.integrate import simulate

CYCLES = (4, 5, 6, 8, 10, 14)
LEVEL = 0.05
_ONE = tuple(term for term in NAMED if len(term.parameters) == 1 and term.amplitude is not None)
_MISFIT, _NOISE = 0.01, 1e-4
"""Over the first amplitude."""
_PER_CYCLE = 50


def measure(seed: int, index: int) -> Mapping[int, bool]:
    """Whether some law passes, for each number of cycles from the first turning point on."""
    rng = np.random.default_rng([seed, 5, index])
    return {cycles: _passes(cycles, rng) for cycles in CYCLES}


def _passes(cycles: int, rng: np.random.Generator) -> bool:
    omega_n, half, left = 10.0, 0.5, float(rng.uniform(0.2, 0.6))
    # half a cycle more, which ends at the first turning point; the decay half viscous, half dry
    turns = cycles + half
    base = Base(
        m=1.0,
        omega_n=omega_n,
        zeta=half * math.log(1.0 / left) / (2.0 * math.pi * turns),
        x_k=0.7 * half * (1.0 - left) / (4.0 * turns),
        x0=1.0,
        v0=0.0,
        length=1.0,
        duration=turns * 2.0 * math.pi / omega_n,
        samples=int(turns * _PER_CYCLE),
    )
    t = base.times
    run = simulate(base.model(), t)
    stroke = Strokes.by(run.v).of
    a, b = rng.standard_normal((2, stroke[-1] + 1))[:, stroke]
    x = run.x + _MISFIT * (a * np.cos(omega_n * t) + b * np.sin(omega_n * t)) + _NOISE * rng.standard_normal(t.size)
    problem = FreeDecay(t, {"x": x}, {"x": channel_noise(t, x)}, zero_free=True)
    found = misfit(problem, *baseline(problem))
    base_fit, scales = found.base, found.scales
    promised = screen(base_fit, found.problem, starting_evidence(base_fit, found.problem, scales), scales, _ONE)
    return any(
        evidence(base_fit.chi2, base_fit.chi2 - c.gain, found.words, 1, 1.0) >= GAIN.value
        and c.gain >= SHARE_OF_EXCESS.value * base_fit.chi2
        for c in promised
    )


_OF_BASE = 6
"""Words that the base's own parameters take up: mass aside, damping, spring, friction, zero, start and speed."""


def by_words(cycles: int, laws: int) -> float:
    """Chance that the best of so many directions passes, where a misfit says one word a stroke.

    The share of squares that one direction takes off n independent words is Beta(1/2, (n - 1)/2).
    """
    words = 2.0 * cycles
    needed = 1.0 - math.exp(-(GAIN.value + math.log(words)) / words)
    single = float(beta.sf(max(needed, SHARE_OF_EXCESS.value), 0.5, (words - _OF_BASE - 1.0) / 2.0))
    return float(-math.expm1(laws * math.log1p(-single)))


def said(rows: Sequence[Mapping[int, bool]]) -> Iterator[str]:
    """The rate at each number of cycles."""
    yield f"best of {len(_ONE)} laws of one parameter on random misfit, {len(rows)} draws"
    yield "cycles " + " ".join(f"{cycles:>7d}" for cycles in CYCLES)
    rates = {cycles: sum(row[cycles] for row in rows) / max(len(rows), 1) for cycles in CYCLES}
    yield "passes " + " ".join(f"{100.0 * rate:>5.1f} %" for rate in rates.values())
    bounds = " ".join(f"{100.0 * by_words(cycles, len(_ONE)):>5.1f} %" for cycles in CYCLES)
    yield "bound  " + bounds + f" (one word a stroke, {len(_ONE)} directions by chance)"
    here = max((rate for cycles, rate in rates.items() if cycles >= LEAST_CYCLES.value), default=1.0)
    yield stands(
        LEAST_CYCLES, here <= LEVEL, f"{100.0 * here:.1f} % at the most from there on, {100 * LEVEL:.0f} % is borne"
    )


CALIBRATION = Calibration(measure, said, "how often random misfit passes for a law of one parameter")
