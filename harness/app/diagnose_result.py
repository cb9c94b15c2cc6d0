"""An outcome in the form of the results."""

import logging
from typing import Any

from harness.app.compare import channel_pair
from harness.app.diagnose_attribution import Configured, attribution_of, simulator_of
from harness.app.diagnose_mismatch import places
from harness.app.diagnose_options import DiagnoseOptions
from harness.app.diagnose_problem import Prepared
from harness.app.diagnose_where import where_of
from harness.app.machine import this_machine
from harness.app.reading import recording_info
from harness.core.errors import SimulationError
from harness.core.recording import Recording
from harness.diagnosis.engines import engine_fit
from harness.diagnosis.fit import Fit
from harness.diagnosis.outcome import Holdout, Mechanism, Outcome
from harness.diagnosis.problem import Problem
from harness.diagnosis.rmse import rmse
from harness.model.document import to_document
from harness.model.model import Model
from harness.results.common import P, RecordingInfo
from harness.results.diagnosis import (
    AlternativeResult,
    DiagnosisResult,
    EngineResult,
    EvidenceResult,
    FitResult,
    ForcedResult,
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
    recording: Recording,
    prepared: Prepared,
    outcome: Outcome,
    options: DiagnoseOptions,
    user: Configured,
    command: str = "",
) -> DiagnosisResult:
    """Everything a result says but its files; runs both models in the engines.

    Raises InputError for a --sim that has nothing in common with the recording.
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
        holdout=_held_out(outcome.holdout),
        engines=engines,
        attribution=attribution_of(outcome, options, user),
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


def _held_out(held: Holdout) -> HoldoutResult:
    forced = None
    if held.forced is not None:
        forced = ForcedResult(
            name=held.forced.name,
            baseline_rmse=dict(held.forced.baseline_rmse),
            refined_rmse=dict(held.forced.refined_rmse),
        )
    return HoldoutResult(
        spans_s=[[low, high] for low, high in held.spans],
        baseline_rmse=dict(held.baseline_rmse),
        refined_rmse=dict(held.refined_rmse),
        forced=forced,
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
        parameters=parameters, rmse=rmse(found.shown.y, problem), chi2_per_point=found.chi2 / max(found.points, 1)
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


def _in_engine(name: str, outcome: Outcome, options: DiagnoseOptions) -> EngineResult:
    """Both models in one engine, or the reason why not."""
    try:
        simulator, dt = simulator_of(name, options)
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
