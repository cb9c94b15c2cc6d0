"""Results of harness run: harness.run/1, and of a robot's joint in the engines, harness.joint/1."""

from collections.abc import Mapping
from typing import Any, Literal, Self

from pydantic import ConfigDict, Field

from harness.results.common import Machine, P, Paged, Result, Settings
from harness.results.robot import PasteResult, ReductionResult


class Metrics(Result):
    """How far a trace is from the exact one; null where the scenario has no such figure.

    A scenario that is no free decay has figures of its own beside these (period_s, stick_fraction, ...), SI units.
    """

    model_config = ConfigDict(extra="allow")
    __pydantic_extra__: dict[str, float | None] = Field(init=False)

    max_error_m: float | None = Field(description="largest |x - exact x|, m")
    rest_error_m: float | None = Field(description="last x minus the exact rest position, m")
    stick_time_s: float | None = Field(description="time from which the slider does not move any more, s")
    creep_m_s: float | None = Field(description="mean speed over the part in which the exact slider rests, m/s")
    half_cycles: int | None = Field(description="half-cycles until it rests")
    reversal_lead_s: float | None = Field(description="by how much friction reverses before the speed does, s")
    energy_error: float | None = Field(description="largest error of the energy balance over the starting energy")
    lift_m: float | None = Field(default=None, description="contact route: largest height above the floor, m")

    @classmethod
    def of(cls, found: Mapping[str, float | None]) -> Self:
        """From figures by name; those of every scenario that are not among them are null."""
        return cls.model_validate(dict.fromkeys(cls.model_fields) | dict(found))


class Estimates(Result):
    """What one estimator reads from one trace."""

    omega_n: P
    zeta: P
    x_k: P
    reversals: int
    per_reversal: list[dict[str, Any]] = Field(default_factory=list)
    guard_s: float | None = Field(default=None, description="time skipped on each side of a reversal, s")
    lead_s: P | None = Field(default=None, description="by how much friction reverses before the speed does, s")
    notes: list[str] = Field(default_factory=list)


class TraceResult(Result):
    """One source of the run."""

    source: str
    preset: str
    version: str
    settings: Settings
    ignored: list[str]
    dt_s: float | None
    wall_s: float | None
    samples: int
    metrics: Metrics
    estimates: dict[str, Estimates]
    error: str | None = Field(default=None, description="why this run could not be completed")

    @property
    def label(self) -> str:
        """Source and preset, as tables and plots show them."""
        return f"{self.source} {self.preset}".strip()


class RunResult(Paged):
    """harness run."""

    schema_: Literal["harness.run/1"] = Field(default="harness.run/1", alias="schema")
    scenario: dict[str, Any]
    traces: list[TraceResult]
    conclusions: list[str] = Field(default_factory=list, description="what differs and why, in sentences")
    command: str = Field(default="", description="the line that makes it again")
    machine: Machine
    files: dict[str, str]


class JointScore(Result):
    """What one engine makes of the joint's dry friction."""

    engine: str
    preset: Literal["as-shipped", "tuned"] = Field(description="as-shipped: MuJoCo with the words of the user's file")
    version: str
    dt_s: float | None
    creep: float | None = Field(description="under the load, rad/s or m/s; 0 is right, null without friction")
    reversal_lead_s: float | None = Field(description="by which friction reverses before the velocity; 0 is right")
    settings: Settings
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
        default=False, description="by both conditions; without a damping its velocity reverses at every step"
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


class JointRunResult(Paged):
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
