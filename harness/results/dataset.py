"""Results of published cases (harness.dataset/1) and recordings of machines (harness.machines/1)."""

from typing import Literal

from pydantic import Field

from harness.results.common import Machine, Result
from harness.results.diagnosis import DiagnosisResult


class FigureRow(Result):
    """One model's figures: published, by the published protocol, or ours; null where there is none."""

    label: str
    mass_kg: float | None = None
    mass_stderr_kg: float | None = None
    viscous: list[float] = Field(description="N s/m: one, or forwards and backwards")
    dry_n: float | None = None
    offset_n: float | None = None
    fit_error_percent: float | None = Field(default=None, description="relative force error on the recording fitted")
    cross_error_percent: float | None = Field(default=None, description="and on the other, nothing refitted")


class RippleResult(Result):
    """A force periodic in position found in one file."""

    file: str
    period_m: float
    amplitude_n: float
    phase_rad: float
    contrast: float = Field(description="power over the median of the periods tried")


class DatasetResult(Result):
    """harness dataset."""

    schema_: Literal["harness.dataset/1"] = Field(default="harness.dataset/1", alias="schema")
    name: Literal["emps"]
    source: str
    verdict: str
    rows: list[FigureRow] = Field(description="published figures beside ours")
    found: list[str] = Field(description="a sentence for each mechanism")
    ripples: list[RippleResult]
    unexplained: str
    diagnosis: DiagnosisResult
    command: str = Field(default="", description="the line that makes it again")
    files: dict[str, str]


class FoundResult(Result):
    """A mechanism of one recording."""

    name: str
    grade: str
    share: float | None = Field(default=None, description="of the misfit beyond the noise that it explains alone")
    holdout: float | None = Field(default=None, description="error after over before on blocks held out of the fit")
    forward: float | None = Field(default=None, description="the same of a free run of the last 40 %")


class MachineRow(Result):
    """One recording of one machine."""

    name: str
    file: str
    source: str = Field(description="where it comes from, and its licence")
    others: str = Field(description="what other fits of it said")
    verdict: str
    said: str = Field(description="the statement of the diagnosis")
    found: list[FoundResult]
    fit_percent_before: dict[str, float] | None = None
    fit_percent_after: dict[str, float] | None = None
    over_noise: float | None = Field(default=None, description="rms of what is left over that of the sensors' noise")
    given: list[str] = Field(default_factory=list, description="covariates, which held-out figures do not predict")


class MachinesResult(Result):
    """harness dataset machines."""

    schema_: Literal["harness.machines/1"] = Field(default="harness.machines/1", alias="schema")
    rows: list[MachineRow]
    absent: list[str] = Field(description="listed files that the folder does not hold")
    machine: Machine
    command: str = Field(default="", description="the line that makes it again")
    files: dict[str, str]
