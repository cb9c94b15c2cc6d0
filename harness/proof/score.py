"""How well answers match the truth: confusion, false alarms, recovery, location, improvement, with intervals.

What is withheld counts against: no result, no refined fit, no standard error, a list longer than three.
"""

import math
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from harness.proof.plant.effects import FAMILY
from harness.proof.statistics import Asked, Figure, Median, Rate, figures

Truth = Mapping[str, Any]
Result = Mapping[str, Any]
SLACK, LONGEST = 10.0, 3
NEUTRAL = {"gain": 1.0}
"""Value of a parameter that means no effect: errors are relative to the distance from it."""
NOTHING, CANNOT_TELL, ABSENT = "nothing", "cannot tell", "no result"
ASKED = {
    "named": Asked("single effects named", "lower bound above 88 %", least=0.88, of_low=True),
    "listed": Asked("single effects named or not ruled out"),
    "both_named": Asked("pairs, both named"),
    "false_alarms": Asked("false alarms", "at most 2 %", most=0.02),
    "wrong_family": Asked("outside the catalogue, called a wrong family", "at most 10 %", most=0.1),
    "misled": Asked("outside the catalogue, called that or nothing", "at most 10 %", most=0.1),
    "covered": Asked("true values within two standard errors", "92.5 to 98 %", least=0.925, most=0.98),
    "parameter_error": Asked("relative error of parameters, median"),
    "overlap": Asked("overlap of the place with the true one, median"),
    "holdout": Asked("held-out rmse after over before, median", "at most 0.5", most=0.5),
    "engines_improved": Asked("fit improved in MuJoCo and PyBullet", "at least 95 %", least=0.95),
}
MEDIANS = ("parameter_error", "overlap", "holdout")


@dataclass(frozen=True, slots=True)
class Answer:
    """What a diagnosis said: names, and names said or not ruled out."""

    said: tuple[str, ...]
    near: frozenset[str]
    label: str

    @classmethod
    def of(cls, result: Result | None) -> "Answer":
        """Read a harness.diagnosis/2 object (or a /1); None stands for no result.

        A main effect is a name, as one that explains is; names of which one is meant are a list: nothing is named.
        """
        found, verdict = (result or {}).get("mechanisms", []), (result or {}).get("verdict")
        said = tuple(m["name"] for m in found)
        if verdict in ("adequate", "unexplained"):
            return cls((), frozenset(), NOTHING if verdict == "adequate" else CANNOT_TELL)
        if verdict == "one_of":
            listed = frozenset(said)
            return cls((), listed if len(listed) <= LONGEST else frozenset(), "a list")
        if verdict not in ("missing_physics", "main_effect"):
            return cls((), frozenset(), ABSENT)
        near = set(said)
        for m in found:
            near |= {a["name"] for a in m.get("alternatives", []) if a.get("delta_bic", SLACK) < SLACK}
        if len(said) > LONGEST:
            return cls(said, frozenset(), "a list")
        return cls(said, frozenset(near if len(near) <= LONGEST else ()), " + ".join(sorted(said)) or CANNOT_TELL)


@dataclass(frozen=True, slots=True)
class Scores:
    """found : the figures of ``ASKED``; a rate or median without cases holds None.

    wrong_family : effects outside the catalogue that were given a name of another family. misled : those, and what was
    called nothing or withheld. confusion : true label -> said label -> count. by_name : single effects named, by name.
    not_tested : names that did not occur alone.
    """

    found: Mapping[str, Rate | Median]
    confusion: Mapping[str, Mapping[str, int]]
    by_name: Mapping[str, Rate]
    not_tested: Sequence[str]

    @property
    def figures(self) -> list[Figure]:
        """In the order in which they are shown."""
        return figures(self.found, ASKED)


def spans_overlap(said: Sequence[Sequence[float]], true: Sequence[Sequence[float]], end: float) -> float:
    """Intersection over union of two sets of time spans in s, on a grid of 2000 points over [0, end]."""
    grid = end * (np.arange(2000) + 0.5) / 2000

    def inside(spans: Sequence[Sequence[float]]) -> Any:
        return np.any([(grid >= lo) & (grid <= hi) for lo, hi in spans], axis=0) if len(spans) else grid < 0.0

    a, b = inside(said), inside(true)
    return float(np.sum(a & b) / max(1, np.sum(a | b)))


def rmse_ratio(block: Mapping[str, Any] | None, channel: str) -> float:
    """Refined over baseline rmse of a channel; infinite where it was not given."""
    before, after = (((block or {}).get(key) or {}).get(channel) for key in ("baseline_rmse", "refined_rmse"))
    return float(after) / float(before) if before and after is not None else math.inf


def of_another_family(answer: Answer, truth: Truth) -> bool:
    """Whether a name was given that is of no family of an effect outside the catalogue."""
    return not {FAMILY.get(name, "") for name in answer.said} <= set(truth["families"])


