"""The result of a search of settings: harness.tune/1."""

from typing import Any, Literal

from pydantic import Field

from harness.results.common import Machine, Result


class TunedFigure(Result):
    """One figure of the scorecard on sliders that were not searched on, relative distances from exact, means."""

    name: str
    before: float | None
    after: float | None


class TunedJoint(Result):
    """A robot's joint that settings were searched for."""

    file: str = Field(description="of the model, absolute")
    joint: str
    inertia: list[float] = Field(description="kg m^2 or kg that it moves, a pose of the others each: searched, scored")
    gravity: list[float] = Field(description="largest torque of gravity in each, N m; of a slide its force, N")


class TuneResult(Result):
    """harness tune."""

    schema_: Literal["harness.tune/1"] = Field(default="harness.tune/1", alias="schema")
    engine: str
    version: str
    route: Literal["joint", "contact", "law"]
    dt_s: float
    max_cost: float | None = Field(description="allowed wall time over that of what ships at the same step")
    changed: dict[str, Any] = Field(description="settings that differ from what ships")
    settings: dict[str, Any] = Field(description="every setting in force")
    paste: str = Field(description="XML or calls that make these settings")
    score_before: float = Field(description="what ships, on sliders that were not searched on; lower is better")
    score_after: float
    score_preset: float = Field(description="the preset tuned, for comparison")
    cost: float = Field(description="measured wall time over that of what ships at the same step")
    figures: list[TunedFigure]
    searched: int = Field(description="sets of settings that were scored")
    sliders: dict[str, list[int]] = Field(
        description="numbers of the random suites, or of a robot's poses: searched on, scored on"
    )
    robot: TunedJoint | None = Field(default=None, exclude_if=lambda value: value is None)
    machine: Machine
