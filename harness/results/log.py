"""What a log of a robot's joints holds: harness.log/1."""

from typing import Literal

from pydantic import Field

from harness.results.common import Result, Span


class Topic(Result):
    """A topic of a bag, an episode of a data set, or a table."""

    name: str
    type: str = Field(description='the type of its messages, "table" or "episode"')
    count: int = Field(description="messages or rows")
    rate_hz: float | None = Field(description="by the median interval; null where no times are read")
    joints: list[str]
    fields: list[str] = Field(
        description="position, velocity, effort; current (A); magnitude, an effort without its sign"
    )
    units_guessed: dict[str, str] = Field(description="the unit each field is read in")
    gaps_s: list[Span] = Field(description="[from, to], where more than five intervals are missing")
    ranges: dict[str, dict[str, list[float]]] = Field(
        default_factory=dict, description="by joint and field, from the least to the largest value, in these units"
    )
    notes: list[str] = Field(default_factory=list, description="what was done and what is odd, one sentence each")


class LogResult(Result):
    """harness log."""

    schema_: Literal["harness.log/1"] = Field(default="harness.log/1", alias="schema")
    file: str
    topics: list[Topic]
