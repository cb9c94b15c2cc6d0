"""Two traces of any origin: the same within noise, or where they part."""

import json
from dataclasses import replace
from pathlib import Path

import jsonschema
import numpy as np
import pytest

from harness.app.compare import compare
from harness.core.slider import PAPER, Slider
from harness.exact.decay import Decay, free_decay
from harness.io.recording import ReadOptions
from harness.results import generate
from harness.results.compare import CompareResult
from harness.results.run import RunResult

AS_IT_IS = (ReadOptions(), ReadOptions())


def trace(
    path: Path,
    slider: Slider = PAPER,
    samples: int = 2400,
    noise: tuple[float, float] = (0.0, 0.0),
    shift: float = 0.0,
    scale: float = 1.0,
    seed: int = 1,
) -> Path:
    """x and a of the paper's case over 2.4 s; ``shift`` is that of the clock, ``scale`` multiplies a."""
    rng = np.random.default_rng(seed)
    t = np.linspace(0.0, 2.399, samples)
    exact = free_decay(Decay.of(slider, 1.0), t)
    x = exact.x + noise[0] * rng.normal(size=t.size)
    a = scale * (exact.a + noise[1] * rng.normal(size=t.size))
    np.savetxt(path, np.column_stack([t + shift, x, a]), "%.12g", ",", header="t,x,a", comments="")
    return path


GOOD = (1e-4, 1e-2)


def compared(sim: Path, real: Path, folder: Path) -> CompareResult:
    return compare(sim, real, AS_IT_IS, out=folder / "out")


@pytest.mark.parametrize(("samples", "shift"), [(2400, 0.0), (700, 0.0), (2400, 0.0132), (5000, -0.04)])
def test_a_motion_and_its_noisy_recording_are_the_same(tmp_path: Path, samples: int, shift: float) -> None:
    result = compared(
        trace(tmp_path / "sim.csv", samples=samples, shift=shift), trace(tmp_path / "real.csv", noise=GOOD), tmp_path
    )
    assert result.verdict == "same within noise"
    assert result.where == []
    found = result.aligned["shift_s"]
    assert found.value is not None
    assert found.stderr is not None
    assert abs(found.value + shift) < 4.0 * found.stderr
    assert result.noise["x"] == pytest.approx(1e-4, rel=0.1)


def test_same_within_noise_is_said_at_the_promised_rate(tmp_path: Path) -> None:
    wrong = 0
    sim = trace(tmp_path / "sim.csv", samples=800)
    for seed in range(20):
        real = trace(tmp_path / f"real{seed}.csv", samples=800, noise=GOOD, seed=seed)
        wrong += compare(sim, real, AS_IT_IS, out=tmp_path / f"out{seed}").verdict == "different"
    assert wrong <= 2


def test_three_per_cent_of_friction_make_a_difference(tmp_path: Path) -> None:
    sim = trace(tmp_path / "sim.csv", replace(PAPER, f_k=2.9, f_s=2.9))
    result = compared(sim, trace(tmp_path / "real.csv", noise=GOOD), tmp_path)
    assert result.verdict == "different"
    assert result.where
    assert result.rmse["x"] > 1e-3


def test_units_off_by_a_thousand_are_told(tmp_path: Path) -> None:
    result = compared(
        trace(tmp_path / "sim.csv", noise=GOOD, scale=1e3), trace(tmp_path / "real.csv", noise=GOOD, seed=2), tmp_path
    )
    assert result.where[0].regime == "channel"
    assert result.where[0].condition == "channel a"
    assert not result.consistent_channels["sim"]["x-a"].consistent
    assert result.consistent_channels["real"]["x-a"].consistent
    assert any("does not match displacement by a factor of about 1000" in line for line in result.sentences)


def test_a_trace_against_itself(tmp_path: Path) -> None:
    real = trace(tmp_path / "real.csv", noise=GOOD)
    result = compared(real, real, tmp_path)
    assert result.verdict == "same within noise"
    assert result.rmse == {"x": 0.0, "a": 0.0}


def test_what_is_left_is_whole_and_valid(tmp_path: Path) -> None:
    sim = trace(tmp_path / "sim.csv", replace(PAPER, f_k=2.9, f_s=2.9))
    result = compared(sim, trace(tmp_path / "real.csv", noise=GOOD), tmp_path)
    folder = tmp_path / "out"
    assert {file.name for file in folder.iterdir()} == {"result.json", "trace.rrd", "report.html", "log.txt"}
    data = json.loads((folder / "result.json").read_text())
    jsonschema.validate(data, json.loads((generate.FOLDER / "harness.compare-1.json").read_text()))
    assert CompareResult.model_validate(data) == result
    assert "The two traces differ" in (folder / "report.html").read_text()


def test_traces_of_a_run_are_compared_by_name(done: tuple[RunResult, Path], tmp_path: Path) -> None:
    _, folder = done
    rrd = folder / "trace.rrd"
    result = compare(rrd, rrd, AS_IT_IS, ("mujoco as-shipped", "reference exact"), tmp_path / "out")
    assert result.verdict == "different"
