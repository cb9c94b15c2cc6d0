"""Engines that run MuJoCo's models, alone or many at once: what an adapter of one says."""

import time
from abc import abstractmethod
from collections.abc import Sequence
from typing import Any, ClassVar, Protocol, TypeAlias

from harness.core.errors import HarnessError
from harness.core.trajectory import Trajectory
from harness.engines.base import Engine, Task, resolve
from harness.engines.mujoco.held import Held, Recorded, held
from harness.engines.samples import UNSATURATED, trajectory
from harness.engines.stepping import SINGLE_PRECISION

Ready: TypeAlias = tuple[Held, dict[str, Any]]
"""A task and its settings."""
SINGLE_STICKS = 1.0 - 1e-5
"""UNSATURATED in single precision."""


class Runs(Protocol):
    """Tasks that are compiled and ready to run."""

    def run(self) -> list[Recorded]:
        """What each recorded."""


class AtOnce(Engine):
    """An engine within whose steps nothing can be called, and that takes as many sliders as there are."""

    calls: ClassVar[bool] = False
    curves: ClassVar[bool] = True
    batches: ClassVar[bool] = True

    @abstractmethod
    def check(self, settings: dict[str, Any]) -> None:
        """Raise InputError for a value that does not exist."""

    @abstractmethod
    def of_mujoco(self, settings: dict[str, Any]) -> dict[str, Any]:
        """All settings that MuJoCo has."""

    @abstractmethod
    def single(self, settings: dict[str, Any]) -> bool:
        """Whether numbers are in single precision."""

    @abstractmethod
    def unused(self, task: Task, settings: dict[str, Any]) -> tuple[str, ...]:
        """Settings without effect, one sentence each."""

    @abstractmethod
    def alike(self, ready: Ready) -> tuple[Any, ...]:
        """What must be the same for tasks that run at once."""

    @abstractmethod
    def ready(self, group: Sequence[Ready]) -> Runs:
        """Tasks that are alike, compiled. Raises NoDeviceError for a device that is not here."""

    def sticks_below(self, settings: dict[str, Any]) -> float:
        """See harness.engines.stepping.Stepped."""
        return SINGLE_STICKS if self.single(settings) else UNSATURATED

    def simulate(self, task: Task) -> Trajectory:
        (found,) = self.simulate_all([task])
        if isinstance(found, HarnessError):
            raise found
        return found

    def simulate_all(self, tasks: Sequence[Task]) -> list[Trajectory | HarnessError]:
        found: dict[int, Trajectory | HarnessError] = {}
        groups: dict[tuple[Any, ...], dict[int, Ready]] = {}
        for i, task in enumerate(tasks):
            try:
                settings = resolve(self, task)
                self.check(settings)
                ready = held(task, self.of_mujoco(settings)), settings
                groups.setdefault(self.alike(ready), {})[i] = ready
            except HarnessError as error:
                found[i] = error
        for group in groups.values():
            found |= dict(zip(group, self._together(list(group.values())), strict=True))
        return [found[i] for i in range(len(tasks))]

    def _together(self, group: Sequence[Ready]) -> list[Trajectory | HarnessError]:
        try:
            runs = self.ready(group)
        except HarnessError as error:
            return [error] * len(group)
        started = time.perf_counter()
        recorded = runs.run()
        wall = (time.perf_counter() - started) / len(group)
        return [self._told(*ready, one, wall) for ready, one in zip(group, recorded, strict=True)]

    def _told(
        self, ready: Held, settings: dict[str, Any], recorded: Recorded, wall: float
    ) -> Trajectory | HarnessError:
        ignored = self.unused(ready.task, settings)
        if self.single(settings):
            ignored = (*ignored, SINGLE_PRECISION)
        try:
            motion = ready.motion(recorded, float(settings["dt"]), self.sticks_below(settings))
            return trajectory(self, ready.task, settings, ignored, motion, wall)
        except HarnessError as error:
            return error
