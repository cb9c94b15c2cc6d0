"""What changed of a machine between two conditions: harness.change/1."""

from typing import Literal

from pydantic import Field

from harness.results.common import Machine, P, Paged, RecordingInfo, Result, rare


class ChangedNumber(Result):
    """A number of the machine in both conditions."""

    name: str = Field(description='"c", "f_k", "quadratic-drag.c2"; "inertia" where a mass that is not known changed')
    said: str = Field(description="what it is, in words")
    before: P | None = rare("fitted jointly to all recordings before")
    after: P | None = rare("the same afterwards; as before where it did not change")
    ratio: P = Field(description="after over before, as if it might have changed whether or not it did")
    changed: bool
    repeats: float | None = rare("standard deviation of repeats beyond their errors, in the unit of the number")


class ChangedCovariate(Result):
    """A covariate in both conditions."""

    name: str
    before: float = Field(description="mean of the recordings before, in the column's own unit")
    after: float


class ChangeResult(Paged):
    """harness diagnose --before ... --after ..."""

    schema_: Literal["harness.change/1"] = Field(default="harness.change/1", alias="schema")
    statement: str = Field(description="what changed, by how much, and what did not")
    changed: list[str] = Field(description="names of what changed, the clearest first; empty where nothing did")
    chance: float = Field(description="that two conditions which are alike differ so much")
    left: float = Field(description="that conditions which differ in nothing else differ so much")
    numbers: list[ChangedNumber]
    laws: list[str] = Field(description="catalogue names beside viscous and dry friction that both were read with")
    given: list[ChangedCovariate] = rare("covariates, whose push is no change of the machine", list)
    before: list[RecordingInfo]
    after: list[RecordingInfo]
    warnings: list[str]
    command: str = Field(default="", description="the line that makes it again")
    machine: Machine
    files: dict[str, str] = Field(default_factory=dict)
