"""What every estimator says of twenty-odd small recordings, number by number, is what it said before.

Physics is stated by the tests beside this one; here any change of a figure has to be meant. What writes them anew:
``PYTHONPATH=.:tests/support python tests/estimate/test_figures.py``
"""

import sys
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from unchanged import by_place, differences, flat, known, noisy, write

from benchmarks import table1
from harness.core.arrays import FloatArray
from harness.core.errors import InputError
from harness.core.recording import Recording
from harness.core.slider import Slider
from harness.estimate.channel import fit_channel
from harness.estimate.displacement import displacement
from harness.estimate.every import estimate_all
from harness.estimate.noise import channel_noise
from harness.estimate.reversals import Kind
from harness.estimate.saturation import within_range
from harness.exact.decay import Decay, free_decay

FILE = Path(__file__).with_name("figures.json")
DECAY = Decay(9.4, 0.012, 0.011)


@dataclass(frozen=True)
class Made:
    """Samples of a decay: times, channels and what of them is shown."""

    t: FloatArray
    x: FloatArray
    v: FloatArray
    a: FloatArray

    def said(self, shown: str, unit: str = "m", **given: Any) -> Any:
        """All methods, of the channels named."""
        return {"all": estimate_all(self.t, **{name: getattr(self, name) for name in shown}, unit=unit, **given)}


def made(
    decay: Decay = DECAY,
    end: float = 4.2,
    count: int = 420,
    noise: float = 2e-4,
    seed: int = 3,
    begin: float = 0.0,
    t: FloatArray | None = None,
) -> Made:
    """A decay with white noise of this share of each channel's size."""
    t = np.linspace(begin, end, count) if t is None else t
    run = free_decay(decay, t)
    size = np.array([1.0, decay.omega_n, decay.omega_n**2])
    x, v, a = (noisy(y, noise * s, seed + i) for i, (y, s) in enumerate(zip((run.x, run.v, run.a), size, strict=True)))
    return Made(t, x, v, a)


def _jittered() -> FloatArray:
    t = np.linspace(0.0, 4.0, 400) + 2e-3 * np.random.default_rng(8).standard_normal(400)
    return np.asarray(np.delete(np.sort(t), slice(120, 128)))


def _coloured() -> Any:
    clean, rng = made(noise=0.0), np.random.default_rng(4)
    e = 1e-3 * rng.standard_normal(clean.t.size)
    for i in range(1, e.size):
        e[i] += 0.7 * e[i - 1]
    return replace(clean, x=clean.x + e).said("x")


def _smeared() -> Any:
    fine = made(count=4200, noise=0.0)
    a = np.convolve(fine.a, np.full(81, 1.0 / 81.0), "same")[::10]
    return Made(fine.t[::10], fine.x[::10], fine.v[::10], noisy(a, 0.02, 6)).said("a")


def _bent() -> Any:
    clean = made()
    return replace(clean, x=clean.x + 0.03 * clean.x**3).said("x")


def _resting(held: float) -> Any:
    decay = Decay(9.4, 0.012, 0.06)
    late = made(decay, end=7.0, count=500)
    t = np.concatenate((np.linspace(-held, -0.02, 30), late.t))
    before = np.zeros(30)
    x = np.concatenate((noisy(before + 1.0, 2e-4, 9), late.x))
    a = np.concatenate((noisy(before, 2e-4 * 88.0, 10), late.a))
    return Made(t, x, x, a).said("xa")


def _of(t: FloatArray, y: FloatArray, shown: str = "x") -> Any:
    return Made(t, y, y, y).said(shown)


def _clipped() -> Any:
    clean = made(noise=0.0, count=900)
    out = []
    for low, high, step, sigma in ((-9.0, 0.6, 0.0, 1e-3), (-0.5, 9.0, 0.0, 2e-4), (-0.7, 0.7, 1e-3, 0.0)):
        x = noisy(clean.x, sigma, 2)
        x = np.clip(np.round(x / step) * step if step else x, low, high)
        kept, said = within_range(Recording(clean.t, {"x": x, "v": np.clip(clean.v, -8.0, 6.0)}), ("x", "v"))
        out.append({"t": kept.t, "said": said})
    return out


