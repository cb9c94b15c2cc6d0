"""The command's output: tables within a width, streams, and an interruption."""

import re
import signal
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from rich.table import Table

from harness.app.view import viewer_command
from harness.cli.output import line_width, say, say_as_it_is, show, with_error, wrapped
from harness.results.common import P


@pytest.mark.parametrize(
    ("number", "text"),
    [
        (P(value=0.0123188, stderr=0.0041, unit="rad"), "0.0123 +- 0.0041 rad"),
        (P(value=10.7596, stderr=0.0212, unit="rad/s"), "10.760 +- 0.021 rad/s"),
        (P(value=0.05, stderr=3.2e-7, unit="1"), "0.05000000 +- 0.00000032"),
        (P(value=231.4, stderr=14.0, unit="m"), "231 +- 14 m"),
        (P(value=1.548529, stderr=0.0, unit="m"), "1.549 m"),
        (P(value=1.5, stderr=None, unit="m", why="one reversal"), "1.5 m"),
        (P(value=None, stderr=None, unit="m", why="no reversal"), "-"),
    ],
)
def test_values_carry_the_digits_their_errors_give_meaning_to(number: P, text: str) -> None:
    assert with_error(number) == text


def test_a_cell_is_shown_as_it_is(capsys: pytest.CaptureFixture[str]) -> None:
    table = Table(title="[bold]title[/]")
    table.add_column("x [mm]")
    table.add_row("pip install 'friction-harness[dart]'")
    table.add_row(":smile: [red]red[/red] \x1b[2J\x9b")
    show(table)
    say("a line [red] \x1b[2J")
    shown = capsys.readouterr().out
    for text in (
        "title[/]",
        "x [mm]",
        "friction-harness[dart]",
        r":smile: [red]red[/red] \x1b[2J\x9b",
        r"[red] \x1b[2J",
    ):
        assert text in shown
    assert "\x1b" not in shown


def test_the_viewer_listens_on_this_machine_alone() -> None:
    command = viewer_command("rerun", Path("-trace.rrd"), web=True)
    assert command[1:4] == ["--bind", "127.0.0.1", "--web-viewer"]
    assert command[-1] == str(Path.cwd() / "-trace.rrd")


NUMBERS = ["0.05000000 +- 0.00000032", "10.760 +- 0.021", "0.0123188 +- 0.0000041 rad", "1.234567e-12", "-231.4"]


def table(rows: int, columns: int) -> Table:
    made = Table(title="what was found, by every method there is, in a title that is wider than a narrow table")
    for place in range(columns):
        made.add_column(f"quantity {place}" if place else "", no_wrap=True)
    for row in range(rows):
        made.add_row(f"row {row}", *(NUMBERS[(row + place) % len(NUMBERS)] for place in range(1, columns)))
    return made


