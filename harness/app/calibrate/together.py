"""Two recordings of one machine at two amplitudes: how often are they said to differ though they do not?

Beside it how often a heavier slider is told from the first. A machine holds one effect among small ones, or small ones
alone, so that what is missing acts differently at the two amplitudes.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from harness.app.calibrate.calibration import Calibration, stands
from harness.app.calibrate.pairs_of_one import two
from harness.diagnosis.pipeline import fit_base, prepare_together
from harness.diagnosis.pooling.pooled import shared_by
from harness.diagnosis.problems.together import Together
from harness.diagnosis.rules import OWN, POOLED

HEAVIER = 1.05
LEVEL = 0.05


@dataclass(frozen=True, slots=True)
class Tested:
    """chance : of the base parameters differing so. own : parameters that were made each recording's own."""

    heavier: bool
    main: str
    chance: float
    own: tuple[str, ...]


def measure(seed: int, index: int) -> Tested:
    """One pair, of alike or of two inertias in turn."""
    rng = np.random.default_rng([seed, 11, index])
    heavier = index % 2 == 1
    pair = two(rng, heavier=HEAVIER if heavier else 1.0)
    problem, _ = prepare_together(pair.recordings, pair.asked)
    based = fit_base(problem)
    assert isinstance(based.problem, Together)
    found = shared_by(based.problem, based.fit, based.scales)
    return Tested(heavier, pair.main, found.compared.chance, found.own)


def said(rows: Sequence[Tested]) -> Iterator[str]:
    """Rates."""
    alike = [row for row in rows if not row.heavier]
    other = [row for row in rows if row.heavier]
    failed = sum(row.chance < POOLED.value for row in alike)
    wrong = [row for row in alike if row.own]
    yield f"alike: {len(alike)}, base parameters differ in {failed}, said to differ: {len(wrong)}"
    for row in wrong:
        yield f"  {row.main or 'control'}: {', '.join(row.own)} (chance {row.chance:.2g})"
    named = sum("m" in row.own for row in other)
    yield f"inertia x {HEAVIER:g}: {len(other)}, said to differ: {sum(bool(r.own) for r in other)}, in inertia: {named}"
    rate = len(wrong) / max(len(alike), 1)
    yield stands(OWN, rate <= LEVEL, f"{100 * rate:.1f} % of alike ones said to differ, {100 * LEVEL:.0f} % is borne")


CALIBRATION = Calibration(measure, said, "how often recordings of one machine are said to differ")
