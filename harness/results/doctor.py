"""The result of looking at the installation: harness.doctor/1."""

from typing import Literal

from pydantic import Field

from harness.results.common import Machine, Result


class Check(Result):
    """One thing that works or does not."""

    name: str
    ok: bool
    found: str = Field(description="a version, a path, or what is wrong")
    needed_for: str = Field(description="what does not work without it")
    remedy: str | None = Field(default=None, description="what to do when it is not there")


class DoctorResult(Result):
    """harness doctor."""

    schema_: Literal["harness.doctor/1"] = Field(default="harness.doctor/1", alias="schema")
    checks: list[Check]
    machine: Machine
