"""The result of a sealed blind proof: harness.proof/1."""

from typing import ClassVar, Literal

from pydantic import Field

from harness.results.common import Machine, Paged, Result


class RateResult(Result):
    """A share of cases with its exact 95 % interval; null without a case."""

    hits: int
    cases: int
    value: float | None
    low: float | None
    high: float | None


class ProofFigure(Result):
    """A figure of the scores with its 95 % interval: exact for a share, resampled for a median."""

    key: str
    label: str
    asked: str = Field(description='what is asked of it; "" for one that is only shown')
    met: bool | None = Field(description="null where nothing is asked")
    share: bool = Field(description="a share of cases, else a median")
    hits: int | None
    cases: int
    value: float | None
    low: float | None
    high: float | None


class ForcedFigure(Result):
    """Held-out rmse of controls with the best-ranked term forced in, over that without it."""

    cases: int
    worst: float | None
    worst_file: str | None
    above: list[str] = Field(description="recordings above 1.05")
    withheld: list[str]
    named: list[str] = Field(description="controls in which something was named, which are counted as false alarms")


class MustFail(Result):
    """What a diagnoser that looks at nothing would have scored."""

    name: str
    about: str
    named: RateResult
    false_alarms: RateResult
    misled: RateResult


class BaselineMargin(Result):
    """Ours beside a baseline on the same recordings."""

    name: str
    about: str
    what: str = Field(description="which figure")
    cases: int = Field(description="recordings on which the baseline has something to work on")
    ours: float | None
    theirs: float | None
    value: float | None = Field(description="by how much ours is better")
    low: float | None = Field(description="95 % interval of it, resampled in pairs")
    high: float | None
    none: float = Field(description="what no margin is: 0 for shares, 1 for ratios")
    share: bool
    why: str = Field(description="why there is no margin")
    beaten: bool = Field(description="whether the interval lies above that")


class DetectionLevel(Result):
    """Cases at one likelihood loss."""

    loss: float = Field(description="chi-square that the best model without the effect loses to the truth")
    named: RateResult
    payable: int = Field(description="cases whose numbers BIC would charge less for")


class Detection(Result):
    """The same cases under growing noise: share named against the likelihood loss."""

    levels: list[DetectionLevel] = Field(description="largest loss, least noise, first")
    half: float | None = Field(description="loss at which half are named; null without a crossing")
    low: float | None = Field(description="95 % interval of it, resampled over cases")
    high: float | None
    limit: float | None = Field(description="median of what BIC charges: below it nobody who goes by BIC can name")


class PathLevel(Result):
    """Effects that are worth so much, by what was said of them."""

    low: float = Field(description="effective samples: log-likelihood that the base model is expected to lose")
    high: float
    cases: int
    named: RateResult
    listed: RateResult
    silent: RateResult
    wrong: RateResult


class PathResult(Result):
    """One way that gives a verdict, by itself."""

    RATES: ClassVar[tuple[str, ...]] = ("told", "bare", "wrong", "misled", "alarms", "covered")

    path: str
    told: RateResult = Field(description="effects worth above 20 effective samples that were named or listed")
    bare: RateResult = Field(description="the same where no option was given")
    wrong: RateResult = Field(description="effects that were called others")
    misled: RateResult = Field(description="unknown effects that were given a name")
    alarms: RateResult = Field(description="controls that were given a name")
    covered: RateResult = Field(description="true values within two standard errors, of controls")


class ReliabilityBin(Result):
    """Verdicts whose likeliest explanation was given such a probability."""

    low: float
    high: float
    said: float = Field(description="their mean probability")
    held: RateResult


class PathsResult(Result):
    """Every way that gives a verdict, as a user runs it."""

    levels: list[PathLevel]
    ways: list[PathResult]
    reliability: list[ReliabilityBin]


