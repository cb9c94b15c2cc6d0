"""Two recordings of one machine at two amplitudes: how often are they said to differ though they do not?

Beside it how often a heavier slider is told from the first. A machine holds one effect among small ones, or small ones
alone, so that what is missing acts differently at the two amplitudes. And of sliders in which nothing is hidden, how
often noise alone lets the base parameters differ.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from benchmarks.calibrate.calibration import Calibration, stands
from benchmarks.calibrate.pairs_of_one import SMALLER, two
from harness.core.recording import Recording
from harness.diagnosis.pipeline import fit_base, prepare_together
from harness.diagnosis.pooling.own import alone, compared
from harness.diagnosis.pooling.pooled import shared_by
from harness.diagnosis.problems.together import Together
from harness.diagnosis.request import Asked
from harness.diagnosis.rules import OWN, POOLED
from harness.kernels.solve import solve
from harness.model.model import Model

HEAVIER = 1.05
LEVEL = 0.05


@dataclass(frozen=True, slots=True)
class Tested:
    """chance : of the base parameters differing so. own : parameters that were made each recording's own.

    bare : the chance where nothing is hidden.
    """

    heavier: bool
    main: str
    chance: float
    own: tuple[str, ...]
    bare: float = 1.0


def measure(seed: int, index: int) -> Tested:
    """One pair, of alike or of two inertias in turn."""
    rng = np.random.default_rng([seed, 11, index])
    heavier = index % 2 == 1
    pair = two(rng, heavier=HEAVIER if heavier else 1.0)
    problem, _ = prepare_together(pair.recordings, pair.asked)
    based = fit_base(problem)
    assert isinstance(based.problem, Together)
    found = shared_by(based.problem, based.fit, based.scales)
    return Tested(heavier, pair.main, found.compared.chance, found.own, bare(seed, index))


def bare(seed: int, index: int) -> float:
    """The chance of two decays of a random slider in which nothing is hidden, from two amplitudes."""
    rng = np.random.default_rng([seed, 13, index])
    m = Model(1.0, float(rng.uniform(0.05, 0.6)), 100.0, float(rng.uniform(0.1, 0.6)))
    each = []
    for amplitude in (0.1, 0.1 * float(rng.uniform(*SMALLER))):
        t = np.linspace(0.0, 6.0, int(rng.integers(300, 1500)))
        noise = float(10.0 ** rng.uniform(-5.0, -3.0)) * rng.standard_normal(t.size)
        each.append(Recording(t, {"x": solve(replace(m, x0=amplitude), t).x + 0.01 * float(rng.normal()) + noise}))
    problem, _ = prepare_together(each, Asked(zero_free=True))
    return compared([alone(one) for one in problem.alone]).chance


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
    small = [sum(row.bare < level for row in rows) for level in (0.05, 0.01, POOLED.value)]
    yield f"nothing hidden: {len(rows)}, chance below .05 in {small[0]}, .01 in {small[1]}, .001 in {small[2]}"
    yield stands(POOLED, small[2] <= 1 + 3.0 * POOLED.value * len(rows), "noise alone differs as seldom as it says")
    yield stands(OWN, rate <= LEVEL, f"{100 * rate:.1f} % of alike ones said to differ, {100 * LEVEL:.0f} % is borne")


CALIBRATION = Calibration(measure, said, "how often recordings of one machine are said to differ")
