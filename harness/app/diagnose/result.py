"""An outcome in the form of the results."""

import logging
import shlex
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

from harness.app.diagnose.attribution import Configured, Shared, attribution_of, simulator_of
from harness.app.diagnose.options import DiagnoseOptions
from harness.app.diagnose.problem import Prepared, Validation, validated
from harness.app.shared.leaving import curves_of
from harness.app.shared.machine import this_machine
from harness.app.shared.reading import recording_info
from harness.core.arrays import FloatArray
from harness.core.errors import SimulationError
from harness.core.events import Mode
from harness.core.quantity import Quantity
from harness.core.recording import Recording
from harness.core.trajectory import Trajectory
from harness.core.wording import capitalised
from harness.diagnosis.explain.engines import engine_fit
from harness.diagnosis.explain.force_map import ForceMap
from harness.diagnosis.explain.locate import Place, locate, share_within
from harness.diagnosis.explain.seen_law import curve_law, seen_laws
from harness.diagnosis.explain.sentences import sentence_of
from harness.diagnosis.fit.model_fit import Fit
from harness.diagnosis.fit.rmse import fit_percent, rmse
from harness.diagnosis.fit.standard_errors import unit_of
from harness.diagnosis.kinds.known import kind_of
from harness.diagnosis.motion import Motion
from harness.diagnosis.outcome import Mechanism, Outcome, Prediction, Surface, Tried
from harness.diagnosis.problem import Problem
from harness.diagnosis.tables.describe import gauge_of
from harness.model.document import to_document
from harness.results.common import Curves, MotionResult, Where
from harness.results.compare import ChannelPair
from harness.results.diagnosis import (
    DiagnosisResult,
    EngineResult,
    FitPercent,
    FitResult,
    HoldoutResult,
    MechanismResult,
    PredictionResult,
    ReadResult,
    SeenLawResult,
    SurfaceResult,
    TableResult,
)
from harness.show.report.diagnosis_figures import YOUR_SIMULATION, model_names, yours
from harness.show.stored import Shown

STEPS = 4
"""Of a diagnosis, as progress counts them."""
LOGGER = logging.getLogger(__name__)
_NOT_GIVEN = "whose mismatch it is, was not divided: an engine is not given covariates"
_NOT_TOGETHER = "whose mismatch it is, is divided for one recording at a time: diagnose each without --together"
_EVERYWHERE = "no part of the motion stands out"


@dataclass(frozen=True, slots=True)
class Diagnosed:
    """A diagnosis with what it rests on.

    simulated : base model and refined model at every time of the recording, behind them the user's own simulation
    where there is one. result : without files. left : the force that the base model leaves over. shown : of a robot.
    """

    recording: Recording
    outcome: Outcome
    simulated: tuple[Trajectory, ...]
    result: DiagnosisResult
    left: ForceMap
    shown: Shown | None = None

    @property
    def curves(self) -> Curves:
        """The recording, and the motion of each model."""
        own = yours(self.simulated)
        models = dict(zip(model_names(self.result), self.simulated, strict=False))
        return curves_of({"recording": self.recording, **models, **({} if own is None else {YOUR_SIMULATION: own})})


def with_laws(result: DiagnosisResult, outcome: Outcome) -> tuple[DiagnosisResult, ForceMap]:
    """The result with its laws beside the recording, and the force that the base model leaves over."""
    problem, kind = outcome.problem, kind_of(outcome.problem)
    left = kind.left_over(problem, outcome.base, outcome.scales)
    named = outcome.mechanisms and outcome.verdict != "unexplained"
    if problem.moves and not named:
        return result, left
    after = kind.left_over(problem, outcome.refined, outcome.scales, left.wander)
    found = seen_laws(outcome, after) if problem.moves else (curve_law(outcome, after),)
    units = {"x": unit_of("m", problem), "v": unit_of("m/s", problem), "t": "s"}
    laws = [SeenLawResult.taken_from(one, at_unit=units[one.over], force_unit=unit_of("N", problem)) for one in found]
    return result.model_copy(update={"laws": laws}), left


def result_of(
    recording: Recording,
    prepared: Prepared,
    outcome: Outcome,
    options: DiagnoseOptions,
    user: Configured,
    other: Validation | None,
    command: str = "",
    **more: Any,
) -> DiagnosisResult:
    """Everything a result says but its files; runs both models in the engines. more : fields of its own.

    Raises InputError for a --sim that has nothing in common with the recording, and for another recording that cannot
    be diagnosed.
    """
    problem, base, refined = outcome.problem, outcome.base, outcome.refined
    engines = {name: _in_engine(name, outcome, options) for name in options.engines}
    shared = _shared(recording, outcome, options, user)
    info = recording_info(recording, problem.noise)
    notes = [*info.notes, *(f"{capitalised(note)}." for note in prepared.notes)]
    covariates, best = outcome.refined.model.covariates, dict[str, Tried]()
    for one in sorted(outcome.evidence, key=lambda one: -one.delta_bic):
        best.setdefault(one.name, one)
    return DiagnosisResult.taken_from(
        outcome,
        recording=info.model_copy(update={"notes": notes}),
        motion=MotionResult.taken_from(prepared.moves, spans_s=prepared.moves.spans),
        read=read_of((recording,), options),
        statement=sentence_of(outcome, shared.has),
        baseline=_fit_result(base, outcome, outcome.base_parameters),
        where=_places(outcome),
        mechanisms=[_mechanism(m, outcome) for m in outcome.mechanisms],
        refined=_fit_result(refined, outcome, outcome.refined_parameters),
        tables=[
            TableResult.taken_from(
                table,
                at_unit=unit_of("m" if table.of == "x" else "m/s", problem),
                force_unit=unit_of("N", problem),
                gauge=gauge_of(table),
                nearest=[{"name": name, "share": share} for name, share in table.nearest],
            )
            for table in outcome.tables
        ],
        surface=None if outcome.surface is None else _surface(outcome.surface, problem),
        fit_percent=FitPercent(
            baseline=fit_percent(base.shown.y, problem), refined=fit_percent(refined.shown.y, problem)
        ),
        holdout=HoldoutResult.taken_from(
            outcome.holdout, spans_s=outcome.holdout.spans, given=list(problem.covariates)
        ),
        engines=engines,
        attribution=shared.result,
        evidence=list(best.values()),
        consistent_channels={"-".join(c.pair): ChannelPair.taken_from(c, lag_s=c.lag) for c in prepared.channels},
        residual_map=None,
        baseline_model=to_document(base.model),
        refined_model=to_document(refined.model),
        model_left_out=[f"{one.said}: no model file holds a covariate" for one in covariates],
        warnings=[*problem.choices, *prepared.warnings, *outcome.warnings, *shared.warnings],
        settings=options.settings(),
        validation=None if other is None else validated(other, outcome, options),
        command=command,
        machine=this_machine(),
        files={},
        **more,
    )


