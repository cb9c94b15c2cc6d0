"""The engine: tasks alone, or many at once where what is compiled in is the same."""

import time
from collections.abc import Sequence
from typing import Any, ClassVar, final

from harness.core.errors import HarnessError
from harness.core.trajectory import Trajectory
from harness.engines.base import Engine, Preset, Route, Task, resolve
from harness.engines.mjx import presets as table
from harness.engines.mujoco.held import Held, Recorded, held
from harness.engines.samples import trajectory


@final
class MjxEngine(Engine):
    """MJX on one slide joint (joint and law routes) or a box that slides and lifts (contact route)."""

    name: ClassVar[str] = "mjx"
    package: ClassVar[str] = "mujoco-mjx"
    calls: ClassVar[bool] = False
    batches: ClassVar[bool] = True

    def presets(self, route: Route, preset: Preset, dt: float | None = None) -> dict[str, Any]:
        return table.presets(route, preset, dt)

    def simulate(self, task: Task) -> Trajectory:
        (found,) = self.simulate_all([task])
        if isinstance(found, HarnessError):
            raise found
        return found

    def simulate_all(self, tasks: Sequence[Task]) -> list[Trajectory | HarnessError]:
        from harness.engines.mjx.scan import structure

        found: dict[int, Trajectory | HarnessError] = {}
        alike: dict[tuple[Any, ...], list[tuple[int, Held, dict[str, Any]]]] = {}
        for i, task in enumerate(tasks):
            try:
                settings = resolve(self, task)
                table.check(settings)
                ready = held(task, settings | table.LACKING)
                alike.setdefault(structure(ready, settings), []).append((i, ready, settings))
            except HarnessError as error:
                found[i] = error
        for group in alike.values():
            found |= self._together(group)
        return [found[i] for i in range(len(tasks))]

    def _together(self, group: Sequence[tuple[int, Held, dict[str, Any]]]) -> dict[int, Trajectory | HarnessError]:
        from harness.engines.mjx.scan import Runs

        try:
            runs = Runs([(ready, settings) for _, ready, settings in group])
        except HarnessError as error:
            return {i: error for i, *_ in group}
        started = time.perf_counter()
        recorded = runs.run()
        wall = (time.perf_counter() - started) / len(group)
        found: dict[int, Trajectory | HarnessError] = {}
        for (i, ready, settings), one in zip(group, recorded, strict=True):
            try:
                found[i] = self._told(ready, settings, one, wall)
            except HarnessError as error:
                found[i] = error
        return found

    def _told(self, ready: Held, settings: dict[str, Any], recorded: Recorded, wall: float) -> Trajectory:
        from harness.engines.mjx.scan import sticks_below

        task = ready.task
        ignored = table.unused(settings, self.presets(task.route, "as-shipped", task.dt), task.route)
        motion = ready.motion(recorded, float(settings["dt"]), sticks_below(settings))
        return trajectory(self, task, settings, ignored, motion, wall)
