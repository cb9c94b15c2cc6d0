"""What a calibration is: a draw that is measured, and what is said of all of them; draws run side by side."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from harness.app.shared.rows import LocalPool
from harness.core.errors import HarnessError
from harness.diagnosis.rules import Rule

QUANTILES = (0.5, 0.9, 0.95, 0.99, 1.0)


@dataclass(frozen=True, slots=True)
class Calibration:
    """A simulation that a rule comes from.

    measure : what the draw of a seed and an index gives, None where it says nothing; it depends on these two alone.
    said : lines about the draws that were measured, ending with whether each rule stands.
    """

    measure: Callable[[int, int], Any]
    said: Callable[[Sequence[Any]], Iterator[str]]
    about: str


def measured(measure: Callable[[int, int], Any], seed: int, draws: int, jobs: int) -> list[Any]:
    """What draws 0 to ``draws - 1`` of a seed give, but for those that say nothing."""
    if jobs == 1:
        found = [_one(measure, seed, i) for i in range(draws)]
    else:
        pool = LocalPool(jobs)
        try:
            found = list(pool.executor.map(_one, [measure] * draws, [seed] * draws, range(draws)))
        finally:
            pool.close()
    return [one for one in found if one is not None]


def _one(measure: Callable[[int, int], Any], seed: int, index: int) -> Any:
    try:
        return measure(seed, index)
    except HarnessError:
        return None


def quantiles(label: str, values: Sequence[float]) -> str:
    """A row: how many values, and their quantiles."""
    if not values:
        return f"{label:28s} no value"
    at = np.quantile(np.asarray(values), QUANTILES)
    return f"{label:28s} {len(values):5d}" + "".join(f" {one:9.4g}" for one in at)


def head(label: str) -> str:
    """What stands above rows of quantiles."""
    names = ["50 %", "90 %", "95 %", "99 %", "most"]
    return f"{label:28s} draws" + "".join(f" {name:>9s}" for name in names)


def stands(rule: Rule, well: bool, why: str) -> str:
    """Whether a rule stands."""
    return f"{rule.name} = {rule.value:.4g} {rule.unit}: the rule {'stands' if well else 'falls short'}: {why}"
