"""An engine that runs in a worker, behind the interface of those that run here."""

import atexit
import os
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import cache
from multiprocessing.connection import Connection
from pathlib import Path
from typing import Any, ClassVar

import harness.core
from harness.core.errors import HarnessError, InputError, SimulationError
from harness.core.trajectory import Trajectory
from harness.engines.base import Engine, Preset, Route, Task
from harness.engines.elsewhere.worker import START

PATIENCE_S = 5.0
"""How long a worker may take to end before it is ended."""
LAST_LINES = 3


class Worker:
    """A process of ``python`` with one engine ("module:Class") in it; started when first asked, again after a death."""

    def __init__(self, python: str, where: str) -> None:
        self._python, self._where = python, where
        self._process: subprocess.Popen[bytes] | None = None
        self._questions: Connection[Any, Any]
        self._answers: Connection[Any, Any]
        self._said: Any = None
        self._last: list[str] = []

    def ask(self, *request: Any) -> Any:
        """The answer; raises the HarnessError of a run that failed, SimulationError when the process died."""
        process = self._running()
        try:
            self._questions.send(request)
            kind, value = self._answers.recv()
        except (OSError, EOFError):
            raise SimulationError(self._obituary(process)) from None
        if kind == "failed":
            raise value
        return value

    def close(self) -> None:
        process, self._process = self._process, None
        if process is None:
            return
        self._questions.close()
        try:
            process.wait(PATIENCE_S)
        except subprocess.TimeoutExpired:
            process.kill()
            process.wait()
        self._answers.close()
        self._said.seek(0)
        self._last = self._said.read().decode(errors="replace").splitlines()
        self._said.close()

    def _running(self) -> subprocess.Popen[bytes]:
        if self._process is None:
            self._said = tempfile.TemporaryFile()  # noqa: SIM115  (open as long as the process)
            folder = str(Path(harness.core.__file__).resolve().parents[1])
            self._process = subprocess.Popen(
                [self._python, "-P", "-c", START, folder, self._where],
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                stderr=self._said,
                env=_environment(self._python),
            )
            with self._process.stdin as stdin, self._process.stdout as stdout:  # type: ignore[union-attr]
                self._questions = Connection(os.dup(stdin.fileno()), readable=False)
                self._answers = Connection(os.dup(stdout.fileno()), writable=False)
        return self._process

    def _obituary(self, process: subprocess.Popen[bytes]) -> str:
        self.close()
        lines = [line.strip() for line in self._last if line.strip()]
        last = f" ({'; '.join(lines[-LAST_LINES:])})" if lines else ""
        return f"{self._python}: its process ended with code {process.returncode}{last}"


def _environment(python: str) -> dict[str, str]:
    """What a worker starts with; one of this interpreter finds the modules that this process finds."""
    same = {"PYTHONPATH": os.pathsep.join(filter(None, sys.path))} if python == sys.executable else {}
    return os.environ | same


class Elsewhere(Engine):
    """An engine in a worker; what it can do is asked once."""

    worker: ClassVar[Worker]
    found: ClassVar[str]

    def version(self) -> str:
        return self.found

    def presets(self, route: Route, preset: Preset, dt: float | None = None) -> dict[str, Any]:
        settings: dict[str, Any] = self.worker.ask("presets", route, preset, dt)
        return settings

    def simulate(self, task: Task) -> Trajectory:
        """See Engine.simulate; also raises SimulationError when the process dies."""
        motion: Trajectory = self.worker.ask("simulate", task)
        return self._labelled(motion)

    def simulate_all(self, tasks: Sequence[Task]) -> list[Trajectory | HarnessError]:
        """See Engine.simulate_all; an engine that runs one after the other is asked for one after the other."""
        if not self.batches:
            return super().simulate_all(tasks)
        found: list[Trajectory | HarnessError] = self.worker.ask("simulate_all", list(tasks))
        return [one if isinstance(one, HarnessError) else self._labelled(one) for one in found]

    def _labelled(self, motion: Trajectory) -> Trajectory:
        return replace(motion, source=replace(motion.source, name=self.label))


@cache
def worker(python: str, where: str) -> Worker:
    """The one worker of this process for an engine in an interpreter."""
    made = Worker(python, where)
    atexit.register(made.close)
    return made


def engine_in(python: str, where: str) -> Engine:
    """The engine "module:Class" of the interpreter ``python``.

    Raises InputError when there is no such interpreter, SimulationError when it has no such engine.
    """
    program = shutil.which(python)
    if program is None:
        raise InputError(f"engine @{python}", "no program", "NAME@PYTHON with the path of an interpreter")
    return _kind(program, where)()


@cache
def _kind(program: str, where: str) -> Callable[[], Engine]:
    asked = worker(program, where)
    name, version, about = asked.ask("about")
    own = {"name": name, "worker": asked, "found": version}
    kind: Callable[[], Engine] = type("Elsewhere", (Elsewhere,), about | own)
    return kind


HERE = sys.executable
"""The interpreter of this process, for engines that want a process of their own."""
