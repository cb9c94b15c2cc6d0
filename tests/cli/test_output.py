"""Numbers for people, and text as it is."""

from pathlib import Path

import pytest
from rich.table import Table

from harness.app.report.view import viewer_command
from harness.cli.output import say, with_error
from harness.cli.tables import show
from harness.results.common import P


@pytest.mark.parametrize(
    ("number", "text"),
    [
        (P(value=0.0123188, stderr=0.0041, unit="rad"), "0.0123 +- 0.0041 rad"),
        (P(value=10.7596, stderr=0.0212, unit="rad/s"), "10.760 +- 0.021 rad/s"),
        (P(value=0.05, stderr=3.2e-7, unit="1"), "0.05000000 +- 0.00000032"),
        (P(value=231.4, stderr=14.0, unit="m"), "231 +- 14 m"),
        (P(value=1.5, stderr=0.0, unit="m"), "1.5 m"),
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
