"""The result of the estimators on a recording: harness.identify/1."""

from typing import Literal

from pydantic import Field

from harness.results.common import DampingResult, Machine, MotionResult, P, Paged, RecordingInfo, Result, Swing, rare
from harness.results.diagnosis import FitResult
from harness.results.run import Estimates


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
