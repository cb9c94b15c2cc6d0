"""The estimators on recordings of every origin."""

import json
from pathlib import Path

import jsonschema
import numpy as np
import pytest

from harness.app.identify import identify
from harness.app.report.rebuild import rebuild
from harness.core.errors import InputError
from harness.core.slider import PAPER
from harness.exact.decay import Decay, free_decay
from harness.io.options import ReadOptions
from harness.results import generate
from harness.results.common import P
from harness.results.run import RunResult


def recorded(path: Path, header: str = "t [ms],x [mm],a [g]") -> Path:
    """The paper's case at 1 kHz with the noise of good sensors."""
    rng = np.random.default_rng(1)
    t = np.arange(3000, dtype=np.float64) * 1e-3
    exact = free_decay(Decay.of(PAPER, 1.0), t)
    x = (exact.x + rng.normal(0.0, 1e-4, t.size)) * 1e3
    a = (exact.a + rng.normal(0.0, 1e-2, t.size)) / 9.80665
    np.savetxt(path, np.stack([t * 1e3, x, a], axis=1), delimiter=",", header=header, comments="", fmt="%.9g")
    return path


def near(found: P, true: float) -> bool:
    assert found.value is not None
    assert found.stderr is not None
    return abs(found.value - true) <= 4.0 * found.stderr


@pytest.mark.parametrize("method", ["acceleration", "displacement"])
def test_a_noisy_recording_gives_what_was_put_in(tmp_path: Path, method: str) -> None:
    result = identify(recorded(tmp_path / "a.csv"), ReadOptions(), out=tmp_path / "out")
    estimate = result.estimates[method]
    assert near(estimate.omega_n, 10.0)
    assert near(estimate.zeta, 0.05)
    assert near(estimate.x_k, 0.03)
    assert estimate.x_k.unit == "m"
    assert result.recording.noise["x"] == pytest.approx(1e-4, rel=0.1)
    assert result.recording.noise["a"] == pytest.approx(1e-2, rel=0.1)


def test_what_is_left_is_whole_valid_and_made_again_from_the_trace(tmp_path: Path) -> None:
    result = identify(
        recorded(tmp_path / "a.csv"), ReadOptions(start=0.2), out=tmp_path / "out", command="harness identify"
    )
    folder = tmp_path / "out"
    assert {file.name for file in folder.iterdir()} == {"result.json", "trace.rrd", "report.html", "log.txt"}
    data = json.loads((folder / "result.json").read_text())
    jsonschema.validate(data, json.loads((generate.FOLDER / "harness.identify-1.json").read_text()))
    page = (folder / "report.html").read_bytes()
    again, where = rebuild(folder)
    assert again == result
    assert where.read_bytes() == page


@pytest.mark.usefixtures("pybullet")
def test_a_trace_of_a_run_is_a_recording(done: tuple[RunResult, Path], tmp_path: Path) -> None:
    result, folder = done
    found = identify(folder / "trace.rrd", ReadOptions(), "mujoco tuned", tmp_path / "out")
    wanted = next(t for t in result.traces if (t.source, t.preset) == ("mujoco", "tuned"))
    assert found.estimates == wanted.estimates
    with pytest.raises(InputError, match="no --trace among 5; --trace with one of reference exact, mujoco as-shipped"):
        identify(folder / "trace.rrd", ReadOptions(), out=tmp_path / "other")


def test_the_trace_of_a_recording_is_a_recording(tmp_path: Path) -> None:
    result = identify(recorded(tmp_path / "a.csv"), ReadOptions(), out=tmp_path / "out")
    again = identify(tmp_path / "out" / "trace.rrd", ReadOptions(), out=tmp_path / "again")
    assert again.estimates == result.estimates


@pytest.mark.parametrize(("columns", "reason"), [("t=t [ms],x=x [mm]", None), ("x=#2[mm]", None), ("x=#2[deg]", "rad")])
def test_an_angle_is_estimated_in_rad(tmp_path: Path, columns: str, reason: str | None) -> None:
    path = recorded(tmp_path / "a.csv")
    columns = columns.replace("t=t [ms]", "t=t[ms]").replace("x=x [mm]", "x=x[mm]")
    result = identify(path, ReadOptions(columns), out=tmp_path / "out")
    assert result.estimates["displacement"].x_k.unit == (reason or "m")


def test_no_decay_leaves_nothing(tmp_path: Path) -> None:
    t = np.arange(1000) * 1e-3
    np.savez(tmp_path / "a.npz", t=t, x=np.sin(10.0 * t) * t)
    with pytest.raises(InputError, match="no estimate is possible"):
        identify(tmp_path / "a.npz", ReadOptions(), out=tmp_path / "out")
    assert not (tmp_path / "out").exists()


def test_a_swinging_pendulum(recordings: Path, tmp_path: Path) -> None:
    path = recordings / "rotary-pendulum" / "pendulum_free_swing_data_03.txt"
    result = identify(path, ReadOptions("x=#1[deg]", 2, 1000.0, 0.4), out=tmp_path / "out")
    estimate = result.estimates["displacement"]
    assert result.recording.samples == 4600
    assert estimate.omega_n.value == pytest.approx(10.76, abs=0.05)
    for number in (estimate.omega_n, estimate.zeta, estimate.x_k):
        assert number.value is not None
        assert number.stderr is not None
        assert 0.0 < number.stderr < number.value
    assert estimate.x_k.unit == "rad"


@pytest.mark.parametrize(
    ("columns", "reason"),
    [
        ("t=t,x=qm[m],u=vir*gtau[N]", "a driven recording (a force of up to 152 N acts), which is no free decay"),
        ("t=t,x=qm[m]", "no estimate is possible"),
    ],
)
def test_a_driven_machine_is_refused_with_the_reason(
    recordings: Path, tmp_path: Path, columns: str, reason: str
) -> None:
    with pytest.raises(InputError) as caught:
        identify(recordings / "emps" / "DATA_EMPS.mat", ReadOptions(columns), out=tmp_path / "out")
    assert reason in str(caught.value)
    assert list(tmp_path.iterdir()) == []
