"""``python -m benchmarks.corpus``: ask every case again, and say what moved. Exit 1 where something did.

Outcomes stand in outcomes.jsonl, one case a line: what was answered, whether that is right, and what is; "since" is the
commit from which on a case is answered so. Without the folder of others' recordings their cases are left out.
"""

import argparse
import json
import os
import subprocess
import sys
import time
from collections import Counter
from pathlib import Path
from typing import Any

from benchmarks.corpus import own, shared
from benchmarks.corpus.case import Case, marked, outcome
from harness.core.errors import HarnessError

OUTCOMES = Path(__file__).with_name("outcomes.jsonl")
_SHARED = Path(__file__).resolve().parents[3] / "shared"
_SAME_SHARE = 0.02
"""A share moved by less is said as before: threads and processors differ in the last digit."""


def kept() -> dict[str, dict[str, Any]]:
    """Outcomes as they stand, by case."""
    if not OUTCOMES.exists():
        return {}
    return {row["case"]: row for row in map(json.loads, OUTCOMES.read_text(encoding="utf-8").splitlines())}


def asked(case: Case) -> dict[str, Any]:
    """A case's row, made now."""
    try:
        answer = case.ask().model_dump(mode="json")
    except HarnessError as error:
        answer = {"verdict": "error", "error": str(error)}
    except Exception as error:  # what a user would see as an internal error is an outcome too
        answer = {"verdict": "error", "error": f"internal: {type(error).__name__}: {error}"}
    row: dict[str, Any] = {"case": case.name, "kind": case.kind, **outcome(answer)}
    mark = marked(answer, case.truth)
    if mark is not None and case.truth is not None:
        row |= {"mark": mark} | ({} if mark == "right" else {"truth": case.truth.said})
    return row


def moved(before: dict[str, Any], after: dict[str, Any]) -> list[str]:
    """What of an outcome differs in more than the last digits: verdict, names, grades, shares, worth."""
    said = [
        f"{key}: {before.get(key)} -> {after.get(key)}"
        for key in ("verdict", "mark")
        if before.get(key) != after.get(key)
    ]
    old, new = before.get("names", {}), after.get("names", {})
    for name in sorted(old.keys() | new.keys()):
        grade, share = [*old.get(name, "none").split(), "0"][:2]
        grade_now, share_now = [*new.get(name, "none").split(), "0"][:2]
        if grade != grade_now or abs(float(share) - float(share_now)) > _SAME_SHARE:
            said.append(f"{name}: {old.get(name)} -> {new.get(name)}")
    return said


def _commit() -> str:
    try:
        return subprocess.run(
            ["git", "rev-parse", "--short", "HEAD"], capture_output=True, text=True, check=True, cwd=OUTCOMES.parent
        ).stdout.strip()
    except (OSError, subprocess.CalledProcessError):
        return "unknown"


def _write(rows: dict[str, dict[str, Any]]) -> None:
    beside = OUTCOMES.with_suffix(".part")
    beside.write_text("".join(json.dumps(row) + "\n" for row in rows.values()), encoding="utf-8")
    os.replace(beside, OUTCOMES)


def main(arguments: list[str] | None = None) -> int:
    parser = argparse.ArgumentParser(prog="python -m benchmarks.corpus", description=__doc__)
    parser.add_argument("--only", metavar="TEXT", action="append", help="cases whose name begins with this; may repeat")
    parser.add_argument("--shared", metavar="DIR", type=Path, default=_SHARED, help="folder of others' recordings")
    parser.add_argument("--write", action="store_true", help="keep the outcomes as they are now")
    parser.add_argument("--tally", action="store_true", help="count what stands in the file, ask nothing")
    options = parser.parse_args(arguments)
    rows = kept()
    if not options.tally:
        chosen = [*own.cases(), *shared.cases(options.shared)]
        if options.only:
            chosen = [c for c in chosen if any(c.name.startswith(text) for text in options.only)]
        changed = _ask(chosen, rows, options.write)
    for (kind, mark), count in sorted(Counter((r["kind"], r.get("mark", "-")) for r in rows.values()).items()):
        sys.stdout.write(f"{kind:14} {mark:12} {count}\n")
    return 1 if not options.tally and changed else 0


def _ask(chosen: list[Case], rows: dict[str, dict[str, Any]], write: bool) -> int:
    changed, commit = 0, _commit()
    for case in chosen:
        start = time.process_time()
        row, before = asked(case), rows.get(case.name)
        said = ["new"] if before is None else moved(before, row)
        row["since"] = commit if said or before is None else before["since"]
        rows[case.name] = row
        changed += bool(said)
        line = f"{case.name} ({time.process_time() - start:.1f} s): {'; '.join(said) or 'as before'}"
        sys.stdout.write(line + "\n")
        sys.stdout.flush()
        if write:
            _write(rows)
    return changed


if __name__ == "__main__":
    sys.exit(main())
