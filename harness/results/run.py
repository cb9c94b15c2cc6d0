"""The result of the main job: harness.run/1."""

from collections.abc import Mapping
from typing import Any, Literal, Self

from pydantic import ConfigDict, Field

from harness.results.common import Machine, P, Result


class Metrics(Result):
    """How far a trace is from the exact one; null where the scenario has no such figure.

    A scenario that is no free decay has figures of its own beside these (period_s, stick_fraction, ...), SI units.
    """

    model_config = ConfigDict(extra="allow")
    __pydantic_extra__: dict[str, float | None] = Field(init=False)

    max_error_m: float | None = Field(description="largest |x - exact x|, m")
    rest_error_m: float | None = Field(description="last x minus the exact rest position, m")
    stick_time_s: float | None = Field(description="time from which the slider does not move any more, s")
    creep_m_s: float | None = Field(description="mean speed over the part in which the exact slider rests, m/s")
    half_cycles: int | None = Field(description="half-cycles until it rests")
    reversal_lead_s: float | None = Field(description="by how much friction reverses before the speed does, s")
    energy_error: float | None = Field(description="largest error of the energy balance over the starting energy")
    lift_m: float | None = Field(default=None, description="contact route: largest height above the floor, m")

    @classmethod
    def of(cls, found: Mapping[str, float | None]) -> Self:
        """From figures by name; those of every scenario that are not among them are null."""
        return cls.model_validate(dict.fromkeys(cls.model_fields) | dict(found))


class Estimates(Result):
    """What one estimator reads from one trace."""

    omega_n: P
    zeta: P
    x_k: P
    reversals: int
    per_reversal: list[dict[str, Any]] = Field(default_factory=list)
    guard_s: float | None = Field(default=None, description="time left out on each side of a reversal, s")
    lead_s: P | None = Field(default=None, description="by how much friction reverses before the speed does, s")
    notes: list[str] = Field(default_factory=list)


class TraceResult(Result):
    """One source of the run."""

    source: str
    preset: str
    version: str
    settings: dict[str, Any]
    ignored: list[str]
    dt_s: float | None
    wall_s: float | None
    samples: int
    metrics: Metrics
    estimates: dict[str, Estimates]
    error: str | None = Field(default=None, description="why this run could not be completed")


class RunResult(Result):
    """harness run."""

    schema_: Literal["harness.run/1"] = Field(default="harness.run/1", alias="schema")
    scenario: dict[str, Any]
    traces: list[TraceResult]
    conclusions: list[str] = Field(default_factory=list, description="what differs and why, in sentences")
    command: str = Field(default="", description="the line that makes it again")
    machine: Machine
    files: dict[str, str]
