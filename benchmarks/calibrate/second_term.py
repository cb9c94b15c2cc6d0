"""One effect hidden: what does the best second term take off BIC, beside the true one?"""

from collections.abc import Iterator, Sequence

import numpy as np

from benchmarks.calibrate.calibration import Calibration, head, quantiles, stands
from benchmarks.calibrate.plant_cases import NAMES, case_of, start_of, with_term
from harness.diagnosis.rules import SECOND_TERM
from harness.diagnosis.search.extend import extend

LEVEL = 0.99


def measure(seed: int, index: int) -> float | None:
    """BIC that the best second term gains on the true first one; None where that one could not be fitted."""
    rng = np.random.default_rng([seed, 1, index])
    name = NAMES[int(rng.integers(len(NAMES)))]
    first = with_term(start_of(case_of(name, rng, index)), name)
    if first is None:
        return None
    fits = extend(first.base, first.problem, first.scales).fits
    return max(0.0, first.base.bic - fits[0].bic) if fits else 0.0


def said(gains: Sequence[float]) -> Iterator[str]:
    """Quantiles of the gain."""
    yield head("BIC of the best second term")
    yield quantiles("one effect hidden", gains)
    if gains:
        point = float(np.quantile(np.asarray(gains), LEVEL))
        least = round(1.0 / (1.0 - LEVEL))
        few = "" if len(gains) >= least else f"; fewer than {least} draws: the point is their most"
        yield stands(SECOND_TERM, point <= SECOND_TERM.value, f"the 99 % point is {point:.3g}{few}")


CALIBRATION = Calibration(measure, said, "what the best second term takes off where one effect is hidden")
