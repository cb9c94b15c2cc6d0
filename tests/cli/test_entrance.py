"""The way in: help, names that were mistyped, completion, files that are not there."""

import os
import subprocess
import sys
from itertools import pairwise
from pathlib import Path

import click
import pytest

from harness.cli.main import COMPLETION, cli, run
from harness.core.errors import InputError, did_you_mean
from harness.engines import registry
from harness.engines.base import PRESETS, choice
from harness.fidelity.kind import kind
from harness.model.registry import term

CHECKOUT = Path(__file__).resolve().parents[2]


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
    done = subprocess.run(line, capture_output=True, text=True, cwd=CHECKOUT, check=True)
    assert done.stdout.startswith("harness, version ")


def test_the_nearest_name_is_said() -> None:
    assert did_you_mean("mujco", ("dart", "mujoco")) == "; did you mean mujoco?"
    assert did_you_mean("MuJoCo", ("dart", "mujoco")) == "; did you mean mujoco?"
    assert did_you_mean("zebra", ("dart", "mujoco")) == ""
    assert did_you_mean("", ()) == ""


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
    assert f"{COMPLETION}={shell}_source harness" in (CHECKOUT / "docs" / "terminal.md").read_text()


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
        ["diagnose", str(CHECKOUT / "README.md"), "--sim", "nosuch.csv"],
        ["identify", "nosuch.csv"],
        ["compare", str(CHECKOUT / "README.md"), "nosuch.csv"],
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
    environment = {**os.environ, "PYTHONPATH": str(CHECKOUT)}
    done = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, cwd=tmp_path, env=environment, check=True
    )
    assert done.stdout == "2 []\n"
    assert "nosuch.csv: no such file; " in done.stderr
    assert list(tmp_path.iterdir()) == []
