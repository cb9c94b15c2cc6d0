"""What README tells people to type exists."""

import re
import shlex
from pathlib import Path

import click
import pytest

from harness.cli.main import cli

CHECKOUT = Path(__file__).resolve().parents[2]
README = (CHECKOUT / "README.md").read_text(encoding="utf-8")
LINES = [line for block in re.findall(r"```sh\n(.*?)```", README, re.DOTALL) for line in block.splitlines()]


def test_two_lines_make_an_environment_each() -> None:
    first, second = [line for line in LINES if line.startswith("python3 -m venv")]
    assert first.endswith(".venv/bin/harness run")
    assert ".[test]" in second
    assert "-m pytest" in second
    assert all("-c constraints.txt" in line for line in (first, second))


@pytest.mark.parametrize("line", [line for line in LINES if line.startswith("harness ")])
def test_every_command_shown_can_be_parsed(line: str) -> None:
    _, name, *args = shlex.split(line)
    context = click.Context(cli)
    command = cli.get_command(context, name)
    assert command is not None
    command.make_context(name, args)


def test_files_it_points_to_are_there() -> None:
    links = re.findall(r"\]\((?!https?:)([^)]+)\)", README)
    assert links
    for link in links:
        assert (CHECKOUT / link).is_file(), link
    for named in re.findall(r"harness/[\w/]+(?:\.py)?", README):
        assert (CHECKOUT / named).exists(), named
