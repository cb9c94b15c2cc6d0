"""Branch coverage of the heart: ``python -m benchmarks.branches [--room exact ...]``.

Tests of each room run as it ships, and, for the functions that are compiled, once more without compilation of that room
(some of them: what takes long so is left out); a branch counts when either takes it. Exit 1 when a room is below 95 %.
"""

import argparse
import os
import subprocess
import sys
import tempfile
from collections.abc import Mapping
from importlib.util import find_spec
from pathlib import Path

from benchmarks.mutation import LAST, TOO_LONG

ROOT = Path(__file__).resolve().parents[1]
LEAST = 95
PLAIN_PARTS = ("noise", "saturation", "estimators")
QUICK_PLAIN = (
    *("samples_that_do_not_count", "doubted_as_far", "white_and_of_unit", "right_to_first_order"),
    *("implicit_steps_own", "smoothing_of_a_cubic", "test_force_partials", "test_implied_states"),
)
TESTS: Mapping[str, tuple[tuple[str, ...], tuple[str, ...]]] = {
    "exact": (("tests/exact",), ("tests/exact",)),
    "estimate": (
        ("tests/estimate",),
        (*(f"tests/estimate/test_{name}.py" for name in PLAIN_PARTS), "-k", f"not ({LAST} or {TOO_LONG})"),
    ),
    # what is said of a diagnosis, and of a robot's joint, is tested where it is said
    "diagnosis": (
        ("tests/diagnosis", "tests/app", "tests/robot", "tests/show"),
        ("tests/diagnosis", "-k", " or ".join(QUICK_PLAIN)),
    ),
    "engines": (("tests/engines",), ("tests/engines/test_engine_terms.py", "-k", "pybullet")),
}
"""By room, what is run compiled and what is run plain."""
LONG = {"diagnosis": ("-m", "full", "tests/diagnosis")}
"""And what is left out of every day's tests because it takes long."""
OPTIONAL = {"drake.py": "pydrake", "newton.py": "newton", "physx.py": "physx", "physx_world.py": "physx"}
UNSEEN = ("engines/mujoco/callback.py", "engines/elsewhere/worker.py")
"""What no tracer sees: machine code that MuJoCo calls, built of addresses; and what another interpreter runs."""


def left_out() -> list[str]:
    """Files that are not measured: those above, and engines that are not installed."""
    missing = (f"engines/{name}" for name, package in OPTIONAL.items() if find_spec(package) is None)
    return [f"harness/{name}" for name in (*UNSEEN, *missing)]


def _coverage(data: Path, *words: str, **environment: str) -> int:
    call = [sys.executable, "-m", "coverage", words[0], f"--data-file={data}", *words[1:]]
    return subprocess.run(call, cwd=ROOT, env={**os.environ, **environment}, check=False).returncode


def measured(room: str, folder: Path) -> bool:
    """Run, print the report of a room, and say whether it reaches what is asked. SystemExit where tests fail."""
    parts = []
    for name, tests in zip(("compiled", "plain", "long"), (*TESTS[room], LONG.get(room, ())), strict=True):
        parts.append(folder / f"{room}-{name}")
        run = ("run", "--branch", f"--source=harness/{room}", "-m", "pytest", "-q", "-n", "0", "-p", "no:cacheprovider")
        plain = ("-p", "benchmarks.plain") if name == "plain" else ()
        if tests and _coverage(parts[-1], *run, *plain, *tests, HARNESS_PLAIN=f"harness.{room}"):
            raise SystemExit(f"{' '.join(tests)}: tests fail, {name}")
    there = [str(part) for part in parts if part.exists()]
    _coverage(folder / room, "combine", "-q", *there)
    out = left_out()
    print(f"{room}; not measured: {', '.join(out)}" if room == "engines" else room, flush=True)
    return (
        _coverage(
            folder / room,
            "report",
            f"--omit={','.join(out)}",
            "--skip-covered",
            "--show-missing",
            f"--fail-under={LEAST}",
        )
        == 0
    )


def main() -> int:
    """See the module."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.branches", description=__doc__)
    parser.add_argument("--room", action="append", choices=sorted(TESTS), help="which room; all")
    rooms = parser.parse_args().room or list(TESTS)
    with tempfile.TemporaryDirectory() as folder:
        return int(len([room for room in rooms if not measured(room, Path(folder))]) > 0)


if __name__ == "__main__":
    raise SystemExit(main())
