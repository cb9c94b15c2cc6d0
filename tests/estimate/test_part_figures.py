"""What the parts of the estimators give for numbers at random, number by number, is what it was.

What writes them anew: ``PYTHONPATH=.:tests/support python tests/estimate/test_part_figures.py``
"""

import sys
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from unchanged import differences, flat, known, noisy, write

from harness.core.arrays import FloatArray
from harness.estimate.channel import ChannelFit, fit_channel
from harness.estimate.displacement import _by_eq_7, _fit, half_cycle_frequency
from harness.estimate.guard import find_guard
from harness.estimate.halfcycles import fit_separately, moved_edges, with_variance
from harness.estimate.isolated import constant_decrement, log_decrement
from harness.estimate.jumps import as_acceleration, combine, find_jumps
from harness.estimate.local import acceleration_local, samples_beside
from harness.estimate.noise import Noise, channel_noise, quantisation_step
from harness.estimate.paper import acceleration_paper, beside, by_eq_12, by_eq_13, moving_average
from harness.estimate.phase import sensor_lead
from harness.estimate.result import quantity, rates_to_modal
from harness.estimate.reversals import Kind, _crossings, _train, find_half_cycles, period_of
from harness.estimate.saturation import saturated
from harness.estimate.sequence import powers, whitening
from harness.estimate.tied import value_at
from harness.estimate.turning import (
    TurningPoints,
    _locally,
    all_edges,
    first_and_last_seen,
    reversal_times,
    turning_points,
)
from harness.exact.decay import Decay, free_decay

FILE = Path(__file__).with_name("part_figures.json")
DRAWS = 12


def _random(seed: int) -> np.random.Generator:
    return np.random.default_rng([99, seed])


def _fits() -> list[ChannelFit]:
    """Of decays in each channel: clean ones, short ones, noisy ones, and one whose reversals are smeared."""
    found = []
    for i in range(DRAWS):
        rng, kind = _random(i), list(Kind)[i % 3]
        decay = Decay(float(rng.uniform(4.0, 20.0)), float(rng.uniform(0.0, 0.04)), float(rng.uniform(0.004, 0.03)))
        period = 2.0 * np.pi / decay.omega_n
        t = np.linspace(float(rng.choice([0.0, 0.3])) * period, float(rng.uniform(2.5, 6.0)) * period, 300)
        run = free_decay(decay, t)
        y = {Kind.DISPLACEMENT: run.x, Kind.VELOCITY: run.v, Kind.ACCELERATION: run.a}[kind]
        if i % 4 == 3:
            y = np.convolve(y, np.full(9, 1.0 / 9.0), "same")
        size = float(np.ptp(y)) * float(10.0 ** rng.uniform(-4.5, -2.0))
        found.append(fit_channel(t, noisy(y, size, i), kind))
    return found


def _of_fits() -> Any:
    return [
        {
            "holds": fit.holds,
            "turning": turning_points(fit),
            "merged": turning_points(fit).merged(),
            "locally": _locally(fit) if fit.kind is Kind.DISPLACEMENT else None,
            "reversals": reversal_times(fit),
            "edges": all_edges(fit),
            "seen": first_and_last_seen(fit),
            "frequency": half_cycle_frequency(fit, np.r_[np.nan, reversal_times(fit), np.nan]),
            "guard": find_guard(fit.t, fit.y, fit.separate, fit.noise.sigma**2),
            "moved": moved_edges(fit.separate, fit.cycles, fit.t),
            "least": with_variance(fit.separate, 1e-3).variance,
        }
        for fit in _fits()
    ]


def _of_jumps() -> Any:
    said = []
    for fit in _fits():
        if fit.kind is Kind.DISPLACEMENT:
            continue
        separate = as_acceleration(fit.separate)
        for follow in (False, True):
            jumps = find_jumps(separate, fit.cycles.side, follow)
            said.append({"separate": separate, "jumps": jumps, "all": combine(jumps, fit.variance)})
    return said


def _apart() -> Any:
    said = []
    for fit in _fits():
        for guard, fixed in ((0.0, False), (0.05, False), (0.12, True)):
            start = (1.1 * fit.sigma + 0.01, 0.97 * fit.omega)
            cycles = fit.separate
            said.append(fit_separately(fit.t, fit.y, fit.kind, cycles.edges, guard * np.pi / fit.omega, start, fixed))
    return said


