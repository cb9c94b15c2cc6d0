"""From a job of the plan to a recording and its answer: both follow from the seed and the job's place alone."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from harness.core.errors import SimulationError
from harness.proof.machines.cases import draw
from harness.proof.machines.kinds import KINDS
from harness.proof.machines.plan import Job, possible
from harness.proof.machines.records import csv_text
from harness.proof.machines.truth import truth

ATTEMPTS = 4
"""Times a job is drawn before it is given up; from the second on with another effect of its group."""


@dataclass(frozen=True, slots=True)
class Made:
    """A recording as CSV, and its answer."""

    recording: str
    answer: dict[str, Any]


def made(seed: int, job: Job, sums: bool = True) -> Made:
    """Draw a job; raises SimulationError when nothing came out.

    sums : whether the answer of a control says which laws sum it up, most of the time that a control takes.
    """
    kind, reason = KINDS[job.kind], ""
    for attempt in range(ATTEMPTS):
        rng = np.random.default_rng([seed, 1, job.index, attempt])
        names = possible(kind, job.group)
        main = names[int(rng.integers(len(names)))] if attempt else job.main
        try:
            case = draw(kind, main, rng, sums)
        except SimulationError as error:
            reason = str(error)
            continue
        return Made(csv_text(case), {"group": job.group, **truth(case)})
    raise SimulationError(reason)
