"""Several recordings of one machine: what all say of its numbers, by how much they differ, which stands out."""

import json
import math
import shlex
from dataclasses import replace
from pathlib import Path

import jsonschema
import numpy as np
import pytest

import harness
from harness.app.report import rebuild
from harness.cli.main import run
from harness.core.errors import HarnessError, InputError
from harness.core.recording import Recording
from harness.core.slider import PAPER
from harness.exact.decay import Decay, free_decay
from harness.results import generate
from harness.results.identify import IdentifyResult, RepeatedIdentifyResult

X_K = 0.03
"""Of the paper's case, m."""


def decay(x_k: float = X_K, seed: int = 0, name: str = "", angle: bool = False) -> Recording:
    """A decay of the paper's case with this x_k (m), with the noise of good sensors."""
    rng = np.random.default_rng(seed)
    t = np.arange(3000, dtype=np.float64) * 1e-3
    force = x_k * PAPER.k
    exact = free_decay(Decay.of(replace(PAPER, f_k=force, f_s=force), 1.0), t)
    channels = {"x": exact.x + rng.normal(0.0, 1e-4, t.size), "a": exact.a + rng.normal(0.0, 1e-2, t.size)}
    return Recording(t, channels, name or f"run-{seed}.csv", angular=angle)


def written(folder: Path, recording: Recording) -> Path:
    path = folder / recording.file
    columns = [recording.t, *recording.channels.values()]
    header = ",".join(["t", *recording.channels])
    np.savetxt(path, np.column_stack(columns), delimiter=",", header=header, comments="", fmt="%.12g")
    return path


def test_repetitions_add_up_and_do_not_differ() -> None:
    """Four alike: the mean has half the error of one, holds the true value, and nothing is said to differ."""
    found = harness.identify([decay(seed=seed) for seed in range(4)])
    x_k = found.together["acceleration.x_k"]
    assert found.method == "acceleration"
    assert x_k.value.value is not None
    assert x_k.value.stderr is not None
    assert abs(x_k.value.value - X_K) < 4.0 * x_k.value.stderr
    assert x_k.value.stderr < 0.8 * x_k.within
    assert found.estimates["acceleration"].x_k == x_k.value
    assert found.estimates["acceleration"].reversals == sum(
        one.estimates["acceleration"].reversals for one in found.found
    )
    assert not any("differs" in one or "stand" in one for one in found.warnings)


def test_what_recordings_differ_by_is_in_the_error_of_all() -> None:
    """x_k of 28, 29, 31 and 32 mm: mean 30, standard deviation sqrt(10/3) = 1.83 mm, error of the mean half of it.

    Within a tenth: the spread is a moment's estimate, weighted by errors that are not all alike.
    """
    found = harness.identify([decay(x_k, seed) for seed, x_k in enumerate((0.028, 0.029, 0.031, 0.032))])
    x_k = found.together["acceleration.x_k"]
    spread = math.sqrt(10.0 / 3.0) * 1e-3
    assert x_k.value.value == pytest.approx(X_K, rel=2e-3)
    assert x_k.between == pytest.approx(spread, rel=0.1)
    assert x_k.value.stderr == pytest.approx(spread / 2.0, rel=0.1)
    assert x_k.outliers == []
    assert found.together["acceleration.zeta"].between < 1e-4
    assert any(one.startswith("x_k differs between the recordings by 1.9 mm") for one in found.warnings)


def test_the_one_that_stands_out_is_named() -> None:
    files = [decay(seed=seed) for seed in range(4)] + [decay(0.036, 9, "odd.csv")]
    found = harness.identify(files)
    assert found.together["acceleration.x_k"].outliers == ["odd.csv"]
    assert "x_k of odd.csv stands out from the others." in found.warnings


