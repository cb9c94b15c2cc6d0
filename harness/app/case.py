"""What a run simulates: the exact motion, the engines' task, the figures, and how it is written down."""

from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any, final

from harness.app.conclusions import conclusions
from harness.app.scenarios import scenario_json
from harness.core.arrays import FloatArray
from harness.core.scenario import Scenario
from harness.core.trajectory import Trajectory
from harness.engines import models
from harness.engines.base import Engine, Preset, Task
from harness.exact.decay import free_decay
from harness.fidelity.metrics import measure
from harness.results.run import Metrics, TraceResult


class Case(ABC):
    """One thing to run. Implementations are final."""

    @abstractmethod
    def exact(self, t: FloatArray) -> Trajectory:
        """The exact motion at times t (s)."""

    @abstractmethod
    def simulated(self, engine: Engine, preset: Preset, dt: float | None) -> Trajectory:
        """The motion in an engine; dt in s, None for the preset's own. Raises SimulationError."""

    @abstractmethod
    def metrics(self, trajectory: Trajectory) -> Metrics:
        """Figures of a trajectory against the exact motion."""

    @abstractmethod
    def describe(self) -> dict[str, Any]:
        """As a result holds it."""

    @abstractmethod
    def conclusions(self, traces: Sequence[TraceResult]) -> list[str]:
        """What differs and why, in sentences."""

    @abstractmethod
    def export(self, folder: Path) -> None:
        """Write slider.xml and slider.urdf, and what belongs to them, into a folder. Raises StoreError."""


@final
class DecayCase(Case):
    """A free decay of a slider."""

    def __init__(self, scenario: Scenario) -> None:
        self._scenario = scenario

    def exact(self, t: FloatArray) -> Trajectory:
        """See Case.exact; a closed form."""
        return free_decay(self._scenario, t)

    def simulated(self, engine: Engine, preset: Preset, dt: float | None) -> Trajectory:
        """See Case.simulated."""
        return engine.simulate(Task(self._scenario, preset=preset, dt=dt))

    def metrics(self, trajectory: Trajectory) -> Metrics:
        """See Case.metrics."""
        return Metrics(**asdict(measure(trajectory, self._scenario)))

    def describe(self) -> dict[str, Any]:
        """See Case.describe."""
        return scenario_json(self._scenario)

    def conclusions(self, traces: Sequence[TraceResult]) -> list[str]:
        """See Case.conclusions."""
        return conclusions(traces, self._scenario)

    def export(self, folder: Path) -> None:
        """See Case.export."""
        models.export(self._scenario.slider, folder)
