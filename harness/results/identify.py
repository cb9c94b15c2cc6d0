"""The result of the estimators on a recording: harness.identify/1."""

from typing import Literal

from pydantic import Field

from harness.results.common import Machine, P, RecordingInfo, Result
from harness.results.run import Estimates


class IdentifyResult(Result):
    """harness identify."""

    schema_: Literal["harness.identify/1"] = Field(default="harness.identify/1", alias="schema")
    recording: RecordingInfo
    estimates: dict[str, Estimates]
    sensor_phase_rad: P
    warnings: list[str]
    command: str = Field(default="", description="the line that makes it again")
    machine: Machine
    files: dict[str, str] = Field(default_factory=dict)
