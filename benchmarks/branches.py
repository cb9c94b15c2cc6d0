"""Branch coverage of the heart, by its own tests: ``python -m benchmarks.branches [--room exact ...]``.

Each room's tests run twice, compiled as they ship, and, for the functions that are compiled, without compilation; a
branch counts when either takes it. Exit 1 when a room is below 95 %. What takes long without compilation is left out of
the second run.
"""

import argparse
import os
import subprocess
import sys
import tempfile
from collections.abc import Mapping
from pathlib import Path

from benchmarks.mutation import LAST

ROOT = Path(__file__).resolve().parents[1]
LEAST = 95
TESTS: Mapping[str, tuple[tuple[str, ...], tuple[str, ...]]] = {
    "exact": (("tests/exact",), ("tests/exact",)),
    "estimate": (("tests/estimate",), ("tests/estimate", "-k", f"not ({LAST})")),
    "diagnosis": (("tests/diagnosis",), ()),
    "engines": (("tests/engines",), ()),
}
"""By room, what is run compiled and what is run plain."""


def _coverage(data: Path, *words: str, **environment: str) -> int:
    call = [sys.executable, "-m", "coverage", words[0], f"--data-file={data}", *words[1:]]
    return subprocess.run(call, cwd=ROOT, env={**os.environ, **environment}, check=False).returncode


def measured(room: str, folder: Path) -> bool:
    """Run, print the report of a room, and say whether it reaches what is asked. SystemExit where tests fail."""
    parts = []
    for name, tests in zip(("compiled", "plain"), TESTS[room], strict=True):
        parts.append(folder / f"{room}-{name}")
        run = ("run", "--branch", f"--source=harness/{room}", "-m", "pytest", "-q", "-n", "0", "-p", "no:cacheprovider")
        if tests and _coverage(parts[-1], *run, *tests, NUMBA_DISABLE_JIT="1" if name == "plain" else "0"):
            raise SystemExit(f"{' '.join(tests)}: tests fail, {name}")
    there = [str(part) for part in parts if part.exists()]
    _coverage(folder / room, "combine", "-q", *there)
    return _coverage(folder / room, "report", "--skip-covered", "--show-missing", f"--fail-under={LEAST}") == 0


def main() -> int:
    """See the module."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.branches", description=__doc__)
    parser.add_argument("--room", action="append", choices=sorted(TESTS), help="which room; all")
    rooms = parser.parse_args().room or list(TESTS)
    with tempfile.TemporaryDirectory() as folder:
        return int(len([room for room in rooms if not measured(room, Path(folder))]) > 0)


if __name__ == "__main__":
    raise SystemExit(main())
