"""A small proof that is made once, and copies of it to change."""

import shutil
from collections.abc import Iterator
from pathlib import Path

import pytest
from here import in_this_process
from small_proof import SIZES, STUB, unchanged_sources

from harness.app.prove.prove import ProveOptions, prove


@pytest.fixture(autouse=True)
def without_processes(request: pytest.FixtureRequest) -> Iterator[None]:
    """But where it is the processes that are looked at."""
    if request.path.name == "test_prove_blind.py":
        yield
    else:
        with in_this_process():
            yield


@pytest.fixture
def one_version() -> Iterator[None]:
    """Sources that seem to stay the same."""
    with unchanged_sources():
        yield


@pytest.fixture(scope="session")
def published(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A small proof of a diagnosis that says of everything that nothing is left out."""
    folder = tmp_path_factory.mktemp("proof") / "done"
    with unchanged_sources(), in_this_process():
        prove(ProveOptions(SIZES, jobs=1, blind=STUB), folder)
    return folder


@pytest.fixture
def proof(published: Path, tmp_path: Path) -> Path:
    """A copy to change."""
    shutil.copytree(published, tmp_path / "proof")
    return tmp_path / "proof"
