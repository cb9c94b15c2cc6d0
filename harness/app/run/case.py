"""What a run simulates: the exact motion, the engines' task, the figures, and how it is written down."""

from abc import ABC, abstractmethod
from collections.abc import Sequence
from pathlib import Path
from typing import Any, final

from harness.core.arrays import FloatArray
from harness.core.scenario import Scenario
from harness.core.trajectory import Trajectory
from harness.engines import models
from harness.engines.base import Engine, Preset, Task
from harness.estimate.every import estimate_all
from harness.estimate.result import Estimation
from harness.fidelity.kind import kind_of
from harness.fidelity.metrics import max_error_m, measure_contact
from harness.fidelity.row import describe
from harness.results.run import Metrics, TraceResult
from harness.show.sentences.run import conclusions


class Case(ABC):
    """One thing to run. Implementations are final.

    decays : whether it is a free decay, which the estimators can read.
    """

    decays: bool
    file_name: str = "slider"
    """Of the MJCF and URDF that are left, without ending."""

    @abstractmethod
    def exact(self, t: FloatArray) -> Trajectory:
        """The exact motion at times t (s)."""

    @abstractmethod
    def simulated(self, engine: Engine, preset: Preset, dt: float | None) -> Trajectory:
        """The motion in an engine; dt in s, None for the preset's own. Raises SimulationError."""

    @abstractmethod
    def metrics(self, trajectory: Trajectory) -> Metrics:
        """Figures of a trajectory against the exact motion."""

    def estimated(self, trajectory: Trajectory) -> Estimation:
        """What the estimators read of it, from position and acceleration."""
        return estimate_all(trajectory.t, x=trajectory.x, a=trajectory.a)

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
class SuiteCase(Case):
    """A scenario of the fidelity suite."""

    def __init__(self, scenario: Scenario) -> None:
        self._scenario, self._kind = scenario, kind_of(scenario)
        self.decays = scenario.action is None

    def exact(self, t: FloatArray) -> Trajectory:
        """See Case.exact; a closed form."""
        return self._kind.exact(self._scenario, t)

    def simulated(self, engine: Engine, preset: Preset, dt: float | None) -> Trajectory:
        """See Case.simulated."""
        return engine.simulate(Task(self._scenario, self._kind.routes[0], preset, dt))

    def metrics(self, trajectory: Trajectory) -> Metrics:
        """See Case.metrics; the distance from the exact motion, and what the scenario is about."""
        found = self._kind.measure(trajectory, self._scenario) | measure_contact(trajectory, self._scenario.slider)
        if "max_error_m" not in found:
            found["max_error_m"] = max_error_m(trajectory, self.exact(trajectory.t))
        return Metrics.of(found)

    def describe(self) -> dict[str, Any]:
        """See Case.describe; scales : what a figure is measured against, in its own unit."""
        slider, said = self._scenario.slider, describe(self._scenario)
        row = {"slider": said["slider"], "setup": said, "exact": self._kind.answers(self._scenario)}
        truth = {"omega_n": slider.omega_n, "zeta": slider.zeta, "x_k": slider.x_k}
        return said | {"truth": truth, "scales": {one.metric: one.scale(row) for one in self._kind.figures}}

    def conclusions(self, traces: Sequence[TraceResult]) -> list[str]:
        """See Case.conclusions."""
        return conclusions(traces, self._scenario)

    def export(self, folder: Path) -> None:
        """See Case.export."""
        models.export(self._scenario.slider, folder)
