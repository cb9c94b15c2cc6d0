"""The result of published recordings of machines: harness.machines/1."""

from typing import Literal

from pydantic import Field

from harness.results.common import Machine, Result


class FoundResult(Result):
    """A mechanism of one recording."""

    name: str
    grade: str
    share: float | None = Field(default=None, description="of the misfit beyond the noise that it takes off alone")
    holdout: float | None = Field(default=None, description="error after over before on blocks left out of the fit")
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
