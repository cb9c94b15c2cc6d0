"""How a command refuses bad input: exit code 2, one line that says what was found, nothing on standard output."""

import pytest

from harness.cli.main import run


def refuses(line: str, message: str, capfd: pytest.CaptureFixture[str]) -> None:
    """Run a command line and see that it is refused with this message."""
    assert run(line.split()) == 2
    said = capfd.readouterr()
    assert said.out == ""
    assert said.err.startswith(f"harness: {message}")
    assert said.err.count("\n") == 1
