"""How well verdicts on the ways match the truth: right is the mechanism, whatever its formula.

A name claims where it is graded "main" or "explains", a list where it has three names at most. A second name that is
none of the mechanism makes the whole wrong, and so does a short list without it. Of a whole arm every entry claims,
small ones too, of the joint that it names, but those beside what is right of the same joint.
"""

import math
from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np

from harness.proof.machines.score import Claim, holdout_ratio
from harness.proof.paths.forms import OF_MODEL
from harness.proof.paths.made import CONTROL, LOSSES, UNKNOWN
from harness.proof.statistics import Asked, Figure, Median, Rate, figures, resampled
from harness.results.prove import PathLevel, PathResult, PathsResult, ReliabilityBin

Truth = Mapping[str, Any]
Result = Mapping[str, Any]
NAMED, LISTED, SILENT, WRONG = OUTCOMES = ("named", "listed", "silent", "wrong")
LONGEST = 3
"""Names of a list that still says something."""
PLAIN = 20.0
"""Effective samples above which an effect is to be told, fixed before anything was drawn."""
SURE = 0.9
UNNAMED = {"unnamed-curve"}
"""As results call what has no name: right of an effect of no family alone."""
ASKED = {
    "told": Asked(f"named or listed, worth above {PLAIN:g}", "lower bound above 85 %", least=0.85, of_low=True),
    "bare": Asked(f"without options, worth above {PLAIN:g}", "lower bound above 75 %", least=0.75, of_low=True),
    "wrong": Asked("effects: wrong family", "at most 3 %", most=0.03),
    "sure": Asked(f"unknown effects: a wrong family at P >= {SURE:g}", "at most 3 %", most=0.03),
    "misled": Asked("unknown effects: named or listed as a family"),
    "alarms": Asked("controls: false alarms", "at most 1 %", most=0.01),
    "covered": Asked("true values within two standard errors, nothing hidden", "93 to 97 %", least=0.93, most=0.97),
    "right_covered": Asked("the same where the effect was named, systematic errors counted"),
    "holdout": Asked("named or listed: held-out error after over before, median", "at most 0.5", most=0.5),
    "calibration": Asked("expected calibration error of probabilities", "at most 0.05", most=0.05),
}


def outcome(truth: Truth, result: Result | None) -> str:
    """One of ``OUTCOMES``; of a control, and of an effect of no family, whatever is claimed is wrong.

    Of a control beside a simulation of the user's own so is a change of it that is none of ``changes``.
    """
    if "found" in (result or {}):
        return _of_arm(set(truth["right"]), (result or {})["found"])
    claim, right = Claim.of(result), set(truth["right"])
    mains = {m["name"] for m in (result or {}).get("mechanisms", []) if m.get("grade") in ("main", "explains")}
    listed = claim.near if claim.main == "" and len(claim.near) <= LONGEST else frozenset()
    if claim.main:
        return NAMED if mains <= right else WRONG
    if listed:
        return LISTED if listed & right else WRONG
    beside_own = "changes" in truth and truth["group"] == CONTROL
    return WRONG if beside_own and changes(result) - set(truth["changes"]) else SILENT


def _of_arm(right: set[str], found: Iterable[Mapping[str, Any]]) -> str:
    """Of an arm whatever is found claims, with the joint it is of; but as elsewhere a small one beside what is right of
    its joint claims nothing."""
    said: dict[str, list[tuple[str, bool]]] = {}
    for one in found:
        named, listed = (
            {f"{one['joint']}: {name}" if one["joint"] and name not in OF_MODEL else name for name in names}
            for names in ((one["name"],), one["rivals"])
        )
        what = NAMED if named & right else LISTED if listed & right else WRONG
        said.setdefault(one["joint"] or "", []).append((what, one["grade"] == "minor"))
    kept = {
        what
        for entries in said.values()
        for what, minor in entries
        if what != WRONG or not minor or all(other == WRONG for other, _ in entries)
    }
    return next((what for what in (WRONG, LISTED, NAMED) if what in kept), SILENT)


def changes(result: Result | None) -> set[str]:
    """Numbers and terms of the user's simulation that are said to be wrong."""
    told = ((result or {}).get("attribution") or {}).get("changes") or []
    return {one["name"] for one in told if one["kind"] in ("parameter", "term")}


def is_hidden(truth: Truth) -> bool:
    """Whether an effect is hidden that has a mechanism, one of no name that a law all but equals among them."""
    return bool(truth["right"])


def likeliest(truth: Truth, result: Result | None) -> tuple[float, bool] | None:
    """Probability of the likeliest explanation and whether it holds; None of a verdict without probabilities."""
    said = (result or {}).get("posterior") or []
    if not said:
        return None
    names = set(said[0]["names"])
    if names == UNNAMED:
        return float(said[0]["probability"]), truth["group"] == UNKNOWN and not is_hidden(truth)
    return float(said[0]["probability"]), names <= set(truth["right"]) and bool(names) == is_hidden(truth)


