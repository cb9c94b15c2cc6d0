"""One term too many: held-out rmse of controls with the best-ranked term of the catalogue forced in.

A term that is not there must not spoil the prediction of what was held out.
"""

import math
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from typing import Any

from harness.proof.score import Result, Truth, rmse_ratio

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
