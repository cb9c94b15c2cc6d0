"""The result of a diagnosis: harness.diagnosis/2, one object, or an array when several files were given."""

from typing import Annotated, Any, ClassVar, Literal

from pydantic import Field, RootModel

from harness.results.common import (
    DampingResult,
    Floats,
    Machine,
    ModelDocument,
    MotionResult,
    P,
    Paged,
    RecordingInfo,
    RepeatedResult,
    Result,
    Settings,
    Span,
    Where,
    rare,
)
from harness.results.compare import ChannelPair
from harness.results.robot import CurveResult, RobotResult

Verdict = Literal["adequate", "missing_physics", "main_effect", "one_of", "unexplained"]
Grade = Literal["explains", "main", "one-of", "part", "minor", "tabulated"]
Rmse = dict[str, float]
"""Root mean square error by channel, in the channel's unit."""


class FitResult(Result):
    """A model fitted to the recording."""

    parameters: dict[str, P] = Field(
        description="omega_n, zeta, x_k; on a free axis mass, c, f_k; of a robot's joint inertia, c, f_k besides"
    )
    rmse: Rmse
    chi2_per_point: float | None = Field(description="in units of the noise; 1 when only noise is left")


class AlternativeResult(Result):
    """A name that the data do not rule out."""

    name: str
    delta_bic: float = Field(description="by how much it is worse, below 10")


class PredictionResult(Result):
    """What took no part in a fit, predicted without the term and with it."""

    baseline_rmse: Rmse
    refined_rmse: Rmse
    blocks: list[float] = Field(description="squares after over before, span by span")
    spans_s: list[Span]

    @property
    def ratios(self) -> dict[str, float]:
        """Error after over before, by channel."""
        return {c: self.refined_rmse[c] / before for c, before in self.baseline_rmse.items() if before > 0.0}

    @property
    def ratio(self) -> float | None:
        """The largest of them."""
        return max(self.ratios.values(), default=None)


class MechanismResult(Result):
    """One piece of physics that is missing."""

    name: str
    family: str
    variant: str = Field(default="", description="which of the laws that share the name")
    statement: str
    parameters: dict[str, P]
    grade: Grade = Field(default="explains", description="how much of what is missing it is")
    share: float | None = Field(default=None, description="of the misfit beyond noise that it explains alone")
    chance: float | None = rare(
        "of the first name to be the main effect: on simulated machines that look alike, half of which have one; in the"
        " others several small effects come to the same"
    )
    probability: float | None = Field(
        default=None,
        description="that it is missing, as the main effect or beside another name; null of a table, which has no name",
    )
    delta_bic: float = Field(
        description="what BIC loses when it is taken out of the refined model and the rest is fitted again"
    )
    holdout: PredictionResult | None = Field(
        default=None, description="interleaved blocks of cycles, refitted without them"
    )
    forward: PredictionResult | None = Field(
        default=None, description="fitted to the first 60 %, run freely through the rest"
    )
    where: Where = Field(description="when it acts, and the share of the baseline's mean square mismatch in that time")
    alternatives: list[AlternativeResult] = Field(max_length=3)


class HypothesisResult(Result):
    """What may be missing, and how likely that is."""

    names: list[str] = Field(
        description="of the catalogue, unnamed-curve for a smooth law of the speed, of the position or of both that is"
        " none of them; empty for nothing, or for no name that is the main effect"
    )
    probability: float


class ForcedResult(Result):
    """The best-ranked catalogue term put into a model that needs none."""

    name: str
    baseline_rmse: Rmse
    refined_rmse: Rmse = Field(description="with the term; at most a few per cent above the baseline's")


class HoldoutResult(Result):
    """Prediction of samples held out of the fit."""

    spans_s: list[Span]
    baseline_rmse: Rmse
    refined_rmse: Rmse
    given: list[str] = rare("covariates that both predictions are given, not predicted", list)
    forced: ForcedResult | None = rare("where nothing is missing: what one term too many does to the prediction")


