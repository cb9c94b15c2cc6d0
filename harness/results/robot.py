"""Results of robots: what a diagnosis says of a joint besides, and what a log holds (harness.log/1)."""

from typing import Annotated, Literal

from pydantic import BeforeValidator, Field

from harness.results.common import Floats, MotionResult, P, Paged, Result, Span, rare

Pair = Annotated[list[str], Field(min_length=2, max_length=2)]


class ReductionResult(Result):
    """A joint's own equation, the other joints locked, as the model has it; kg m^2 and N m, kg and N for a slide."""

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
    isaac: str = Field(default="", description="Isaac Lab's actuators, and attributes of PhysX's joints in a USD")
    newton: str = Field(default="", description="of a ModelBuilder")
    sdf: str = Field(default="", description="in the joint's axis")
    genesis: str = Field(default="", description="of a RigidEntity")
    drake: str = Field(default="", description="of a MultibodyPlant")
    ros2: str = Field(default="", description="parameters of a controller: Coulomb, viscous, width of a tanh")
    warning: str = Field(default="", description="why it is not to be pasted yet; empty where it helps")


class MatchResult(Result):
    """A joint's logged torque against what the model needs, before anything is named."""

    joint: str
    by: str = Field(description="gravity, inertia, or empty where neither loads it")
    correlation: float | None = Field(description="of logged and modelled torque, friction taken off both")
    slope: float | None = Field(description="logged over modelled torque")
    slope_stderr: float | None
    offset: float = Field(description="constant torque beside them, N m or N")
    suspicion: str = Field(description="what is wrong with it or not checked; empty for nothing")
    option: str = Field(description="of the command, that mends it; empty where none does")


class EntryResult(Result):
    """Something that a log of a whole arm shows: of a joint's friction, or of the model."""

    name: str
    family: str = Field(description="friction, or model for what is wrong with it")
    joint: str | None = Field(description="null for the whole arm")
    partner: str = Field(default="", description="what no log of this kind can tell it from: the entry is of both")
    grade: str
    share: float = Field(description="of what the base leaves beyond the noise")
    evidence: float = Field(description="square of estimate over standard error, of one number")
    bic: float | None = Field(default=None, description="the same less the logarithm of the samples that show it")
    probability: float | None = Field(default=None, description="that it is missing")
    rivals: list[str] = Field(description="what would do nearly as well, with its joint where that is another")
    parameters: dict[str, P]
    statement: str


class LawResult(Result):
    """One way to say a friction curve."""

    name: str
    probability: float = Field(description="beside the other laws")
    parameters: Annotated[dict[str, P], BeforeValidator(dict)]


class ChangeOfFriction(Result):
    """How friction changes with something beside speed."""

    what: str
    by: P | None = Field(description="of friction along the motion, for one unit of it; null where it is not covered")
    why: str = Field(default="", description="then what the log lacks")
    surely: bool = Field(description="by more than two errors")


class CurveResult(Result):
    """Friction of a joint over its speed, mean over the positions and loads of the log."""

    v: Floats = Field(description="rad/s or m/s, rising, in both directions; linear between them")
    friction: Floats = Field(description="N m or N, of the sign of v")
    low: Floats = Field(description="band of 95 %, as wide as blocks of the log differ")
    high: Floats
    unit: str
    laws: list[LawResult] = Field(description="the most probable first, down to .01")
    apart: float = Field(description="probability of such a difference between the directions where there is none")
    break_away: P | None = Field(description="at its zero; null where the log does not show it")
    presliding: P | None = Field(description="distance over which friction builds up after a reversal; or null")
    changes: list[ChangeOfFriction]
    left: float | None = Field(description="rms of torque that was not fitted, beside the curve")
    line: list[P] = Field(description="Coulomb and viscous friction that come nearest at the speeds that occur")


class JointResult(Result):
    """Friction of one joint of an arm that moves as a whole, everything that is named beside it."""

    joint: str
    f_k: P
    c: P
    offset: P
    held_out_before: float | None = Field(description="rms torque of what was not fitted, by the base")
    held_out_after: float | None = Field(description="and by the model with everything named")
    over_noise: float | None = Field(
        description="rms of what is left, away from reversals, over that of the noise of torque and positions"
    )
    guard_s: float | None = Field(description="skipped on each side of a reversal")
    samples: int = Field(description="that were fitted")
    curve: CurveResult | None = rare("null where too few speeds occur")
    statement: str


class ArmResult(Result):
    """The whole arm: every joint, and what is wrong with its model."""

    joints: list[JointResult]
    found: list[EntryResult]
    lowpass_hz: float
    rate_hz: float
    seconds: float


class IdentifiableResult(Result):
    """Whether the motion of a log can tell a number of a joint's friction, before anything is fitted."""

    joint: str
    parameter: str
    verdict: Literal["identifiable", "weak", "not"]
    error: float | None = Field(description="that it would have, over the joint's torque; null where it hardly moves")
    why: str = Field(description="what it goes with, or that the motion is too short; empty where it is identifiable")
    mend: str = Field(description="the motion that would part them")


