"""What is left out of a robot's joint beside its reversals: what friction comes to, and what is named for nothing."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from benchmarks.calibrate.calibration import Calibration, head, quantiles, stands
from harness.diagnosis.fit.model_fit import fit
from harness.diagnosis.parameters import free_of
from harness.diagnosis.pipeline import fit_base, judge, prepare, search
from harness.diagnosis.problems.inverse import InverseDynamics
from harness.diagnosis.problems.measured import Measured
from harness.diagnosis.request import Asked
from harness.diagnosis.rules import GUARD_SPEED
from harness.engines.models import folder
from harness.model.model import Restoring
from harness.robot.arm import load_arm
from harness.robot.example import Friction, excited
from harness.robot.recording import coupling, one_joint

_SHARES = (0.0, 0.02, 0.05, 0.1)
"""Of the rms speed: what is tried; 0 leaves out speeds without a sure sign alone."""
_DURATION = 10.0
"""s."""
_SMALL = 0.005
"""Share of f_k by which it may be off."""


@dataclass(frozen=True, slots=True)
class Draw:
    """errors : by share of the rms speed, of f_k, as shares. adequate : nothing is named where nothing is missing."""

    errors: dict[float, float]
    adequate: bool


def measure(seed: int, index: int) -> Draw | None:
    """A joint of the arm in models/arm with viscous and Coulomb friction that are drawn, and nothing else."""
    random = np.random.default_rng([seed, 7, index])
    arm = load_arm(folder() / "arm" / "arm.xml")
    joint = arm.joints[index % len(arm.joints)]
    own = Friction(float(random.uniform(0.3, 1.2)), float(random.uniform(0.1, 0.5)))
    log = excited(arm, {joint: own}, (joint,), _DURATION, seed=int(random.integers(1 << 30)))
    one = one_joint(log, coupling(arm, log, joint).reduced)
    free = None if one.restoring == "none" else True
    problem, _ = prepare(one.recording, Asked(Restoring(one.restoring), free, guarded=True))
    if not isinstance(problem, InverseDynamics):
        return None
    errors = {}
    for share in _SHARES:
        guarded = replace(problem, fixed=Measured.of(problem, share))
        found = fit(problem.first, guarded, free_of(problem.first, problem.base_names))
        errors[share] = abs(found.model.f_k / own.f_k - 1.0)
    return Draw(errors, judge(search(fit_base(problem))).judgement.verdict == "adequate")


def said(rows: Sequence[Draw]) -> Iterator[str]:
    """Quantiles of the error by share, and how often nothing is named."""
    yield head("error of f_k, shares")
    for share in _SHARES:
        yield quantiles(f"{share:.2g} of the rms speed", [row.errors[share] for row in rows])
    worst = max((row.errors[GUARD_SPEED.value] for row in rows), default=np.inf)
    right = sum(row.adequate for row in rows)
    why = f"f_k is {100.0 * worst:.2g} % off at most, and {right} of {len(rows)} are adequate"
    yield stands(GUARD_SPEED, worst < _SMALL and right == len(rows), why)


CALIBRATION = Calibration(measure, said, "what is left out beside the reversals of a robot's joint")