class EngineResult(Result):
    """Both models in one engine against the recording."""

    settings: Settings
    baseline_rmse: Rmse
    refined_rmse: Rmse
    own_error: Rmse = Field(
        default_factory=dict, description="rms against the exact motion of the refined model, in units of the noise"
    )
    version: str = ""
    ignored: list[str] = Field(default_factory=list)
    error: str | None = Field(default=None, description="why this engine could not be run")


class ChangeResult(Result):
    """One thing to change in the user's simulation."""

    kind: Literal["parameter", "term", "setting"]
    name: str
    before: float | str | None = Field(description="as the simulation has it; null for a term it lacks")
    after: float | str | None = Field(description="as the recording has it; null for a term to take out")
    unit: str = ""
    said: str = Field(description="the change in words")


class Bar(Result):
    """Part of the mean square mismatch. of: one of engine, parameters, missing_physics, unexplained and noise, or
    several whose errors make up for each other.
    """

    of: list[str]
    name: str
    share: float


class AttributionResult(Result):
    """Shares of the mean square mismatch of a simulation; they add up to 1, negative ones too.

    Shapley values of a game in which engine, parameters and missing physics are put right in every order.
    """

    engine: float | None
    why: str | None = Field(default=None, description="why engine is null: with --sim alone it is in parameters")
    parameters: float
    missing_physics: float
    unexplained: float
    noise: float
    stderr: dict[str, float] | None = Field(
        default=None,
        description="of engine, parameters and missing_physics, from what the recording leaves open of the refined "
        "model; null where an engine was simulated",
    )
    configuration: str = Field(default="", description="what was compared with the recording")
    mean_square: float | None = Field(default=None, description="S0, the whole, in units of the noise")
    shift_s: float | None = Field(default=None, description="by which a trace was moved in time")
    reads: dict[str, P] | None = Field(default=None, description="what the trace of --sim reads, fitted as a recording")
    recording: dict[str, P] = Field(default_factory=dict, description="the refined model's, beside it")
    changes: list[ChangeResult] = Field(default_factory=list, description="what to change, what moves most first")
    sentences: list[str] = Field(default_factory=list)
    paste: str | None = Field(default=None, description="attributes that mend the engine's friction")
    bars: list[Bar] = Field(default_factory=list, description="the shares as drawn: none is negative, all add up to 1")


class ForceError(Result):
    """Relative force error of a driven recording, %."""

    fit_baseline: float
    fit_refined: float
    baseline: float
    refined: float
    refined_with_ripple: float | None = rare("with a force ripple whose phase is refitted there")


class ValidationResult(Result):
    """Both models on another recording, nothing fitted but its start."""

    file: str
    baseline_rmse: Rmse
    refined_rmse: Rmse
    force_rel_error: ForceError | None = None


class EvidenceResult(Result):
    """A catalogue name tried alone."""

    name: str
    delta_bic: float = Field(description="by how much it is better than the baseline, by BIC")
    share: float | None = rare("of the misfit beyond noise, where names are graded")


class RemainderResult(Result):
    """What the best model found leaves, where none explains the recording to its noise."""

    share: float = Field(description="of the baseline's misfit beyond noise")
    over_noise: float = Field(description="its rms over the sensors'")
    looks_like: str
    depends_on: dict[str, float] = Field(
        description="share of it that is a function of x, v, t, direction or amplitude"
    )


class NearResult(Result):
    """A law of the catalogue that comes near a table."""

    name: str
    share: float = Field(description="of the table's squares over the motion, what belongs to the base taken off")


class TableResult(Result):
    """A force without a name, on the left of the equation of motion, over the range that was swept."""

    form: str = Field(description="f(x), f(v), f(|v|) sgn v, or g(x) sgn v")
    of: Literal["x", "v", "|v|"]
    at: Floats = Field(description="m or m/s, rad or rad/s; beyond the ends nothing is known")
    at_unit: str
    force: Floats
    stderr: Floats = Field(description="one standard error")
    force_unit: str
    gauge: str = Field(description="what the table has none of, as it belongs to the base")
    described: str = Field(description="its shape in words")
    nearest: list[NearResult]


