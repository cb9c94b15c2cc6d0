"""What test files run in worker processes instead of the real thing."""

import os
import signal
import time
from pathlib import Path
from typing import Any

from harness.app.sweep.parts import compute
from harness.core.scenario import FREE_DECAY
from harness.fidelity.row import Spec, failed

KILLER = "kills its worker"


def spec(number: int, preset: str = "tuned") -> Spec:
    """A spec that no other has."""
    return Spec("none", "1", "joint", preset, "tuned", (("number", number),), None, FREE_DECAY)


def light(one: Spec) -> dict[str, Any]:
    """A row without a simulation; one of them takes its process down."""
    if one.preset == KILLER:
        os.kill(os.getpid(), signal.SIGKILL)
    return failed(one, "light").model_dump()


def slow(one: Spec) -> dict[str, Any]:
    """A real row that takes a little longer, and leaves its process's number behind."""
    folder = os.environ.get("SWEEP_TEST_PIDS")
    if folder:
        (Path(folder) / str(os.getpid())).touch()
    time.sleep(0.05)
    return compute(one)


def sleepy(one: Spec) -> dict[str, Any]:
    """A row that never ends."""
    if dict(one.changed)["number"] >= 40:
        time.sleep(600.0)
    return failed(one, "light").model_dump()
