"""Differences that engines make are named in drawn traces, and none is where nothing but noise differs."""

import os
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from harness.app.compare import result_of
from harness.core.arrays import FloatArray
from harness.core.recording import Recording
from harness.core.slider import Slider
from harness.exact.decay import Decay, free_decay
from harness.results.compare import SignatureResult

NOISE = 5e-5


def draws(count: int, few: int) -> list[Any]:
    """Seeds, of which all but some are run by hand."""
    return [*range(few), *(pytest.param(seed, marks=pytest.mark.full) for seed in range(few, count))]


FEW = draws(8, 1)


def drawn(seed: int) -> tuple[np.random.Generator, Slider, FloatArray]:
    """A hinge of 1 kg m^2 with dry friction, let go at .6 rad, and times of some ten swings."""
    rng = np.random.default_rng(seed)
    omega, zeta = rng.uniform(6.0, 14.0), rng.uniform(0.002, 0.01)
    slider = Slider(m=1.0, c=2.0 * zeta * omega, k=omega**2, f_k=omega**2 * rng.uniform(0.004, 0.01))
    return rng, slider, np.arange(0.0, 10.0 * 2.0 * np.pi / omega, 0.002)


def recording(rng: np.random.Generator, t: FloatArray, x: FloatArray, **more: FloatArray) -> Recording:
    channels = {"x": x + NOISE * rng.normal(size=t.size), **more}
    return Recording(t, channels, angular=True)


def exact(rng: np.random.Generator, slider: Slider, t: FloatArray) -> Recording:
    return recording(rng, t, free_decay(Decay.of(slider, 0.6), t).x)


def stepped(slider: Slider, t: FloatArray, step: Callable[[float, float, float], tuple[float, float]]) -> FloatArray:
    """Position and speed (2, n) of what is stepped from sample to sample."""
    h, states = float(t[1] - t[0]), [(0.6, 0.0)]
    for _ in t[1:]:
        states.append(step(*states[-1], h))
    return np.array(states).T


def names(sim: Recording, real: Recording) -> list[SignatureResult]:
    return result_of(sim, real)[0].signatures


@pytest.mark.parametrize("seed", FEW)
@pytest.mark.parametrize("factor", [180.0 / np.pi, np.pi / 180.0])
def test_damping_per_degree_read_per_radian(seed: int, factor: float) -> None:
    rng, slider, t = drawn(seed)
    slider = replace(slider, c=slider.c / 4.0 if factor > 1.0 else slider.c * 16.0)
    (found,) = names(exact(rng, replace(slider, c=slider.c * factor), t), exact(rng, slider, t))
    assert found.name == "per-degree"
    assert found.found.value == pytest.approx(57.3, rel=0.03)


@pytest.mark.parametrize("seed", FEW)
def test_friction_that_was_dropped(seed: int) -> None:
    rng, slider, t = drawn(seed)
    real = exact(rng, slider, t)
    none = replace(slider, f_k=0.0, f_s=0.0)
    found = names(exact(rng, none, t), real)
    assert [one.name for one in found] == ["no-friction"]


@pytest.mark.parametrize("seed", FEW)
@pytest.mark.parametrize(("more", "name"), [(0.05, "body-damping"), (0.04, "link-damping")])
def test_damping_of_bodies(seed: int, more: float, name: str) -> None:
    """What PhysX damps a body by, and Bullet a slow one, whose part in the square is not seen."""
    rng, slider, t = drawn(seed)
    found = names(exact(rng, replace(slider, c=slider.c + more), t), exact(rng, slider, t))
    assert [one.name for one in found] == [name]


@pytest.mark.parametrize("seed", FEW)
def test_damping_of_links(seed: int) -> None:
    """.04 (1 + |v|) 1/s beside the joint's own, by the fourth-order Runge-Kutta rule."""
    rng, slider, t = drawn(seed)
    slider = replace(slider, f_k=0.0, f_s=0.0)

    def fall(x: float, v: float) -> float:
        return -slider.k * x - slider.c * v - 0.04 * (1.0 + abs(v)) * v

    def step(x: float, v: float, h: float) -> tuple[float, float]:
        a1 = fall(x, v)
        a2 = fall(x + 0.5 * h * v, v + 0.5 * h * a1)
        a3 = fall(x + 0.5 * h * v + 0.25 * h * h * a1, v + 0.5 * h * a2)
        a4 = fall(x + h * v + 0.5 * h * h * a2, v + h * a3)
        return x + h * v + h * h * (a1 + a2 + a3) / 6.0, v + h * (a1 + 2.0 * a2 + 2.0 * a3 + a4) / 6.0

    found = names(recording(rng, t, stepped(slider, t, step)[0]), exact(rng, slider, t))
    assert [one.name for one in found] == ["link-damping"]


@pytest.mark.parametrize("seed", FEW)
def test_damping_of_an_implicit_step(seed: int) -> None:
    rng, slider, t = drawn(seed)
    slider = replace(slider, f_k=0.0, f_s=0.0)

    def step(x: float, v: float, h: float) -> tuple[float, float]:
        v = (v - h * slider.k * x) / (1.0 + h * slider.c + h * h * slider.k)
        return x + h * v, v

    found = names(recording(rng, t, stepped(slider, t, step)[0]), exact(rng, slider, t))
    assert "step-damping" in [one.name for one in found]
    assert {one.name for one in found} <= {"step-damping", "half-step"}


@pytest.mark.parametrize("seed", FEW)
def test_speed_half_a_step_beside_position(seed: int) -> None:
    rng, slider, t = drawn(seed)
    slider = replace(slider, f_k=0.0, f_s=0.0)

    def step(x: float, v: float, h: float) -> tuple[float, float]:
        v = v - h * (slider.k * x + slider.c * v)
        return x + h * v, v

    x, v = stepped(slider, t, step)
    found = names(recording(rng, t, x, v=v + NOISE * rng.normal(size=t.size)), exact(rng, slider, t))
    assert [one.name for one in found] == ["half-step"]


@pytest.mark.parametrize("seed", draws(30, 2))
def test_nothing_is_named_where_noise_alone_differs(seed: int) -> None:
    rng, slider, t = drawn(100 + seed)
    assert names(exact(rng, slider, t), exact(rng, slider, t[:: 1 + seed % 2])) == []


@pytest.mark.parametrize("seed", draws(10, 1))
def test_parameters_that_are_wrong_are_no_engines(seed: int) -> None:
    """Friction, damping and stiffness off by some per cent have no number of an engine's in them."""
    rng, slider, t = drawn(200 + seed)
    off = replace(slider, c=1.3 * slider.c, f_k=0.8 * slider.f_k, f_s=0.8 * slider.f_k, k=1.02 * slider.k)
    assert names(exact(rng, off, t), exact(rng, slider, t)) == []


def test_the_case_of_a_damping_per_degree() -> None:
    folder = os.environ.get("HARNESS_RECORDINGS")
    cases = None if folder is None else Path(folder).parent / "engine-cases"
    if cases is None or not (cases / "unit-sim.csv").exists():
        pytest.skip("needs the recordings of HARNESS_RECORDINGS")
    from harness.app.shared.reading import ReadOptions, read

    (found,) = names(*(read(cases / f"unit-{one}.csv", ReadOptions()) for one in ("sim", "real")))
    assert (found.name, round(found.expected, 3)) == ("per-degree", 57.296)