class SurfaceResult(Result):
    """A force without a name over position and speed at once, on the left of the equation of motion."""

    form: Literal["f(x, v)"] = "f(x, v)"
    x: Floats = Field(description="m or rad")
    x_unit: str
    v: Floats = Field(description="m/s or rad/s")
    v_unit: str
    force: list[list[float | None]] = Field(description="a row for each v; null where the motion never was")
    stderr: list[list[float | None]] = Field(description="one standard error")
    force_unit: str
    gauge: str = Field(description="what it has none of, as it belongs to the tables of either")
    described: str = Field(description="in words")


class ModelForcesResult(Result):
    """Forces of both models, in the units of the law."""

    at: Floats
    fitted: Floats
    base: Floats


class SeenLawResult(Result):
    """A law beside the recording: a force on the left of the equation, means over cells, rows of a friction curve."""

    names: list[str]
    over: Literal["v", "x", "t"] = Field(
        description="v: all friction and damping; x: what the refined model's spring is not; t: over time"
    )
    level: bool = Field(description="whether it is the level of dry friction, against the motion")
    at: Floats = Field(description="m/s, m or s; rad/s or rad")
    at_unit: str
    seen: Floats = Field(description="the fitted law with the force that the refined model leaves over")
    stderr: Floats
    fitted: Floats
    base: Floats = Field(description="of viscous and Coulomb friction alone")
    force_unit: str
    between: ModelForcesResult | None = rare("of a friction curve: both models at speeds between its rows")


class FitPercent(Result):
    """100 (1 - |y - yhat| / |y - mean y|) by channel, before and after."""

    baseline: dict[str, float]
    refined: dict[str, float]


class RuleResult(Result):
    """A number that moved the verdict."""

    name: str
    value: float
    unit: str
    origin: str


class OwnResult(Result):
    """What one of several recordings has of its own beside the physics that all share."""

    file: str
    begins_s: float = Field(description="where its release, or its first sample, lies on the common axis of time")
    start: dict[str, P] = Field(
        description="x0, v0 where it is let go, or of a driven one at its first sample, in its own zero"
    )
    zero: P | None = Field(description="what its sensor of x shows at rest without friction; null where it is known")
    noise: dict[str, float | str] = Field(description="standard deviation by channel")
    baseline_rmse: Rmse
    rmse: Rmse = Field(description="of the refined model")
    alone: dict[str, P] = Field(description="the baseline's parameters, fitted to this recording by itself")
    differs: list[str] = Field(description="in what it is not as the first, one sentence each")
    unshared: list[str] = rare("base parameters that each recording has for itself: c, f_k, k, m", list)


_FOLLOWS = {
    "c": {"c", "zeta"},
    "f_k": {"f_k", "x_k"},
    "k": {"k", "omega_n", "zeta", "x_k"},
    "m": {"m", "omega_n", "zeta"},
}
"""Numbers of a fit that are those of the first recording where each has such a parameter for itself."""


class ReadResult(Result):
    """How a recording was read."""

    command: str = Field(description="the line that reads it so, whatever was guessed")
    columns: dict[str, str] = Field(description="by channel, as --columns takes them")
    mended: list[str] = Field(description="what was changed or skipped to read it, one sentence each")


