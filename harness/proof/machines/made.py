"""From a job of the plan to a recording and its answer: both follow from the seed and the job's place alone."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from harness.core.errors import SimulationError
from harness.proof.machines.cases import Messy, draw, with_sums
from harness.proof.machines.kinds import KINDS
from harness.proof.machines.plan import Job, possible
from harness.proof.machines.records import csv_text
from harness.proof.machines.sealed import Sealed
from harness.proof.machines.truth import truth

ATTEMPTS = 4
"""Times a job is drawn before it is given up; from the second on with another effect of its group."""


@dataclass(frozen=True, slots=True)
class Made:
    """A recording as CSV, and its answer."""

    recording: str
    answer: dict[str, Any]


def made(seed: int, job: Job, sealed: Sealed | None = None) -> Made:
    """A recording and all of its answer; raises SimulationError when nothing came out.

    sealed : what its answer says that fits decide.
    """
    case, rng = _drawn(seed, job, sealed)
    return _told(job, with_sums(case, rng))


def made_quickly(seed: int, job: Job) -> Made:
    """The same, but that the answer of a control does not say which laws sum it up."""
    return _told(job, _drawn(seed, job)[0])


def _told(job: Job, case: Messy) -> Made:
    return Made(csv_text(case), {"group": job.group, **truth(case)})


def _drawn(seed: int, job: Job, sealed: Sealed | None = None) -> tuple[Messy, np.random.Generator]:
    """A case, and the chance that goes on from it."""
    kind, reason = KINDS[job.kind], ""
    for attempt in range(ATTEMPTS):
        rng = np.random.default_rng([seed, 1, job.index, attempt])
        names = possible(kind, job.group)
        main = names[int(rng.integers(len(names)))] if attempt else job.main
        try:
            return draw(kind, main, rng, sealed), rng
        except SimulationError as error:
            reason = str(error)
    raise SimulationError(reason)
