"""How well diagnoses of machines match the truth: ``python -m harness.proof.machines.score RESULTS TRUTH.json``.

RESULTS is the JSON of ``harness diagnose ... --json`` or a folder in which result.json files lie. A main effect is
claimed by the first mechanism graded "main" or "explains" (or without a grade, as harness.diagnosis/1 has none); a
list by those graded "one-of", its alternatives and ties. What is graded "minor" or "tabulated" claims nothing.
"""

import argparse
import json
import math
import sys
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Any

from harness.core.errors import HarnessError, InputError
from harness.proof.machines.effects import FAMILY
from harness.proof.machines.plan import CONTROL, MAIN, TABLE, UNNAMED
from harness.proof.statistics import Median, Rate

Truth = Mapping[str, Any]
Result = Mapping[str, Any]
SILENT = ("adequate", "unexplained", "error")
"""Verdicts that name nothing as the main effect."""
LONGEST = 4
"""Names of a list that still says something."""
BETTER, TABLE_BETTER = 0.7, 0.7
"""Held-out error over the base's below which a model, a tabulated one, is one."""


@dataclass(frozen=True, slots=True)
class Claim:
    """What a diagnosis claims of one recording.

    main : the main effect, "" for none. entry : its mechanism. near : names said or not ruled out. minor : names of
    small parts.
    """

    main: str
    entry: Mapping[str, Any]
    near: frozenset[str]
    minor: frozenset[str]

    @classmethod
    def of(cls, result: Result | None) -> "Claim":
        """Read a harness.diagnosis/2 or /1 object; None stands for no result."""
        found = list((result or {}).get("mechanisms", []))
        minor = frozenset(m["name"] for m in found if m.get("grade") in ("minor", "tabulated"))
        if result is None or result.get("verdict", "error") in SILENT:
            return cls("", {}, frozenset(), minor)
        mains = [m for m in found if m.get("grade", "main") in ("main", "explains")]
        first: Mapping[str, Any] = mains[0] if mains else {}
        near = {m["name"] for m in found if m.get("grade") == "one-of"} | {m["name"] for m in mains if m.get("tied")}
        near |= {a["name"] for a in first.get("alternatives", [])} | ({first["name"]} if first else set())
        return cls(str(first.get("name", "")), first, frozenset(near), minor)

    def lists(self, name: str) -> bool:
        """Whether a name was said or listed, the list being short enough to say something."""
        return name in self.near and len(self.near) <= LONGEST


@dataclass(frozen=True, slots=True)
class MachineScores:
    """Figures over recordings of machines; a rate without cases holds None.

    named, listed, wrong, silent, family : main effects of the catalogue. claimed, small : controls that got a main
    effect, a small one; unfounded : claimed, though the law that was named is none of them and does not sum them up
    when it is fitted to the machine itself. misled : effects of no catalogue called one of another family. better,
    holdout : held-out error over the base's where the main effect was named or listed, below ``BETTER``, median.
    table_better, table_holdout : where a static effect of no catalogue was the main one. share_error : share said
    against the truth.
    """

    named: Rate
    listed: Rate
    wrong: Rate
    silent: Rate
    family: Rate
    claimed: Rate
    small: Rate
    unfounded: Rate
    misled: Rate
    better: Rate
    holdout: Median
    table_better: Rate
    table_holdout: Median
    share_error: Median

    def as_dict(self) -> dict[str, Any]:
        """For JSON; an infinite median becomes null."""
        return {field.name: getattr(self, field.name).as_dict() for field in fields(self)}


def right(truth: Truth, result: Result | None) -> bool:
    """Whether a recording was answered as it should be: named or listed, nothing claimed, no other family."""
    claim, group = Claim.of(result), group_of(truth)
    if group == MAIN:
        return claim.lists(truth["dominant"])
    if group == CONTROL:
        return claim.main in ("", *truth.get("may_name", []))
    return claim.main == "" or FAMILY.get(claim.main) in (truth.get("families") or [truth["family"]])


def group_of(truth: Truth) -> str:
    """Main, control, unknown or table."""
    if "group" in truth:
        return str(truth["group"])
    if not truth["dominant"]:
        return CONTROL
    return UNNAMED if truth["dominant"].startswith("alien-") else MAIN


