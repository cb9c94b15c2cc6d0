"""The result of comparing two traces: harness.compare/1."""

from typing import Literal

from pydantic import Field

from harness.results.common import Machine, P, RecordingInfo, Result, Where


class ChannelPair(Result):
    """What one channel of a trace says of another: gain, lag (the first against the second) and offset."""

    gain: P
    lag_s: P
    offset: P
    consistent: bool
    sentence: str


class CompareResult(Result):
    """harness compare."""

    schema_: Literal["harness.compare/1"] = Field(default="harness.compare/1", alias="schema")
    files: list[str] = Field(description="the simulated trace and the recorded one")
    aligned: dict[str, P]
    noise: dict[str, float | str | None] = Field(description="of the difference, by channel, SI units")
    rmse: dict[str, float]
    where: list[Where]
    consistent_channels: dict[str, dict[str, ChannelPair]] = Field(
        description='by trace ("sim", "real") and pair ("x-a")'
    )
    verdict: Literal["same within noise", "different"]
    p_value: float | None = Field(default=None, description="chance that noise alone differs so much")
    sentences: list[str] = Field(default_factory=list)
    recordings: list[RecordingInfo] = Field(default_factory=list)
    command: str = Field(default="", description="the line that makes it again")
    machine: Machine | None = None
    outputs: dict[str, str] = Field(default_factory=dict)
