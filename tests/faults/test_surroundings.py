"""Where a command finds itself: nothing in the environment, a locale of letters alone, no place to write to."""

import json
import os
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from killing import COMMAND, ROOT, ended

from harness.cli.main import run
from harness.core.kernel_cache import cache_folder

T = np.arange(400) / 200.0
X = np.exp(-0.5 * T) * np.cos(10.0 * T)


@pytest.fixture
def place(tmp_path: Path) -> Path:
    np.savetxt(tmp_path / "d.csv", np.column_stack([T, X]), "%.9g", ",", header="t,x", comments="")
    return tmp_path


@pytest.fixture
def read_only(place: Path) -> Iterator[Path]:
    """A file system that nobody can write to, root neither."""
    closed = place / "closed"
    closed.mkdir()
    mount = ["mount", "-t", "tmpfs", "-o", "size=64k,ro", "none", str(closed)]
    if os.geteuid() != 0 or subprocess.run(mount, capture_output=True, check=False).returncode != 0:
        pytest.skip("mounting a read-only file system needs root")
    yield closed
    subprocess.run(["umount", str(closed)], check=True)


def test_an_empty_environment_and_a_locale_of_letters_alone(place: Path) -> None:
    line = [*COMMAND, "identify", "d.csv", "--out", "out", "--json", "-"]
    plain = {"LC_ALL": "C", "PYTHONUTF8": "0", "PYTHONCOERCECLOCALE": "0", "PYTHONPATH": str(ROOT)}
    # without a home what is compiled has a folder of its own, and is compiled there for a minute
    plain["NUMBA_CACHE_DIR"] = str(cache_folder())
    done = subprocess.run(line, cwd=place, env=plain, capture_output=True, check=False)
    assert (done.returncode, done.stderr) == (0, b"")
    assert json.loads(done.stdout.decode("ascii"))["schema"] == "harness.identify/1"
    assert not (place / "out" / "report.html").read_text(encoding="utf-8").isascii()


def test_a_name_that_the_locale_cannot_say(place: Path) -> None:
    os.rename(place / "d.csv", place / "wegü.csv")
    code, out, err = ended(["identify", "wegü.csv"], place, LC_ALL="C", PYTHONUTF8="0", PYTHONCOERCECLOCALE="0")
    assert (code, out) == (2, "")
    assert err.endswith("weg\\udcc3\\udcbc.csv: bytes that are no text in ascii; expected a name that is text\n")


@pytest.mark.parametrize(
    "line",
    [
        "identify {place}/d.csv",
        "compare {place}/d.csv {place}/d.csv",
        "run",
        "diagnose {place}/d.csv",
        "diagnose {place}/d.csv {place}/d.csv",
        "sweep --short",
        "prove --short",
        "identify {place}/d.csv --json {closed}/a.json",
        "regress --baseline {closed}/a.json --update",
    ],
)
def test_a_place_that_is_read_only(
    line: str, place: Path, read_only: Path, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(read_only)
    assert run([*line.format(place=place, closed=read_only).split(), "--quiet"]) == 2
    out, err = capfd.readouterr()
    assert out == ""
    assert err.count("\n") == 1
    assert "a read-only file system" in err
    named = "{closed}" in line
    assert ("; expected a folder that can be written" if named else ". Try: harness ") in err
    assert named or "--quiet --out " in err


def test_a_folder_that_was_removed_meanwhile(place: Path) -> None:
    gone = place / "gone"
    gone.mkdir()
    again = [*COMMAND, "identify", str(place / "d.csv")]
    program = f"import os; os.rmdir({str(gone)!r}); os.execv({sys.executable!r}, {again!r})"
    environment = {**os.environ, "PYTHONPATH": str(ROOT)}
    done = subprocess.run(
        [sys.executable, "-c", program], cwd=gone, env=environment, capture_output=True, text=True, check=False
    )
    assert (done.returncode, done.stdout) == (2, "")
    assert done.stderr == "harness: the working folder: it was removed; expected a folder that is there\n"
