"""An outcome in the form of the results."""

import logging
from dataclasses import replace
from typing import Any

from harness.app.compare import channel_pair
from harness.app.diagnose_mismatch import places
from harness.app.diagnose_options import DiagnoseOptions
from harness.app.diagnose_problem import Prepared
from harness.app.diagnose_where import where_of
from harness.app.machine import this_machine
from harness.app.reading import read, recording_info
from harness.core.errors import SimulationError
from harness.core.recording import Recording
from harness.diagnosis.attribute import Attribution, attribute_engine, attribute_trace
from harness.diagnosis.engines import engine_fit, rmse
from harness.diagnosis.fit import Fit
from harness.diagnosis.outcome import Mechanism, Outcome
from harness.diagnosis.problem import Problem
from harness.engines.simulator import EngineSimulator
from harness.io.recording import ReadOptions
from harness.model.document import load as load_model
from harness.model.document import to_document
from harness.model.model import Model
from harness.results.common import P, RecordingInfo
from harness.results.diagnosis import (
    AlternativeResult,
    AttributionResult,
    DiagnosisResult,
    EngineResult,
    EvidenceResult,
    FitResult,
    HoldoutResult,
    MechanismResult,
)
from harness.results.model import ModelDocument

LOGGER = logging.getLogger(__name__)

_NOTHING = "Viscous and Coulomb friction explain this recording to its noise: nothing is left out that it could show."
_NOBODY = (
    "Viscous and Coulomb friction do not explain this recording, and neither does any entry or pair of the catalogue:"
    " what was left out is not known to this program."
)


def sentence_of(outcome: Outcome) -> str:
    """The verdict in a sentence."""
    if outcome.verdict == "adequate":
        return _NOTHING
    if outcome.verdict == "unexplained":
        return _NOBODY
    said = " ".join(m.statement for m in outcome.mechanisms)
    names = " and ".join(m.name.replace("-", " ") for m in outcome.mechanisms)
    return f"The simulation leaves out {names}: {said}"


def result_of(
    recording: Recording, prepared: Prepared, outcome: Outcome, options: DiagnoseOptions, command: str = ""
) -> DiagnosisResult:
    """Everything a result says but its files; runs both models in the engines.

    Raises InputError for a --model or --sim that cannot be used.
    """
    problem = outcome.problem
    engines = {name: _in_engine(name, outcome, options) for name in options.engines}
    return DiagnosisResult(
        recording=_info(recording, prepared, problem),
        verdict=outcome.verdict,
        statement=sentence_of(outcome),
        baseline=_fit_result(outcome.base, problem, {n: P.of(q) for n, q in outcome.base_parameters.items()}),
        where=places(outcome),
        mechanisms=[_mechanism(m, outcome) for m in outcome.mechanisms],
        refined=_fit_result(outcome.refined, problem, {n: P.of(q) for n, q in outcome.refined_parameters.items()}),
        holdout=HoldoutResult(
            spans_s=[[low, high] for low, high in outcome.holdout.spans],
            baseline_rmse=dict(outcome.holdout.baseline_rmse),
            refined_rmse=dict(outcome.holdout.refined_rmse),
        ),
        engines=engines,
        attribution=_attribution(outcome, options),
        evidence=_evidence(outcome),
        consistent_channels={"-".join(found.pair): channel_pair(found) for found in prepared.channels},
        next_experiment=outcome.next_experiment,
        residual_map=None,
        baseline_model=_document(outcome.base.model),
        refined_model=_document(outcome.refined.model),
        model_left_out=[],
        warnings=[*prepared.warnings, *outcome.warnings],
        settings=options.settings(),
        command=command,
        machine=this_machine(),
        files={},
    )


def _info(recording: Recording, prepared: Prepared, problem: Problem) -> RecordingInfo:
    about = recording_info(recording, problem.noise)
    return about.model_copy(update={"notes": [*about.notes, *map(_sentence, prepared.notes)]})


def _sentence(note: str) -> str:
    return f"{note[0].upper()}{note[1:]}."


def _document(model: Model) -> ModelDocument:
    return ModelDocument.model_validate(to_document(model))


