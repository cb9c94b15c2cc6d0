"""An engine with its settings as something that simulates models: what the diagnosis is handed."""

from dataclasses import dataclass, field
from typing import final

from harness.core.trajectory import Trajectory
from harness.engines import registry
from harness.engines.base import Engine, Preset, Settings
from harness.engines.law import Drive
from harness.engines.realise import task_of
from harness.kernels.conditions import Drive as Measured
from harness.model.model import Model


@final
@dataclass(frozen=True, slots=True)
class EngineSimulator:
    """Simulates models in one engine on one preset; ``settings`` are overrides of it."""

    engine: Engine
    preset: Preset = "tuned"
    settings: Settings = field(default_factory=dict)

    @classmethod
    def named(cls, name: str, preset: Preset = "tuned", settings: Settings | None = None) -> "EngineSimulator":
        """By the engine's name; raises InputError for an unknown one, SimulationError for one that is not installed."""
        return cls(registry.load(name), preset, settings or {})

    @property
    def name(self) -> str:
        """Name of the engine."""
        return self.engine.name

    def __call__(self, model: Model, duration: float, dt: float | None, drive: Measured | None) -> Trajectory:
        """See harness.diagnosis.engines.Simulator; dt None is the preset's own step."""
        step = dt if dt is not None else float(self.engine.presets("joint", self.preset)["dt"])
        force = None if drive is None else Drive(drive.t, drive.u)
        task = task_of(model, duration, step, preset=self.preset, settings=self.settings, drive=force)
        return self.engine.simulate(task)
