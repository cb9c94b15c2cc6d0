"""The estimators on recordings of every origin, a pendulum's among them."""

import json
import re
from pathlib import Path

import jsonschema
import numpy as np
import pytest

from harness.app.identify import identify, result_of
from harness.app.report import rebuild
from harness.app.run.run import RunOptions, run
from harness.app.shared.estimates import estimate
from harness.core.errors import InputError
from harness.core.recording import Recording
from harness.core.slider import PAPER
from harness.exact.decay import Decay, free_decay
from harness.io.options import ReadOptions
from harness.kernels.solve import solve
from harness.model.model import Model, Restoring
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
    assert {file.name for file in folder.iterdir()} == {
        "result.json",
        "trace.rrd",
        "report.html",
        "log.txt",
        "damping.csv",
    }
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
    with pytest.raises(
        InputError, match="no --trace among 5; expected --trace with one of reference exact, mujoco as-shipped"
    ):
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


OMEGA, ZETA, X_K = 6.0, 0.01, 0.01
TRUE = {"omega_n": OMEGA, "zeta": ZETA, "x_k": X_K}


def swing(x0: float, seed: int | None, span: float = 14.0) -> Recording:
    """A decay from x0 (rad), with noise of 1 mrad and .05 rad/s^2 unless ``seed`` is None."""
    model = Model(
        1.0, 2.0 * ZETA * OMEGA, OMEGA**2, X_K * OMEGA**2, x0=x0, restoring=Restoring.PENDULUM, mass_known=False
    )
    t = np.arange(0.0, span, 4e-3)
    motion = solve(model, t)
    random = np.random.default_rng(seed or 0)
    level = 0.0 if seed is None else 1.0
    x = motion.x + level * 1e-3 * random.standard_normal(t.size)
    a = motion.a + level * 0.05 * random.standard_normal(t.size)
    return Recording(t, {"x": x, "a": a}, "swing.csv", angular=True)


@pytest.mark.parametrize("x0", [0.5, 1.5])
def test_estimates_of_a_pendulum_are_within_their_errors(x0: float) -> None:
    found = estimate(swing(x0, 3), "pendulum")
    for method in ("acceleration", "displacement"):
        for name, true in TRUE.items():
            figure = getattr(found.methods[method], name)
            assert abs(figure.value - true) < 5.0 * figure.stderr, (method, name, figure)
            assert figure.value == pytest.approx(true, rel=0.02)


@pytest.mark.parametrize("x0", [0.5, 1.0, 1.5])
def test_the_systematic_error_is_below_a_tenth_of_a_standard_error(x0: float) -> None:
    """Without noise what is left is systematic; held against the error with noise."""
    clean, noisy = estimate(swing(x0, None), "pendulum"), estimate(swing(x0, 3), "pendulum")
    for method in ("acceleration", "displacement"):
        for name, true in TRUE.items():
            error = getattr(noisy.methods[method], name).stderr
            assert abs(getattr(clean.methods[method], name).value - true) < 0.1 * error, (method, name)


def test_a_spring_is_no_pendulum() -> None:
    """Read as a spring's, a swing of 1.5 rad gives a wrong frequency and wrong damping."""
    found = estimate(swing(1.5, 3)).methods["displacement"]
    assert abs((found.omega_n.value or 0.0) / OMEGA - 1.0) > 0.01
    assert abs((found.zeta.value or 0.0) / ZETA - 1.0) > 0.1


def test_an_angle_is_asked_for_and_the_result_says_how_it_was_read() -> None:
    plain = swing(0.5, 3)
    with pytest.raises(InputError, match="holds no angle"):
        estimate(Recording(plain.t, plain.channels, "cart.csv"), "pendulum")
    result, _ = result_of(plain, restoring="pendulum")
    assert result.restoring == "pendulum"
    assert result.estimates["displacement"].x_k.unit == "rad"
    assert any(line.startswith("Read as a pendulum") for line in result.warnings)


def test_a_pendulum_is_run_with_exact_events_and_in_radians(tmp_path: Path) -> None:
    options = RunOptions.asked(restoring="pendulum", given={"x0": 1.2}, engines=("mujoco",), preset="tuned")
    result = run(options, tmp_path / "out")
    exact, engine = result.traces
    for trace, within in ((exact, 1e-3), (engine, 5e-3)):
        figure = trace.estimates["acceleration"]
        assert figure.x_k.unit == "rad"
        assert figure.x_k.value == pytest.approx(0.03, rel=within)
        assert figure.zeta.value == pytest.approx(0.05, rel=within)
    assert Path(result.files["mjcf"]).name == "pendulum.xml"
    assert Path(result.files["mjcf"]).is_file()
    page = (tmp_path / "out" / "report.html").read_text(encoding="utf-8")
    words = re.sub(r"<script.*?</script>", "", page, flags=re.DOTALL)
    assert not re.search(r"[\d ]mm\b|>mm(/s)?<|N/m\b", words), "the page of an angle speaks of no length"
    assert "mrad" in words
    assert "N m/rad" in words
    assert "closed form" not in words
