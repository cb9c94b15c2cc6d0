"""Results of the fidelity suite: a sweep, baselines and what is compared with them, a search of settings."""

from typing import Any, ClassVar, Literal

from pydantic import Field

from harness.results.common import Machine, Paged, Result, rare


class SweepRow(Result):
    """One engine, route, set of settings, step and scenario; metrics, or the reason why there are none."""

    key: str = Field(description="16 hex digits, the same for the same inputs and versions")
    name: str = Field(description="the row as baselines know it, with the version of its engine")
    engine: str
    version: str
    environment: str = Field(default="", description="where the engine ran, empty for the environment of the program")
    route: Literal["joint", "contact", "law"]
    preset: str = Field(description="as-shipped, tuned, or the name of another set of settings")
    settings: dict[str, Any] = Field(description="every setting in force")
    changed: dict[str, Any] = Field(description="those that differ from the preset this one starts from")
    ignored: list[str] = Field(description="what the engine does not honour, one sentence each")
    integrator: str
    effort: dict[str, int] | None = rare("of the solver: iterations, ls_iterations, where the engine has both")
    apart_m: dict[str, float] | None = rare(
        "largest difference of position between runs, worlds and devices; 0 is the same to the last bit"
    )
    not_again: dict[str, str] | None = rare("why it did not run again, by runs, worlds and devices")
    dt_s: float | None
    scenario: str
    slider: dict[str, float]
    setup: dict[str, Any] = Field(description="the whole scenario: slider, release, duration, action")
    draw: int = Field(description="0 for the suite's own sliders, else the number of the random ones")
    metrics: dict[str, float | None]
    exact: dict[str, float] = Field(description="exact values of those metrics that have one other than 0")
    samples: int
    wall_s: float | None
    steps_per_s: float | None
    error: str | None = Field(description="why this row could not be run")


class Convergence(Result):
    """Errors of rows that differ in their step alone: error ~ dt^order."""

    engine: str
    version: str
    route: str
    preset: str
    integrator: str
    scenario: str
    metric: str
    dt_s: list[float]
    error: list[float]
    order: float
    spread: float = Field(description="largest factor between an error and the fitted line")


class SweepResult(Paged):
    """harness sweep."""

    LINES: ClassVar[str] = "rows"

    schema_: Literal["harness.sweep/1"] = Field(default="harness.sweep/1", alias="schema")
    machine: Machine
    command: str = Field(default="", description="the line that makes it again")
    notes: list[str] = Field(default_factory=list, description="what happened on the way: damaged parts, dead workers")
    files: dict[str, str] = Field(default_factory=dict)
    rows: list[SweepRow]
    convergence: list[Convergence]


class BaselineRow(Result):
    """What a baseline keeps of a row of the matrix; never how fast it was."""

    engine: str
    version: str
    environment: str = Field(default="", description="where the engine ran, empty for the environment of the program")
    route: str
    scenario: str
    dt_s: float | None
    metrics: dict[str, float | None]
    exact: dict[str, float]
    error: str | None


class Baseline(Result):
    """Rows by name, to compare later ones with."""

    schema_: Literal["harness.baseline/1"] = Field(default="harness.baseline/1", alias="schema")
    machine: Machine
    rows: dict[str, BaselineRow]


Verdict = Literal["worse", "better", "lost", "gained", "fails", "works", "missing", "new"]


class Moved(Result):
    """One thing that is not as it was."""

    name: str
    metric: str = Field(description="empty when the whole row changed")
    before: float | None
    after: float | None
    verdict: Verdict
    why: str
    expected: str | None = rare("why the row is known to fail; then it is no regression")
    times: float | None = rare("the change over what is allowed")


