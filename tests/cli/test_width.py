"""Within the width there is: sentences are wrapped at words, tables turned on their side, and no number is cut."""

import pytest
from rich.table import Table

from harness.cli.output import line_width, say, say_as_it_is, wrapped
from harness.cli.tables import show

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
            assert f"quantity {place}" in shown


def test_a_table_is_turned_before_it_becomes_a_list(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv("COLUMNS", "80")
    wide = Table()
    for heading in ("method", *(f"a long heading {place}" for place in range(5))):
        wide.add_column(heading)
    wide.add_row("free decay", "1", "2", "3", "4", "5")
    show(wide)
    said = [line.split() for line in capsys.readouterr().out.replace("\u2502", " ").replace("\u2503", " ").splitlines()]
    assert ["method", "free", "decay"] in said
    assert ["a", "long", "heading", "4", "5"] in said


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
