"""How well answers match the truth: confusion, false alarms, recovery, location, improvement, with intervals.

What is withheld counts against: no result, no refined fit, no standard error, a list longer than three.
"""

import math
from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass, field
from typing import Any

import numpy as np

from harness.proof.machines.score import LABELS, MachineScores
from harness.proof.plant.effects import FAMILY
from harness.proof.statistics import Median, Rate


@dataclass(frozen=True, slots=True)
class Figure:
    """A figure of the scores.

    label : what it counts. asked : what is asked of it, "" for one that is only shown. met : None where nothing is
    asked. share : whether it is a share of cases.
    """

    key: str
    label: str
    asked: str
    found: Rate | Median
    met: bool | None

    @property
    def share(self) -> bool:
        """Whether it is a share of cases, and not a median."""
        return isinstance(self.found, Rate)

    @property
    def sentence(self) -> str:
        """What falls short, in a sentence."""
        low = self.found.low if self.key == "named" else self.found.value
        shown = "unknown" if low is None else f"{100.0 * low:.1f} %" if self.share else f"{low:.3g}"
        bound = "lower bound " if self.key == "named" else ""
        return f"{self.label}: {bound}{shown}, {self.asked} is asked"


def _within(value: float | None, low: float, high: float) -> bool:
    return value is not None and low <= value <= high


def figures(scores: "Scores") -> list[Figure]:
    """Every figure in the order in which it is shown."""
    rows: list[tuple[str, str, str, Callable[[Rate | Median], bool] | None]] = [
        ("named", "single effects named", "lower bound above 88 %", lambda f: _within(f.low, 0.88, 1.0)),
        ("listed", "single effects named or not ruled out", "", None),
        ("both_named", "pairs, both named", "", None),
        ("false_alarms", "false alarms", "at most 2 %", lambda f: _within(f.value, -1.0, 0.02)),
        (
            "wrong_family",
            "outside the catalogue, called a wrong family",
            "at most 10 %",
            lambda f: _within(f.value, -1.0, 0.1),
        ),
        (
            "misled",
            "outside the catalogue, called that or nothing",
            "at most 10 %",
            lambda f: _within(f.value, -1.0, 0.1),
        ),
        (
            "covered",
            "true values within two standard errors",
            "92.5 to 98 %",
            lambda f: _within(f.value, 0.925, 0.98),
        ),
        ("parameter_error", "relative error of parameters, median", "", None),
        ("overlap", "overlap of the place with the true one, median", "", None),
        (
            "holdout",
            "held-out rmse after over before, median",
            "at most 0.5",
            lambda f: _within(f.value, -1.0, 0.5),
        ),
        (
            "engines_improved",
            "fit improved in MuJoCo and PyBullet",
            "at least 95 %",
            lambda f: _within(f.value, 0.95, 1.0),
        ),
    ]
    made = []
    for key, label, asked, holds in rows:
        found: Rate | Median = getattr(scores, key)
        made.append(Figure(key, label, asked, found, None if holds is None else holds(found)))
    return made


_LEAST = {"listed": 0.8, "better": 0.6}
_MOST = {"wrong": 0.04, "claimed": 0.03}
_CONTROLS = ("claimed", "unfounded", "small")
_SHOWN = ("listed", "named", "wrong", "silent", *_CONTROLS, "misled", "better", "holdout", "share_error")


def machine_figures(scores: MachineScores) -> list[Figure]:
    """Every figure in the order in which it is shown."""
    return [_figure(name, getattr(scores, name)) for name in _SHOWN]


def _figure(name: str, found: Rate | Median) -> Figure:
    asked, met = "", None
    if name in _LEAST:
        asked = f"at least {100.0 * _LEAST[name]:.0f} %"
        met = found.value is not None and found.value >= _LEAST[name]
    elif name in _MOST:
        asked = f"at most {100.0 * _MOST[name]:.0f} %"
        met = found.value is not None and found.value <= _MOST[name]
    return Figure(f"machines_{name}", LABELS[name], asked, found, met)


Truth = Mapping[str, Any]
Result = Mapping[str, Any]
SLACK, LONGEST = 10.0, 3
NEUTRAL = {"gain": 1.0}
"""Value of a parameter that means no effect: errors are relative to the distance from it."""
NOTHING, CANNOT_TELL, ABSENT = "nothing", "cannot tell", "no result"


_VERDICTS = ("adequate", "missing_physics", "main_effect", "one_of", "unexplained")


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
        verdict = (result or {}).get("verdict")
        if result is None or verdict not in _VERDICTS:
            return cls((), frozenset(), ABSENT)
        if verdict == "one_of":
            listed = frozenset(m["name"] for m in result.get("mechanisms", []))
            return cls((), listed if len(listed) <= LONGEST else frozenset(), "a list")
        if verdict not in ("missing_physics", "main_effect"):
            return cls((), frozenset(), NOTHING if verdict == "adequate" else CANNOT_TELL)
        found = result.get("mechanisms", [])
        said = tuple(m["name"] for m in found)
        near = set(said)
        for m in found:
            near |= {a["name"] for a in m.get("alternatives", []) if a.get("delta_bic", SLACK) < SLACK}
        if len(said) > LONGEST:
            return cls(said, frozenset(), "a list")
        return cls(said, frozenset(near if len(near) <= LONGEST else ()), " + ".join(sorted(said)) or CANNOT_TELL)


