"""The result of a published case: harness.dataset/1."""

from typing import Literal

from pydantic import Field

from harness.results.common import Result
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
