"""Baselines and what is compared with them: harness.baseline/1, harness.regress/1."""

from typing import Any, Literal

from pydantic import Field

from harness.results.common import Machine, Result


class BaselineRow(Result):
    """What a baseline keeps of a row of the matrix; never how fast it was."""

    engine: str
    version: str
    environment: str = Field(default="", description="where the engine ran, empty for the environment of the program")
    route: str
    scenario: str
    dt_s: float | None
    metrics: dict[str, float | None]
    exact: dict[str, float]
    error: str | None


class Baseline(Result):
    """Rows by name, to compare later ones with."""

    schema_: Literal["harness.baseline/1"] = Field(default="harness.baseline/1", alias="schema")
    machine: Machine
    rows: dict[str, BaselineRow]


class Moved(Result):
    """One thing that is not as it was."""

    name: str
    metric: str = Field(description="empty when the whole row changed")
    before: float | None
    after: float | None
    verdict: Literal["worse", "better", "lost", "gained", "fails", "works", "missing", "new"]
    why: str


class RegressResult(Result):
    """harness regress."""

    schema_: Literal["harness.regress/1"] = Field(default="harness.regress/1", alias="schema")
    baseline: str
    rows: int = Field(description="rows that were compared")
    moved: list[Moved]
    regressions: int
    not_run: list[str] = Field(default_factory=list, description="engines of the baseline that are not installed here")
    versions: dict[str, Any] = Field(default_factory=dict, description="engine versions, baseline's and these")
    machine: Machine
