"""The result of a sweep: harness.sweep/1."""

from typing import Any, Literal

from pydantic import Field

from harness.results.common import Machine, Result


class SweepRow(Result):
    """One engine, route, set of settings, step and scenario; metrics, or the reason why there are none."""

    key: str = Field(description="16 hex digits, the same for the same inputs and versions")
    name: str = Field(description="the row as baselines know it, with the version of its engine")
    engine: str
    version: str
    environment: str = Field(default="", description="where the engine ran, empty for the environment of the program")
    route: Literal["joint", "contact", "law"]
    preset: str = Field(description="as-shipped, tuned, or the name of another set of settings")
    settings: dict[str, Any] = Field(description="every setting in force")
    changed: dict[str, Any] = Field(description="those that differ from the preset this one starts from")
    ignored: list[str] = Field(description="what the engine does not honour, one sentence each")
    integrator: str
    dt_s: float | None
    scenario: str
    slider: dict[str, float]
    setup: dict[str, Any] = Field(description="the whole scenario: slider, release, duration, action")
    draw: int = Field(description="0 for the suite's own sliders, else the number of the random ones")
    metrics: dict[str, float | None]
    exact: dict[str, float] = Field(description="exact values of those metrics that have one other than 0")
    samples: int
    wall_s: float | None
    steps_per_s: float | None
    error: str | None = Field(description="why this row could not be run")


class Convergence(Result):
    """Errors of rows that differ in their step alone: error ~ dt^order."""

    engine: str
    version: str
    route: str
    preset: str
    integrator: str
    scenario: str
    metric: str
    dt_s: list[float]
    error: list[float]
    order: float
    spread: float = Field(description="largest factor between an error and the fitted line")


class SweepResult(Result):
    """harness sweep."""

    schema_: Literal["harness.sweep/1"] = Field(default="harness.sweep/1", alias="schema")
    machine: Machine
    command: str = Field(default="", description="the line that makes it again")
    notes: list[str] = Field(default_factory=list, description="what happened on the way: damaged parts, dead workers")
    files: dict[str, str] = Field(default_factory=dict)
    rows: list[SweepRow]
    convergence: list[Convergence]
