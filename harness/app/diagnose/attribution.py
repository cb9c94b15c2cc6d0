"""Whose mismatch it is: the simulation as the user has it, engine or trace, against the recording."""

import logging
from dataclasses import dataclass, replace
from pathlib import Path

from harness.app.diagnose.options import DiagnoseOptions
from harness.app.shared.reading import ReadOptions, read
from harness.core.errors import SimulationError
from harness.core.recording import Recording
from harness.diagnosis.explain.attribution import Attribution, attribute_engine, attribute_trace
from harness.diagnosis.outcome import Outcome
from harness.engines.simulator import EngineSimulator
from harness.model.document import load as load_model
from harness.model.model import Model
from harness.results.diagnosis import AttributionResult

LOGGER = logging.getLogger(__name__)


@dataclass(frozen=True, slots=True)
class Configured:
    """The simulation as the user has it: model of --model and trace of --sim, None where none was given."""

    model: Model | None = None
    trace: Recording | None = None

    @classmethod
    def of(cls, options: DiagnoseOptions) -> "Configured":
        """Read the files; raises InputError for one that cannot be used."""
        model = load_model(options.model) if isinstance(options.model, Path) else options.model
        return cls(model, read(options.sim, ReadOptions()) if isinstance(options.sim, Path) else options.sim)

    def released(self, base: Model) -> Model:
        """The user's model, released as the recording was where the file does not say; ``base`` when there is none."""
        if self.model is None:
            return base
        if self.model.x0 == 0.0 and self.model.v0 == 0.0:
            return replace(self.model, x0=base.x0, v0=base.v0, t0=base.t0)
        return self.model


def simulator_of(name: str, options: DiagnoseOptions) -> tuple[EngineSimulator, float | None]:
    """An engine on the preset that was asked for, and its step in s; None: one that suits the recording."""
    simulator = EngineSimulator.named(name, options.preset)
    if options.preset == "as-shipped":
        return simulator, float(simulator.engine.presets("joint", options.preset)["dt"])
    return simulator, options.dt


def attribution_of(outcome: Outcome, options: DiagnoseOptions, user: Configured) -> AttributionResult | None:
    """Shares of the mismatch of the user's trace, else of the first engine that runs; None when none does."""
    base, refined = outcome.base.model, outcome.refined.model
    model = user.released(base)
    parameters = (
        "the baseline fit's parameters" if options.model is None else f"the parameters in {_name(options.model)}"
    )
    if user.trace is not None:
        found = attribute_trace(user.trace, model, base, refined, outcome.problem, outcome.scales)
        moved = "" if not found.shift else f", moved by {found.shift:.4g} s"
        return _shares(_with_steps(found, outcome), f"the trace {_name(options.sim)}{moved}, against {parameters}")
    for name in options.engines:
        try:
            simulator, dt = simulator_of(name, options)
            step = dt if dt is not None else float(simulator.engine.presets("joint", options.preset)["dt"])
            found = attribute_engine(simulator, model, base, refined, outcome.problem, outcome.scales, step)
        except SimulationError as error:
            LOGGER.warning("attribution, %s: %s", name, error)
            continue
        configuration = f"{name}, {options.preset}, step {step * 1e3:.4g} ms, at {parameters}"
        return _shares(_with_steps(found, outcome), configuration)
    return None


def _name(given: Path | Recording | Model | None) -> str:
    """What was given, in a sentence."""
    return given.file if isinstance(given, Recording) else str(given) if isinstance(given, Path) else "the given model"


def _with_steps(found: Attribution, outcome: Outcome) -> Attribution:
    """With what the integrator adds to a recording that is the trace of an engine."""
    return found if outcome.stepping is None else found.with_steps(outcome.stepping.left)


def _shares(found: Attribution, configuration: str) -> AttributionResult:
    return AttributionResult(
        engine=found.engine,
        parameters=found.parameters,
        missing_physics=found.missing_physics,
        unexplained=found.unexplained,
        noise=found.noise,
        configuration=configuration,
        mean_square=found.squares.simulated,
    )
