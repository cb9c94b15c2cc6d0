"""Two effects hidden: how near the noise does the true second one promise to come, from the true first one?"""

from collections.abc import Iterator, Sequence

import numpy as np

from harness.app.calibrate.calibration import Calibration, head, quantiles, stands
from harness.app.calibrate.plant_cases import case_of, pair_of, start_of, terms_of, with_term
from harness.diagnosis.rules import PAIR_PROMISE
from harness.diagnosis.search.screen import screen
from harness.diagnosis.search.start_evidence import evidence


def measure(seed: int, index: int) -> tuple[str, float] | None:
    """The two names, the one fitted first, and chi-square per point that the other promises to leave.

    None where neither fits alone, or where the other is no law with a linear amplitude, which promises nothing.
    """
    rng = np.random.default_rng([seed, 3, index])
    names = pair_of(rng)
    start = start_of(case_of(names, rng, index))
    alone = {name: found for name in names if (found := with_term(start, name)) is not None}
    if not alone:
        return None
    first = min(alone, key=lambda name: alone[name].base.chi2 / alone[name].problem.points)
    (other,) = (name for name in names if name != first)
    at = alone[first]
    promised = screen(at.base, at.problem, evidence(at.base, at.problem, at.scales), at.scales, terms_of(other))
    if not promised:
        return None
    return f"{first} + {other}", (at.base.chi2 - promised[0].gain) / at.base.points


def said(rows: Sequence[tuple[str, float]]) -> Iterator[str]:
    """Quantiles of the promise, the largest with its effects."""
    yield head("chi-square per point promised")
    yield quantiles("true second effect", [promise for _, promise in rows])
    if rows:
        names, most = max(rows, key=lambda row: row[1])
        yield stands(PAIR_PROMISE, most <= PAIR_PROMISE.value, f"the largest is {most:.3g} ({names})")


CALIBRATION = Calibration(measure, said, "chi-square per point that the true second effect promises to leave")