def _paper() -> Any:
    slow = made(end=3.0, count=900)
    fit = fit_channel(slow.t, slow.x, Kind.DISPLACEMENT)
    return [
        table1.displacement_paper(slow.t, slow.x, fit.edges, (fit.omega, 0.01)),
        table1.displacement_paper(slow.t, slow.x, fit.edges[:3], (fit.omega, 0.01)),
        displacement(fit, "rad"),
        table1.table(setup=replace(table1.Setup(), starts=(5e-3, 5.2e-3), rate=250.0)),
        table1.table(Slider(2.0, 0.5, 900.0, 0.4), replace(table1.Setup(), starts=(4e-3,) * 2, rate=200.0, seed=4)),
    ]


def _noises() -> Any:
    rng, t = np.random.default_rng(1), np.linspace(0.0, 5.0, 600)
    slow = np.sin(3.0 * t)
    white = 1e-3 * rng.standard_normal(t.size)
    return [
        channel_noise(t, y, period)
        for period in (None, 2.0)
        for y in (slow, slow + white, np.round((slow + white) / 5e-3) * 5e-3, np.cumsum(white), white, slow * (t > 1.0))
    ]


def _refused() -> Any:
    said, t = [], np.linspace(0.0, 1.0, 40)
    cases: tuple[dict[str, Any], ...] = (
        {"x": t[:30]},
        {"x": t * np.nan},
        {},
        {"x": t[:12], "t": t[:12]},
        {"x": t, "t": t[::-1]},
    )
    for given in cases:
        with pytest.raises(InputError) as error:
            estimate_all(given.pop("t", t), **given)
        said.append(str(error.value))
    return said


