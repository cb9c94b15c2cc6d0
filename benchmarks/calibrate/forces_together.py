"""Two driven recordings of one machine: how often are they said to differ though they do not, and what is told if so?

Axes and spring sliders under two forces, each with a noise of its own; in half of them something is hidden: an effect,
which acts differently under the other force, or a force that nobody measured. Every second pair is alike; of the others
the second carries a tenth more, or has a fifth less dry friction. Asked is the base fit: what differs beside a hidden
law is looked for once more when that is found.
"""

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from benchmarks.calibrate.calibration import Calibration, stands
from harness.core.arrays import FloatArray
from harness.core.recording import Recording
from harness.diagnosis.inverse_dynamics.prepare import forces_together
from harness.diagnosis.pooling.forces import shared_forces
from harness.diagnosis.pooling.pooled import differences
from harness.diagnosis.request import Asked
from harness.diagnosis.rules import OWN, POOLED
from harness.kernels.solve import Drive, solve
from harness.model.model import Model, ModelTerm, Restoring

OF_A_DRIVE: Mapping[str, Mapping[str, float]] = {
    "stribeck": {"f_s": 2.5, "v_s": 0.1},
    "quadratic-drag": {"c2": 2.0},
    "asymmetric-viscous": {"c_diff": 1.2},
}
"""Effects of a slider of 2 kg under some 10 N, at strengths that leave some per cent of that; parameters in SI."""

DIFFERS = {"m": 1.1, "f_k": 0.8}
"""What is another number in the second recording, over the first's."""
LEVEL = 0.05
_RATE = 250.0
_SAMPLES = (2000, 3000)
_UNSEEN, _LASTS = "unmeasured force", 0.975
"""What is hidden where it is no effect, and what of it is left a sample later."""


@dataclass(frozen=True, slots=True)
class Tested:
    """differs : what is another number, "" where nothing is. hidden : the effect. chance : of numbers so far apart.

    own : what was made each recording's own. apart : the ratio that is said less the true one, in standard errors.
    """

    differs: str
    hidden: str
    chance: float
    own: tuple[str, ...]
    apart: float | None


def measure(seed: int, index: int) -> Tested:
    """One pair; of four in a row two are alike, and an effect is hidden in two."""
    rng = np.random.default_rng([seed, 17, index])
    restoring = Restoring.SPRING if rng.random() < 0.5 else Restoring.NONE
    differs = "" if index % 2 == 0 else str(rng.choice(list(DIFFERS)))
    hidden = str(rng.choice([*OF_A_DRIVE, _UNSEEN])) if index // 2 % 2 else ""
    k = float(rng.uniform(40.0, 120.0)) if restoring is Restoring.SPRING else 0.0
    base = Model(2.0, float(rng.uniform(2.0, 5.0)), k, float(rng.uniform(1.0, 2.0)), restoring=restoring)
    if hidden in OF_A_DRIVE:
        base = base.with_terms(ModelTerm.named(hidden, **OF_A_DRIVE[hidden]))
    second = replace(base, **{differs: DIFFERS[differs] * getattr(base, differs)}) if differs else base
    unseen = float(rng.uniform(0.1, 0.5)) if hidden == _UNSEEN else 0.0
    recordings = [recorded(model, rng, unseen, f"recording-{i + 1}.csv") for i, model in enumerate((base, second))]
    problem, _ = forces_together(recordings, Asked(restoring))
    found = shared_forces(problem)
    apart = None
    if found.own == (differs,):
        ratio = differences(found.base, found.problem, found.scales.omega, True)[1][0].ratio
        if ratio.value is not None and ratio.stderr is not None:
            apart = (ratio.value - DIFFERS[differs]) / ratio.stderr
    return Tested(differs, hidden, found.compared.chance, found.own, apart)


def recorded(model: Model, rng: np.random.Generator, unseen: float, name: str) -> Recording:
    """A model under three waves of force, its position to micrometres and its force to some per cent.

    unseen : rms of a force that is not recorded, N.
    """
    t = np.arange(int(rng.integers(*_SAMPLES))) / _RATE
    force: FloatArray = np.zeros(t.size)
    for size, slowest in ((6.0, 1.5), (4.0, 5.0), (3.0, 11.0)):
        force += size * np.sin(float(rng.uniform(1.0, 1.6)) * slowest * t + float(rng.uniform(0.0, 2.0 * math.pi)))
    hidden = np.zeros(t.size)
    for i in range(1, t.size if unseen else 1):
        hidden[i] = _LASTS * hidden[i - 1] + math.sqrt(1.0 - _LASTS**2) * unseen * rng.standard_normal()
    x = solve(model, t, drive=Drive(t, force + hidden)).x + 0.01 * float(rng.normal())
    x += float(10.0 ** rng.uniform(-6.0, -5.0)) * rng.standard_normal(t.size)
    u = force + float(10.0 ** rng.uniform(-2.0, -0.5)) * rng.standard_normal(t.size)
    return Recording(t, {"x": x, "u": u}, name)


def said(rows: Sequence[Tested]) -> Iterator[str]:
    """Rates."""
    alike, other = ([row for row in rows if bool(row.differs) is wanted] for wanted in (False, True))
    bare = [row for row in alike if not row.hidden]
    wrong = [row for row in alike if row.own]
    yield f"alike: {len(alike)}, said to differ: {len(wrong)}"
    for row in wrong:
        yield f"  {row.hidden or 'control'}: {', '.join(row.own)} (chance {row.chance:.2g})"
    for stem, factor in DIFFERS.items():
        each = [row for row in other if row.differs == stem]
        right = sum(row.own == (stem,) for row in each)
        yield f"{stem} x {factor:g}: {len(each)}, said to differ: {sum(bool(r.own) for r in each)}, in {stem}: {right}"
    for row in other:
        if row.own != (row.differs,):
            yield f"  {row.differs} with {row.hidden or 'nothing'}: {', '.join(row.own) or 'none'} is said"
    for what, wanted in (("nothing", False), ("an effect", True)):
        sizes = [abs(row.apart) for row in other if row.apart is not None and bool(row.hidden) is wanted]
        within = [sum(size < most for size in sizes) for most in (1.0, 2.0, 3.0)]
        counts = f"{within[0]}, {within[1]}, {within[2]} of {len(sizes)}"
        yield f"with {what} hidden, the base fit's size within 1, 2, 3 standard errors: {counts}"
    small = [sum(row.chance < level for row in bare) for level in (0.05, 0.01, POOLED.value)]
    yield f"nothing hidden: {len(bare)}, chance below .05 in {small[0]}, .01 in {small[1]}, .001 in {small[2]}"
    yield stands(POOLED, small[2] <= 1 + 3.0 * POOLED.value * len(bare), "noise alone differs as seldom as it says")
    rate = len(wrong) / max(len(alike), 1)
    yield stands(OWN, rate <= LEVEL, f"{100 * rate:.1f} % of alike ones said to differ, {100 * LEVEL:.0f} % is borne")


CALIBRATION = Calibration(measure, said, "how often driven recordings of one machine are said to differ")
