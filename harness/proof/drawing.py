"""From a job of the plan to a recording and its answer: both follow from the seed and the job's place alone."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, cast

import numpy as np

from harness.core.errors import SimulationError
from harness.proof.detection import LOSSES, draw_series
from harness.proof.engine_source import ENGINE_KINDS, EngineName, draw_engine
from harness.proof.machines.cases import Sealed as SealedMachine
from harness.proof.machines.kinds import FREE
from harness.proof.machines.kinds import Job as MachineJob
from harness.proof.machines.made import made
from harness.proof.paths import made as paths
from harness.proof.plan import DETECTION, MACHINE, PAIR, PATH, PLANT, REAL, Job, possible_pairs
from harness.proof.plant.cases import Case, csv_text, draw, truth
from harness.proof.real.made import Measured, Rig, Wanted
from harness.proof.real.made import made as of_real
from harness.proof.seal import Sealed, digest

ATTEMPTS = 5
"""Times a job is drawn before it is given up; a pair that does not come out is replaced by another."""
PROBES = 12
"""Lines of a recording that a transcript holds."""


@dataclass(frozen=True, slots=True)
class Drawn:
    """A recording with its answer.

    name : random, tells nothing. recording : CSV. answer : as ``truth`` says it, with the group and source of the job.
    """

    name: str
    recording: bytes
    answer: Mapping[str, Any]


def probes_of(recording: bytes) -> list[str]:
    """Header and ``PROBES`` lines of a recording, evenly spaced: what one drawn again elsewhere is compared with."""
    lines = recording.decode().splitlines()
    places = np.unique(np.linspace(1, len(lines) - 1, PROBES).astype(int))
    return [lines[0], *(lines[i] for i in places)]


def name_of(seed: int, index: int) -> str:
    """The name of a recording: nobody without the seed can tell its place from it."""
    return _secret(seed, "name", index)[:16]


def sealed_answers(seed: int, answers: Mapping[str, Mapping[str, Any]]) -> dict[str, Sealed]:
    """Answers by name, each with a salt that follows from the seed and the job's place."""
    return {
        name: Sealed(dict(answer), _secret(seed, "salt", int(answer["index"]))[:32]) for name, answer in answers.items()
    }


def _secret(seed: int, use: str, index: int) -> str:
    return digest(f"{seed:x} {use} {index}".encode())


@dataclass(frozen=True, slots=True)
class AtHand:
    """Recordings of real machines by file: what the transcript says of each, and its samples."""

    rigs: Mapping[str, Rig] = field(default_factory=dict)
    measured: Mapping[str, Measured] = field(default_factory=dict)


def drawn(seed: int, job: Job, sealed: SealedMachine | None = None, at_hand: AtHand | None = None) -> Drawn:
    """Draw a job; raises SimulationError when nothing concealed and decidable came out.

    sealed : what the answer of a machine says that fits decide. at_hand : what real machines are made from.
    """
    about = {"index": job.index, "group": job.group}
    if job.source == MACHINE:
        recording, answer = _machine(seed, job, sealed)
        return Drawn(name_of(seed, job.index), recording.encode(), {**answer, **about})
    if job.source == PATH:
        one = paths.made(seed, job.index, job.setting, job.group, "".join(job.kinds))
        return Drawn(name_of(seed, job.index), one.recording, {**one.answer, **about})
    if job.source == REAL:
        given, wanted = at_hand or AtHand(), Wanted(job.group, job.files, "".join(job.kinds))
        data, told = of_real(seed, job.index, wanted, given.rigs, given.measured)
        return Drawn(name_of(seed, job.index), data, {**told, **about})
    if job.group == DETECTION:
        (step,) = draw_series(job.kinds[0], seed, job.series, LOSSES[job.level : job.level + 1])
        case, answer = step.case, step.answer()
    else:
        case, answer = _case(seed, job)
    return Drawn(name_of(seed, job.index), csv_text(case).encode(), {**answer, **about})


def _machine(seed: int, job: Job, sealed: SealedMachine | None) -> tuple[str, dict[str, Any]]:
    """A recording of a machine, and its answer with what every answer of a proof holds."""
    found = made(seed, MachineJob(job.index, job.group, FREE[job.setting], "".join(job.kinds)), sealed)
    answer = found.answer
    loss = sum(answer["samples"] * (left / answer["noise"][c]) ** 2 for c, left in answer["base_rmse"].items())
    common = {
        "mechanisms": [answer["dominant"]] if answer["dominant"] else [],
        "source": MACHINE,
        "setting": answer["kind"],
        "points": answer["samples"],
        "arguments": answer["options"],
        "base_chi2_excess": loss,
    }
    return found.recording, {**answer, **common}


def _case(seed: int, job: Job) -> tuple[Case, dict[str, Any]]:
    """A recording with its answer; drawn again when nothing came out, a pair as another pair."""
    reason, kinds = "", job.kinds
    for attempt in range(ATTEMPTS):
        rng = np.random.default_rng([seed, 1, job.index, attempt])
        if attempt and job.group == PAIR:
            others = [pair for pair in possible_pairs() if job.source == PLANT or set(pair) <= set(ENGINE_KINDS)]
            kinds = others[int(rng.integers(len(others)))]
        kind = "control" if not kinds else kinds[0] if len(kinds) == 1 else kinds
        try:
            if job.source == PLANT:
                case = draw(kind, rng, setting=job.setting, noise=job.noise)
            else:
                case = draw_engine(kind, rng, cast(EngineName, job.source), noise=job.noise)
        except SimulationError as error:
            reason = str(error)
            continue
        return case, truth(case)
    raise SimulationError(reason)