@pytest.mark.parametrize("width", [40, 80, 120])
@pytest.mark.parametrize(("rows", "columns"), [(2, 3), (2, 9), (9, 2), (12, 12), (1, 1), (0, 4)])
def test_no_line_runs_over_and_no_number_is_cut(
    rows: int, columns: int, width: int, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv("COLUMNS", str(width))
    show(table(rows, columns))
    shown = capsys.readouterr().out
    assert max(map(len, shown.splitlines()), default=0) <= width
    assert "\N{HORIZONTAL ELLIPSIS}" not in shown
    for place in range(1, columns):
        for row in range(rows):
            assert NUMBERS[(row + place) % len(NUMBERS)] in shown
            assert "quantity" in shown
            assert re.search(rf"\b{place}\b", shown)


def test_headings_are_broken_before_a_table_is_turned(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv("COLUMNS", "60")
    wide = Table()
    for heading in ("joint", "position of it, rad", "speed of it, rad/s", "torque of it, N m", "nothing"):
        wide.add_column(heading)
    wide.add_row("elbow", "-0.1 to 0.1", "-2 to 2", "-3 to 3", "-")
    show(wide)
    said = [line.split() for line in capsys.readouterr().out.splitlines()]
    assert ["joint", "rad", "rad/s", "N", "m"] in said
    assert ["elbow", *["-0.1", "to", "0.1", "-2", "to", "2", "-3", "to", "3"]] in said


def test_a_table_is_turned_before_it_becomes_a_list(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv("COLUMNS", "80")
    wide = Table()
    for heading in ("method", *(f"a long heading {place}" for place in range(5))):
        wide.add_column(heading)
    wide.add_row("free decay", "1", "2", "3", "4", "5" * 40)
    show(wide)
    said = [line.split() for line in capsys.readouterr().out.replace("\u2502", " ").replace("\u2503", " ").splitlines()]
    assert ["method", "free", "decay"] in said
    assert ["a", "long", "heading", "4", "5" * 40] in said


def test_without_a_width_a_table_is_as_wide_as_it_needs_to_be(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.delenv("COLUMNS", raising=False)
    show(table(2, 12))
    assert all(number in capsys.readouterr().out for number in NUMBERS[:1])
    say(long := "word " * 60)
    assert capsys.readouterr().out == f"{long}\n"


def test_sentences_are_wrapped_at_words_and_a_value_stays_with_its_error() -> None:
    text = "- the friction found is f_k = 0.351 +- 0.012 N, which is 17 % or 3 mN more than the maker says it is"
    for width in range(28, 100):
        lines = wrapped(text, width).split("\n")
        assert max(map(len, lines)) <= width
        assert " ".join(line.strip() for line in lines) == text
        assert all(line.startswith("  ") for line in lines[1:])
        for whole in ("f_k = 0.351 +- 0.012", "17 %", "3 mN"):
            assert any(whole in line for line in lines), width


def test_a_path_is_never_cut_and_what_is_to_be_copied_stays(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv("COLUMNS", "40")
    path = "/home/somebody/" + "folder-of-results/" * 4
    say(f"report: {path}")
    assert capsys.readouterr().out == f"report:\n{path}\n"
    say_as_it_is(f'<option a="1"  b="{path}"/>')
    assert capsys.readouterr().out == f'<option a="1"  b="{path}"/>\n'


@pytest.mark.parametrize(("said", "width"), [("80", 80), ("0", None), ("wide", None), ("", None)])
def test_the_width_is_that_of_columns(
    said: str, width: int | None, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv("COLUMNS", said)
    assert line_width() == width


# a mutex that is locked twice holds its thread where no signal is looked at, as a compiled loop does; a shell that
# starts tests in the background has them ignore the first signal
_DEAF = """
import ctypes, pathlib, signal, sys, threading
from harness.cli import main
from harness.io.store import output_folder
signal.signal(signal.SIGINT, signal.default_int_handler)
main.heed()
written = output_folder("run", pathlib.Path(sys.argv[1]))
(written.__enter__() / "part.csv").write_text("t,x")
lock, mutex = ctypes.CDLL(None).pthread_mutex_lock, ctypes.create_string_buffer(64)
threading.Timer(0.3, print, ("deaf",), {"flush": True}).start()
lock(mutex)
lock(mutex)
"""


@pytest.mark.parametrize("stop", [signal.SIGINT, signal.SIGTERM])
def test_a_call_that_looks_up_at_nothing_is_ended(stop: signal.Signals, tmp_path: Path) -> None:
    line = [sys.executable, "-c", _DEAF, str(tmp_path / "out")]
    with subprocess.Popen(line, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as deaf:
        try:
            assert deaf.stdout is not None
            assert deaf.stdout.readline() == "deaf\n"
            deaf.send_signal(stop)
            _, err = deaf.communicate(timeout=60)
        finally:
            deaf.kill()
    assert (deaf.returncode, err) == (130, "harness: interrupted; nothing was written\n")
    assert not any(tmp_path.iterdir())


@pytest.mark.parametrize(("files", "code"), [(["good.csv"], 0), (["good.csv", "none.csv"], 1)])
def test_a_reader_that_goes_early_changes_nothing(files: list[str], code: int, tmp_path: Path) -> None:
    """What ``| head -1`` closes: the files are written, nothing is said, and the code is that of the work."""
    t = np.arange(600) * 5e-3
    x = np.exp(-0.2 * t) * np.cos(8.0 * t) + np.random.default_rng(0).normal(0.0, 1e-3, t.size)
    np.savetxt(tmp_path / "good.csv", np.column_stack([t, x]), delimiter=",", header="t,x", comments="")
    line = [sys.executable, "-m", "harness.cli", "identify", *files, "--out", "out"]
    with subprocess.Popen(line, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, cwd=tmp_path) as left:
        assert left.stdout is not None
        assert left.stderr is not None
        left.stdout.close()
        said = left.stderr.read()
    assert (left.returncode, said) == (code, "")
    assert (tmp_path / "out" / "report.html").is_file()