class DiagnosisResult(Paged):
    """harness diagnose, for one recording, or for several of one machine together."""

    schema_: Literal["harness.diagnosis/2"] = Field(default="harness.diagnosis/2", alias="schema")
    recording: RecordingInfo = Field(description="with --together all of them, laid one behind the other")
    recordings: list[RecordingInfo] = rare("with --together: each", list)
    own: list[OwnResult] = rare("with --together: what each has of its own", list)
    motion: MotionResult | None = rare("its kind, before any fit; with --together that of the first")
    damping: DampingResult | None = rare("of a free decay, over its amplitude")
    read: ReadResult | None = rare("of a file that is no .rrd")
    together: dict[str, RepeatedResult] = rare(
        "with --together: the refined model's parameters, fitted to each recording by itself", dict
    )
    verdict: Verdict
    statement: str = Field(description="the verdict in a sentence")
    baseline: FitResult
    where: list[Where]
    mechanisms: list[MechanismResult]
    posterior: list[HypothesisResult] = Field(
        default_factory=list,
        description=(
            "what may be missing, most likely first, down to a probability of .01; no names: nothing that has one. "
            "All others share what is left of 1: one may be there, too weak to identify. Of an arm a name of one joint "
            "has that before it"
        ),
    )
    refined: FitResult
    remainder: RemainderResult | None = None
    tables: list[TableResult] = Field(
        default_factory=list, description="what has no name, as curves; part of the refined model"
    )
    surface: SurfaceResult | None = rare("of a force without a name, what depends on position and speed at once")
    laws: list[SeenLawResult] = rare("what was found, beside the recording", list)
    fit_percent: FitPercent | None = None
    rules: list[RuleResult] = Field(default_factory=list, description="the numbers that moved the verdict")
    holdout: HoldoutResult
    bounded: bool = Field(
        default=False, description="whether a budget ended the search, so that this is the best so far"
    )
    engines: dict[str, EngineResult]
    attribution: AttributionResult | None = Field(description="null when no engine could be run")
    validation: ValidationResult | None = rare()
    robot: RobotResult | None = rare()
    curve: CurveResult | None = rare("of a robot's joint: friction over speed")
    evidence: list[EvidenceResult] = Field(description="every catalogue name tried alone, best first")
    consistent_channels: dict[str, ChannelPair] = Field(description='by pair ("x-a"), without a model')
    next_experiment: str
    residual_map: str | None
    baseline_model: ModelDocument
    refined_model: ModelDocument = Field(description="the baseline's where nothing is named")
    model_left_out: list[str] = Field(description="what the MJCF and URDF of the refined model cannot say")
    warnings: list[str]
    settings: dict[str, Any] = Field(description="every option in force")
    command: str = Field(default="", description="the line that makes it again")
    machine: Machine
    files: dict[str, str] = Field(description="absolute paths")

    @property
    def of_first(self) -> frozenset[str]:
        """Numbers of both fits that are the first recording's alone, where several do not share them."""
        return frozenset().union(*(_FOLLOWS.get(name, {name}) for one in self.own for name in one.unshared))

    @property
    def has_own_simulation(self) -> bool:
        """Whether a simulation of the user's was compared, by its trace or its model."""
        return bool(self.settings.get("sim") or self.settings.get("model"))


class UnreadRecording(Result):
    """A recording that could not be diagnosed."""

    file: str


class FailedDiagnosis(Result):
    """The entry of a file that failed; the others go on."""

    named: Literal["harness.diagnosis/2"] = Field(default="harness.diagnosis/2", alias="schema")
    recording: UnreadRecording
    verdict: Literal["error"] = "error"
    error: str
    mechanisms: list[MechanismResult] = Field(default_factory=list, max_length=0)


Entry = Annotated[DiagnosisResult | FailedDiagnosis, Field(discriminator="verdict")]


class DiagnosisDocument(RootModel[Entry | list[Entry]]):
    """What --json and result.json hold: one entry, or an array in the order of the files."""

    SCHEMA: ClassVar[str] = "harness.diagnosis/2"


def read_diagnosis(data: dict[str, Any]) -> DiagnosisResult:
    """A result of this version, or of harness.diagnosis/1, whose new fields are not known; raises ValidationError."""
    if data.get("schema") == "harness.diagnosis/1":
        data = {**data, "schema": "harness.diagnosis/2"}
    return DiagnosisResult.model_validate(data)