def _at_random(seed: int) -> Any:
    """Of many recordings of any kind, as one number and one text each."""
    rng = np.random.default_rng(seed)
    said: dict[str, Any] = {}
    for i in range(RANDOM):
        zeta, x_k = 10.0 ** rng.uniform(-3.5, -0.7), 10.0 ** rng.uniform(-3.0, -0.5)
        decay = Decay(
            10.0 ** rng.uniform(0.3, 1.6),
            zeta * (rng.random() < 0.85),
            x_k * (rng.random() < 0.85),
            rng.choice([-1, 1]),
        )
        period = 2.0 * np.pi / decay.omega_n
        end, count = period * rng.uniform(1.0, 9.0), int(rng.integers(60, 360))
        t = np.linspace(period * rng.choice([0.0, 0.0, rng.uniform(0.0, 1.0)]), end + period, count)
        if rng.random() < 0.3:
            t = np.sort(t + rng.uniform(0.0, 0.6) * (t[1] - t[0]) * rng.random(count))
        if rng.random() < 0.2:
            t = np.delete(t, slice(count // 3, count // 3 + int(rng.integers(2, 12))))
        shown = str(rng.choice(["x", "v", "a", "xa", "xv", "va"]))
        found = made(decay, noise=10.0 ** rng.uniform(-5.0, -1.2), seed=i, t=np.unique(t))
        x, a = found.x, found.a + rng.choice([0.0, 0.0, 0.7]) * decay.omega_n**2
        if rng.random() < 0.25:
            step = 10.0 ** rng.uniform(-3.5, -1.5)
            x = np.round(x / step) * step
        if rng.random() < 0.25:
            x = x + rng.normal() + 10.0 ** rng.uniform(-3.0, -1.0) * x**3
        if rng.random() < 0.2:
            x = np.clip(x, -rng.uniform(0.3, 0.9), 9.0)
        if rng.random() < 0.15:
            width = int(rng.integers(2, 9))
            a = np.convolve(a, np.full(width, 1.0 / width), "same")
        unit = str(rng.choice(["m", "rad"]))
        figures = flat(replace(found, x=x, a=a).said(shown, unit, drop_first=bool(rng.random() < 0.15)))
        clipped = within_range(Recording(found.t, {"x": x}), ("x",)) if x.size >= 50 and np.ptp(x) > 0.0 else None
        numbers = [y for y in figures.values() if isinstance(y, float)]
        size = np.array([np.sign(y) * np.log1p(abs(y)) for y in numbers])
        texts = sorted({y for y in figures.values() if isinstance(y, str)})
        said[str(i)] = [size.size, float(np.sum(np.abs(size))), by_place(size), *texts]
        said[f"{i} clipped"] = None if clipped is None else [len(clipped[0]), clipped[1]]
    return said


T = np.linspace(0.0, 4.2, 420)
RANDOM = 25
CASES: dict[str, Callable[[], Any]] = {
    "x": lambda: made().said("x"),
    "v": lambda: made().said("v"),
    "a": lambda: made().said("a"),
    "x, v and a": lambda: made(end=2.0, count=300).said("xva"),
    "angles": lambda: made().said("xa", unit="rad"),
    "a late x": lambda: replace(made(), x=made(t=T - 0.015).x, a=made().a + 0.4).said("xa"),
    "coarse": lambda: made(count=80).said("xa"),
    "fine and noisy": lambda: made(count=1200, noise=0.02).said("a"),
    "uneven": lambda: made(t=_jittered()).said("xa"),
    "coloured": _coloured,
    "quantised": lambda: _of(T, np.round(made(noise=1e-5).x / 4e-3) * 4e-3),
    "viscous": lambda: made(Decay(9.4, 0.03, 0.0)).said("xa"),
    "Coulomb": lambda: made(Decay(9.4, 0.0, 0.02)).said("xa"),
    "negative start": lambda: made(Decay(9.4, 0.02, 0.01, -1.0)).said("xa"),
    "from mid-swing": lambda: made(begin=0.45).said("xa"),
    "pushed off": lambda: made(Decay(9.4, 0.02, 0.01, 0.1, 5.0)).said("xv"),
    "three half-cycles": lambda: made(Decay(9.4, 0.01, 0.14), end=1.6, count=200).said("xa"),
    "one half-cycle": lambda: made(Decay(9.4, 0.01, 0.4), end=1.6, count=200).said("xa"),
    "many": lambda: made(Decay(60.0, 0.002, 0.004), count=900).said("xa"),
    "first left out": lambda: replace(made(), x=made().x + 0.05 * (made().t < 0.3)).said("x", drop_first=True),
    "heavily damped": lambda: made(Decay(9.4, 0.3, 0.02), end=2.0, count=300).said("xa"),
    "overdamped": lambda: made(Decay(9.4, 1.4, 0.02)).said("xa"),
    "grows": lambda: _of(T, np.exp(0.2 * T) * np.cos(9.0 * T)),
    "steady": lambda: _of(T, noisy(np.cos(9.0 * T), 1e-3, 1)),
    "still": lambda: _of(T, noisy(0.0 * T, 1e-3, 1)),
    "a line": lambda: _of(T, T),
    "two tones": lambda: _of(T, np.cos(9.0 * T) + 0.8 * np.cos(14.0 * T)),
    "a force": lambda: estimate_all(T, x=made().x, u=np.sin(T)),
    "smeared": _smeared,
    "bent": _bent,
    "held, and at rest": lambda: _resting(0.6),
    "at rest": lambda: _resting(0.1),
    "clipped": _clipped,
    "as in the paper": _paper,
    "noise": _noises,
    "refused": _refused,
    **{f"at random {seed}": partial(_at_random, seed) for seed in range(4)},
}


@pytest.mark.parametrize("name", CASES)
def test_every_figure_is_what_it_was(name: str) -> None:
    assert differences(flat(CASES[name]()), known(FILE)[name]) == []


@pytest.mark.parametrize("name", ["steady", "at random 1"])
def test_rounding_of_the_samples_does_not_show(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Nor in the standard errors of what a recording hardly determines: of steady swings, zeta."""
    before, exact = flat(CASES[name]()), noisy
    monkeypatch.setattr(sys.modules[__name__], "noisy", lambda *y, **given: exact(*y, **given) * (1.0 + 1e-15))
    assert differences(flat(CASES[name]()), before) == []


if __name__ == "__main__":
    write(FILE, CASES)
    sys.stdout.write(f"{FILE}\n")
