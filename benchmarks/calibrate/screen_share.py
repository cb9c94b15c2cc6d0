"""The share of the best promise that the true effect has in the screen, in the whole or in the first part."""

from collections.abc import Iterator, Sequence

import numpy as np

from benchmarks.calibrate.calibration import Calibration, head, quantiles, stands
from benchmarks.calibrate.plant_cases import NAMES, case_of, start_of, terms_of
from harness.diagnosis.fit.model_fit import fit
from harness.diagnosis.rules import SCREEN_SHARE
from harness.diagnosis.search.look import evidence
from harness.diagnosis.search.screen import screen
from harness.model.registry import NAMED

_EARLY = 0.5
_LAWS = tuple(name for name in NAMES if all(t.amplitude is not None and len(t.parameters) > 1 for t in terms_of(name)))
"""Effects that the share decides on: of two or more parameters, one of them linear."""


def measure(seed: int, index: int) -> tuple[str, float] | None:
    """Name of the hidden effect, and its share of the best promise; None where nothing promised anything."""
    rng = np.random.default_rng([seed, 2, index])
    name = _LAWS[int(rng.integers(len(_LAWS)))]
    start = start_of(case_of(name, rng, index))
    early = start.problem.part(slice(0, int(_EARLY * start.problem.t.size)))
    shares = []
    for problem, base in (
        (start.problem, start.base),
        (early, fit(start.base.model, early, start.base.free, start.scales)),
    ):
        found = screen(base, problem, evidence(base, problem, start.scales), start.scales, NAMED)
        own = max((c.gain for c in found if c.term.name == name), default=0.0)
        if found and found[0].gain > 0.0:
            shares.append(own / found[0].gain)
    return (name, max(shares)) if shares else None


def said(rows: Sequence[tuple[str, float]]) -> Iterator[str]:
    """Quantiles of the share, the least with its effect."""
    yield head("share of the best promise")
    yield quantiles("true effect", [share for _, share in rows])
    if rows:
        name, least = min(rows, key=lambda row: row[1])
        yield stands(SCREEN_SHARE, least >= SCREEN_SHARE.value, f"the least is {least:.3g} ({name})")


CALIBRATION = Calibration(measure, said, "share of the best promise that the true effect had in the screen")
