"""Results that compare: traces (compare/2), models on a recording (models/1), two conditions (change/1)."""

from typing import ClassVar, Literal

from pydantic import Field

from harness.results.common import Machine, P, Paged, RecordingInfo, Result, Where, rare


class ChannelPair(Result):
    """What one channel of a trace says of another: gain, lag (the first against the second) and offset."""

    gain: P
    lag_s: P
    offset: P
    consistent: bool
    sentence: str


class OtherShift(Result):
    """A shift that was tried as well. worse_by: mean square difference over that of the shift taken."""

    shift_s: float
    worse_by: float


class Aligned(Result):
    """The first trace's clock in that of the second: its first sample is moved by shift_s, and from there on a second
    of it lasts scale seconds of the second's clock. scale_applied: a scale beyond what clocks differ by is reported and
    not applied, as it may be another frequency as well.
    """

    shift_s: P
    scale: P
    scale_applied: bool = True
    alternatives: list[OtherShift] = Field(default_factory=list)


class Event(Result):
    """Where a motion begins, turns, or stops; time_s by the clock of the second trace."""

    time_s: float
    kind: Literal["release", "start", "reversal", "stop", "end"]
    value: float | None = Field(description="of the displacement there, SI")


class Reading(Result):
    """What the estimators read from one trace."""

    method: str | None = Field(description="of the estimators, None where none gives a figure")
    omega_n: P
    zeta: P
    x_k: P
    amplitude: P
    rest: P
    events: list[Event]


class Difference(Result):
    """One figure of both. significance: their distance over its standard error, None where one is not known."""

    what: str
    first: P
    second: P
    significance: float | None


class Largest(Result):
    """The largest difference of one sample, second minus first; time_s by the second's clock."""

    channel: str
    value: float
    unit: str
    time_s: float


class SignatureResult(Result):
    """A difference by a number that engines and importers are known to make."""

    name: Literal["per-degree", "no-friction", "link-damping", "body-damping", "step-damping", "half-step"]
    sentence: str
    found: P
    expected: float = Field(description="in the unit of found")


class CompareResult(Paged):
    """harness compare."""

    schema_: Literal["harness.compare/2"] = Field(default="harness.compare/2", alias="schema")
    files: list[str] = Field(description="the first trace (simulated) and the second (recorded)")
    aligned: Aligned
    traces: dict[str, Reading] = Field(description="by the files' stems, or sim and real where these are alike")
    differences: list[Difference] = Field(description="the most significant first")
    largest: Largest
    fit_percent: dict[str, float] = Field(description="100 (1 - |second - first| / |second - its mean|), by channel")
    noise: dict[str, float | str | None] = Field(description="of the difference, by channel, SI units")
    rmse: dict[str, float]
    where: list[Where]
    consistent_channels: dict[str, dict[str, ChannelPair]] = Field(description='by trace and pair ("x-a")')
    verdict: Literal["identical", "same within noise", "different"]
    signatures: list[SignatureResult] = Field(default_factory=list, description="none where the two are the same")
    p_value: float | None = Field(default=None, description="chance that noise alone differs so much")
    sentences: list[str] = Field(default_factory=list)
    recordings: list[RecordingInfo] = Field(default_factory=list)
    command: str = Field(default="", description="the line that makes it again")
    machine: Machine | None = None
    outputs: dict[str, str] = Field(default_factory=dict)


class ComparedModel(Result):
    """One model, fitted to the recording."""

    name: str
    terms: list[str] = Field(description="of the catalogue, beside viscous and Coulomb friction")
    fitted: int = Field(description="numbers that were fitted")
    chi2_per_point: float = Field(description="in units of the noise that the best model leaves; 1 when only noise is")
    delta_bic: float = Field(description="worse than the best by BIC; 10 is decisive")
    weight: float = Field(description="probability among these models, were they equally likely before")
    rmse: dict[str, float]
    parameters: dict[str, P] = Field(description="omega_n, zeta, x_k; on a free axis mass, c, f_k")
    note: str = ""


class ModelsResult(Paged):
    """Models of one recording, the best first."""

    LINES: ClassVar[str] = "models"

    schema_: Literal["harness.models/1"] = Field(default="harness.models/1", alias="schema")
    recording: RecordingInfo
    statement: str
    models: list[ComparedModel]


class ChangedNumber(Result):
    """A number of the machine in both conditions."""

    name: str = Field(description='"c", "f_k", "quadratic-drag.c2"; "inertia" where a mass that is not known changed')
    said: str = Field(description="what it is, in words")
    before: P | None = rare("fitted jointly to all recordings before")
    after: P | None = rare("the same afterwards; as before where it did not change")
    ratio: P = Field(description="after over before, as if it might have changed whether or not it did")
    changed: bool
    repeats: float | None = rare("standard deviation of repeats beyond their errors, in the unit of the number")


class ChangedCovariate(Result):
    """A covariate in both conditions."""

    name: str
    before: float = Field(description="mean of the recordings before, in the column's own unit")
    after: float


class ChangeResult(Paged):
    """harness diagnose --before ... --after ..."""

    schema_: Literal["harness.change/1"] = Field(default="harness.change/1", alias="schema")
    statement: str = Field(description="what changed, by how much, and what did not")
    changed: list[str] = Field(description="names of what changed, the clearest first; empty where nothing did")
    chance: float = Field(description="that two conditions which are alike differ so much")
    left: float = Field(description="that conditions which differ in nothing else differ so much")
    numbers: list[ChangedNumber]
    laws: list[str] = Field(description="catalogue names beside viscous and dry friction that both were read with")
    given: list[ChangedCovariate] = rare("covariates, whose push is no change of the machine", list)
    before: list[RecordingInfo]
    after: list[RecordingInfo]
    warnings: list[str]
    command: str = Field(default="", description="the line that makes it again")
    machine: Machine
    files: dict[str, str] = Field(default_factory=dict)
