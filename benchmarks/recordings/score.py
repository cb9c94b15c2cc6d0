"""How well diagnoses of machines match the truth: ``python -m benchmarks.recordings.score RESULTS TRUTH.json``.

RESULTS is the JSON of ``harness diagnose ... --json`` or a folder in which result.json files lie.
"""

import argparse
import json
import sys
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path

from harness.core.errors import HarnessError, InputError
from harness.proof.machines.kinds import CONTROL, MAIN
from harness.proof.machines.score import ASKED, TABLE_BETTER, Claim, Result, Truth, group_of, right, score
from harness.proof.statistics import Median, Rate

LABELS = {name: asked.label for name, asked in ASKED.items()} | {
    "family": "right family",
    "table_better": f"tables: held-out error at most {TABLE_BETTER}",
    "table_holdout": "tables: held-out error over the base's, median",
}


def lines(scores: Mapping[str, Rate | Median]) -> Iterator[str]:
    """A line for each figure that has cases, with its 95 % interval."""
    for name, label in LABELS.items():
        one = scores[name]
        if one.value is None or one.low is None or one.high is None:
            continue
        if isinstance(one, Rate):
            percent = f"{100.0 * one.value:.1f} % ({100.0 * one.low:.1f} to {100.0 * one.high:.1f} %)"
            yield f"{label}: {one.hits} of {one.cases}, {percent}"
        else:
            yield f"{label}: {one.value:.3f} ({one.low:.3f} to {one.high:.3f}) of {one.cases}"


def misses(truths: Mapping[str, Truth], results: Mapping[str, Result]) -> Iterator[str]:
    """A line for each recording that was not answered as it should be."""
    for name, truth in sorted(truths.items()):
        claim, group, want = Claim.of(results.get(name)), group_of(truth), truth["dominant"]
        said = claim.main or ", ".join(sorted(claim.near)) or (results.get(name) or {}).get("verdict", "no result")
        if group == CONTROL and not right(truth, results.get(name)):
            sums = ", ".join(f"{law} {100.0 * part:.0f} %" for law, part in truth.get("sums_up", {}).items())
            told = f" (summed up by {sums})" if sums else ""
            yield f"{name}: control ({', '.join(truth['minor'])}) called {said}{told}"
        elif group == MAIN and claim.main != want:
            listed = " (listed)" if claim.lists(want) else ""
            yield f"{name}: {want} ({100.0 * truth['share']:.0f} %) on a {truth['kind']} called {said}{listed}"


def read_results(path: Path) -> dict[str, Result]:
    """Results by the name of their recording's file. Raises InputError for what holds none."""
    files = sorted(path.rglob("result.json")) if path.is_dir() else [path]
    found: dict[str, Result] = {}
    try:
        for file in files:
            said = json.loads(file.read_text(encoding="utf-8"))
            for one in said if isinstance(said, list) else [said]:
                found[Path(one["recording"]["file"]).name] = one
    except (OSError, ValueError, KeyError, TypeError):
        raise InputError(str(path), "no results", "the JSON of harness diagnose, or a folder") from None
    return found


def main(argv: Sequence[str] | None = None) -> int:
    """Print the figures and what was missed; exit code."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.recordings.score")
    parser.add_argument("results", type=Path)
    parser.add_argument("truth", type=Path)
    parser.add_argument("--only-given", action="store_true", help="leave recordings without a result out")
    parser.add_argument("--json", type=Path, help="write the figures here too")
    told = parser.parse_args(argv)
    try:
        results = read_results(told.results)
        truths = json.loads(told.truth.read_text(encoding="utf-8"))
    except (HarnessError, OSError, ValueError) as error:
        print(error, file=sys.stderr)
        return 2
    if told.only_given:
        truths = {name: truth for name, truth in truths.items() if name in results}
    scores = score(truths, results)
    print("\n".join([*misses(truths, results), *lines(scores)]))
    if told.json:
        figures = {name: one.as_dict() for name, one in scores.items()}
        told.json.write_text(json.dumps(figures, indent=1), encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main())
