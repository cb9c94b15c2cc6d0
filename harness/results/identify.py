"""The result of the estimators on a recording, harness.identify/1, and on several, harness.identify/2."""

from typing import Literal

from pydantic import Field

from harness.results.common import (
    DampingResult,
    Machine,
    MotionResult,
    P,
    Paged,
    RecordingInfo,
    RepeatedResult,
    Result,
    Swing,
    rare,
)
from harness.results.diagnosis import FitResult, UnreadRecording
from harness.results.run import Estimates

QUANTITIES = ("x_k", "zeta", "omega_n")
SLOWING = ("f_k", "c")
"""What is estimated of a free decay, and of a run-down or a friction curve."""


class SlowingResult(Result):
    """What one assumption reads from a run-down, or from a table of steady speeds."""

    c: P = Field(description="viscous damping; per unit mass where the mass is unknown")
    f_k: P = Field(description="dry friction")
    chi2_per_point: float = Field(description="in units of the noise; 1 where the assumption holds")


class IdentifyResult(Paged):
    """harness identify."""

    schema_: Literal["harness.identify/1"] = Field(default="harness.identify/1", alias="schema")
    recording: RecordingInfo
    motion: MotionResult | None = rare("its kind, before any fit")
    damping: DampingResult | None = rare("of a free decay, over its amplitude")
    estimates: dict[str, Estimates]
    slowing: dict[str, SlowingResult] = rare(
        "of a run-down or a friction curve, instead of estimates: linear (dry friction alone), exponential (damping"
        " alone), both",
        dict,
    )
    sensor_phase_rad: P
    restoring: Swing | Literal["none"] = Field(
        default="spring", description="a pendulum is read as the spring that it would be; none: it runs down"
    )
    baseline: FitResult | None = Field(
        default=None, description="viscous and Coulomb friction fitted to all channels at once, as a diagnosis has it"
    )
    warnings: list[str]
    command: str = Field(default="", description="the line that makes it again")
    machine: Machine
    files: dict[str, str] = Field(default_factory=dict)

    def numbers(self, method: str) -> dict[str, P]:
        """What a method reads, by name: x_k, zeta and omega_n, or f_k and c; none where it was not used."""
        found = self.estimates.get(method) or self.slowing.get(method)
        names = QUANTITIES if method in self.estimates else SLOWING
        return {} if found is None else {name: getattr(found, name) for name in names}


class FailedIdentify(Result):
    """A recording of several from which nothing could be estimated; the others go on."""

    recording: UnreadRecording
    error: str


class RepeatedIdentifyResult(Paged):
    """harness identify, of several recordings of one machine."""

    schema_: Literal["harness.identify/2"] = Field(default="harness.identify/2", alias="schema")
    statement: str = Field(description="the numbers of all in a sentence")
    method: str = Field(description="whose numbers these are")
    estimates: dict[str, Estimates] = Field(
        description="of all recordings, by method: weighted means whose errors count the spread between recordings; of"
        " run-downs and friction curves none: see together"
    )
    recordings: list[IdentifyResult | FailedIdentify] = Field(description="each by itself, in the order of the files")
    together: dict[str, RepeatedResult] = Field(
        description='by "METHOD.NUMBER", such as "acceleration.x_k": what two recordings or more say of it'
    )
    conditions: dict[str, dict[str, float]] = rare("with --conditions: numbers by name, by file name", dict)
    warnings: list[str]
    command: str = Field(default="", description="the line that makes it again")
    machine: Machine
    files: dict[str, str] = Field(default_factory=dict)

    @property
    def found(self) -> list[IdentifyResult]:
        """The recordings from which something was estimated."""
        return [one for one in self.recordings if isinstance(one, IdentifyResult)]

    @property
    def failed(self) -> list[FailedIdentify]:
        """The recordings that could not be read, or show no free decay."""
        return [one for one in self.recordings if isinstance(one, FailedIdentify)]
