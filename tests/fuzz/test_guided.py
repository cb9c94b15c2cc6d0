"""The search that is steered by branches, for a moment; its long form is ``python tests/fuzz --seconds 600``."""

import subprocess
import sys
from pathlib import Path

import pytest
from fuzz_guided import stored
from fuzz_targets import NAMES, TARGETS, Target

from harness.core.errors import HarnessError

ROOT = Path(__file__).resolve().parents[2]


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
    line = [sys.executable, str(ROOT / "tests" / "fuzz"), "--seconds", "0.7", "--seed", "1", "table", "model", "npz"]
    done = subprocess.run(line, capture_output=True, text=True, check=False)
    assert (done.returncode, done.stderr) == (0, "")
    assert done.stdout.count(" 0 wrong") == 3