def _leads() -> Any:
    said = []
    for i in range(DRAWS):
        decay = Decay(9.0 + i, 0.01, 0.01)
        t = np.linspace(0.1, 4.0, 400)
        x, a = free_decay(decay, t - 2e-3 * i).x, free_decay(decay, t).a
        fits = fit_channel(t, noisy(a, 0.1, i), Kind.ACCELERATION), fit_channel(t, noisy(x, 1e-3, i), Kind.DISPLACEMENT)
        said.append(sensor_lead(*fits))
    return said


def _noise() -> Any:
    said = []
    for i in range(DRAWS):
        rng = _random(200 + i)
        noise = Noise(float(rng.uniform(0.1, 2.0)), True, phi=float(rng.choice([0.0, 0.3, -0.4, 0.8])))
        y = rng.standard_normal(50)
        t = np.linspace(0.0, 3.0, 240)
        e = np.asarray(noise.drawn(t.size, np.random.default_rng(i)))
        signal = 30.0 * np.sin((1.0 + i) * t) + e
        step = 0.5 * i
        said.append(
            {
                "white": noise.whitened(y.copy()),
                "rows": noise.whitened(rng.standard_normal((20, 2))),
                "means": [noise.of_means(n) for n in (1, 2, 7)],
                "drawn": e,
                "over": noise.over(signal, np.random.default_rng(i)),
                "inflation": noise.inflation(3.0, 0.1),
                "seen": [channel_noise(t, signal, period) for period in (None, 2.0, 9.0)],
                "stepped": channel_noise(t, np.round(signal / step) * step if step else signal),
                "step": [quantisation_step(np.round(signal / s) * s) for s in (0.01, 0.4, 3.0)],
            }
        )
    return said


def _reversals() -> Any:
    said = []
    for i in range(4 * DRAWS):
        rng = _random(300 + i)
        gaps = np.concatenate(
            [
                rng.uniform(0.05, 0.4, int(rng.integers(0, 4))),
                rng.normal(1.0, 0.1, int(rng.integers(0, 9))),
                rng.uniform(1.0, 3.0, 2),
            ]
        )
        times = np.cumsum(rng.permutation(gaps) if i % 3 == 0 else gaps)
        train = _train(times, 2.0 * float(rng.uniform(0.7, 1.3)))
        g = np.sin(np.linspace(0.0, 20.0, 200)) * np.linspace(1.0, 0.0, 200) + 0.1 * rng.standard_normal(200)
        said.append([train.start, train.stop, _crossings(np.linspace(0.0, 20.0, 200), g, 0.1 * (i % 5))])
        decay = Decay(float(rng.uniform(2.0, 30.0)), 0.01, float(rng.uniform(0.0, 0.1)))
        t = np.linspace(0.0, 3.0, 260)
        y = noisy(free_decay(decay, t).x, float(10.0 ** rng.uniform(-4.0, -0.7)), i)
        noise = channel_noise(t, y)
        try:
            found: Any = [period_of(t, y, Kind.DISPLACEMENT, noise), find_half_cycles(t, y, Kind.DISPLACEMENT, noise)]
        except Exception as reason:
            found = str(reason)
        said.append(found)
    return said


def _clipped() -> Any:
    said = []
    for i in range(8 * DRAWS):
        rng = _random(400 + i)
        t = np.linspace(0.0, 5.0, int(rng.integers(80, 500)))
        if i % 7 == 6:
            t = np.delete(t, slice(30, 36))
        y = np.exp(-0.2 * t) * np.cos(float(rng.uniform(2.0, 12.0)) * t)
        sigma = float(10.0 ** rng.uniform(-5.0, -2.0)) * (i % 3 > 0)
        step = float(10.0 ** rng.uniform(-3.5, -1.5)) if i % 2 else 0.0
        y = noisy(y, sigma, i)
        y = np.clip(
            np.round(y / step) * step if step else y, float(rng.uniform(-1.1, -0.2)), float(rng.uniform(0.2, 1.1))
        )
        said.append(saturated(t, y, channel_noise(t, y)).astype(float))
    return said


