"""An engine as a third party would write it: the closed form dressed up as one."""

from dataclasses import replace
from typing import Any, ClassVar, final

import numpy as np

from harness.core.trajectory import Source, Trajectory
from harness.engines.base import Engine, Preset, Route, Task, resolve
from harness.exact.decay import free_decay


@final
class Mine(Engine):
    """Knows free decays only."""

    name: ClassVar[str] = "mine"

    def version(self) -> str:
        return "1"

    def presets(self, route: Route, preset: Preset, dt: float | None = None) -> dict[str, Any]:
        return {"dt": dt or 1e-3}

    def simulate(self, task: Task) -> Trajectory:
        settings = resolve(self, task)
        exact = free_decay(task.scenario, settings["dt"] * np.arange(task.steps(settings["dt"]) + 1))
        return replace(exact, source=Source(self.name, task.preset, self.version(), settings["dt"], settings))
