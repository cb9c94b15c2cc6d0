"""The result of comparing two traces: harness.compare/1."""

from typing import Any, Literal

from pydantic import Field

from harness.results.common import P, Result, Where


class CompareResult(Result):
    """harness compare."""

    schema_: Literal["harness.compare/1"] = Field(default="harness.compare/1", alias="schema")
    files: list[str]
    aligned: dict[str, P]
    noise: dict[str, float | str | None]
    rmse: dict[str, float]
    where: list[Where]
    consistent_channels: dict[str, Any]
    verdict: Literal["same within noise", "different"]
