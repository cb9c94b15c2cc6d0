"""The result of the estimators on a recording: harness.identify/1."""

from typing import Literal

from pydantic import Field

from harness.results.common import Machine, MotionResult, P, Paged, RecordingInfo, rare
from harness.results.diagnosis import FitResult
from harness.results.run import Estimates

Swing = Literal["spring", "pendulum"]
"""What pulls back."""


class IdentifyResult(Paged):
    """harness identify."""

    schema_: Literal["harness.identify/1"] = Field(default="harness.identify/1", alias="schema")
    recording: RecordingInfo
    motion: MotionResult | None = rare("its kind, before any fit")
    estimates: dict[str, Estimates]
    sensor_phase_rad: P
    restoring: Swing = Field(default="spring", description="a pendulum is read as the spring that it would be")
    baseline: FitResult | None = Field(
        default=None, description="viscous and Coulomb friction fitted to all channels at once, as a diagnosis has it"
    )
    warnings: list[str]
    command: str = Field(default="", description="the line that makes it again")
    machine: Machine
    files: dict[str, str] = Field(default_factory=dict)
