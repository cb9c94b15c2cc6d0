"""The search that is steered by branches, for a moment; its long form is ``python -m benchmarks.fuzz``."""

from pathlib import Path

import pytest

from benchmarks.fuzz.search import Search, stored
from benchmarks.fuzz.targets import NAMES, TARGETS, Target
from harness.core.errors import HarnessError


@pytest.mark.parametrize("name", [name for name, target in TARGETS.items() if not target.apart])
def test_what_earlier_searches_found_is_answered(name: str, tmp_path: Path) -> None:
    target = TARGETS[name]
    path = tmp_path / NAMES.get(name, f"fuzzed{target.suffix}")
    for data in (*target.seeds, *stored(name)):
        path.write_bytes(data)
        assert answered(target, path).isprintable()


def answered(target: Target, path: Path) -> str:
    """The line that refuses a file, "" for one that is read."""
    try:
        target.call(path)
    except HarnessError as error:
        return str(error)
    return ""


def test_a_short_search_finds_nothing_wrong() -> None:
    for name in ("table", "model", "npz"):
        search = Search(name, 1)
        search.run(0.7)
        assert search.tried > 0
        assert search.wrong == {}
