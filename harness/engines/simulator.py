"""An engine with its settings as something that simulates models: what the diagnosis is handed."""

from dataclasses import dataclass, field, replace
from typing import final

from harness.core.trajectory import Trajectory
from harness.engines import registry
from harness.engines.base import Engine, Preset, Settings
from harness.engines.forces import Drive
from harness.engines.joint_words import Kinds, elements
from harness.engines.realise import task_of
from harness.kernels.solve import Drive as Measured
from harness.model.model import Model, ModelTerm
from harness.model.term import Slot


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
        return self.engine.name

    def __call__(self, model: Model, duration: float, dt: float | None, drive: Measured | None) -> Trajectory:
        """See harness.diagnosis.explain.engines.Simulator; dt None is the preset's own step.

        source.settings["terms"] says how each term was realised.
        """
        step = dt if dt is not None else float(self.engine.presets("joint", self.preset)["dt"])
        lines = None if drive is None else drive.straight
        force = None if lines is None else Drive(lines.t, lines.u)
        native = self._native(model)
        task = task_of(model, duration, step, preset=self.preset, settings=self.settings, drive=force, native=native)
        motion = self.engine.simulate(task)
        terms = {entry.term.key: _how(entry, model.k, native) for entry in model.terms}
        if not terms:
            return motion
        source = replace(motion.source, settings={**motion.source.settings, "terms": terms})
        return replace(motion, source=source)

    def _native(self, model: Model) -> Kinds:
        """Kinds of elements that are left to the engine's joint.

        A friction without a state may look at every other force, so that they all must be laws; a step that is implicit
        in position gives back accelerations that only a linear spring can be taken out of.
        """
        smoothed = any(not law.term.internal for law in model.in_slot(Slot.FRICTION_LAW))
        implicit = self.settings.get("integrator") == "discrete"
        return frozenset() if smoothed or implicit else self.engine.native


def _how(entry: ModelTerm, k: float, native: Kinds) -> str:
    """How an engine was told of a term."""
    if elements(entry, k, native):
        return "attribute of the joint"
    match entry.term.slot:
        case Slot.OBSERVATION:
            return "none: what a sensor makes of the motion"
        case Slot.EVENT:
            return "knock in the driving force, two steps wide"
        case Slot.BREAK_AWAY | Slot.FRICTION_LEVEL | Slot.FRICTION_MODULATION:
            return "limit of the engine's own friction, set in every step"
        case _:
            return "force law, called at every stage of the step"