def within(truth: Truth, result: Result | None, systematic: bool = False) -> list[bool]:
    """Of each parameter of the base that has an error, whether its true value lies within two of them.

    systematic : whether that of the law's form counts as a part of it.
    """
    said = ((result or {}).get("refined") or {}).get("parameters") or {}
    return [
        abs(p["value"] - truth["base"][name])
        <= 2.0 * math.hypot(p["stderr"], systematic * (p.get("systematic") or 0.0))
        for name, p in said.items()
        if name in truth["base"] and p.get("value") is not None and p.get("stderr")
    ]


def found(truths: Mapping[str, Truth], results: Mapping[str, Result]) -> list[Figure]:
    """The figures of ``ASKED``; a rate or median without cases holds None."""
    kept: dict[str, list[Any]] = {key: [] for key in ASKED}
    for name, truth in sorted(truths.items()):
        result = results.get(name)
        what = outcome(truth, result)
        if truth["group"] == CONTROL:
            kept["alarms"].append(what != SILENT)
            kept["covered"] += within(truth, result) if what == SILENT else []
        elif is_hidden(truth):
            kept["wrong"].append(what == WRONG)
            if truth["loss"] > PLAIN:
                kept["told"].append(what in (NAMED, LISTED))
                kept["bare"] += [what in (NAMED, LISTED)] if not truth["arguments"] else []
            kept["right_covered"] += within(truth, result, systematic=True) if what == NAMED else []
            # of a table, and of a motion too short to part, nothing is held out
            held = holdout_ratio((result or {}).get("holdout"))
            kept["holdout"] += [held] if what in (NAMED, LISTED) and math.isfinite(held) else []
        else:
            kept["misled"].append(what == WRONG)
            sure = [m for m in (result or {}).get("mechanisms", []) if (m.get("probability") or 0.0) >= SURE]
            kept["sure"].append(what == WRONG and bool(sure))
    said = _probabilities(truths, results)
    figured: dict[str, Rate | Median] = {key: Rate.of(hits) for key, hits in kept.items()}
    figured |= {"holdout": Median.of(kept["holdout"]), "calibration": _calibration(said)}
    return figures(figured, ASKED, "paths_")


def _probabilities(truths: Mapping[str, Truth], results: Mapping[str, Result]) -> list[tuple[float, bool]]:
    each = (likeliest(truth, results.get(name)) for name, truth in sorted(truths.items()))
    return [one for one in each if one is not None]


BINS = np.linspace(0.0, 1.0, 11)


def _bins(said: Iterable[tuple[float, bool]]) -> list[list[tuple[float, bool]]]:
    found: list[list[tuple[float, bool]]] = [[] for _ in BINS[1:]]
    for one in said:
        found[min(int(np.searchsorted(BINS, one[0], "right")) - 1, len(found) - 1)].append(one)
    return found


def _error(p: Any, held: Any) -> Any:
    """Expected calibration error of rows (.., n)."""
    place = np.clip(np.searchsorted(BINS, p, "right") - 1, 0, BINS.size - 2)
    return sum(np.abs(np.sum(np.where(place == i, p - held, 0.0), axis=-1)) for i in range(BINS.size - 1)) / p.shape[-1]


def _calibration(said: list[tuple[float, bool]]) -> Median:
    if not said:
        return Median(0, None, None, None)
    p, held = np.array(said, dtype=np.float64).T
    picks = np.arange(p.size, dtype=np.float64)
    low, high = resampled(picks, lambda rows: _error(p[rows.astype(int)], held[rows.astype(int)]))
    return Median(p.size, float(_error(p, held)), low, high)


def paths(truths: Mapping[str, Truth], results: Mapping[str, Result]) -> PathsResult:
    """The detection curve, every way by itself, and the reliability of probabilities."""
    said = {name: outcome(truth, results.get(name)) for name, truth in sorted(truths.items())}
    hidden = {name: truth for name, truth in truths.items() if is_hidden(truth)}
    edges = [*(10.0 ** (0.5 * i) for i in range(10)), np.inf]
    levels = []
    for low, high in zip([0.0, *edges], [*edges, np.inf], strict=False):
        here = [said[name] for name, truth in sorted(hidden.items()) if low <= truth["loss"] < high]
        if here:
            shares = {one: Rate.of([what == one for what in here]) for one in OUTCOMES}
            levels.append(PathLevel(low=low, high=min(high, max(LOSSES[1], low)), cases=len(here), **shares))
    ways = []
    for path in sorted({truth["setting"] for truth in truths.values()}):
        own = {name: truth for name, truth in truths.items() if truth["setting"] == path}
        rates = {one.key.removeprefix("paths_"): one.found.as_dict() for one in found(own, results)}
        ways.append(PathResult.model_validate({"path": path} | {key: rates[key] for key in PathResult.RATES}))
    reliability = [
        ReliabilityBin(low=float(low), high=float(high), said=float(np.mean([p for p, _ in here])),
                       held=Rate.of([held for _, held in here]))
        for low, high, here in zip(BINS, BINS[1:], _bins(_probabilities(truths, results)), strict=False)
        if here
    ]  # fmt: skip
    return PathsResult(levels=levels, ways=ways, reliability=reliability)


def right(truth: Truth, result: Result | None) -> bool:
    """Whether a recording was answered as it should be."""
    return outcome(truth, result) in ((NAMED, LISTED) if is_hidden(truth) else (SILENT,))


__all__ = ["ASKED", "UNKNOWN", "found", "outcome", "paths", "right"]
