"""What can be run: a scenario of the suite, or a model of the five slots; exact motion, engines and figures.

A model's document alone runs in the compiled reference.
"""

import json
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from os import PathLike
from pathlib import Path
from typing import Any, TypeAlias

import numpy as np

from harness.app.shared.estimates import as_spring
from harness.core.arrays import FloatArray
from harness.core.checks import positive
from harness.core.errors import InputError
from harness.core.events import EventKind, Mode
from harness.core.quantity import Quantity, parameter_unit
from harness.core.recording import Recording
from harness.core.scenario import Scenario
from harness.core.trajectory import Trajectory
from harness.engines import model_files, models
from harness.engines.base import Engine, Preset
from harness.engines.simulator import EngineSimulator
from harness.estimate.every import estimate_all
from harness.estimate.result import Estimation
from harness.exact.decay import rounded_up
from harness.fidelity import metrics as figures
from harness.fidelity.kind import kind_of
from harness.fidelity.metrics import measure_contact
from harness.fidelity.row import describe, scenario_of
from harness.kernels.solve import Scales, simulate
from harness.model import document
from harness.model.document import from_document, load
from harness.model.model import Model, Restoring, beyond
from harness.model.term import Slot
from harness.results.common import ModelDocument
from harness.results.run import Metrics, TraceResult
from harness.robot.own_model import OwnModel
from harness.robot.paste import stiff_friction
from harness.show.sentences import conclusions, position_error

_PERIODS = 10.0
_LONGEST = 200.0
_LOOKS = 4000
"""Samples at which a motion is held against the range of a table."""


class SuiteCase:
    """A scenario of the fidelity suite.

    decays : whether it is a free decay, which the estimators can read. file_name : of the MJCF and URDF that are left.
    """

    file_name = "slider"

    def __init__(self, scenario: Scenario) -> None:
        self._scenario, self._kind = scenario, kind_of(scenario)
        self.decays = scenario.action is None

    def exact(self, t: FloatArray) -> Trajectory:
        """The exact motion at times t (n,) in s; a closed form."""
        return self._kind.exact(self._scenario, t)

    def simulated(self, engine: Engine, preset: Preset, dt: float | None) -> Trajectory:
        """The motion in an engine; dt in s, None for the preset's own. Raises SimulationError."""
        return engine.simulate(engine.task(self._scenario, self._kind.routes[0], preset, dt))

    def metrics(self, trajectory: Trajectory) -> Metrics:
        """The distance from the exact motion, and what the scenario is about."""
        found = self._kind.measure(trajectory, self._scenario)
        found |= measure_contact(trajectory, self._scenario.slider)
        if "max_error_m" not in found:
            found["max_error_m"] = figures.max_error_m(trajectory, self.exact(trajectory.t))
        return Metrics.of(found)

    def estimated(self, trajectory: Trajectory) -> Estimation:
        """What the estimators read of it, from position and acceleration."""
        return estimate_all(trajectory.t, x=trajectory.x, a=trajectory.a)

    def describe(self) -> dict[str, Any]:
        """As a result holds it; scales : what a figure is measured against, in its own unit."""
        slider, said = self._scenario.slider, describe(self._scenario)
        row = {"slider": said["slider"], "setup": said, "exact": self._kind.answers(self._scenario)}
        truth = {"omega_n": slider.omega_n, "zeta": slider.zeta, "x_k": slider.x_k}
        return said | {"truth": truth, "scales": {one.metric: one.scale(row) for one in self._kind.figures}}

    def conclusions(self, traces: Sequence[TraceResult]) -> list[str]:
        """What differs and why, in sentences."""
        return conclusions(traces, self._scenario)

    def export(self, folder: Path) -> None:
        """Write MJCF and URDF, and what belongs to them, into a folder. Raises StoreError."""
        models.export(self._scenario.slider, folder)