class RealMachine(Result):
    """One real machine, by itself."""

    RATES: ClassVar[tuple[str, ...]] = ("told", "moved", "wrong", "alarms", "switched", "switched_wrong", "repeats")

    machine: str
    files: int
    told: RateResult = Field(description="constructed laws that were named or listed")
    moved: RateResult = Field(description="constructed gain, clock and damping of which their number alone moved")
    wrong: RateResult = Field(description="constructed effects that were called another, or moved another number")
    alarms: RateResult = Field(description="constructed delays that were called anything")
    switched: RateResult = Field(description="two conditions of which the cause came first and moved alone")
    switched_wrong: RateResult = Field(description="two conditions that were given another cause")
    repeats: RateResult = Field(description="one condition recorded twice and called different")


class RealResult(Result):
    """Recordings of real machines that were given."""

    machines: list[RealMachine]
    not_run: list[str] = Field(description="what these files could not be asked, a sentence each")


class ProofCase(Result):
    """One recording: what was hidden, what was said."""

    name: str
    group: str
    source: str
    setting: str
    channels: str
    points: int
    hidden: list[str]
    said: str
    near: list[str] = Field(description="names that were not ruled out")
    right: bool
    loss: float | None = Field(
        description="chi-square that the best viscous and Coulomb fit loses to the truth; null of a real machine"
    )
    r2: float | None = Field(
        description="R^2 of that fit, the worse channel; null where a real machine's force is not measured"
    )


class ProofSizes(Result):
    """How many recordings of each group were asked for."""

    singles: int
    controls: int
    pairs: int
    outside: int
    machines: int = Field(default=0, description="recordings of machines, half of them controls")
    paths: int = Field(default=0, description="recordings on all ways that give a verdict, half of them controls")
    ways: int = Field(default=0, description="on how many ways; 0 for the nine of the first published proof")
    real: int = Field(default=0, description="effects constructed on recordings of real machines")


class ProofResult(Paged):
    """harness prove."""

    LINES: ClassVar[str] = "figures"

    schema_: Literal["harness.proof/1"] = Field(default="harness.proof/1", alias="schema")
    evidence: bool = Field(description="whether there are enough recordings for the figures to say anything")
    sizes: ProofSizes
    given_up: list[str] = Field(description="recordings that could not be drawn, and why")
    seed: str = Field(description="hexadecimal; it was committed to before anything else and revealed at the end")
    figures: list[ProofFigure]
    forced: ForcedFigure
    confusion: dict[str, dict[str, int]] = Field(description="what was hidden -> what was said -> recordings")
    by_name: dict[str, RateResult] = Field(description="single effects named, by name")
    not_tested: list[str] = Field(description="names of the catalogue that did not occur alone")
    shortfalls: list[str] = Field(description="figures that were not reached, a sentence each")
    by_source: dict[str, list[ProofFigure]] = Field(description="figures by what made the recordings")
    must_fail: list[MustFail]
    baselines: list[BaselineMargin]
    detection: Detection | None = Field(description="null in a proof that is no evidence")
    paths: PathsResult | None = Field(default=None, description="null in a proof without recordings on all ways")
    real: RealResult | None = Field(default=None, description="null in a proof without real machines")
    absent: list[str] = Field(
        default_factory=list, description="listed recordings of real machines that were not at hand: not run"
    )
    cases: list[ProofCase]
    diagnosis_s: float = Field(description="time that all diagnoses took, added up, s")
    machine: Machine
    command: str = Field(default="", description="the line that makes another")
    files: dict[str, str] = Field(description="in the folder of the proof")


class ProofCheck(Paged):
    """harness prove --verify."""

    schema_: Literal["harness.proof-check/1"] = Field(default="harness.proof-check/1", alias="schema")
    folder: str
    accepted: bool
    wrong: list[str] = Field(description="what does not hold, a sentence each")
    recordings: int
    drawn_again: int = Field(description="recordings that were made again from the seed")
    identical: int = Field(description="of these, the same to the last bit; the others agree but for rounding")
    notes: list[str]