class RegressResult(Paged):
    """harness regress."""

    LINES: ClassVar[str] = "moved"

    schema_: Literal["harness.regress/1"] = Field(default="harness.regress/1", alias="schema")
    baseline: str
    rows: int = Field(description="rows that were compared")
    moved: list[Moved]
    regressions: int
    not_run: list[str] = Field(default_factory=list, description="engines of the baseline that are not installed here")
    skipped: dict[str, str] = Field(default_factory=dict, description="rows that were not to be run, and why")
    passed: dict[str, str] = Field(
        default_factory=dict, description="rows that were known to fail and do not, and why they were"
    )
    unused: list[str] = Field(default_factory=list, description="patterns that no row has the name of")
    versions: dict[str, Any] = Field(default_factory=dict, description="engine versions, baseline's and these")
    machine: Machine


class DiffSide(Result):
    """One of two that are compared."""

    given: str = Field(description="as it was named: an engine, with its version or interpreter, or a sweep")
    engines: list[str] = Field(description="with versions, and environments where they were not the program's own")
    rows: int


class DiffResult(Paged):
    """harness diff."""

    LINES: ClassVar[str] = "moved"

    schema_: Literal["harness.diff/1"] = Field(default="harness.diff/1", alias="schema")
    statement: str
    before: DiffSide
    after: DiffSide
    rows: int = Field(description="rows that both have, and that were compared")
    moved: list[Moved] = Field(description="beyond tolerance, regressions first, the largest of them first")
    new: list[str] = Field(description="rows that only the second has")
    skipped: dict[str, str] = Field(description="rows, or all of an engine, that one lacks, and why")
    passed: dict[str, str] = Field(description="rows that were known to fail and do not, and why they were")
    unused: list[str] = Field(description="patterns that no row has the name of")
    regressions: int
    files: dict[str, str] = Field(default_factory=dict)
    machine: Machine


class TunedFigure(Result):
    """One figure of the scorecard on sliders that were not searched on, relative distances from exact, means."""

    name: str
    before: float | None
    after: float | None


class TunedGoal(Result):
    """A figure that was to stay below a limit: its largest distance from exact on sliders that were not searched on."""

    name: str
    metric: str
    limit: float = Field(description="in the unit, as the values")
    before: float | None = Field(description="null where it could not be run")
    after: float | None
    unit: str
    met: bool


class TunedJoint(Result):
    """A robot's joint that settings were searched for."""

    file: str = Field(description="of the model, absolute")
    joint: str
    inertia: list[float] = Field(description="kg m^2 or kg that it moves, a pose of the others each: searched, scored")
    gravity: list[float] = Field(description="largest torque of gravity in each, N m; of a slide its force, N")


class TunedRival(Result):
    """An engine that settings were searched for beside the one that was chosen."""

    engine: str
    version: str
    met: bool = Field(description="whether it meets every goal on sliders that were not searched on")
    seconds: float | None = Field(description="wall time of a second of motion with its settings")
    why: str | None = rare("why it could not be searched")


class TuneResult(Paged):
    """harness tune."""

    LINES: ClassVar[str] = "figures"

    schema_: Literal["harness.tune/1"] = Field(default="harness.tune/1", alias="schema")
    engine: str
    version: str
    route: Literal["joint", "contact", "law"]
    dt_s: float
    max_cost: float | None = Field(description="allowed wall time over that of what ships at the same step")
    changed: dict[str, Any] = Field(description="settings that differ from what ships")
    settings: dict[str, Any] = Field(description="every setting in force")
    paste: str = Field(description="XML or calls that make these settings")
    score_before: float = Field(description="what ships, on sliders that were not searched on; lower is better")
    score_after: float
    score_preset: float = Field(description="the preset tuned, for comparison")
    cost: float = Field(description="measured wall time over that of what ships at the same step")
    figures: list[TunedFigure]
    searched: int = Field(description="sets of settings that were scored")
    sliders: dict[str, list[int]] = Field(
        description="numbers of the random suites, or of a robot's poses: searched on, scored on"
    )
    goals: list[TunedGoal] = rare(factory=list)
    seconds: float | None = rare("wall time of a second of motion with these settings, where goals were asked")
    rivals: list[TunedRival] = rare("every engine that was asked, the chosen one among them", list)
    robot: TunedJoint | None = rare()
    machine: Machine