@dataclass(frozen=True, slots=True)
class ModelScenario:
    """A model to run for ``duration`` s, in time since its release: in the reference, and in engines by their laws.

    own : the file that it is read from, where that is an engine's own. The methods are those of ``SuiteCase``.
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
            raise InputError(label, "a free axis, without a period", "--duration with it")
        return cls(model, _long_enough(model), own=own)

    @property
    def omega(self) -> float:
        """Of its swing, rad/s."""
        return Scales.of(self.model).omega

    @property
    def decays(self) -> bool:
        return True

    @property
    def file_name(self) -> str:
        """Of the MJCF and URDF that are left."""
        return model_files.file_name(self.model)

    def exact(self, t: FloatArray) -> Trajectory:
        """See SuiteCase.exact; the event-driven integrator."""
        motion = simulate(self.model, t + self.model.t0)
        events = replace(motion.events, t=motion.events.t - self.model.t0)
        return replace(motion, t=t, events=events)

    def simulated(self, engine: Engine, preset: Preset, dt: float | None) -> Trajectory:
        """See SuiteCase.simulated; as shipped the engine of the user's file has the file's options and step."""
        own = self.own
        if own is not None and preset == "as-shipped" and engine.name == own.engine:
            return own.simulator(self.model, self.duration, own.dt, None)
        return EngineSimulator(engine, preset)(self.model, self.duration, dt, None)

    def metrics(self, trajectory: Trajectory) -> Metrics:
        """See SuiteCase.metrics; lead and energy are figures of the base model and are left out."""
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
        """See SuiteCase.estimated; a pendulum's trace is read as that of the spring it would be."""
        if self.model.restoring is not Restoring.PENDULUM:
            return estimate_all(trajectory.t, x=trajectory.x, a=trajectory.a)
        measured = Recording(
            trajectory.t, {"x": trajectory.x, "a": trajectory.a}, trajectory.source.label, angular=True
        )
        try:
            spring = as_spring(measured)
        except InputError as error:
            return Estimation({}, Quantity.refused("rad", str(error)), warnings=(str(error),))
        return estimate_all(spring.t, x=spring["x"], a=spring["a"], unit="rad")

    def describe(self) -> dict[str, Any]:
        model = self.model
        said: dict[str, Any] = {
            "name": self.name,
            "slider": {"m": model.m, "c": model.c, "k": model.k, "f_k": model.f_k},
            "release": {"x0": model.x0, "v0": model.v0},
            "duration_s": self.duration,
            "model": document.to_document(model),
        }
        if model.restoring is not Restoring.NONE:
            omega = math.sqrt(model.k / model.m)
            zeta = model.c / (2.0 * math.sqrt(model.k * model.m))
            said["truth"] = {"omega_n": omega, "zeta": zeta, "x_k": model.f_k / model.k}
        return said

    def conclusions(self, traces: Sequence[TraceResult]) -> list[str]:
        said, own = list[str](), self.own
        turns = self.model.restoring is Restoring.PENDULUM or (own is not None and own.turns)
        for entry in self.model.terms:
            units = (parameter_unit(one.unit, turns, self.model.mass_known) for one in entry.term.parameters)
            values = (
                f"{value:.6g}{'' if unit == '1' else f' {unit}'}"
                for value, unit in zip(entry.values, units, strict=True)
            )
            said.append(f"{entry.term.name}: {entry.term.say(dict(zip(entry.term.names, values, strict=True)))}")
        if any(entry.term.known is not None for entry in self.model.terms):
            motion = self.exact(np.linspace(0.0, self.duration, _LOOKS))
            said += beyond(self.model, motion.x, motion.v)
        if sensors := self.model.in_slot(Slot.OBSERVATION):
            names = ", ".join(entry.term.name for entry in sensors)
            said.append(
                f"What is shown is the motion itself: {names} change what a sensor makes of it, not the motion."
            )
        if self.model.terms:
            said.append("The estimators know viscous and dry friction alone; what else acts shows in their figures.")
        if own is not None:
            said.append(f"{own.engine} as-shipped has the options of {own.file}, with a step of {1e3 * own.dt:.4g} ms.")
            if own.rest:
                said.append(f"x is measured from where the joint rests, which is at {own.rest:.6g} in that file.")
            said += self._beyond_limits(own)
            if own.engine == "mujoco" and self.model.f_k > 0.0:
                words = " ".join(f'{name}="{value}"' for name, value in stiff_friction(own.dt).items())
                said.append(f"For friction as stiff as that step allows, paste into its joint: <joint {words}/>.")
        for trace in traces:
            if trace.error is not None:
                said.append(f"{trace.source} {trace.preset} could not be run: {trace.error}")
            elif trace.source != "reference" and (text := position_error(trace, turns)) is not None:
                said.append(f"{trace.source} {trace.preset}: {text}")
        return said

    def _beyond_limits(self, own: OwnModel) -> list[str]:
        """That the motion passes the end of the joint's range, whose stop is in none of the runs."""
        x = self.exact(np.linspace(0.0, self.duration, _LOOKS)).x
        low, high = own.limits
        if low <= float(np.min(x)) and float(np.max(x)) <= high:
            return []
        unit = "rad" if own.turns else "m"
        return [
            f"The joint's range in that file is {low:.4g} to {high:.4g} {unit}, and the motion goes from"
            f" {np.min(x):.4g} to {np.max(x):.4g} {unit}: the stops at its ends are not simulated here."
        ]

    def export(self, folder: Path) -> None:
        """See SuiteCase.export; with model.json and a list of what the formats cannot say."""
        model_files.export(self.model, folder)
        text = json.dumps(document.to_document(self.model), indent=2, allow_nan=False)
        (folder / "model.json").write_text(text + "\n", encoding="utf-8")


