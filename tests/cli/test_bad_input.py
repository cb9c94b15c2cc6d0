"""Bad input: one line on standard error (where, what, what is accepted), exit 2, nothing on standard output."""

import json
import os
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from harness.cli.main import run

CHECKOUT = Path(__file__).resolve().parents[2]
N = 400
T = np.arange(N) / 200.0
X = np.exp(-0.5 * T) * np.cos(10.0 * T)


def write(path: Path, header: str, x: np.ndarray, line: str | None = None) -> None:
    lines = [header, *(f"{t:.6f},{v:.6f}" for t, v in zip(T, x, strict=False))]
    if line is not None:
        lines[20] = line
    path.write_text("\n".join(lines) + "\n")


@pytest.fixture
def desk(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """A folder with recordings, good and bad; nothing else may be in it afterwards."""
    write(tmp_path / "good.csv", "t,x", X)
    write(tmp_path / "two.csv", "t,x", X[:2])
    write(tmp_path / "nan.csv", "t,x", X, "0.095,nan")
    write(tmp_path / "text.csv", "t,x", X, "0.095,high")
    write(tmp_path / "back.csv", "t,x", X, "0.8,1")
    write(tmp_path / "unit.csv", "t,x [kg]", X)
    write(tmp_path / "blub.csv", "t,x [blub]", X)
    write(tmp_path / "still.csv", "t,x", np.ones(N))
    write(tmp_path / "slope.csv", "t,x", T)
    write(tmp_path / "speed.csv", "t,v", X)
    write(tmp_path / "driven.csv", "t,x,u", X)
    driven = [f"{t:.6f},{x:.6f},{np.sin(t):.6f}" for t, x in zip(T, X, strict=True)]
    (tmp_path / "driven.csv").write_text("t,x,u\n" + "\n".join(driven) + "\n")
    write(tmp_path / "short.csv", "t,x", X[:10])
    write(tmp_path / "half.csv", "t,x", X[:120])
    write(tmp_path / "rail.csv", "t,x", np.sign(X))
    other = [f"{t:.6f},{x:.6f},{np.sin(37.0 * t):.6f}" for t, x in zip(T, X, strict=True)]
    (tmp_path / "other.csv").write_text("t,x,a\n" + "\n".join(other) + "\n")
    for name in ("log.json", "model.json"):
        (tmp_path / name).write_text("{}")
    (tmp_path / "full").mkdir()
    (tmp_path / "full" / "mine.txt").write_text("precious")
    monkeypatch.chdir(tmp_path)
    before = sorted(tmp_path.rglob("*"))
    yield tmp_path
    assert sorted(tmp_path.rglob("*")) == before


BAD: list[tuple[str, str]] = [
    ("run --m 0", "slider: m: 0; a number above 0 kg is accepted"),
    ("run --m -1", "slider: m: -1; a number above 0 kg is accepted"),
    ("run --k 0", "slider: k: 0; a number above 0 N/m is accepted"),
    ("run --k -5", "slider: k: -5; a number above 0 N/m is accepted"),
    ("run --c -1", "slider: c: -1; 0 or more N s/m is accepted"),
    ("run --f-k -1", "slider: f_k: -1; 0 or more N is accepted"),
    ("run --f-s 2", "slider: f_s: 2 N, below f_k = 3 N; f_s >= f_k is accepted"),
    ("run --m nan", "slider: m: nan; a finite number is accepted"),
    ("run --k nan", "slider: k: nan; a finite number is accepted"),
    ("run --c nan", "slider: c: nan; a finite number is accepted"),
    ("run --f-k nan", "slider: f_k: nan; a finite number is accepted"),
    ("run --f-s nan", "slider: f_s: nan; a finite number is accepted"),
    ("run --x0 nan", "x0: nan; a finite number is accepted"),
    ("run --v0 inf", "v0: inf; a finite number is accepted"),
    ("run --duration nan", "duration: nan; a finite number is accepted"),
    ("run --duration 0", "duration: 0; a number above 0 s is accepted"),
    ("run --m one", "'--m': 'one' is not a valid float"),
    ("run --dt 0", "--dt: 0; a number above 0 s is accepted"),
    ("run --dt -0.001", "--dt: -0.001; a number above 0 s is accepted"),
    ("run --dt nan", "--dt: nan; a finite number is accepted"),
    ("run --dt 1e-12", "--duration: 3e+12 samples; at most 20000000"),
    ("run --dt 0.001 --preset as-shipped", "--dt: given with --preset as-shipped"),
    ("run --preset best", "--preset: 'best'; one of as-shipped, tuned is accepted"),
    ("run --engine bullet", "--engine: 'bullet'; one of "),
    ("run swing", "scenario: 'swing'; free-decay, free-decay-no-friction, hold-50, hold-97, belt, harmonic,"),
    ("run free-decay more", "unexpected extra argument"),
    ("run --out full", "--out full: the folder holds files already; a new or empty one is accepted"),
    ("run --out /proc/run", "accepted"),
    ("run --out good.csv/run", "a file stands where a folder is needed"),
    ("run --json /no/such/folder/a.json", "/no/such/folder/a.json: no such folder"),
    ("run --json full", "a folder stands where a file is needed"),
    ("run --nonsense", "No such option"),
    ("identify", "Missing argument 'RECORDING'"),
    ("identify none.csv", "none.csv: no such file; a file that can be read is accepted"),
    ("identify full", "full: a folder"),
    ("identify log.json", "the format .json; text tables, also gzipped (.csv, .txt"),
    ("identify two.csv", "two.csv: 2 samples; at least 50 are accepted"),
    ("identify nan.csv", "nan.csv: row 20 (line 21), column x: no value or nan"),
    ("identify text.csv", "text.csv: row 20 (line 21), column x: the text 'high'; a number is accepted"),
    ("identify back.csv", "back.csv: row 21 (line 22), column t: time 0.1 s does not come after 0.8 s"),
    ("identify unit.csv", "unit.csv: column x: 'kg' is a unit of another kind"),
    ("identify blub.csv", "blub.csv: column x: 'blub' is not a unit"),
    ("identify still.csv", "still.csv: column x: the constant 1; a channel that moves is accepted"),
    ("identify slope.csv", "slope.csv: no estimate is possible"),
    ("identify driven.csv", "driven.csv: channel u: a driven recording (a force of up to 1 N"),
    ("identify good.csv --columns x=__import__('os').system('id')", "is no name, #N or number"),
    ("identify good.csv --columns x=open('f')[m]", "is no name, #N or number"),
    ("identify good.csv --columns x=y", "good.csv: column y: no such column; t, x are accepted"),
    ("identify good.csv --columns x=x[kg]", "--columns, channel x: 'kg' is a unit of another kind"),
    ("identify good.csv --rate 0", "--rate: 0; a number above 0 Hz is accepted"),
    ("identify good.csv --rate 200", "--rate: given although a column of good.csv gives the time"),
    ("identify good.csv --from 3", "0 samples between --from and --to"),
    ("identify good.csv --skip-rows -1", "--skip-rows: -1; 0 or more is accepted"),
    ("identify good.csv --trace x", "--trace: given for good.csv"),
    ("identify good.csv --out full", "--out full: the folder holds files already"),
    ("compare good.csv", "Missing argument 'REAL'"),
    ("compare none.csv good.csv", "none.csv: no such file; a file that can be read is accepted"),
    ("compare good.csv nan.csv", "nan.csv: row 20 (line 21), column x: no value or nan"),
    ("compare good.csv two.csv", "two.csv: 2 samples; at least 50 are accepted"),
    ("compare good.csv speed.csv", "channels x and v; two traces with one of x, v, a in common are accepted"),
    ("compare good.csv good.csv --trace x", "--trace: given for good.csv"),
    ("compare good.csv good.csv --out full", "--out full: the folder holds files already"),
    ("diagnose", "Missing argument"),
    ("diagnose none.csv", "none.csv: no such file; a file that can be read is accepted"),
    ("diagnose short.csv", "short.csv: 10 samples; at least 50 are accepted"),
    ("diagnose slope.csv", "slope.csv: channel x: 1 half-cycle; at least 3 are accepted"),
    ("diagnose half.csv", "half.csv: channel x: 2 half-cycles; at least 3 are accepted"),
    ("diagnose rail.csv", "rail.csv: channel x: saturated throughout"),
    ("diagnose other.csv", "other.csv: channels x and a: acceleration and displacement do not belong together"),
    ("diagnose good.csv --restoring none", "--restoring: none, but no force u is recorded in good.csv; "),
    ("diagnose good.csv --restoring rope", "--restoring: 'rope'; one of spring, pendulum, none is accepted"),
    ("diagnose good.csv --zero there", "--zero: 'there'; one of spring, free is accepted"),
    (
        "diagnose good.csv --zero spring --restoring pendulum",
        "--zero: spring with --restoring pendulum; free",
    ),
    ("diagnose good.csv --mass 0", "--mass: 0; a number above 0 kg is accepted"),
    ("diagnose good.csv --horizon 1", "--horizon: given, but good.csv has no measured force; "),
    ("diagnose good.csv --dt 0", "--dt: 0; a number above 0 s is accepted"),
    ("diagnose good.csv --dt 1e-3 --preset as-shipped", "--dt: given with --preset as-shipped; "),
    ("diagnose good.csv --preset best", "--preset: 'best'; one of as-shipped, tuned is accepted"),
    ("diagnose good.csv --engine bullet", "--engine: 'bullet'; one of "),
    ("diagnose good.csv --sim good.csv --dt 1e-3", "--sim: given with --dt; one of the two is accepted"),
    ("diagnose good.csv --sim none.csv", "none.csv: no such file"),
    ("diagnose good.csv --model none.json", "none.json: no such file; "),
    ("diagnose good.csv --model model.json", "model.json: no field 'schema'; "),
    ("diagnose good.csv --together", "--together: good.csv alone; two recordings of one machine or more are accepted"),
    (
        "diagnose good.csv good.csv --together --sim good.csv",
        "--together: given with --sim; it is accepted with one",
    ),
    ("diagnose good.csv good.csv --together --model model.json", "--together: given with --model; "),
    ("diagnose good.csv good.csv --together --horizon 1", "--together: given with --horizon; "),
    ("diagnose good.csv good.csv --together --jobs 2", "--jobs: given with --together; "),
    ("diagnose good.csv none.csv --together", "none.csv: no such file"),
    ("diagnose good.csv --jobs 0", "--jobs"),
    ("diagnose good.csv --resume", "--resume: given without --out; "),
    ("diagnose - -", "recording: - given twice; standard input can be read once"),
    ("diagnose good.csv --trace x", "--trace: given for good.csv; it is accepted for a .rrd of ours alone"),
    ("diagnose good.csv --from 1.95", "good.csv: 10 samples between --from and --to"),
    ("nonsense", "command 'nonsense': no such command; accepted: compare, "),
    ("--nonsense", "No such option"),
]


@pytest.mark.parametrize(("line", "message"), BAD, ids=[line or "nothing" for line, _ in BAD])
@pytest.mark.usefixtures("desk")
def test_bad_input_is_one_line_and_exit_2(line: str, message: str, capfd: pytest.CaptureFixture[str]) -> None:
    code = run([*line.split(), *(["--json", "-"] if line and "--json" not in line and "nonsense" not in line else [])])
    out, err = capfd.readouterr()
    assert err.startswith("harness: ")
    assert message.lower() in err.lower()
    assert err.count("\n") == 1
    assert err.endswith("\n")
    assert out == ""
    assert code == 2


@pytest.mark.parametrize("size", ["200k", "2m"])
def test_a_full_disk_is_one_line_and_leaves_nothing(
    size: str, tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    if os.geteuid() != 0:
        pytest.skip("mounting a small file system needs root")
    place = tmp_path / "tiny"
    place.mkdir()
    mount = ["mount", "-t", "tmpfs", "-o", f"size={size}", "none", str(place)]
    if subprocess.run(mount, capture_output=True, check=False).returncode != 0:
        pytest.skip("mounting a small file system is not allowed here")
    try:
        code = run(["run", "--quiet", "--json", "-", "--out", str(place / "out")])
        out, err = capfd.readouterr()
        left = list(place.iterdir())
    finally:
        subprocess.run(["umount", str(place)], check=True)
    assert (code, out, left) == (2, "", [])
    assert err.count("\n") == 1
    assert f"harness: {place}/out" in err
    assert "no space left" in err or "room on its disk" in err


@pytest.mark.parametrize(
    ("line", "code", "message"),
    [
        ("doctor", 0, ""),
        ("doctor --json -", 2, "harness: --json -: standard output is closed; an open one, or a file, is accepted\n"),
    ],
)
def test_a_closed_standard_output(line: str, code: int, message: str) -> None:
    again = [sys.executable, "-m", "harness.cli", *line.split()]
    program = f"import os; os.close(1); os.execv({sys.executable!r}, {again!r})"
    done = subprocess.run([sys.executable, "-c", program], stderr=subprocess.PIPE, text=True, check=False, cwd=CHECKOUT)
    assert (done.returncode, done.stderr) == (code, message)


def test_a_full_standard_output_is_one_line() -> None:
    with Path("/dev/full").open("w") as full:
        done = subprocess.run(
            [sys.executable, "-m", "harness.cli", "doctor", "--json", "-"],
            stdout=full,
            stderr=subprocess.PIPE,
            text=True,
            check=False,
            cwd=CHECKOUT,
        )
    assert done.stderr == "harness: output: No space left on device; another place is accepted\n"
    assert done.returncode == 2


def test_bad_files_among_several_are_entries_and_exit_1(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    write(tmp_path / "short.csv", "t,x", X[:10])
    code = run(["diagnose", "short.csv", "none.csv", "--jobs", "1", "--json", "-", "--out", "out"])
    out, err = capfd.readouterr()
    assert (code, err) == (1, "")
    assert [(one["verdict"], one["recording"]) for one in json.loads(out)] == [
        ("error", {"file": "short.csv"}),
        ("error", {"file": "none.csv"}),
    ]
    assert {file.name for file in (tmp_path / "out").iterdir()} == {"result.json", "index.html"}
