"""A motion that tells the friction of a robot's joints: harness.plan/1."""

from typing import Literal

from pydantic import Field

from harness.results.common import Machine, Paged, Result


class PlannedJoint(Result):
    """One joint of it."""

    joint: str
    slides: bool = Field(default=False, description="whether it slides, in m and N, and does not turn, in rad and N m")
    low: float = Field(description="of its way, rad or m")
    high: float
    speed: float = Field(description="largest, rad/s or m/s")
    torque: float = Field(description="largest that the model needs, its own friction among it, N m or N")
    limits: list[float | None] = Field(description="low, high, speed, torque; null where there is none")
    better: list[float] = Field(description="errors of Coulomb and viscous friction, random motions over this one")


class PlanResult(Paged):
    """harness plan."""

    schema_: Literal["harness.plan/1"] = Field(default="harness.plan/1", alias="schema")
    robot: str = Field(description="file of the model, absolute")
    seconds: float
    rate_hz: float
    joints: list[PlannedJoint]
    better: float = Field(description="geometric mean of how many times smaller errors are than by random motions")
    better_than_drawn: float = Field(
        description="the same of random motions that are not made as large as limits allow"
    )
    better_than_conditioned: float = Field(description="the same of the random motion of the least condition number")
    notes: list[str]
    files: dict[str, str]
    command: str = ""
    machine: Machine
