"""A model of the five slots as something to run: the compiled reference, and both engines by their laws."""

import json
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, final

import numpy as np

from harness.app.run.case import Case, SuiteCase
from harness.app.shared.estimates import as_spring
from harness.core.arrays import FloatArray
from harness.core.checks import positive
from harness.core.errors import InputError
from harness.core.events import EventKind, Mode
from harness.core.quantity import Quantity
from harness.core.recording import Recording
from harness.core.scenario import Scenario
from harness.core.trajectory import Trajectory
from harness.engines import model_files
from harness.engines.base import Engine, Preset
from harness.engines.simulator import EngineSimulator
from harness.estimate.every import estimate_all
from harness.estimate.result import Estimation
from harness.exact.decay import rounded_up
from harness.fidelity import metrics as figures
from harness.fidelity.row import scenario_of
from harness.kernels.solve import Scales, simulate
from harness.model import document
from harness.model.beyond import beyond
from harness.model.model import Model, Restoring
from harness.model.term import Slot
from harness.results.run import Metrics, TraceResult
from harness.robot.own_model import OwnModel
from harness.robot.paste import stiff_friction
from harness.show.sentences.run import position_error

_PERIODS = 10.0
_LONGEST = 200.0
_LOOKS = 4000
"""Samples at which a motion is held against the range of a table."""


@dataclass(frozen=True, slots=True)
class ModelScenario:
    """A model to run from its release on for ``duration`` s. own : the file that it is read from, where that is an
    engine's own.
    """

    model: Model
    duration: float
    name: str = "model"
    own: OwnModel | None = None

    @classmethod
    def of(
        cls, model: Model, duration: float | None, label: str = "model", own: OwnModel | None = None
    ) -> "ModelScenario":
        """A model for ``duration`` s; None is a fifth longer than it takes to stick, or ten periods.

        Raises InputError for a model that does not move, and for one whose duration cannot be guessed.
        """
        if duration is not None:
            return cls(model, positive("--duration", duration, "s"), own=own)
        if model.restoring is Restoring.NONE:
            raise InputError(label, "a free axis, without a period", "--duration is needed with it")
        return cls(model, _long_enough(model), own=own)

    @property
    def omega(self) -> float:
        """Of its swing, rad/s."""
        return Scales.of(self.model).omega


def _long_enough(model: Model) -> float:
    """A fifth longer than it takes to stick, ten periods where that takes longer than two hundred; two digits, s."""
    period = 2.0 * math.pi / Scales.of(model).omega
    motion = simulate(model, model.t0 + np.linspace(0.0, _LONGEST * period, int(40 * _LONGEST)), tolerance=1e-8)
    sticks = motion.events.of(EventKind.STICK).t
    rests = motion.mode is not None and motion.mode[-1] == Mode.STICK and sticks.size
    return rounded_up(1.2 * (float(sticks[-1]) - model.t0) if rests else _PERIODS * period)


