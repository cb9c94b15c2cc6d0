"""The force left over and the consistency of channels, against what was put in."""

from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from harness.core.arrays import FloatArray
from harness.core.slider import PAPER
from harness.diagnosis.alignment.consistency import Consistency, consistency
from harness.diagnosis.explain.force_map import ForceMap, force_map, write_history, write_map
from harness.diagnosis.motion import Motion, motion_of
from harness.estimate.noise import Noise
from harness.exact.decay import Decay, free_decay

OMEGA, DAMPING, DRAG = 10.0, 0.6, 0.003
T = np.arange(0.0, 6.0, 0.002)
NOISE = {"x": 1e-4, "v": 1e-3, "a": 1e-2}


def swing(drag: float) -> dict[str, FloatArray]:
    def slope(t: float, y: FloatArray) -> list[float]:
        return [y[1], -(OMEGA**2) * y[0] - DAMPING * y[1] - drag * abs(y[1]) * y[1]]

    x, v = solve_ivp(slope, (0.0, 6.0), [1.0, 0.0], t_eval=T, rtol=1e-10, atol=1e-12).y
    return {"x": x, "v": v, "a": -(OMEGA**2) * x - DAMPING * v - drag * np.abs(v) * v}


def mapped(channels: str) -> tuple[ForceMap, FloatArray]:
    rng = np.random.default_rng(0)
    base, real = swing(0.0), swing(DRAG)
    residual = {c: real[c] - base[c] + rng.normal(0.0, NOISE[c], T.size) for c in channels}
    motion = Motion(base["x"], base["v"], np.zeros(T.size, dtype=np.bool_), OMEGA)
    found = force_map(T, residual, {c: NOISE[c] for c in channels}, motion, DAMPING, np.full(T.size, OMEGA**2))
    return found, DRAG * np.abs(real["v"]) * real["v"]


@pytest.mark.parametrize(("channels", "share"), [("x", 0.25), ("v", 0.25), ("a", 1.0), ("xa", 0.1)])
def test_the_force_left_over_is_the_one_put_in(channels: str, share: float) -> None:
    found, true = mapped(channels)
    assert np.sqrt(np.mean((found.force - true) ** 2)) < share * np.sqrt(np.mean(true**2))
    assert np.mean(np.abs(found.force - true) < 2.0 * found.stderr) > 0.9
    law = DRAG * np.abs(found.v) * found.v
    assert np.mean(np.abs(found.cell_force - law) < 2.0 * found.cell_stderr) > 0.85


def test_maps_are_tables(tmp_path: Path) -> None:
    found, _ = mapped("xa")
    write_map(tmp_path / "map.csv", found)
    write_history(tmp_path / "time.csv", found)
    assert (tmp_path / "map.csv").read_text().startswith("x,v,force,stderr,samples\n")
    rows = np.loadtxt(tmp_path / "map.csv", delimiter=",", skiprows=1)
    assert rows[:, 4].sum() == T.size
    assert np.loadtxt(tmp_path / "time.csv", delimiter=",", skiprows=1).shape == (T.size, 3)


def test_nothing_is_said_of_a_rest() -> None:
    t = np.linspace(0.0, 2.999, 3000)
    exact = free_decay(Decay.of(PAPER, 1.0), t)
    motion = motion_of(t, {"x": exact.x}, OMEGA)
    rest = t > 2.6
    assert np.all(motion.stuck[rest])
    x = np.random.default_rng(1).normal(0.0, 1e-4, t.size)
    found = force_map(t, {"x": x}, {"x": 1e-4}, motion, 1.0, np.full(t.size, 100.0))
    assert np.all(np.isnan(found.force[rest]))
    assert np.all(np.isfinite(found.force[t < 2.4]))


def pair(gain: float = 1.0, lag: float = 0.0, offset: float = 0.0, seed: int = 0, mixed: bool = False) -> Consistency:
    rng = np.random.default_rng(seed)
    t = np.linspace(0.0, 2.399, 2400)
    exact = free_decay(Decay.of(PAPER, 1.0), t)
    x = np.interp(np.maximum(t - lag, 0.0), t, exact.x) + rng.normal(0.0, 1e-4, t.size)
    a = gain * exact.a + offset + rng.normal(0.0, 0.05, t.size)
    if mixed:
        a = np.sin(17.3 * t)
    return consistency(t, {"x": x, "a": a}, {"x": Noise(1e-4, True), "a": Noise(0.05, True)}, OMEGA)[0]


def test_channels_of_one_motion_agree() -> None:
    found = [pair(seed=seed) for seed in range(40)]
    assert sum(not f.consistent for f in found) <= 2
    assert found[0].sentence == "acceleration agrees with displacement"


def test_gain_lag_and_offset_are_those_put_in() -> None:
    found = pair(1.02, 0.003, 0.2)
    for quantity, true in ((found.gain, 1.02), (found.lag, 0.003), (found.offset, 0.2)):
        assert quantity.value is not None
        assert quantity.stderr is not None
        assert abs(quantity.value - true) < 4.0 * quantity.stderr
    assert found.sentence.startswith("acceleration is 1.02 times what displacement says and is early by 0.003")


@pytest.mark.parametrize(
    ("gain", "mixed", "sentence"),
    [
        (1e3, False, "acceleration does not match displacement by a factor of about 1000; are the units right?"),
        (1e-3, False, "acceleration does not match displacement by a factor of about 1/1000; are the units right?"),
        (-1.0, False, "acceleration and displacement do not belong together (they move against each other)"),
        (1.0, True, "acceleration and displacement do not belong together"),
    ],
)
def test_channels_that_cannot_be_are_told(gain: float, mixed: bool, sentence: str) -> None:
    found = pair(gain, mixed=mixed)
    assert not found.consistent
    assert found.sentence.startswith(sentence)
