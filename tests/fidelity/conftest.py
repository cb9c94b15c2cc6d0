"""Rows are computed where the test is; processes are looked at by their own pool, or by the command."""

from collections.abc import Iterator

import pytest
from here import in_this_process


@pytest.fixture(scope="module", autouse=True)
def without_processes() -> Iterator[None]:
    """For what a file makes once for all of its tests too."""
    with in_this_process():
        yield
