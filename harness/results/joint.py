"""The result of a robot's joint in the engines: harness.joint/1."""

from typing import Any, Literal

from pydantic import Field

from harness.results.common import Machine, Result
from harness.results.robot import PasteResult, ReductionResult


class JointScore(Result):
    """What one engine makes of the joint's dry friction."""

    engine: str
    preset: Literal["as-shipped", "tuned"] = Field(description="as-shipped: MuJoCo with the words of the user's file")
    version: str
    dt_s: float | None
    creep: float | None = Field(description="under the load, rad/s or m/s; 0 is right, null without friction")
    reversal_lead_s: float | None = Field(description="by which friction turns round before the speed does; 0 is right")
    settings: dict[str, Any]
    ignored: list[str] = Field(default_factory=list)
    error: str | None = None


class ServoScore(Result):
    """What a time step does to a servo's damping: the law of one who computes it."""

    who: str
    false_damping: float | None = Field(description="N m s/rad or N s/m beyond what was asked for; null: it diverges")
    zeta: float | None


class ServoResult(Result):
    """The servo that the model has on the joint."""

    stiffness: float = Field(description="N m/rad or N/m")
    damping: float = Field(description="of servo and joint, N m s/rad or N s/m")
    zeta: float
    step_s: float
    scores: list[ServoScore]


class JointRunResult(Result):
    """harness run --robot."""

    schema_: Literal["harness.joint/1"] = Field(default="harness.joint/1", alias="schema")
    file: str
    joint: str
    slides: bool
    step_s: float = Field(description="of the model")
    reduction: ReductionResult
    load: float | None = Field(description="that creep is measured under, N m or N")
    scores: list[JointScore]
    servo: ServoResult | None
    paste: PasteResult
    conclusions: list[str]
    command: str = ""
    machine: Machine
    files: dict[str, str]
