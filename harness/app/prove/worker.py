"""What a worker process of a proof does: draw a recording, or have one answered by a sealed process."""

import os
import sys
import threading
import time
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from harness.app.prove.store import measured_in
from harness.core.errors import SimulationError
from harness.core.kernel_cache import cache_folder
from harness.proof.blind import BlindProcess
from harness.proof.drawing import drawn
from harness.proof.plan import Job

TIMEOUT_S = 1800.0
"""A diagnosis that takes longer has said nothing."""
COMMAND = (sys.executable, "-m", "harness.app.prove.blind_worker")
"""What runs in a sealed process."""


@dataclass(frozen=True, slots=True)
class DrawTask:
    """A job to be drawn with the seed of the proof. folder : of recordings of real machines, None without."""

    seed: int
    job: Job
    folder: Path | None = None

    @property
    def key(self) -> str:
        return str(self.job.index)


@dataclass(frozen=True, slots=True)
class BlindTask:
    """A recording to be answered. who : which diagnoser. place : folder for working folders, on this machine."""

    name: str
    who: str
    arguments: tuple[str, ...]
    recording: bytes
    place: str
    command: tuple[str, ...] = COMMAND
    timeout_s: float = TIMEOUT_S

    @property
    def key(self) -> str:
        return f"{self.who} {self.name}"


def draw_one(task: DrawTask) -> dict[str, Any]:
    """The recording and its answer as plain data, or why there is none."""
    try:
        at_hand = None if task.folder is None else measured_in(task.folder)[0]
        case = drawn(task.seed, task.job, at_hand=at_hand)
    except SimulationError as error:
        return draw_failed(task, str(error))
    said = {"name": case.name, "recording": case.recording.decode(), "answer": dict(case.answer), "error": None}
    return {"index": task.job.index, **said}


def draw_failed(task: DrawTask, why: str) -> dict[str, Any]:
    return {"index": task.job.index, "error": f"{' + '.join(task.job.kinds) or 'control'}: {why}"}


_own = threading.local()
"""The sealed process of each thread; a worker of the local pool has one thread, one of a cluster may have several."""


def answer_one(task: BlindTask) -> dict[str, Any]:
    """What a sealed process says of a recording, as text; "" when it said nothing."""
    began = time.perf_counter()
    running: dict[tuple[str, ...], BlindProcess] = _own.__dict__.setdefault("running", {})
    if task.command not in running:
        # where the program and its compiled kernels are
        code = str(Path(__file__).resolve().parents[3])
        environment = {"PYTHONPATH": code, "NUMBA_CACHE_DIR": str(cache_folder())}
        place = Path(task.place) if os.path.isdir(task.place) else None
        running[task.command] = BlindProcess(task.command, environment, place)
    said = running[task.command].ask(task.who, task.arguments, task.recording, task.timeout_s)
    seconds = round(time.perf_counter() - began, 3)
    return {"name": task.name, "who": task.who, "said": said.decode(), "seconds": seconds}


def answer_failed(task: BlindTask, why: str) -> dict[str, Any]:
    """A diagnosis that took its worker down has said nothing."""
    return {"name": task.name, "who": task.who, "said": "", "seconds": 0.0}