def _shared(recording: Recording, outcome: Outcome, options: DiagnoseOptions, user: Configured) -> Shared:
    if outcome.problem.covariates:
        return Shared(None, (_NOT_GIVEN,))
    if outcome.problem.alone:
        return Shared(None, (_NOT_TOGETHER,))
    if not outcome.problem.moves:
        return Shared(None, ())
    whole = outcome.problem.at_every_sample(recording.t, recording.channels)
    return attribution_of(outcome, whole, options, user)


def read_of(recordings: Sequence[Recording], options: DiagnoseOptions) -> ReadResult | None:
    """The command that reads recordings of one machine, as the first of them was read."""
    first = recordings[0]
    if not first.columns:
        return None
    columns = dict(first.columns)
    said = replace(options.reading, columns=",".join(f"{c}={product}" for c, product in columns.items()))
    files = dict.fromkeys(shlex.quote(one.file.removesuffix(f" run {k}")) for k, one in enumerate(recordings, 1))
    together = " --together" if len(recordings) > 1 else ""
    command = f"harness diagnose {' '.join(files)} {said.pasted}{together}"
    return ReadResult(command=command, columns=columns, mended=list(first.mended))


def _fit_result(found: Fit, outcome: Outcome, of: Mapping[str, Quantity]) -> FitResult:
    left = rmse(found.shown.y, outcome.problem)
    return FitResult.taken_from(found, parameters=of, rmse=left, chi2_per_point=outcome.chi2_per_point(found))


def _places(outcome: Outcome) -> list[Where]:
    """Up to three places that hold the base model's mismatch; the whole, where there is one that lies nowhere apart."""
    problem, shown = outcome.problem, outcome.base.shown
    residuals = problem.by_sample(outcome.base.residual)
    motion = Motion(shown.x, shown.v, shown.mode == Mode.STICK, outcome.scales.omega)
    found = locate(residuals, problem.t, motion, unit="rad" if problem.angular else "m")
    if not found and outcome.verdict != "adequate":
        found = (Place(((float(problem.t[0]), float(problem.t[-1])),), "throughout", _EVERYWHERE, 1.0, 0.0),)
    return [Where.taken_from(place, time_s=place.spans) for place in found]


def _mechanism(mechanism: Mechanism, outcome: Outcome) -> MechanismResult:
    """Its share of the mismatch where it acts is of the baseline's mean square, in units of the noise."""
    term, place = mechanism.entry.term, mechanism.place
    share = share_within(place, outcome.base, outcome.problem)
    return MechanismResult.taken_from(
        mechanism,
        family=term.family,
        variant=term.variant,
        holdout=_predicted(mechanism.held_out),
        forward=_predicted(mechanism.forward),
        where=Where.taken_from(place, time_s=place.spans, share=share),
    )


def _predicted(found: Prediction | None) -> PredictionResult | None:
    return None if found is None else PredictionResult.taken_from(found, blocks=found.ratios, spans_s=found.spans)


def _surface(surface: Surface, problem: Problem) -> SurfaceResult:
    def where_known(values: FloatArray) -> list[list[float | None]]:
        rows = zip(values.tolist(), surface.known.tolist(), strict=True)
        return [[y if known else None for y, known in zip(*row, strict=True)] for row in rows]

    return SurfaceResult.taken_from(
        surface,
        x_unit=unit_of("m", problem),
        v_unit=unit_of("m/s", problem),
        force=where_known(surface.force),
        stderr=where_known(surface.stderr),
        force_unit=unit_of("N", problem),
        gauge="no force of position alone and none of speed alone, which are the other tables'",
    )


def _in_engine(name: str, outcome: Outcome, options: DiagnoseOptions) -> EngineResult:
    """Both models in one engine, or the reason why not."""
    try:
        if outcome.problem.covariates:
            raise SimulationError("an engine is not given covariates")
        if not outcome.problem.moves:
            raise SimulationError("a friction curve has no motion to be run beside")
        simulator, dt = simulator_of(name, options)
        found = engine_fit(simulator, outcome.base.model, outcome.refined.model, outcome.problem, outcome.scales, dt)
    except SimulationError as error:
        LOGGER.warning("%s: %s", name, error)
        return EngineResult(settings={}, baseline_rmse={}, refined_rmse={}, error=str(error))
    return EngineResult.taken_from(found, version=simulator.engine.version())