def holdout_ratio(block: Mapping[str, Any] | None) -> float:
    """Refined over baseline rmse on held-out blocks, of the channel that gains most; infinite where not given."""
    before, after = ((block or {}).get(key) or {} for key in ("baseline_rmse", "refined_rmse"))
    ratios = [after[c] / before[c] for c in before if before[c] and after.get(c) is not None]
    return float(min(ratios, default=math.inf))


def score(truths: Mapping[str, Truth], results: Mapping[str, Result]) -> MachineScores:
    """Score results by the recording they belong to; one without a result is silent, of a control too."""
    kept = ("named", "listed", "wrong", "silent", "family", "claimed", "small", "unfounded", "misled")
    outcomes: dict[str, list[bool]] = {name: [] for name in kept}
    ratios: list[float] = []
    tabled: list[float] = []
    off: list[float] = []
    for name, truth in sorted(truths.items()):
        result = results.get(name)
        claim, group, want = Claim.of(result), group_of(truth), truth["dominant"]
        if group == CONTROL:
            outcomes["claimed"].append(not right(truth, result))
            outcomes["small"].append(bool(claim.minor))
            there = {*truth.get("minor", {}), *truth.get("sums_up", {})}
            outcomes["unfounded"].append(not right(truth, result) and claim.main not in there)
        elif group == MAIN:
            listed = claim.lists(want)
            outcomes["named"].append(claim.main == want)
            outcomes["listed"].append(listed)
            outcomes["wrong"].append(claim.main not in ("", want))
            outcomes["silent"].append(not claim.near)
            outcomes["family"].append(FAMILY.get(claim.main) == truth["family"])
            if listed:
                ratios.append(min(holdout_ratio(block) for block in _blocks(result or {}, want)))
            if claim.main == want and claim.entry.get("share") is not None and truth["share"] is not None:
                off.append(abs(claim.entry["share"] - truth["share"]))
        else:
            outcomes["misled"].append(not right(truth, result))
        if group == TABLE:
            tabled.append(holdout_ratio((result or {}).get("holdout")))
    return MachineScores(
        **{name: Rate.of(hits) for name, hits in outcomes.items()},
        better=Rate.of([one < BETTER for one in ratios]),
        holdout=Median.of(ratios),
        table_better=Rate.of([one <= TABLE_BETTER for one in tabled]),
        table_holdout=Median.of(tabled),
        share_error=Median.of(off),
    )


def _blocks(result: Result, name: str) -> Iterator[Mapping[str, Any] | None]:
    """Held-out errors of the model with this effect: its own where they are given, else those of the result."""
    own = next((m.get("holdout") for m in result.get("mechanisms", []) if m["name"] == name), None)
    yield own or result.get("holdout")


LABELS = {
    "named": "main effect named",
    "listed": "named or listed",
    "wrong": "wrong main effect",
    "silent": "silent",
    "family": "right family",
    "claimed": "controls: main effect claimed",
    "small": "controls: something graded minor",
    "unfounded": "controls: claimed, and that law is none of the small effects nor their sum",
    "misled": "no catalogue: another family",
    "better": f"named or listed: held-out error below {BETTER}",
    "holdout": "named or listed: held-out error over the base's, median",
    "table_better": f"tables: held-out error at most {TABLE_BETTER}",
    "table_holdout": "tables: held-out error over the base's, median",
    "share_error": "share said against the true one, median difference",
}


def lines(scores: MachineScores) -> Iterator[str]:
    """A line for each figure that has cases, with its 95 % interval."""
    for name, label in LABELS.items():
        one: Rate | Median = getattr(scores, name)
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
        raise InputError(str(path), "no results", "the JSON of harness diagnose, or a folder, is accepted") from None
    return found


def main(argv: Sequence[str] | None = None) -> int:
    """Print the figures and what was missed; exit code."""
    parser = argparse.ArgumentParser(prog="python -m harness.proof.machines.score")
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
        told.json.write_text(json.dumps(scores.as_dict(), indent=1), encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main())