@dataclass(frozen=True, slots=True)
class Scores:
    """The figures of a proof; a rate or median without cases holds None.

    wrong_family : effects outside the catalogue that were given a name of another family. misled : those, and what was
    called nothing or withheld. confusion : true label -> said label -> count. by_name : single effects named, by name.
    not_tested : names that did not occur alone.
    """

    confusion: Mapping[str, Mapping[str, int]]
    named: Rate
    listed: Rate
    both_named: Rate
    false_alarms: Rate
    wrong_family: Rate
    misled: Rate
    covered: Rate
    parameter_error: Median
    overlap: Median
    holdout: Median
    engines_improved: Rate
    by_name: Mapping[str, Rate] = field(default_factory=dict)
    not_tested: Sequence[str] = ()

    def shortfalls(self) -> list[str]:
        """The figures that are not reached, one sentence each; empty when the proof stands."""
        return [figure.sentence for figure in figures(self) if figure.met is False]


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


def score(truths: Mapping[str, Truth], results: Mapping[str, Result]) -> Scores:
    """Score results by the file they belong to; a file without a result counts as one that was withheld."""
    confusion: dict[str, Counter[str]] = {}
    named: dict[str, list[bool]] = {}
    outcomes: dict[str, list[bool]] = {
        k: [] for k in ("listed", "both", "alarm", "wrong", "misled", "covered", "engines")
    }
    values: dict[str, list[float]] = {k: [] for k in ("error", "overlap", "holdout")}
    for file, truth in sorted(truths.items()):
        want, result = set(truth["mechanisms"]), results.get(file)
        answer = Answer.of(result)
        right = set(answer.said) == want and len(answer.said) == len(want)
        confusion.setdefault(" + ".join(sorted(want)) or NOTHING, Counter())[answer.label] += 1
        if not want:
            outcomes["alarm"].append(answer.label != NOTHING)
            continue
        if any(name.startswith("alien-") for name in want):
            families = {FAMILY.get(name, "") for name in answer.said}
            wrong = bool(answer.said) and not families <= set(truth["families"])
            outcomes["wrong"].append(wrong)
            outcomes["misled"].append(wrong or answer.label in (NOTHING, ABSENT))
            continue
        if len(want) > 1:
            outcomes["both"].append(right)
        else:
            named.setdefault(next(iter(want)), []).append(right)
            outcomes["listed"].append(want <= answer.near and len(answer.said) <= len(want))
        _measure(truth, result if answer.said else None, want, outcomes, values)
    return Scores(
        confusion={true: dict(said) for true, said in confusion.items()},
        named=Rate.of([hit for hits in named.values() for hit in hits]),
        listed=Rate.of(outcomes["listed"]),
        both_named=Rate.of(outcomes["both"]),
        false_alarms=Rate.of(outcomes["alarm"]),
        wrong_family=Rate.of(outcomes["wrong"]),
        misled=Rate.of(outcomes["misled"]),
        covered=Rate.of(outcomes["covered"]),
        parameter_error=Median.of(values["error"]),
        overlap=Median.of(values["overlap"]),
        holdout=Median.of(values["holdout"]),
        engines_improved=Rate.of(outcomes["engines"]),
        by_name={name: Rate.of(hits) for name, hits in sorted(named.items())},
        not_tested=tuple(name for name in FAMILY if name not in named),
    )


def _measure(
    truth: Truth,
    result: Result | None,
    want: set[str],
    outcomes: Mapping[str, list[bool]],
    values: Mapping[str, list[float]],
) -> None:
    """Improvement, location and parameters of one recording with hidden effects."""
    found = (result or {}).get("mechanisms", [])
    engines = (result or {}).get("engines") or {}
    for channel in truth["channels"]:
        values["holdout"].append(rmse_ratio((result or {}).get("holdout"), channel))
        if result is not None:
            for engine in ("mujoco", "pybullet"):
                outcomes["engines"].append(rmse_ratio(engines.get(engine), channel) < 1.0)
    if truth.get("region"):
        spans = [span for m in found if m["name"] in want for span in (m.get("where") or {}).get("time_s", [])]
        values["overlap"].append(spans_overlap(spans, truth["region"], truth["duration"]))
    for name in sorted(want):
        said = next((m for m in found if m["name"] == name), None)
        for parameter, value in truth["headline"].get(name, {}).items():
            p = (said or {}).get("parameters", {}).get(parameter) or {}
            if p.get("value") is None:
                values["error"].append(1.0)
                if said is not None:
                    outcomes["covered"].append(False)
                continue
            miss = abs(p["value"] - value)
            values["error"].append(miss / abs(value - NEUTRAL.get(parameter, 0.0)))
            outcomes["covered"].append(p.get("stderr") is not None and miss <= 2.0 * p["stderr"])


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


def forced_ratio(result: Result, truth: Truth) -> float | None:
    """The ratio of the worst channel; None when the result does not say, infinite when it leaves out a channel."""
    block = (result.get("holdout") or {}).get("forced")
    return None if block is None else max(rmse_ratio(block, channel) for channel in truth["channels"])


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
        ratio = forced_ratio(result, truth)
        if ratio is None:
            withheld.append(file)
        else:
            ratios[file] = ratio
    worst = max(ratios, key=lambda file: ratios[file], default=None)
    return Forced(
        cases=len(ratios),
        worst=None if worst is None else ratios[worst],
        worst_file=worst,
        above=tuple(file for file, ratio in ratios.items() if ratio > LARGEST),
        withheld=tuple(withheld),
        named=tuple(named),
    )
