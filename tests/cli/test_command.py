"""The command as a process, and the way in: streams, exit codes, signals, help, names that were mistyped."""

import json
import os
import pty
import signal
import subprocess
import sys
import time
from itertools import pairwise
from pathlib import Path

import click
import pytest
from killing import ROOT, ended, environment, stopped

from harness.cli import progress
from harness.cli.main import COMPLETION, cli, run
from harness.core.errors import InputError, did_you_mean
from harness.engines import registry
from harness.engines.base import PRESETS, choice
from harness.fidelity.kind import kind
from harness.model.registry import term

NO_HOME = "/proc/no-home"
"""A home that nobody can make, root neither."""


@pytest.fixture(autouse=True)
def patient(monkeypatch: pytest.MonkeyPatch) -> None:
    """How slow this machine is must not be seen in standard error."""
    monkeypatch.setattr(progress, "PATIENCE_S", 600.0)
    monkeypatch.setattr(progress, "UNSEEN_S", 600.0)


@pytest.mark.usefixtures("pybullet")
def test_run_works_without_a_home_and_standard_output_is_json_alone(tmp_path: Path) -> None:
    # one engine, the one whose library writes to the streams; all of them are run beside the use case
    line = ["run", "--engine", "pybullet", "--preset", "tuned", "--json", "-", "--quiet"]
    code, out, said = ended(line, tmp_path, HOME=NO_HOME)
    assert (code, said) == (0, "")
    result = json.loads(out)
    assert result["schema"] == "harness.run/1"
    assert result["command"] == f"harness {' '.join(line)}"
    (folder,) = (tmp_path / "reports").iterdir()
    assert json.loads((folder / "result.json").read_text()) == result
    assert "pybullet build time" in (folder / "log.txt").read_text()


def test_the_cache_of_kernels_needs_no_home() -> None:
    program = "from harness.core.kernel_cache import cache_folder; print(cache_folder())"
    kept = {k: v for k, v in environment(HOME=NO_HOME).items() if k != "NUMBA_CACHE_DIR"}
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True, env=kept)
    assert os.access(done.stdout.strip(), os.W_OK)
    assert not done.stdout.startswith(NO_HOME)


@pytest.mark.parametrize("stop", [signal.SIGINT, signal.SIGTERM])
def test_an_interruption_leaves_nothing(tmp_path: Path, stop: signal.Signals) -> None:
    line = "run --engine mujoco --preset tuned --duration 200 --dt 1e-4 --json - --quiet"
    said = stopped(line.split(), tmp_path, "reports/.*.partial/log.txt", stop)
    assert said == (130, "", "harness: interrupted; nothing was written\n")
    assert list(tmp_path.iterdir()) == []


