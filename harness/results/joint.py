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
    false_damping: float | None = Field(
        description="N m s/rad or N s/m beyond what was asked for; null: it diverges, or see stable"
    )
    zeta: float | None
    stable: bool = Field(
        default=False, description="by both conditions; without a damping its speed turns round at every step"
    )


class ServoCure(Result):
    """What makes a servo stable, one thing at a time, as little as it takes; null where that alone does not."""

    stiffness: float | None = Field(description="largest, at the joint, N m/rad or N/m")
    kp: float | None = Field(description="the same as the actuator's gain; null where there is not one actuator")
    damping: float | None = Field(description="largest of the servo, at the joint, N m s/rad or N s/m")
    step_s: float | None = Field(description="largest")
    armature: float | None = Field(description="least that is to be added, kg m^2 or kg")
    integrators: list[str] = Field(description="of MuJoCo, with which it is stable at this step")


class ServoResult(Result):
    """The servo that the model has on the joint."""

    stiffness: float = Field(description="N m/rad or N/m")
    damping: float = Field(description="of servo and joint, N m s/rad or N s/m")
    zeta: float | None = Field(description="null where it has no stiffness")
    step_s: float
    scores: list[ServoScore]
    diverges_after: int | None = Field(
        default=None, description="steps of the file itself, let go beside its target; null: it does not"
    )
    cure: ServoCure | None = Field(default=None, description="null where it is stable")


class StopResult(Result):
    """The joint let go at a speed without a load, until a twentieth of it is left; null where more than 4 s are."""

    speed: float = Field(description="rad/s or m/s")
    time_s: float | None
    exact_time_s: float = Field(description="by Coulomb's law and the damping there is")
    travel: float | None = Field(description="rad or m")
    exact_travel: float


class AsItIsResult(Result):
    """The user's file itself, stepped by an engine under its own options, the other joints held."""

    engine: str
    preset: Literal["as-shipped", "tuned"] = Field(description="of MuJoCo always the file's own options")
    version: str
    dt_s: float
    friction: float = Field(description="dry friction in force, of joint, tendon and motor, N m or N")
    break_away: float = Field(description="load at which it gives way")
    switched_off: float = Field(default=0.0, description="friction that the file has and a flag of it disables")
    gravity: float = Field(description="largest torque or force after compensation, N m or N")
    damping: float = Field(description="of the joint without its servo, N m s/rad or N s/m")
    load: float | None
    pose: float | None = Field(description="in which gravity is that load; null where the load was put on")
    creep: float | None = Field(description="along the load, second half of half a second, rad/s or m/s")
    stop: StopResult | None = None
    diverges_after: int | None = Field(description="steps, without servo; null: it does not")
    differs: str | None = Field(default=None, description="from the reduced slider, and why")
    notes: list[str] = Field(default_factory=list)


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
    as_it_is: list[AsItIsResult] = Field(default_factory=list)
    servo: ServoResult | None
    paste: PasteResult
    conclusions: list[str]
    command: str = ""
    machine: Machine
    files: dict[str, str]