@final
class ModelCase(Case):
    """A model in the reference and in the engines, in time since release."""

    def __init__(self, scenario: ModelScenario) -> None:
        self._scenario, self._model = scenario, scenario.model
        self.decays = True
        self.file_name = model_files.file_name(self._model)

    def exact(self, t: FloatArray) -> Trajectory:
        """See Case.exact; the event-driven integrator."""
        motion = simulate(self._model, t + self._model.t0)
        events = replace(motion.events, t=motion.events.t - self._model.t0)
        return replace(motion, t=t, events=events)

    def simulated(self, engine: Engine, preset: Preset, dt: float | None) -> Trajectory:
        """See Case.simulated; as shipped the engine of the user's file has the file's options and step."""
        own = self._scenario.own
        if own is not None and preset == "as-shipped" and engine.name == own.engine:
            return own.simulator(self._model, self._scenario.duration, own.dt, None)
        return EngineSimulator(engine, preset)(self._model, self._scenario.duration, dt, None)

    def metrics(self, trajectory: Trajectory) -> Metrics:
        """See Case.metrics; lead and energy are figures of the base model and are left out."""
        exact = self.exact(trajectory.t)
        speed = float(np.max(np.abs(exact.v)))
        return Metrics.of(
            {
                "max_error_m": figures.max_error_m(trajectory, exact),
                "rest_error_m": figures.rest_error_m(trajectory, exact),
                "stick_time_s": figures.stick_time_s(trajectory, figures.STILL * speed),
                "creep_m_s": figures.creep_m_s(trajectory, exact),
                "half_cycles": figures.half_cycles(trajectory, figures.SWING * speed),
            }
        )

    def estimated(self, trajectory: Trajectory) -> Estimation:
        """See Case.estimated; a pendulum's trace is read as that of the spring it would be."""
        if self._model.restoring is not Restoring.PENDULUM:
            return super().estimated(trajectory)
        measured = Recording(
            trajectory.t, {"x": trajectory.x, "a": trajectory.a}, trajectory.source.label, angular=True
        )
        try:
            spring = as_spring(measured)
        except InputError as error:
            return Estimation({}, Quantity.refused("rad", str(error)), warnings=(str(error),))
        return estimate_all(spring.t, x=spring["x"], a=spring["a"], unit="rad")

    def describe(self) -> dict[str, Any]:
        """See Case.describe."""
        model = self._model
        said: dict[str, Any] = {
            "name": self._scenario.name,
            "slider": {"m": model.m, "c": model.c, "k": model.k, "f_k": model.f_k},
            "release": {"x0": model.x0, "v0": model.v0},
            "duration_s": self._scenario.duration,
            "model": document.to_document(model),
        }
        if model.restoring is not Restoring.NONE:
            omega = math.sqrt(model.k / model.m)
            zeta = model.c / (2.0 * math.sqrt(model.k * model.m))
            said["truth"] = {"omega_n": omega, "zeta": zeta, "x_k": model.f_k / model.k}
        return said

    def conclusions(self, traces: Sequence[TraceResult]) -> list[str]:
        """See Case.conclusions."""
        said = [
            f"{entry.term.name}: {entry.term.say(dict(zip(entry.term.names, map(_digits, entry.values), strict=True)))}"
            for entry in self._model.terms
        ]
        if any(entry.term.known is not None for entry in self._model.terms):
            motion = self.exact(np.linspace(0.0, self._scenario.duration, _LOOKS))
            said += beyond(self._model, motion.x, motion.v)
        if sensors := self._model.in_slot(Slot.OBSERVATION):
            names = ", ".join(entry.term.name for entry in sensors)
            said.append(
                f"What is shown is the motion itself: {names} change what a sensor makes of it, not the motion."
            )
        if self._model.terms:
            said.append("The estimators know viscous and dry friction alone; what else acts shows in their figures.")
        if (own := self._scenario.own) is not None:
            said.append(f"{own.engine} as-shipped has the options of {own.file}, with a step of {1e3 * own.dt:.4g} ms.")
            if own.engine == "mujoco" and self._model.f_k > 0.0:
                words = " ".join(f'{name}="{value}"' for name, value in stiff_friction(own.dt).items())
                said.append(f"For friction as stiff as that step allows, paste into its joint: <joint {words}/>.")
        turns = self._model.restoring is Restoring.PENDULUM
        for trace in traces:
            if trace.error is not None:
                said.append(f"{trace.source} {trace.preset} could not be run: {trace.error}")
            elif trace.source != "reference" and (text := position_error(trace, turns)) is not None:
                said.append(f"{trace.source} {trace.preset}: {text}")
        return said

    def export(self, folder: Path) -> None:
        """See Case.export; with model.json and a list of what the formats cannot say."""
        model_files.export(self._model, folder)
        text = json.dumps(document.to_document(self._model), indent=2, allow_nan=False)
        (folder / "model.json").write_text(text + "\n", encoding="utf-8")


def _digits(value: float) -> str:
    return f"{value:.6g}"


def case_of(scenario: Scenario | ModelScenario) -> Case:
    """The case of a scenario."""
    return ModelCase(scenario) if isinstance(scenario, ModelScenario) else SuiteCase(scenario)


def case_of_json(data: Mapping[str, Any]) -> Case:
    """The case that ``Case.describe`` made this from. Raises InputError when something is missing."""
    if "model" in data:
        return ModelCase(ModelScenario(document.from_document(data["model"]), float(data["duration_s"])))
    return SuiteCase(scenario_of(data))