def score(truths: Mapping[str, Truth], results: Mapping[str, Result]) -> Scores:
    """Score results by the file they belong to; a file without a result counts as one that was withheld."""
    confusion: dict[str, Counter[str]] = {}
    named: dict[str, list[bool]] = {}
    kept: dict[str, list[Any]] = {key: [] for key in ASKED}
    for file, truth in sorted(truths.items()):
        want, result = set(truth["mechanisms"]), results.get(file)
        answer = Answer.of(result)
        right = set(answer.said) == want and len(answer.said) == len(want)
        confusion.setdefault(" + ".join(sorted(want)) or NOTHING, Counter())[answer.label] += 1
        if not want:
            kept["false_alarms"].append(answer.label != NOTHING)
            continue
        if any(name.startswith("alien-") for name in want):
            wrong = of_another_family(answer, truth)
            kept["wrong_family"].append(wrong)
            kept["misled"].append(wrong or answer.label in (NOTHING, ABSENT))
            continue
        if len(want) > 1:
            kept["both_named"].append(right)
        else:
            kept["named"].append(right)
            named.setdefault(next(iter(want)), []).append(right)
            kept["listed"].append(want <= answer.near and len(answer.said) <= len(want))
        _measure(truth, result if answer.said else None, want, kept)
    return Scores(
        {key: Median.of(all_of) if key in MEDIANS else Rate.of(all_of) for key, all_of in kept.items()},
        {true: dict(said) for true, said in confusion.items()},
        {name: Rate.of(hits) for name, hits in sorted(named.items())},
        tuple(name for name in FAMILY if name not in named),
    )


def _measure(truth: Truth, result: Result | None, want: set[str], kept: Mapping[str, list[Any]]) -> None:
    """Improvement, location and parameters of one recording with hidden effects."""
    found = (result or {}).get("mechanisms", [])
    engines = (result or {}).get("engines") or {}
    for channel in truth["channels"]:
        kept["holdout"].append(rmse_ratio((result or {}).get("holdout"), channel))
        if result is not None:
            for engine in ("mujoco", "pybullet"):
                kept["engines_improved"].append(rmse_ratio(engines.get(engine), channel) < 1.0)
    if truth.get("region"):
        spans = [span for m in found if m["name"] in want for span in (m.get("where") or {}).get("time_s", [])]
        kept["overlap"].append(spans_overlap(spans, truth["region"], truth["duration"]))
    for name in sorted(want):
        said = next((m for m in found if m["name"] == name), None)
        for parameter, value in truth["headline"].get(name, {}).items():
            p = (said or {}).get("parameters", {}).get(parameter) or {}
            if p.get("value") is None:
                kept["parameter_error"].append(1.0)
                if said is not None:
                    kept["covered"].append(False)
                continue
            miss = abs(p["value"] - value)
            kept["parameter_error"].append(miss / abs(value - NEUTRAL.get(parameter, 0.0)))
            kept["covered"].append(p.get("stderr") is not None and miss <= 2.0 * p["stderr"])


LARGEST = 1.05
"""Held-out rmse after over before that is still accepted."""


@dataclass(frozen=True, slots=True)
class Forced:
    """Held-out rmse after over before, the worst channel of each control.

    cases : controls called adequate with a term forced in. worst, worst_file : the largest ratio, None without a case.
    above : files above ``LARGEST``. withheld : controls called adequate that did not say. named : controls in which
    something was named, or that gave no result: false alarms are counted elsewhere.
    """

    cases: int
    worst: float | None
    worst_file: str | None
    above: tuple[str, ...]
    withheld: tuple[str, ...]
    named: tuple[str, ...]

    def shortfalls(self) -> list[str]:
        """What is not reached, one sentence each; a withheld ratio counts as one that is too large."""
        missed = []
        if self.worst is None:
            missed.append("no control with a term forced in")
        elif self.worst > LARGEST:
            missed.append(
                f"a control with a term forced in is predicted {self.worst:.3f} times worse, {LARGEST} at most"
            )
        if self.withheld:
            missed.append(f"{len(self.withheld)} controls do not say what a term forced in does")
        return missed

    def as_dict(self) -> dict[str, Any]:
        """For JSON; an infinite ratio becomes null."""
        worst = self.worst if self.worst is not None and math.isfinite(self.worst) else None
        return {**asdict(self), "worst": worst}


def forced(truths: Mapping[str, Truth], results: Mapping[str, Result]) -> Forced:
    """Collect the ratios of all controls among the truths."""
    ratios: dict[str, float] = {}
    withheld, named = [], []
    for file, truth in sorted(truths.items()):
        if truth["mechanisms"]:
            continue
        result = results.get(file)
        if result is None or result.get("verdict") != "adequate":
            named.append(file)
            continue
        block = (result.get("holdout") or {}).get("forced")
        if block is None:
            withheld.append(file)
        else:
            # a channel that is left out makes it infinite
            ratios[file] = max(rmse_ratio(block, channel) for channel in truth["channels"])
    worst = max(ratios, key=lambda file: ratios[file], default=None)
    above = tuple(file for file, ratio in ratios.items() if ratio > LARGEST)
    largest = None if worst is None else ratios[worst]
    return Forced(len(ratios), largest, worst, above, tuple(withheld), tuple(named))
