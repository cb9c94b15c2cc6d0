"""Several logs of one robot compared: harness.fleet/1."""

from typing import Literal

from pydantic import Field

from harness.results.common import FleetTrend, Machine, P, Result, rare
from harness.results.diagnosis import RuleResult


class FleetLog(Result):
    """One log."""

    file: str
    conditions: dict[str, float | None] = Field(description="as --conditions gives them; null where it does not")


class FleetRow(Result):
    """One parameter of one joint over the logs."""

    joint: str
    parameter: str = Field(description="slow, middle or fast: friction there; f_k or c where logs share no speeds")
    speed: float | None = rare("rad/s or m/s, at which friction is compared")
    values: list[P | None] = Field(description="one a log, in their order; null where a log says nothing of it")
    mean: P = Field(description="weighted; its error counts the spread between logs")
    between: float = Field(default=0.0, description="standard deviation of the logs beyond their errors")
    chi2: float = Field(description="sum of squares of value minus mean over error")
    freedom: int
    chance: float = Field(description="probability of such a scatter where it is the same in all logs")
    apart: str = Field(description="the log farthest from the others")
    differs: bool = Field(description="by more than errors allow, all that is asked counted")
    trends: list[FleetTrend]
    said: str


class FleetResult(Result):
    """harness diagnose of several logs with --robot, beside their own results."""

    schema_: Literal["harness.fleet/1"] = Field(default="harness.fleet/1", alias="schema")
    robot: str = Field(description="file of the model, absolute")
    logs: list[FleetLog]
    rows: list[FleetRow]
    statements: list[str]
    rules: list[RuleResult]
    command: str = ""
    machine: Machine
