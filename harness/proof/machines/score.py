"""How well diagnoses of machines match the truth.

A main effect is claimed by the first mechanism graded "main" or "explains" (or without a grade, as harness.diagnosis/1
has none); a list by those graded "one-of", its alternatives and ties. What is graded "part", "minor" or "tabulated"
claims no main effect.
"""

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

from harness.proof.machines.kinds import CONTROL, MAIN, TABLE, UNNAMED
from harness.proof.plant.effects import FAMILY_OF_MACHINES
from harness.proof.statistics import Asked, Median, Rate

Truth = Mapping[str, Any]
Result = Mapping[str, Any]
SILENT = ("adequate", "unexplained", "error")
"""Verdicts that name nothing as the main effect."""
LONGEST = 4
"""Names of a list that still says something."""
BETTER, TABLE_BETTER = 0.7, 0.7
"""Held-out error over the base's below which a model, a tabulated one, is one."""
ASKED = {
    "listed": Asked("named or listed", "at least 80 %", least=0.8),
    "named": Asked("main effect named"),
    "wrong": Asked("wrong main effect", "at most 4 %", most=0.04),
    "silent": Asked("silent"),
    "claimed": Asked("controls: main effect claimed", "at most 3 %", most=0.03),
    "unfounded": Asked("controls: claimed, and that law is none of the small effects nor their sum"),
    "small": Asked("controls: something graded minor"),
    "misled": Asked("no catalogue: another family"),
    "better": Asked(f"named or listed: held-out error below {BETTER}", "at least 60 %", least=0.6),
    "holdout": Asked("named or listed: held-out error over the base's, median"),
    "share_error": Asked("share said against the true one, median difference"),
}
"""Figures that a proof shows, in their order."""


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
        minor = frozenset(m["name"] for m in found if m.get("grade") in ("part", "minor", "tabulated"))
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


def right(truth: Truth, result: Result | None) -> bool:
    """Whether a recording was answered as it should be: named or listed, nothing claimed, no other family."""
    claim, group = Claim.of(result), group_of(truth)
    if group == MAIN:
        return claim.lists(truth["dominant"])
    if group == CONTROL:
        return claim.main in ("", *truth.get("may_name", []))
    families = truth.get("families") or [truth["family"]]
    return claim.main == "" or FAMILY_OF_MACHINES.get(claim.main) in families


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


def score(truths: Mapping[str, Truth], results: Mapping[str, Result]) -> dict[str, Rate | Median]:
    """Figures of results by the recording they belong to; one without a result is silent, of a control too.

    named, listed, wrong, silent, family : main effects of the catalogue. claimed, small : controls that got a main
    effect, a small one; unfounded : claimed, though the law that was named is none of them and does not sum them up
    when it is fitted to the machine itself. misled : effects of no catalogue called one of another family. better,
    holdout : held-out error over the base's where the main effect was named or listed, below ``BETTER``, median.
    table_better, table_holdout : where a static effect of no catalogue was the main one. share_error : share said
    against the truth. A rate without cases holds None.
    """
    rates = ("named", "listed", "wrong", "silent", "family", "claimed", "small", "unfounded", "misled")
    kept: dict[str, list[bool]] = {name: [] for name in rates}
    ratios: list[float] = []
    tabled: list[float] = []
    off: list[float] = []
    for name, truth in sorted(truths.items()):
        result = results.get(name)
        claim, group, want = Claim.of(result), group_of(truth), truth["dominant"]
        wrong = not right(truth, result)
        if group == CONTROL:
            kept["claimed"].append(wrong)
            kept["small"].append(bool(claim.minor))
            kept["unfounded"].append(wrong and claim.main not in {*truth.get("minor", {}), *truth.get("sums_up", {})})
        elif group == MAIN:
            kept["named"].append(claim.main == want)
            kept["listed"].append(not wrong)
            kept["wrong"].append(claim.main not in ("", want))
            kept["silent"].append(not claim.near)
            kept["family"].append(FAMILY_OF_MACHINES.get(claim.main) == truth["family"])
            if not wrong:
                ratios.append(min(holdout_ratio(block) for block in _blocks(result or {}, want)))
            if claim.main == want and claim.entry.get("share") is not None and truth["share"] is not None:
                off.append(abs(claim.entry["share"] - truth["share"]))
        else:
            kept["misled"].append(wrong)
        if group == TABLE:
            tabled.append(holdout_ratio((result or {}).get("holdout")))
    return {
        **{name: Rate.of(hits) for name, hits in kept.items()},
        "better": Rate.of([one < BETTER for one in ratios]),
        "holdout": Median.of(ratios),
        "table_better": Rate.of([one <= TABLE_BETTER for one in tabled]),
        "table_holdout": Median.of(tabled),
        "share_error": Median.of(off),
    }


def _blocks(result: Result, name: str) -> Iterator[Mapping[str, Any] | None]:
    """Held-out errors of the model with this effect: its own where they are given, else those of the result."""
    own = next((m.get("holdout") for m in result.get("mechanisms", []) if m["name"] == name), None)
    yield own or result.get("holdout")
