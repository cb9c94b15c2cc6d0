"""Driven recordings whose hidden effects have other forms than the catalogue's, and controls without any, diagnosed.

python -m benchmarks.driven_forms --draws 60 [--controls] [--seed S] [--first I] [--options right|none]
"""

import argparse
import json
import sys
import tempfile
import time
from pathlib import Path
from typing import Any

import harness
from benchmarks.draws.shared import interval
from benchmarks.driven_draws import RIGHT, Drawn, drawn
from benchmarks.driven_plant import SPRING
from harness.core.errors import HarnessError

MOST = 3
"""Names of a list that still says something."""


def asked(one: Drawn, options: str) -> dict[str, Any]:
    """Options of the diagnosis."""
    if options == "none":
        return {}
    held = RIGHT[one.kind]
    return {"restoring": held} | ({"zero": "spring"} if one.kind == SPRING else {})


def looked_at(one: Drawn, options: str) -> dict[str, Any]:
    """What is said of a recording, in one row."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "recording.csv"
        path.write_text(one.csv)
        begun = time.process_time()
        try:
            result = harness.diagnose(path, engines=(), **asked(one, options)).model_dump()
        except HarnessError as error:
            return {"verdict": "error", "names": [], "error": str(error)[:150]}
    names = [m["name"] for m in result["mechanisms"] if m["grade"] not in ("minor", "tabulated")]
    minor = [m["name"] for m in result["mechanisms"] if m["grade"] in ("minor", "tabulated")]
    p = result["baseline"]["parameters"]
    return {
        "verdict": result["verdict"], "names": names, "minor": minor, "cpu_s": round(time.process_time() - begun, 1),
        "chi2": result["baseline"]["chi2_per_point"], "base": {k: v["value"] for k, v in p.items()},
        "warnings": result.get("warnings", []),
    }  # fmt: skip


def right(row: dict[str, Any], one: Drawn) -> bool:
    """Whether a control is quiet, or an effect is named or listed with at most three names."""
    names = row["names"]
    if not one.truth:
        return not names and row["verdict"] != "error"
    return len(names) <= MOST and any(name in one.truth or name.split(":")[0] in one.truth for name in names)


def main(arguments: list[str]) -> int:
    """The command."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.driven_forms", description=__doc__)
    parser.add_argument("--draws", type=int, default=60)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--controls", action="store_true")
    parser.add_argument("--options", choices=("right", "none"), default="right")
    parser.add_argument("--only", type=int, nargs="*")
    parser.add_argument("--save", type=Path)
    given = parser.parse_args(arguments)
    good = done = 0
    for i in given.only or range(given.first, given.first + given.draws):
        one = drawn(given.seed, i, given.controls)
        row = looked_at(one, given.options)
        fine = right(row, one)
        good, done = good + fine, done + 1
        said = f"{i:3d} {'ok ' if fine else 'BAD'} {one.kind:8s} {one.measured:20s} {one.effect:9s} {one.worth:8.3g}"
        print(said, row["verdict"], row["names"], row.get("minor"), f"chi2 {row.get('chi2')}", row.get("cpu_s"),
              row.get("error", ""), flush=True)  # fmt: skip
        if given.save:
            with given.save.open("a") as out:
                out.write(json.dumps({"i": i, "kind": one.kind, "effect": one.effect, "worth": one.worth,
                                      "measured": one.measured, "true": one.base, **row}) + "\n")  # fmt: skip
    low, high = interval(good, done)
    print(f"{good} of {done} right ({100 * good / max(done, 1):.0f} %, {100 * low:.0f} to {100 * high:.0f})")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