def _fit_result(found: Fit, problem: Problem, parameters: dict[str, P]) -> FitResult:
    return FitResult(
        parameters=parameters, rmse=rmse(found.shown.y, problem), chi2_per_point=found.chi2 / max(problem.points, 1)
    )


def _mechanism(mechanism: Mechanism, outcome: Outcome) -> MechanismResult:
    return MechanismResult(
        name=mechanism.name,
        family=mechanism.entry.term.family,
        variant=mechanism.entry.term.variant,
        statement=mechanism.statement,
        parameters={name: P.of(quantity) for name, quantity in mechanism.parameters.items()},
        delta_bic=mechanism.delta_bic,
        where=where_of(mechanism, outcome),
        alternatives=[AlternativeResult(name=a.name, delta_bic=a.delta_bic) for a in mechanism.alternatives],
    )


def _evidence(outcome: Outcome) -> list[EvidenceResult]:
    """The best of each name, best first."""
    best: dict[str, float] = {}
    for name, delta in outcome.evidence:
        best[name] = max(delta, best.get(name, delta))
    ordered = sorted(best.items(), key=lambda item: -item[1])
    return [EvidenceResult(name=name, delta_bic=delta) for name, delta in ordered]


def _simulator(name: str, options: DiagnoseOptions) -> tuple[EngineSimulator, float | None]:
    """An engine on the preset that was asked for, and its step in s; None: one that suits the recording."""
    simulator = EngineSimulator.named(name, options.preset)
    if options.preset == "as-shipped":
        return simulator, float(simulator.engine.presets("joint", options.preset)["dt"])
    return simulator, options.dt


def _in_engine(name: str, outcome: Outcome, options: DiagnoseOptions) -> EngineResult:
    """Both models in one engine, or the reason why not."""
    try:
        simulator, dt = _simulator(name, options)
        found = engine_fit(simulator, outcome.base.model, outcome.refined.model, outcome.problem, outcome.scales, dt)
    except SimulationError as error:
        LOGGER.warning("%s: %s", name, error)
        return EngineResult(settings={}, baseline_rmse={}, refined_rmse={}, error=str(error))
    return EngineResult(
        settings=_plain(found.settings),
        baseline_rmse=dict(found.baseline_rmse),
        refined_rmse=dict(found.refined_rmse),
        own_error=dict(found.own_error),
        version=simulator.engine.version(),
        ignored=list(found.ignored),
    )


def _plain(settings: Any) -> dict[str, Any]:
    """Settings as JSON has them."""
    return {k: list(v) if isinstance(v, tuple) else v for k, v in settings.items()}


def configured(outcome: Outcome, options: DiagnoseOptions) -> Model:
    """The user's model, released as the recording was where the file does not say; the base fit when there is none."""
    base = outcome.base.model
    if options.model is None:
        return base
    model = load_model(options.model)
    if model.x0 == 0.0 and model.v0 == 0.0:
        return replace(model, x0=base.x0, v0=base.v0, t0=base.t0)
    return model


def _attribution(outcome: Outcome, options: DiagnoseOptions) -> AttributionResult | None:
    model, base, refined = configured(outcome, options), outcome.base.model, outcome.refined.model
    parameters = "the baseline fit's parameters" if options.model is None else f"the parameters in {options.model}"
    if options.sim is not None:
        trace = read(options.sim, ReadOptions())
        found = attribute_trace(trace, model, base, refined, outcome.problem, outcome.scales)
        moved = "" if not found.shift else f", moved by {found.shift:.4g} s"
        return _shares(found, f"the trace {options.sim}{moved}, against {parameters}")
    for name in options.engines:
        try:
            simulator, dt = _simulator(name, options)
            step = dt if dt is not None else float(simulator.engine.presets("joint", options.preset)["dt"])
            found = attribute_engine(simulator, model, base, refined, outcome.problem, outcome.scales, step)
        except SimulationError as error:
            LOGGER.warning("attribution, %s: %s", name, error)
            continue
        return _shares(found, f"{name}, {options.preset}, step {step * 1e3:.4g} ms, at {parameters}")
    return None


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