def _long_enough(model: Model) -> float:
    """A fifth longer than it takes to stick, ten periods where that takes longer than two hundred; two digits, s."""
    period = 2.0 * math.pi / Scales.of(model).omega
    motion = simulate(model, model.t0 + np.linspace(0.0, _LONGEST * period, int(40 * _LONGEST)), tolerance=1e-8)
    sticks = motion.events.of(EventKind.STICK).t
    rests = motion.mode is not None and motion.mode[-1] == Mode.STICK and sticks.size
    return rounded_up(1.2 * (float(sticks[-1]) - model.t0) if rests else _PERIODS * period)


Case: TypeAlias = SuiteCase | ModelScenario


def case_of(scenario: Scenario | ModelScenario) -> Case:
    return scenario if isinstance(scenario, ModelScenario) else SuiteCase(scenario)


def case_of_json(data: Mapping[str, Any]) -> Case:
    """The case that ``describe`` made this from. Raises InputError when something is missing."""
    if "model" in data:
        return ModelScenario(document.from_document(data["model"]), float(data["duration_s"]))
    return SuiteCase(scenario_of(data))


Given: TypeAlias = Model | ModelDocument | Mapping[str, Any] | str | PathLike[str]


def motion_of(model: Given, t: FloatArray) -> Trajectory:
    """The motion of a model at times t (n,) in s.

    Before its release a model is held where that begins; one that begins in the middle of a motion has no past.
    Raises InputError for times before that, SimulationError.
    """
    found = model_of(model)
    early = int(np.count_nonzero(t < found.t0))
    if early and found.v0 != 0.0:
        raise InputError(
            "simulate: t",
            f"{early} times before {found.t0:.9g} s, where the model begins and moves already",
            f"times from there on: t[t >= {found.t0!r}]",
        )
    return simulate(found, t)


def model_of(model: Given) -> Model:
    """The model that is given as one, as a result holds it, as plain data, or as a model.json. Raises InputError."""
    if isinstance(model, Model):
        return model
    if isinstance(model, ModelDocument):
        model = model.model_dump(mode="json", by_alias=True)
    return from_document(model) if isinstance(model, Mapping) else load(Path(model))