def test_one_that_cannot_be_used_does_not_stop_the_rest(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    for seed in (1, 2):
        written(tmp_path, decay(seed=seed))
    Path("torn.csv").write_text("t,x\n0,1\n", encoding="utf-8")
    line = ["identify", "run-1.csv", "torn.csv", "run-2.csv", "gone.csv", "--out", "out", "--json", "found.json"]
    assert run(line) == 1
    assert "torn.csv" in capsys.readouterr().out
    data = json.loads(Path("found.json").read_text())
    jsonschema.validate(data, json.loads((generate.FOLDER / "harness.identify-2.json").read_text()))
    result = RepeatedIdentifyResult.model_validate(data)
    assert [isinstance(one, IdentifyResult) for one in result.recordings] == [True, False, True, False]
    assert [one.recording.file for one in result.failed] == ["torn.csv", "gone.csv"]
    assert result.found[0].command == "harness identify run-1.csv"
    page = Path("out/report.html").read_bytes()
    again, where = rebuild(Path("out"))
    assert again == result
    assert where.read_bytes() == page


def test_none_that_can_be_used_is_an_error_and_leaves_nothing(tmp_path: Path) -> None:
    t = np.arange(1000, dtype=np.float64) * 1e-3
    still = Recording(t, {"x": np.sin(10.0 * t) * t}, "grows.csv")
    with pytest.raises(HarnessError, match=r"grows.csv: no estimate is possible"):
        harness.identify([still, replace(still, t=still.t * 2.0)], out=tmp_path / "out")
    assert not (tmp_path / "out").exists()


def test_the_same_samples_do_not_count_twice() -> None:
    with pytest.raises(InputError, match=r"copy.csv: the same samples as run-0.csv: it would count twice"):
        harness.identify([decay(), decay(name="copy.csv")])
    with pytest.raises(InputError, match=r"run-0.csv: given twice: it would count twice"):
        harness.diagnose([decay(), decay()], engines=())


def test_the_line_without_the_one_given_twice_runs(
    tmp_path: Path, capfd: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    for seed in (1, 2):
        written(tmp_path, decay(seed=seed))
    assert run(["identify", "run-1.csv", "run-2.csv", "run-1.csv", "--quiet"]) == 2
    line = capfd.readouterr().err.partition("Try: harness ")[2]
    assert line == "identify run-1.csv run-2.csv --quiet\n"
    assert run(shlex.split(line)) == 0


def test_an_angle_beside_a_path_is_refused() -> None:
    with pytest.raises(InputError, match=r"run-1.csv: acceleration.x_k is in rad, and in m of run-0.csv. Try: harness"):
        harness.identify([decay(), decay(seed=1, angle=True)])


def test_run_downs_are_read_together() -> None:
    """Wheels that slow down by v' = -c v - f_k, c 0.5 per s and f_k 2 m/s^2, from 10 m/s."""
    c, f_k = 0.5, 2.0
    t = np.arange(0.0, 2.4, 2e-3)
    v = (10.0 + f_k / c) * np.exp(-c * t) - f_k / c
    runs = [
        Recording(t, {"v": v + np.random.default_rng(seed).normal(0.0, 0.01, t.size)}, f"down-{seed}.csv")
        for seed in range(3)
    ]
    found = harness.identify(runs)
    assert found.method == "both"
    assert found.estimates == {}
    for name, true in (("c", c), ("f_k", f_k)):
        p = found.together[f"both.{name}"].value
        assert p.value is not None
        assert p.stderr is not None
        assert abs(p.value - true) < 4.0 * p.stderr
        assert p.stderr < 0.01 * true
    assert found.statement.startswith("f_k = ")


def test_a_condition_of_every_file_is_told_as_a_trend(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """x_k grows by 1 mm every 3 degrees, the damping does not; the page of the folder is made again with the trend."""
    monkeypatch.chdir(tmp_path)
    for i in range(5):
        written(tmp_path, decay(0.028 + 0.001 * i, i))
    rows = "".join(f"run-{i}.csv,{20 + 3 * i}\n" for i in range(5))
    Path("days.csv").write_text(f"file,temperature [degC]\n{rows}", encoding="utf-8")
    files = [f"run-{i}.csv" for i in range(5)]
    assert run(["identify", *files, "--conditions", "days.csv", "--out", "out", "--json", "found.json"]) == 0
    assert capsys.readouterr().out.count("x_k: it changes with temperature: 0.000333") == 1
    result = RepeatedIdentifyResult.model_validate(json.loads(Path("found.json").read_text()))
    (trend,) = result.together["acceleration.x_k"].trends
    assert trend.differs
    assert trend.slope.value == pytest.approx(1e-3 / 3.0, rel=1e-2)
    assert not result.together["acceleration.zeta"].trends[0].differs
    assert result.found[0].command == "harness identify run-0.csv"
    assert rebuild(Path("out"))[0] == result


def test_conditions_of_one_recording_or_of_other_files_are_refused() -> None:
    with pytest.raises(InputError, match="conditions: given with one recording"):
        harness.identify(decay(), conditions={"run-0.csv": {"load": 1.0}})  # type: ignore[call-overload]
    with pytest.raises(InputError, match=r"rows of a.csv, which are none of the recordings"):
        harness.identify([decay(), decay(seed=1)], conditions={"a.csv": {"load": 1.0}})
