"""Result of harness run --scene: harness.scene/1."""

from typing import ClassVar, Literal

from pydantic import Field

from harness.results.common import Machine, Paged, Result, Settings, rare


class SceneTouch(Result):
    """A pair of geoms in contact, as the file has it; means of the later half of the run."""

    own: str
    other: str
    condim: int
    friction: list[float] = Field(description="sliding (two directions), torsional (m), rolling (two, m)")
    rule: str = Field(description="whose friction the contact has")
    normal: float = Field(description="force, N")
    use: float = Field(description="share of the friction cone, 1 where it slides")


class SceneMotion(Result):
    """What the later half of a run shows, against what bears the body."""

    creep_m_s: float = Field(description="mean speed of the body's centre across the contact")
    lift_m: float = Field(description="largest distance away from the contact")
    spin_rad_s: float = Field(description="about the normal of the contact, mean")
    roll_rad_s: float = Field(description="about what lies across it, mean")
    slip_m_s: float = Field(description="at which the contacts themselves slide, mean")
    travel_m: float = Field(description="over the whole run")
    deceleration_m_s2: float | None = Field(description="of a motion; null where none is read")
    cone_use: float | None = Field(
        description="share of the friction cones, weighed by force, until it is let go; null without contact"
    )
    lost_s: float | None = Field(description="time of the last contact with what holds it; null: it does not end")
    diverged_after: int | None = Field(description="steps; null: it does not")
    steps_per_s: float


class SceneTried(SceneMotion):
    """The same scene with some options changed."""

    options: Settings
    mends: bool = Field(description="whether the body then does what dry friction would do")


class SceneDrift(Result):
    """How far it came in the later half of the run."""

    slide_m: float
    spin_rad: float
    roll_rad: float
    lift_m: float


Part = Literal["slide", "spin", "roll", "lift", "motion", "lets go", "diverges", "sparse"]


class SceneExpected(SceneMotion):
    """What dry friction would do: the run of a hard elliptic cone and a solver that has converged."""

    rests: bool


class SceneResult(SceneMotion, Paged):
    """harness run --scene: a body of the user's own file, stepped under its own options."""

    LINES: ClassVar[str] = "tried"

    schema_: Literal["harness.scene/1"] = Field(default="harness.scene/1", alias="schema")
    file: str
    engine: str = "mujoco"
    version: str
    body: str
    bearer: str = Field(description="the body it is pressed against most, which motions are measured from")
    bearers: list[str] = Field(default=[], description="all bodies that hold it, under dry friction")
    start: str = Field(description="keyframe it begins at; empty: the model's reference")
    duration_s: float
    step_s: float
    settings: Settings = Field(description="options in force")
    drift: SceneDrift
    expected: SceneExpected
    moved: list[Part] = Field(description="what dry friction would not do; empty: nothing")
    touches: list[SceneTouch]
    tried: list[SceneTried] = Field(description="the least change first")
    changed: SceneTried | None = Field(description="the least change that mends it, else what comes nearest; or null")
    change: str = Field(description="the same as a diff of the file; empty where there is nothing to change")
    proved: bool = Field(description="the changed file was run, and does as said")
    dense_differs_m: float | None = rare("largest distance from a dense Jacobian, where MuJoCo's version needs it")
    conclusions: list[str]
    command: str = ""
    machine: Machine
    files: dict[str, str]
