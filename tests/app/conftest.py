"""One default run, shared by the tests of what it leaves."""

from pathlib import Path

import pytest

from harness.app.run.run import RunOptions, run
from harness.results.run import RunResult


@pytest.fixture(scope="session")
def done(tmp_path_factory: pytest.TempPathFactory) -> tuple[RunResult, Path]:
    """The default run and its output folder."""
    folder = tmp_path_factory.mktemp("run") / "out"
    return run(RunOptions(), folder, command="harness run"), folder
