"""An outcome in the form of the results."""

import logging
import shlex
from collections.abc import Mapping
from dataclasses import asdict, replace
from typing import Any

from harness.app.compare.compare import channel_pair
from harness.app.diagnose.attribution import Configured, Shared, attribution_of, simulator_of
from harness.app.diagnose.mismatch import places
from harness.app.diagnose.options import DiagnoseOptions
from harness.app.diagnose.problem import Prepared
from harness.app.shared.machine import this_machine
from harness.app.shared.reading import recording_info
from harness.core.arrays import FloatArray
from harness.core.errors import SimulationError
from harness.core.quantity import Quantity
from harness.core.recording import Recording
from harness.diagnosis.explain.engines import engine_fit
from harness.diagnosis.explain.locate import share_within
from harness.diagnosis.explain.verdict_sentence import sentence_of
from harness.diagnosis.fit.model_fit import Fit
from harness.diagnosis.fit.rmse import fit_percent, rmse
from harness.diagnosis.fit.standard_errors import unit_of
from harness.diagnosis.outcome import Holdout, Mechanism, Outcome, Prediction, Surface, Table
from harness.diagnosis.problem import Problem
from harness.diagnosis.tables.describe import gauge_of
from harness.model.document import to_document
from harness.model.model import Model
from harness.results.common import ModelDocument, P, RecordingInfo, Where
from harness.results.diagnosis import (
    AlternativeResult,
    DiagnosisResult,
    EngineResult,
    EvidenceResult,
    FitPercent,
    FitResult,
    ForcedResult,
    HoldoutResult,
    HypothesisResult,
    MechanismResult,
    NearResult,
    PredictionResult,
    ReadResult,
    RemainderResult,
    RuleResult,
    SurfaceResult,
    TableResult,
)

LOGGER = logging.getLogger(__name__)
_NOT_GIVEN = "whose mismatch it is, was not divided: an engine is not given covariates"
_NOT_TOGETHER = "whose mismatch it is, is divided for one recording at a time: diagnose each without --together"


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
    shared = _shared(recording, outcome, options, user)
    return DiagnosisResult(
        recording=_info(recording, prepared, problem),
        read=_read(recording, options),
        verdict=outcome.verdict,
        statement=sentence_of(outcome, shared.has),
        baseline=_fit_result(outcome.base, outcome, outcome.base_parameters),
        where=places(outcome),
        mechanisms=[_mechanism(m, outcome) for m in outcome.mechanisms],
        posterior=[HypothesisResult(names=list(h.names), probability=h.probability) for h in outcome.posterior],
        refined=_fit_result(outcome.refined, outcome, outcome.refined_parameters),
        remainder=None if outcome.remainder is None else RemainderResult(**asdict(outcome.remainder)),
        tables=[_table(table, problem) for table in outcome.tables],
        surface=None if outcome.surface is None else _surface(outcome.surface, problem),
        fit_percent=FitPercent(
            baseline=fit_percent(outcome.base.shown.y, problem), refined=fit_percent(outcome.refined.shown.y, problem)
        ),
        rules=[RuleResult(name=r.name, value=r.value, unit=r.unit, origin=r.origin) for r in outcome.rules],
        holdout=_held_out(outcome.holdout, list(problem.covariates)),
        bounded=outcome.bounded,
        engines=engines,
        attribution=shared.result,
        evidence=_evidence(outcome),
        consistent_channels={"-".join(found.pair): channel_pair(found) for found in prepared.channels},
        next_experiment=outcome.next_experiment,
        residual_map=None,
        baseline_model=_document(outcome.base.model),
        refined_model=_document(outcome.refined.model),
        model_left_out=[f"{one.said}: no model file holds a covariate" for one in outcome.refined.model.covariates],
        warnings=[*prepared.warnings, *outcome.warnings, *shared.warnings],
        settings=options.settings(),
        command=command,
        machine=this_machine(),
        files={},
    )


def _shared(recording: Recording, outcome: Outcome, options: DiagnoseOptions, user: Configured) -> Shared:
    if outcome.problem.covariates:
        return Shared(None, (_NOT_GIVEN,))
    if outcome.problem.alone:
        return Shared(None, (_NOT_TOGETHER,))
    whole = outcome.problem.at_every_sample(recording.t, recording.channels)
    return attribution_of(outcome, whole, options, user)


def _held_out(held: Holdout, given: list[str]) -> HoldoutResult:
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
        given=given,
    )