class SimulatedResult(Result):
    """A joint in one engine against its log, driven by its torque, in windows that begin at the smoothed log."""

    engine: str
    joint: str | None = rare("where a result is of all joints")
    version: str = ""
    dt_s: float | None = Field(description="the model's own")
    window_s: float | None
    windows: int
    before: dict[str, float] = Field(description="rms of x (rad or m) and v by the model's file as it is")
    after: dict[str, float] = Field(description="and by the copy that has what is to be pasted")
    left_out: list[str] = Field(default_factory=list, description="what the engine has no word for")
    error: str | None = None


class ServoTermResult(Result):
    """A piece of a servo's physics that its log asks for."""

    name: str
    said: str
    evidence: float = Field(description="by which BIC is better with it")
    parameters: dict[str, P]
    held_out_mrad: list[float] = Field(description="mean absolute error of what was not fitted, before and after")
    rivals: dict[str, float] = Field(description="terms that are not ruled out in its place, by how much worse")


class ServoErrorResult(Result):
    """What free runs of a log, or of a part that was not fitted, miss its positions by; mean absolute, mrad."""

    of: str
    before: float = Field(description="with torque, damping, delay, inertia and dry friction alone")
    after: float = Field(description="with everything named")


class ServoNumberResult(Result):
    """Whether a log tells a number."""

    parameter: str
    verdict: Literal["identifiable", "weak", "not"]
    why: str


class ServoResult(Result):
    """A joint under its servo, from goals and positions."""

    servo: str | None = Field(description="preset; null where nobody named one")
    source: str = Field(description="of the preset")
    scale: Literal["gravity", "data sheet", "inertia"] = Field(
        description="what gives torques: gravity's, the data sheet's, or nothing: then all is a ratio to the inertia"
    )
    understood: list[str] = Field(description="what was read and taken, one sentence each")
    base: dict[str, P] = Field(description="with torque, damping, delay, inertia and dry friction alone")
    parameters: dict[str, P]
    stiffness: P = Field(description="torque over error of position, at the nominal voltage and the first gain")
    stall: P = Field(description="torque at rest with all of the duty")
    terms: list[ServoTermResult]
    fitted: list[ServoErrorResult] = Field(description="each log")
    held_out: list[ServoErrorResult] = Field(description="each part that was held out, by a fit of the rest")
    floor_mrad: float = Field(description="rms of the positions' noise and steps")
    confounded: list[str] = Field(description="what goal and position cannot part, one sentence each")
    identifiable: list[ServoNumberResult]
    bam: dict[str, float | str] = Field(description="as a file of BAM's parameters has it; empty without a scale")
    not_in_bam: list[str]


class RobotResult(Result):
    """A joint of a robot."""

    file: str = Field(description="of the model, absolute; empty where a servo's log has none")
    joint: str = Field(description='"all" for every joint, whose parameters then have its name before theirs')
    mode: Literal["locked", "whole-arm", "servo"]
    reduction: ReductionResult | None = Field(description="null where the whole arm moves")
    confounded: list[Pair] = Field(description="what this log cannot distinguish, whatever the fit says")
    paste: PasteResult
    match: list[MatchResult] = Field(default_factory=list, description="the log against its model, before a fit")
    simulated: list[SimulatedResult] = Field(default_factory=list, description="the copy of the model in engines")
    identifiable: list[IdentifiableResult] = rare("where the whole arm moves: what its motion can tell", list)
    arm: ArmResult | None = rare()
    servo: ServoResult | None = rare("where goal and position are the log")


class Topic(Result):
    """A topic of a bag, an episode of a data set, or a table."""

    name: str
    type: str = Field(description='the type of its messages, "table" or "episode"')
    count: int = Field(description="messages or rows")
    rate_hz: float | None = Field(description="by the median interval; null where no times are read")
    joints: list[str]
    fields: list[str] = Field(
        description="position, velocity, effort; current (A); magnitude, an effort without its sign; of servos"
    )
    units_guessed: dict[str, str] = Field(description="the unit each field is read in")
    gaps_s: list[Span] = Field(description="[from, to], where more than five intervals are missing")
    ranges: dict[str, dict[str, list[float]]] = Field(
        default_factory=dict, description="by joint and field, from the least to the largest value, in these units"
    )
    notes: list[str] = Field(default_factory=list, description="what was done and what is odd, one sentence each")


class PreviewResult(Result):
    """A recording as it was read, before anything is fitted."""

    columns: dict[str, str] = Field(description="by channel, the column of the file as --columns takes it")
    samples: int
    rate_hz: float = Field(description="by the median interval")
    duration_s: float
    units: dict[str, str] = Field(description="of what stands below, by channel and t")
    first: dict[str, list[float]] = Field(description="the first three samples, by channel and t")
    ranges: dict[str, list[float]] = Field(description="by channel, from the least to the largest value")
    envelope: dict[str, list[list[float]]] = Field(
        description="by channel, the least and the largest value in each of up to 144 equal spans of the samples"
    )
    motion: MotionResult
    notes: list[str] = Field(description="what was guessed, mended and skipped, one sentence each")


class LogResult(Paged):
    """harness log."""

    schema_: Literal["harness.log/1"] = Field(default="harness.log/1", alias="schema")
    file: str
    topics: list[Topic]
    recording: PreviewResult | None = rare()
