"""What a diagnosis says of a robot's joint besides: its own equation, what cannot be told apart, what to paste."""

from typing import Annotated, Literal

from pydantic import Field

from harness.results.common import Result

Pair = Annotated[list[str], Field(min_length=2, max_length=2)]


class ReductionResult(Result):
    """A joint's own equation with the others still, as the model has it; kg m^2 and N m, kg and N for a slide."""

    inertia: float = Field(description="of what the joint moves, without its rotor")
    armature: float = Field(description="of its rotor")
    gravity: float = Field(description="largest torque of gravity, N m; of a slide its force, N")
    rest_angle: float | None = Field(description="where gravity leaves it at rest, rad; null where it does not")
    spring: float = Field(description="of the joint itself, N m/rad or N/m")
    spring_rest: float = Field(description="where that is slack, rad or m")
    frictionloss: float = Field(description="as the model has it")
    damping: float = Field(description="as the model has it")
    held: dict[str, float] = Field(description="where the others stand, rad or m")
    said: str


class PasteResult(Result):
    """Text for the user's own model."""

    mjcf: str
    urdf: str


class RobotResult(Result):
    """A joint of a robot."""

    file: str = Field(description="of the model, absolute")
    joint: str
    mode: Literal["locked", "whole-arm"]
    reduction: ReductionResult | None = Field(description="null where the whole arm moves")
    confounded: list[Pair] = Field(description="what this log cannot tell apart, whatever the fit says")
    paste: PasteResult