def _info(recording: Recording, prepared: Prepared, problem: Problem) -> RecordingInfo:
    about = recording_info(recording, problem.noise)
    return about.model_copy(update={"notes": [*about.notes, *map(_sentence, prepared.notes)]})


def _read(recording: Recording, options: DiagnoseOptions) -> ReadResult | None:
    if not recording.columns:
        return None
    columns = dict(recording.columns)
    said = replace(options.reading, columns=",".join(f"{c}={product}" for c, product in columns.items()))
    command = f"harness diagnose {shlex.quote(recording.file)} {said.pasted}"
    return ReadResult(command=command, columns=columns, mended=list(recording.mended))


def _sentence(note: str) -> str:
    return f"{note[0].upper()}{note[1:]}."


def _document(model: Model) -> ModelDocument:
    return ModelDocument.model_validate(to_document(model))


def _fit_result(found: Fit, outcome: Outcome, of: Mapping[str, Quantity]) -> FitResult:
    return FitResult(
        parameters={name: P.of(quantity) for name, quantity in of.items()},
        rmse=rmse(found.shown.y, outcome.problem),
        chi2_per_point=outcome.chi2_per_point(found),
    )


def _mechanism(mechanism: Mechanism, outcome: Outcome) -> MechanismResult:
    return MechanismResult(
        name=mechanism.name,
        family=mechanism.entry.term.family,
        variant=mechanism.entry.term.variant,
        statement=mechanism.statement,
        parameters={name: P.of(quantity) for name, quantity in mechanism.parameters.items()},
        delta_bic=mechanism.delta_bic,
        grade=mechanism.grade.value,
        share=mechanism.share,
        chance=mechanism.chance,
        probability=mechanism.probability,
        holdout=_predicted(mechanism.held_out),
        forward=_predicted(mechanism.forward),
        where=where_of(mechanism, outcome),
        alternatives=[AlternativeResult(name=a.name, delta_bic=a.delta_bic) for a in mechanism.alternatives],
    )


def _table(table: Table, problem: Problem) -> TableResult:
    return TableResult(
        form=table.form,
        of=table.of,
        at=table.at.tolist(),
        at_unit=unit_of("m" if table.of == "x" else "m/s", problem),
        force=table.force.tolist(),
        stderr=table.stderr.tolist(),
        force_unit=unit_of("N", problem),
        gauge=gauge_of(table),
        described=table.described,
        nearest=[NearResult(name=name, share=share) for name, share in table.nearest],
    )


def _surface(surface: Surface, problem: Problem) -> SurfaceResult:
    def where_known(values: FloatArray) -> list[list[float | None]]:
        rows = zip(values.tolist(), surface.known.tolist(), strict=True)
        return [[y if known else None for y, known in zip(*row, strict=True)] for row in rows]

    return SurfaceResult(
        x=surface.x.tolist(),
        x_unit=unit_of("m", problem),
        v=surface.v.tolist(),
        v_unit=unit_of("m/s", problem),
        force=where_known(surface.force),
        stderr=where_known(surface.stderr),
        force_unit=unit_of("N", problem),
        gauge="no force of position alone and none of speed alone, which are the other tables'",
        described=surface.described,
    )


def _predicted(found: Prediction | None) -> PredictionResult | None:
    if found is None:
        return None
    return PredictionResult(
        baseline_rmse=dict(found.baseline_rmse),
        refined_rmse=dict(found.refined_rmse),
        blocks=list(found.ratios),
        spans_s=[[low, high] for low, high in found.spans],
    )


def _evidence(outcome: Outcome) -> list[EvidenceResult]:
    """The best of each name, best first."""
    ordered = sorted(outcome.evidence, key=lambda one: -one.delta_bic)
    best = {one.name: one for one in reversed(ordered)}
    return [EvidenceResult(**asdict(one)) for one in ordered if best[one.name] is one]


def _in_engine(name: str, outcome: Outcome, options: DiagnoseOptions) -> EngineResult:
    """Both models in one engine, or the reason why not."""
    try:
        if outcome.problem.covariates:
            raise SimulationError("an engine is not given covariates")
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


def where_of(mechanism: Mechanism, outcome: Outcome) -> Where:
    """Place of a mechanism; its share is of the baseline's mean square mismatch, in units of the noise."""
    place = mechanism.place
    share = share_within(place, outcome.base, outcome.problem)
    time_s = [[low, high] for low, high in place.spans]
    return Where(time_s=time_s, regime=place.regime, condition=place.condition, share=share)
