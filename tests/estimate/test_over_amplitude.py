"""Damping over amplitude, from turning points alone; truths are closed forms of each half-swing."""

import csv
import math
from pathlib import Path

import numpy as np
import pytest

import harness
from harness.core.arrays import FloatArray
from harness.core.recording import Recording
from harness.core.slider import Slider
from harness.exact.decay import Decay, free_decay
from harness.results.common import DampingResult

W, X0, NOISE = 8.0, 0.1, 1e-4
T = np.arange(0.0, 10.0, 0.01)


def measured(zeta: float, x_k: float, channel: str = "x", zero: float = 0.0) -> DampingResult:
    exact = free_decay(Decay.of(Slider(1.0, 2.0 * zeta * W, W * W, x_k * W * W), X0), T)
    clean: FloatArray = getattr(exact, channel)
    noise = NOISE * W ** {"x": 0, "v": 1, "a": 2}[channel] * np.random.default_rng(5).standard_normal(T.size)
    found = harness.identify(Recording(T, {channel: clean + noise + zero}, "swing.csv")).damping
    assert found is not None
    return found


def holds(values: list[float], errors: list[float], truth: FloatArray) -> None:
    """Within four standard errors each, and as a whole as errors say."""
    off = (np.array(values) - truth) / np.array(errors)
    assert np.max(np.abs(off)) < 5.0
    assert np.mean(off**2) < 4.0


@pytest.mark.parametrize("channel", ["x", "v", "a"])
def test_viscous_damping_is_the_same_at_every_amplitude(channel: str) -> None:
    found = measured(0.03, 0.0, channel)
    assert len(found.zeta) > 10
    assert found.amplitude[0] == pytest.approx(X0, rel=0.2)
    holds(found.zeta, found.zeta_stderr, np.full(len(found.zeta), 0.03))
    damped = W * math.sqrt(1.0 - 0.03**2) / (2.0 * math.pi)
    holds(found.frequency_hz, found.frequency_stderr, np.full(len(found.zeta), damped))


def test_dry_friction_rises_towards_small_amplitudes_wherever_the_zero_is() -> None:
    """Of half-swings that each lose 4 x_k the logarithm is 2 asinh(x_k / a)."""
    found = measured(0.0, 1e-3, zero=0.7)
    delta = 2.0 * np.arcsinh(1e-3 / np.array(found.amplitude))
    holds(found.zeta, found.zeta_stderr, delta / np.hypot(math.pi, delta))


def test_a_model_that_fits_has_the_damping_that_was_measured() -> None:
    found = measured(0.02, 5e-4)
    law = found.laws["viscous and Coulomb"]
    order = np.argsort(law["amplitude"])
    shown = np.interp(found.amplitude, np.array(law["amplitude"])[order], np.array(law["zeta"])[order])
    inside = np.array(found.amplitude) <= max(law["amplitude"])
    assert np.array(found.zeta)[inside] == pytest.approx(shown[inside], rel=0.1)


def test_page_and_csv_have_it(tmp_path: Path) -> None:
    exact = free_decay(Decay.of(Slider(1.0, 0.4, W * W, 0.05), X0), T)
    recording = Recording(T, {"x": exact.x + NOISE * np.random.default_rng(1).standard_normal(T.size)}, "swing.csv")
    found = harness.identify(recording, out=tmp_path / "left")
    assert found.damping is not None
    rows = list(csv.DictReader(Path(found.files["damping"]).read_text().splitlines()))
    own = [row for row in rows if row["source"] == "measured"]
    assert [float(row["zeta"]) for row in own] == pytest.approx(found.damping.zeta, rel=1e-6)
    assert [float(row["loss_factor"]) for row in own] == pytest.approx(2.0 * np.array(found.damping.zeta), rel=1e-6)
    assert "Damping over amplitude" in (tmp_path / "left" / "report.html").read_text()
