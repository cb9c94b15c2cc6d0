"""harness diagnose: one line for bad input and usage, an entry and exit code 1 for one bad file of several."""

import json
from pathlib import Path

import numpy as np
import pytest

from harness.cli.main import run

T = np.arange(400) / 100.0
X = np.exp(-0.3 * T) * np.cos(10.0 * T) + 1e-4 * np.random.default_rng(0).normal(size=T.size)


def write(path: Path, **columns: np.ndarray) -> None:
    header = ",".join(columns)
    np.savetxt(path, np.column_stack(list(columns.values())), "%.9g", ",", header=header, comments="")


@pytest.fixture
def desk(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    write(tmp_path / "good.csv", t=T, x=X)
    write(tmp_path / "short.csv", t=T[:10], x=X[:10])
    write(tmp_path / "slope.csv", t=T, x=T)
    write(tmp_path / "half.csv", t=T[:60], x=X[:60])
    write(tmp_path / "rail.csv", t=T, x=np.sign(X))
    write(tmp_path / "other.csv", t=T, x=X, a=np.sin(37.0 * T))
    (tmp_path / "model.json").write_text("{}")
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.mark.parametrize(
    ("line", "message"),
    [
        ("", "missing argument"),
        ("none.csv", "none.csv: no such file; a file that can be read is accepted"),
        ("short.csv", "short.csv: 10 samples; at least 50 are accepted"),
        ("slope.csv", "slope.csv: channel x: 1 half-cycle; at least 3 are accepted"),
        ("half.csv", "half.csv: channel x: 2 half-cycles; at least 3 are accepted"),
        ("rail.csv", "rail.csv: channel x: saturated throughout"),
        ("other.csv", "other.csv: channels x and a: acceleration and displacement do not belong together"),
        ("good.csv --restoring none", "--restoring: none, but no force u is recorded in good.csv; "),
        ("good.csv --restoring rope", "--restoring: 'rope'; one of spring, pendulum, none is accepted"),
        ("good.csv --zero there", "--zero: 'there'; one of spring, free is accepted"),
        ("good.csv --zero spring --restoring pendulum", "--zero: spring with --restoring pendulum; free is accepted"),
        ("good.csv --mass 0", "--mass: 0; a number above 0 kg is accepted"),
        ("good.csv --horizon 1", "--horizon: given, but good.csv has no measured force; "),
        ("good.csv --dt 0", "--dt: 0; a number above 0 s is accepted"),
        ("good.csv --dt 1e-3 --preset as-shipped", "--dt: given with --preset as-shipped; "),
        ("good.csv --preset best", "--preset: 'best'; one of as-shipped, tuned is accepted"),
        ("good.csv --engine bullet", "--engine: 'bullet'; one of "),
        ("good.csv --sim good.csv --dt 1e-3", "--sim: given with --dt; one of the two is accepted"),
        ("good.csv --sim none.csv", "none.csv: no such file"),
        ("good.csv --model none.json", "none.json: no such file; "),
        ("good.csv --model model.json", "model.json: no field 'schema'; "),
        ("good.csv --together", "--together: good.csv alone; two recordings of one machine or more are accepted"),
        (
            "good.csv good.csv --together --sim good.csv",
            "--together: given with --sim; it is accepted with one recording",
        ),
        ("good.csv good.csv --together --model model.json", "--together: given with --model; "),
        ("good.csv good.csv --together --horizon 1", "--together: given with --horizon; "),
        ("good.csv good.csv --together --jobs 2", "--jobs: given with --together; "),
        ("good.csv none.csv --together", "none.csv: no such file"),
        ("good.csv --jobs 0", "--jobs"),
        ("good.csv --resume", "--resume: given without --out; "),
        ("- -", "recording: - given twice; standard input can be read once"),
        ("good.csv --trace x", "--trace: given for good.csv; it is accepted for a .rrd of ours alone"),
        ("good.csv --from 3.9", "good.csv: 10 samples between --from and --to"),
    ],
)
def test_bad_input_is_one_line_and_leaves_nothing(
    line: str, message: str, desk: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    before = sorted(desk.rglob("*"))
    code = run(["diagnose", *line.split()])
    out, err = capfd.readouterr()
    assert (code, out) == (2, "")
    assert err.count("\n") == 1
    assert message.lower() in err.lower()
    assert sorted(desk.rglob("*")) == before


def test_bad_files_among_several_are_entries_and_exit_1(desk: Path, capfd: pytest.CaptureFixture[str]) -> None:
    code = run(["diagnose", "short.csv", "none.csv", "--jobs", "1", "--json", "-", "--out", "out"])
    out, err = capfd.readouterr()
    assert (code, err) == (1, "")
    assert [(one["verdict"], one["recording"]) for one in json.loads(out)] == [
        ("error", {"file": "short.csv"}),
        ("error", {"file": "none.csv"}),
    ]
    assert {file.name for file in (desk / "out").iterdir()} == {"result.json", "index.html"}