def _turning_by_hand() -> Any:
    """Turning points with errors, some unseen, as the displacement's recursion sees them."""
    said = []
    for i in range(2 * DRAWS):
        rng, q = _random(500 + i), float(_random(600 + i).uniform(0.7, 0.99))
        count = int(rng.integers(2, 9))
        size = [1.0]
        for _ in range(count):
            size.append(q * size[-1] - (1.0 + q) * 0.01)
        sides: FloatArray = np.where(np.arange(count) % 2 == 0, 1.0, -1.0)
        offset = 0.05 * (i % 2)
        ends = np.stack([sides * size[:-1], -sides * size[1:]], axis=1) + offset
        seen = rng.random((count, 2)) < 0.9
        seen[0, 0] = True
        covariance = np.tile(np.diag([1e-6, 2e-6]) + 1e-7, (count, 1, 1))
        points = TurningPoints(
            np.cumsum(np.ones((count, 2)), axis=0), ends + 1e-3 * rng.standard_normal((count, 2)), covariance, seen
        )
        fit, shifted = _fit(points, sides, 0.9)
        said.append(
            {
                "fit": [fit.theta, fit.covariance, fit.squares, fit.scatter, shifted],
                "merged": points.merged(),
                "eq. 7": [_by_eq_7(points.merged()[1], j, offset) for j in range(count - 3)],
                "whitening": whitening(covariance),
                "powers": powers(q, count),
            }
        )
    return said


def _isolated() -> Any:
    said = []
    for i in range(3 * DRAWS):
        rng = _random(700 + i)
        count = int(rng.integers(1, 14))
        size = 0.9 ** np.arange(count) if i % 2 else np.maximum(1.0 - 0.08 * np.arange(count), 0.01)
        sides: FloatArray = np.where(np.arange(count) % 2 == 0, 1.0, -1.0)
        turning: FloatArray = sides * size + 3e-3 * rng.standard_normal(count)
        variance: FloatArray = np.full(count, float(10.0 ** rng.uniform(-6.0, -2.0)))
        times: FloatArray = np.linspace(0.0, 0.3 * count, count)
        said.append([m(times, turning, variance, (9.0, 0.01), "m") for m in (log_decrement, constant_decrement)])
    return said


def _by_samples() -> Any:
    """The methods that look at samples beside each reversal."""
    said = []
    for i in range(2 * DRAWS):
        rng = _random(800 + i)
        decay = Decay(float(rng.uniform(5.0, 12.0)), float(rng.uniform(0.0, 0.05)), float(rng.uniform(0.002, 0.03)))
        half = np.pi / decay.omega_n
        t = np.arange(0.0, float(rng.uniform(2.2, 9.0)) * half, half / float(rng.uniform(12.0, 60.0)))
        a = noisy(free_decay(decay, t).a, 1e-3, i)
        edges: FloatArray = np.arange(int(t[-1] / half) + 1, dtype=np.float64) * half + rng.choice([0.0, 0.2 * half])
        rate = decay.zeta * decay.omega_n
        omega_d = (float(np.pi / half), 0.01)
        ends = (bool(i % 2), bool(i % 3))
        before, after = beside(t, moving_average(a), edges, 5)
        said.append(
            {
                "samples": samples_beside(t, a, edges, (rate, omega_d[0])),
                "local": acceleration_local(t, a, 1e-3, edges, ends, 1, omega_d, rate, "m"),
                "paper": [acceleration_paper(t, a, edges, omega_d, drop_first=drop) for drop in (True, False)],
                "eqs.": [by_eq_12(before), by_eq_13(after), moving_average(a, 3)],
            }
        )
    return said


def _numbers() -> Any:
    covariance = np.array([[2e-3, 1e-4], [1e-4, 5e-3]])
    theta = np.array([0.2, 9.0, 0.9, 80.0, 0.1, 0.3])
    t = np.linspace(-0.2, 3.0, 90)
    samples: list[FloatArray] = [value_at(t, kind, theta, side, 6) for kind in Kind for side in (-1, 1)]
    return [
        quantity(1.0, 0.1, "m"),
        quantity(np.nan, 0.1, "m"),
        quantity(1.0, np.inf, "m"),
        rates_to_modal(0.3, 9.0, covariance),
        rates_to_modal(-0.3, 9.0, -covariance),
        *(np.nan_to_num(y, nan=-7.0) for y in samples),
        replace(Noise(1.0, True), sigma=2.0),
    ]


CASES: dict[str, Callable[[], Any]] = {
    "fits": _of_fits,
    "jumps": _of_jumps,
    "apart": _apart,
    "leads": _leads,
    "noise": _noise,
    "reversals": _reversals,
    "clipped": _clipped,
    "turning points": _turning_by_hand,
    "isolated": _isolated,
    "by samples": _by_samples,
    "numbers": _numbers,
}


@pytest.mark.parametrize("name", CASES)
def test_every_part_gives_what_it_gave(name: str) -> None:
    assert differences(flat(CASES[name]()), known(FILE)[name]) == []


if __name__ == "__main__":
    write(FILE, CASES)
    sys.stdout.write(f"{FILE}\n")