def test_output_folders_can_be_named_and_results_written_to_a_file(
    tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    folder = tmp_path / "a" / "b"
    told = ["run", "--engine", "mujoco", "--preset", "tuned", "--out", str(folder), "--json", str(tmp_path / "r.json")]
    assert run(told) == 0
    out, err = capfd.readouterr()
    assert err == ""
    assert "mujoco tuned" in out
    assert f"report: {tmp_path}/a/b/report.html" in out
    assert json.loads((tmp_path / "r.json").read_text()) == json.loads((folder / "result.json").read_text())
    assert run(["report", str(folder), "--quiet"]) == 0
    assert capfd.readouterr() == ("", "")


def test_doctor_says_what_there_is(capfd: pytest.CaptureFixture[str]) -> None:
    code = run(["doctor", "--json", "-"])
    out, err = capfd.readouterr()
    assert err == ""
    checks = {check["name"]: check for check in json.loads(out)["checks"]}
    assert {"python", "engine mujoco", "engine pybullet", "models", "numba cache", "rerun viewer", "browser"} <= set(
        checks
    )
    assert checks["engine mujoco"]["found"] == "version 4.0.0"
    assert all(check["ok"] or check["remedy"] for check in checks.values())
    assert code == 0
    assert run(["doctor"]) == 0
    assert "engine pybullet" in capfd.readouterr().out


def test_viewing_without_a_screen_is_one_line(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.delenv("DISPLAY", raising=False)
    monkeypatch.delenv("WAYLAND_DISPLAY", raising=False)
    (tmp_path / "trace.rrd").touch()
    assert run(["view", str(tmp_path)]) == 2
    told = capfd.readouterr().err
    assert "neither DISPLAY nor WAYLAND_DISPLAY is set. Try: " in told
    assert told.endswith(" --web\n")


def test_a_bug_is_one_line_that_says_where_the_details_are(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    """One file in the folder of states has them all, and does not grow for ever."""
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path))
    monkeypatch.setattr("harness.cli.main._MOST_OF_ERRORS", 1000)

    def broken(*args: object, **kwargs: object) -> None:
        raise ZeroDivisionError("a bug\non two lines")

    monkeypatch.setattr(cli, "invoke", broken)
    assert run(["run"]) == 1
    out, err = capfd.readouterr()
    assert out == ""
    assert err.startswith("harness: internal error, ZeroDivisionError: a bug on two lines; the details are in ")
    assert err.count("\n") == 1
    details = Path(err.rsplit(" ", 1)[1].strip())
    assert "Traceback" in details.read_text()
    assert details.is_relative_to(tmp_path)
    for _ in range(9):
        run(["run"])
    assert len(list(details.parent.iterdir())) == 2
    assert sum(file.stat().st_size for file in details.parent.iterdir()) < 5000


def test_progress_is_shown_on_a_terminal(monkeypatch: pytest.MonkeyPatch) -> None:
    ours, theirs = pty.openpty()
    with os.fdopen(ours, "rb", buffering=0) as reader, os.fdopen(theirs, "w") as terminal:
        monkeypatch.setattr(sys, "stderr", terminal)
        monkeypatch.setattr(progress, "PATIENCE_S", 0.0)
        with progress.shown(quiet=False) as tell:
            tell("mujoco tuned", 1, 4)
            time.sleep(0.3)
        assert b"mujoco tuned" in reader.read(4096)


@pytest.mark.parametrize("quiet", [False, True])
def test_progress_is_a_line_now_and_then_elsewhere(
    quiet: bool, capfd: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(progress, "UNSEEN_S", 0.0)
    monkeypatch.setattr(progress, "EVERY_S", 0.01)
    with progress.shown(quiet) as tell:
        tell("mujoco [tuned]\x1b", 2, 4)
        said = "harness: mujoco [tuned]\\x1b: 2 of 4 done\n"
        seen, deadline = "", time.monotonic() + (0.1 if quiet else 60.0)
        while said not in seen and time.monotonic() < deadline:
            time.sleep(0.01)
            seen += capfd.readouterr().err
    assert set(seen.splitlines(keepends=True)) == (set() if quiet else {said})


def test_versions_and_help(capfd: pytest.CaptureFixture[str]) -> None:
    assert run(["--version"]) == 0
    assert run(["--help"]) == 0
    out = capfd.readouterr().out
    assert "harness, version " in out
    for command in ("doctor", "identify", "report", "run", "view"):
        assert f"  {command} " in out
        assert run([command, "--help"]) == 0
        assert f"Example: harness {command}" in capfd.readouterr().out


def test_alone_it_prints_help(capfd: pytest.CaptureFixture[str]) -> None:
    assert run([]) == 0
    alone = capfd.readouterr()
    assert run(["--help"]) == 0
    assert alone == capfd.readouterr()
    assert "  diagnose " in alone.out


def test_help_keeps_within_eighty_columns(monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]) -> None:
    monkeypatch.setenv("COLUMNS", "80")
    for name in cli.list_commands(click.Context(cli)):
        assert run([name, "--help"]) == 0
        lines = capfd.readouterr().out.splitlines()
        assert [line for line in lines if len(line) > 80] == []
        # an example that goes on in the next line says so to the shell
        assert all(line.endswith("\\") for line, more in pairwise(lines) if more.startswith(" " * 15 + "--"))


def test_the_package_is_a_program() -> None:
    line = [sys.executable, "-m", "harness", "--version"]
    done = subprocess.run(line, capture_output=True, text=True, cwd=ROOT, check=True)
    assert done.stdout.startswith("harness, version ")


def test_the_nearest_name_is_said() -> None:
    assert did_you_mean("mujco", ("dart", "mujoco")) == "; did you mean mujoco?"
    assert did_you_mean("MuJoCo", ("dart", "mujoco")) == "; did you mean mujoco?"
    assert did_you_mean("zebra", ("dart", "mujoco")) == ""
    assert did_you_mean("", ()) == ""


def test_a_folder_of_logs_is_answered_with_the_line_that_takes_them_all(tmp_path: Path) -> None:
    logs = tmp_path / "my logs"
    logs.mkdir()
    for day in "12":
        (logs / f"day-{day}.csv").write_text("t,elbow.goal,elbow.position\n0,0,0\n", encoding="utf-8")
    code, _, error = ended(["diagnose", "my logs", "--quiet"], tmp_path)
    assert code == 2
    assert error.endswith("did you mean my logs/*.csv? Try: harness diagnose 'my logs'/*.csv --quiet\n")


def test_a_term_engine_preset_and_scenario_say_it_from_python_too() -> None:
    known = "end-stop:positive"
    assert term(known).key == known
    for asked, meant in (
        (lambda: term("endstop:positive"), known),
        (lambda: registry.check("pybulet"), "pybullet"),
        (lambda: choice("preset", "as_shipped", PRESETS), "as-shipped"),
        (lambda: kind("belts"), "belt"),
    ):
        with pytest.raises(InputError, match=rf"did you mean {meant}\?"):
            asked()


@pytest.mark.parametrize("shell", ["bash", "zsh", "fish"])
def test_each_shell_gets_its_script(
    shell: str, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv(COMPLETION, f"{shell}_source")
    assert run([]) == 0
    assert f"{COMPLETION}={shell}_complete" in capfd.readouterr().out
    assert f"{COMPLETION}={shell}_source harness" in (ROOT / "docs" / "terminal.md").read_text()


@pytest.mark.parametrize(
    ("words", "expected"),
    [("harness id", {"identify"}), ("harness run --pre", {"--preset"}), ("harness run --engine mu", {"mujoco"})],
)
def test_what_completion_offers(
    words: str, expected: set[str], monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv(COMPLETION, "bash_complete")
    monkeypatch.setenv("COMP_WORDS", words)
    monkeypatch.setenv("COMP_CWORD", str(len(words.split()) - 1))
    assert run([]) == 0
    assert {line.split(",")[1] for line in capfd.readouterr().out.splitlines()} == expected


@pytest.mark.parametrize(
    "line",
    [
        ["diagnose", "nosuch.csv", "--json", "found.json"],
        ["diagnose", str(ROOT / "README.md"), "--sim", "nosuch.csv"],
        ["identify", "nosuch.csv"],
        ["compare", str(ROOT / "README.md"), "nosuch.csv"],
        ["run", "--model", "nosuch.csv"],
        ["regress", "--baseline", "nosuch.csv"],
        ["report", "nosuch.csv"],
        ["view", "nosuch.csv"],
    ],
    ids=lambda line: line[0],
)
def test_a_file_that_is_not_there_is_refused_before_anything_heavy_is_loaded(line: list[str], tmp_path: Path) -> None:
    program = (
        "import sys\n"
        "from harness.cli.main import run\n"
        f"code = run({line!r})\n"
        "heavy = {'numba', 'scipy', 'numpy', 'pydantic', 'pint', 'rich', 'mujoco', 'pybullet', 'pyarrow', 'h5py'}\n"
        "print(code, sorted(heavy & set(sys.modules)))\n"
    )
    environment = {**os.environ, "PYTHONPATH": str(ROOT)}
    done = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, cwd=tmp_path, env=environment, check=True
    )
    assert done.stdout == "2 []\n"
    assert "nosuch.csv: no such file" in done.stderr
    assert list(tmp_path.iterdir()) == []
