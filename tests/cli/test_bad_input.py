"""Bad input and hostile files: one line on standard error (where, what, what to do), exit 2, nothing else."""

import json
import os
import shlex
import shutil
import subprocess
import sys
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hostile import HOSTILE, MODELS, ROWS

from harness.cli.main import run
from harness.core.errors import StoreError
from harness.engines import models
from harness.io.store import output_folder
from harness.model.document import to_document
from harness.model.model import Model
from harness.robot.arm import load_arm
from harness.robot.example import excited
from harness.robot.example import write as write_log

CHECKOUT = Path(__file__).resolve().parents[2]
N = 400
T = np.arange(N) / 200.0
X = np.exp(-0.5 * T) * np.cos(10.0 * T)


def write(path: Path, header: str, x: np.ndarray, line: str | None = None) -> None:
    lines = [header, *(f"{t:.6f},{v:.6f}" for t, v in zip(T, x, strict=False))]
    if line is not None:
        lines[20] = line
    path.write_text("\n".join(lines) + "\n")


def table(path: Path, header: str, *columns: np.ndarray) -> None:
    np.savetxt(path, np.column_stack((T, *columns)), "%.6f", ",", header=header, comments="")


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Recordings, models and logs, good and bad."""
    made = tmp_path_factory.mktemp("desk")
    for name, header, x, line in (
        ("good", "t,x", X, None),
        ("two", "t,x", X[:2], None),
        ("nan", "t,x", np.where((T > 0.094) & (T < 0.3), np.nan, X), None),
        ("text", "t,x", X, "0.095,high"),
        ("back", "t,x", X, "0.8,1"),
        ("unit", "t,x [kg]", X, None),
        ("blub", "t,x [blub]", X, None),
        ("still", "t,x", np.ones(N), None),
        ("slope", "t,x", T, None),
        ("speed", "t,v", X, None),
        ("short", "t,x", X[:10], None),
        ("half", "t,x", X[:120], None),
        ("rail", "t,x", np.sign(X), None),
    ):
        write(made / f"{name}.csv", header, x, line)
    table(made / "driven.csv", "t,x,u", X, np.sin(T))
    table(made / "quiet.csv", "t,x,u", X, 0.0 * T)
    table(made / "other.csv", "t,x,a", X, np.sin(37.0 * T))
    table(made / "units.csv", "t,x [deg],a [g]", X, -100.0 * X)
    for name in ("log.json", "model.json"):
        (made / name).write_text("{}")
    (made / "good.json").write_text(json.dumps(to_document(Model(1.0, 1.0, 100.0, 3.0, x0=1.0))))
    (made / "DATA_EMPS.mat").write_text("foo")
    arm = models.folder() / "arm" / "arm.xml"
    shutil.copy(arm, made)
    for name, duration in (("log", 1.0), ("long", 4.0)):
        log = excited(load_arm(arm), {}, ("shoulder",), duration)
        still = {other: np.zeros(log.t.size) for other in ("base", "elbow")}
        write_log(replace(log, position={**log.position, **still}), made / f"{name}.csv")
    (made / "run").mkdir()
    for name in ("trace.rrd", "report.html"):
        (made / "run" / name).write_text("")
    (made / "full").mkdir()
    (made / "full" / "mine.txt").write_text("precious")
    return made


@pytest.fixture
def desk(folder: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """That folder, in which nothing else may be afterwards."""
    monkeypatch.chdir(folder)
    monkeypatch.setitem(sys.modules, "nonlinear_benchmarks", None)
    before = sorted(folder.rglob("*"))
    yield folder
    assert sorted(folder.rglob("*")) == before


MESSAGES = Path(__file__).with_name("messages.txt").read_text(encoding="utf-8")
BAD = [line.split(" | ", 1) for line in MESSAGES.splitlines() if not line.startswith("#")]


@pytest.mark.parametrize(("line", "message"), BAD, ids=[line for line, _ in BAD])
@pytest.mark.usefixtures("desk")
def test_bad_input_is_one_line_and_exit_2(line: str, message: str, capfd: pytest.CaptureFixture[str]) -> None:
    as_json = line.split(maxsplit=1)[0] in ("run", "identify", "compare", "diagnose") and "--json" not in line
    # quiet: a machine at its limit would see how far the work is
    code = run([*line.split(), *(["--json", "-", "--quiet"] if as_json else [])])
    out, err = capfd.readouterr()
    assert err.startswith("harness: ")
    assert message.lower() in err.lower()
    assert err.count("\n") == 1
    assert err.endswith("\n")
    assert out == ""
    assert code == 2


@pytest.mark.parametrize(
    ("line", "meant"),
    [
        ("identfy good.csv", "identify good.csv"),
        ("identify god.csv", "identify good.csv"),
        ("identify good.csv --colums x=x", "identify good.csv --columns x=x"),
        ("run --engine mujco", "run --engine mujoco"),
        ("identify full", "identify full/mine.txt"),
        ("regress", "regress --baseline friction.json --update"),
        ("run --joint elbow --m 2", "run --m 2"),
        ("run --joint=elbow --m 2", "run --m 2"),
        ("diagnose good.csv --resume", "diagnose good.csv"),
        ("identify", "identify --help"),
        ("identify driven.csv", "diagnose driven.csv"),
        ("identify good.csv --rate=0", "identify good.csv"),
        ("identify good.csv --columns x=y", "identify good.csv"),
        ("identify good.csv --from 3", "identify good.csv"),
        ("run belt --m 0 --out new", "run belt --out new"),
        ("run --out full", "run"),
        ("diagnose good.csv --restoring rope", "diagnose good.csv"),
        ("diagnose log.csv --robot arm.xml --mass 3", "diagnose log.csv --robot arm.xml"),
        ("diagnose log.csv --robot arm.xml --joint wheel", "diagnose log.csv --robot arm.xml --joint base"),
        ("sweep --resume --out nowhere", "sweep --out nowhere"),
        ("run nope", "run free-decay"),
        ("tune foo", "tune mujoco"),
        ("dataset emps", "dataset emps --download emps"),
        ("run --m", "run --help"),
        ("tune mujoco --out new", "tune mujoco"),
        ("log good.csv --robot=arm.xml", "log good.csv"),
        ("identify good.csv --engine mujoco --quiet", "identify good.csv --quiet"),
        ("diagnose --before good.csv", "diagnose good.csv"),
        ("words .", "words ./arm.xml"),
        ("view run/trace.rrd run/report.html", "view run/trace.rrd run/trace.rrd"),
        ("report run/report.html", "report run/trace.rrd"),
        ("diagnose log.csv long.csv --robot arm.xml --together", "diagnose log.csv long.csv --robot arm.xml"),
        ("diff mujco mujoco", "diff mujoco mujoco"),
    ],
)
@pytest.mark.usefixtures("desk")
def test_an_error_ends_in_the_command_that_was_meant(line: str, meant: str, capfd: pytest.CaptureFixture[str]) -> None:
    assert run(line.split()) == 2
    assert capfd.readouterr().err.endswith(f" Try: harness {meant}\n")
    words = meant.split()
    assert run(words if words[-1] == "--help" else [*words, "--help"]) == 0


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
        ("doctor --json -", 2, "harness: --json -: standard output is closed; expected an open one, or a file\n"),
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
    assert done.stderr == "harness: output: No space left on device; expected another place\n"
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


@pytest.mark.parametrize("name", [*HOSTILE, *MODELS])
def test_a_hostile_file_is_refused_by_name(
    name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    make, message = (HOSTILE | MODELS)[name]
    make(tmp_path / name)
    made = sorted(tmp_path.iterdir())
    words = ["run", "--model", name] if name in MODELS else ["identify", name]
    # quiet: a machine at its limit would see how far the work is
    code = run([*words, "--json", "-", "--quiet"])
    out, err = capfd.readouterr()
    assert message in err
    assert (code, out) == (2, "")
    assert err.startswith(f"harness: {'scenario' if name == 'quick.json' else name}")
    assert err.count("\n") == 1
    assert err.removesuffix("\n").isprintable()
    assert len(err) < 1000
    assert sorted(tmp_path.iterdir()) == made


def test_a_name_that_is_no_text_is_refused(tmp_path: Path) -> None:
    name = os.fsencode(tmp_path) + b"/bad\xff.csv"
    Path(os.fsdecode(name)).write_text("\n".join(ROWS))
    command = [os.fsencode(sys.executable), b"-m", b"harness.cli", b"identify", name, b"--json", b"-"]
    done = subprocess.run(command, capture_output=True, check=False, cwd=Path(__file__).resolve().parents[2])
    assert (done.returncode, done.stdout) == (2, b"")
    assert done.stderr.endswith(b"bad\\udcff.csv: bytes that are no text in utf-8; expected a name that is text\n")


def test_what_is_not_asked_for_is_not_read(tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    """24 GB of a data set beside t and x, which the file only declares."""
    import h5py
    import numpy as np
    from hostile import T, X

    with h5py.File(tmp_path / "a.mat", "w") as file:
        file["t"], file["x"] = T, X
        file.create_dataset("camera", (3_000_000_000,), "f8", chunks=(1 << 20,))
    np.savez(tmp_path / "a.npz", t=T, x=X, camera=np.zeros((2, 3, 4)))
    for name in ("a.mat", "a.npz"):
        assert run(["identify", str(tmp_path / name), "--json", "-", "--out", str(tmp_path / f"out-{name}")]) == 0
        assert capfd.readouterr().err == ""


def test_where_reports_cannot_be_the_line_goes_elsewhere(
    desk: Path, tmp_path: Path, capfd: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """A file stands where reports/ is to be made; the proposed line is run, and works."""
    monkeypatch.chdir(tmp_path)
    shutil.copy(desk / "good.csv", tmp_path)
    (tmp_path / "reports").write_text("")
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path))
    assert run(["identify", "good.csv", "--quiet"]) == 2
    line = capfd.readouterr().err.partition("Try: harness ")[2]
    assert "--out" in line
    assert run(shlex.split(line)) == 0


def test_a_folder_that_another_has_filled_meanwhile_is_said(tmp_path: Path) -> None:
    with output_folder("run", tmp_path / "out") as output:
        (tmp_path / "out" / "theirs.txt").write_text("precious")
        with pytest.raises(StoreError, match="out: another command has filled it meanwhile"):
            output.commit()
    assert (tmp_path / "out" / "theirs.txt").read_text() == "precious"


@pytest.mark.parametrize(
    ("line", "proposed"),
    [
        ("report good.csv", "harness log good.csv"),
        ("view good.csv", "harness log good.csv"),
        ("report .", "harness report run/trace.rrd"),
        ("tune newton", "harness doctor"),
        ("regress --traces full", "harness sweep --keep-traces worst:10"),
        ("regress --baseline /no/such/b.json --update", "harness regress --baseline b.json --update"),
        ("identify good.csv good.csv", "harness identify good.csv"),
        ("diagnose good.csv good.csv --together", "harness diagnose good.csv"),
        ("identify good.csv good.csv good.csv -q", "harness identify good.csv -q"),
    ],
)
@pytest.mark.usefixtures("desk")
def test_an_error_ends_in_a_line_that_helps(line: str, proposed: str, capfd: pytest.CaptureFixture[str]) -> None:
    assert run(line.split()) == 2
    assert capfd.readouterr().err.endswith(f"Try: {proposed}\n")
