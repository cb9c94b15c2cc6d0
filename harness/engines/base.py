"""The interface every engine implements: a Task goes in, a core Trajectory comes out."""

import math
from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from types import MappingProxyType
from typing import Any, ClassVar, Literal, TypeAlias, get_args

from harness.core.checks import positive
from harness.core.errors import HarnessError, InputError, SimulationError, did_you_mean
from harness.core.registered import version
from harness.core.scenario import Body, CurveBelt, Scenario
from harness.core.trajectory import Trajectory
from harness.engines.forces import Drive, ForceLaw, curve_of
from harness.engines.joint_words import JointWords, Kinds

Route: TypeAlias = Literal["joint", "contact", "law"]
Preset: TypeAlias = Literal["as-shipped", "tuned"]
Restoring: TypeAlias = Literal["spring", "pendulum", "none"]
Settings: TypeAlias = Mapping[str, Any]

ROUTES: tuple[Route, ...] = get_args(Route)
PRESETS: tuple[Preset, ...] = get_args(Preset)
RESTORING: tuple[Restoring, ...] = get_args(Restoring)

TUNED_DT = 1e-3
"""Step of the tuned presets when none is given, s."""


def choice(where: str, found: str, accepted: tuple[str, ...]) -> None:
    """Raise InputError when ``found`` is not one of ``accepted``; the message lists them."""
    if found not in accepted:
        near = did_you_mean(found, accepted)
        raise InputError(where, repr(found), f"one of {', '.join(accepted)}{near}")


@dataclass(frozen=True, slots=True)
class Task:
    """One simulation.

    scenario : slider, start, duration and action. Action None is a free decay, Harmonic a force, Hold a constant
        load, Belt a floor that moves.
    route : where dry friction lives: "joint" (the engine's own joint friction), "contact" (a box on a floor, the
        engine's own contact friction), "law" (f = clip(-(m v/h + other forces), -f_k, f_k) as a force from outside,
        the same in every engine).
    preset : "as-shipped" or "tuned". dt : step in s, None for the preset's own.
    settings : overrides of the preset; ``Engine.presets`` lists the names there are.
    law, drive : further forces; a drive adds to the action.
    restoring : "spring" (k x), "pendulum" (k sin x) or "none" (k is not used).
    words : what the joint itself is given besides, for engines with native words.

    Raises InputError for a route, preset or restoring force that does not exist and for dt not above 0.
    """

    scenario: Scenario
    route: Route = "joint"
    preset: Preset = "tuned"
    dt: float | None = None
    settings: Settings = field(default_factory=dict)
    law: ForceLaw | None = None
    drive: Drive | None = None
    restoring: Restoring = "spring"
    words: JointWords | None = None

    def __post_init__(self) -> None:
        choice("route", self.route, ROUTES)
        choice("preset", self.preset, PRESETS)
        choice("restoring", self.restoring, RESTORING)
        if self.dt is not None:
            object.__setattr__(self, "dt", positive("dt", self.dt, "s"))
        object.__setattr__(self, "settings", MappingProxyType(dict(self.settings)))

    def steps(self, dt: float) -> int:
        """Number of steps of length dt (s) that reach the scenario's duration."""
        return max(1, math.ceil(self.scenario.duration / dt * (1.0 - 1e-12)))


class Engine(ABC):
    """A physics engine. Implementations are final, have no state of their own and are cheap to make.

    name : as in the entry point. package : what is installed of it, whose version it has. routes : those the engine
    has; the others are refused with a SimulationError. bodies : whether it has bodies with six freedoms, on the contact
    route. native : kinds of elements that its joint has words for; a term made of those needs no law. calls : whether
    something can be called within its steps, as force laws and a pendulum are. curves : whether it computes a
    CurveBelt's friction itself. batches : whether it runs many tasks at once. place : name of the environment it runs
    in, empty for that of this process.
    """

    name: ClassVar[str]
    package: ClassVar[str]
    routes: ClassVar[tuple[Route, ...]] = ROUTES
    bodies: ClassVar[bool] = False
    native: ClassVar[Kinds] = frozenset()
    calls: ClassVar[bool] = True
    curves: ClassVar[bool] = False
    batches: ClassVar[bool] = False
    place: ClassVar[str] = ""

    def version(self) -> str:
        """Version of the engine's package."""
        return version(self.package)

    @property
    def label(self) -> str:
        """Name, version, and place where that is not this process's: what tells two of one engine apart."""
        return f"{self.name}@{self.version()}" + (f"({self.place})" if self.place else "")

    @abstractmethod
    def presets(self, route: Route, preset: Preset, dt: float | None = None) -> dict[str, Any]:
        """Every setting of a preset on a route, "dt" (s) among them.

        dt None takes the preset's own step; settings that depend on the step are computed for it.
        """

    def task(
        self,
        scenario: Scenario,
        route: Route,
        preset: Preset,
        dt: float | None = None,
        settings: Settings | None = None,
    ) -> Task:
        """A scenario as this engine is told of it: friction that is a curve becomes a law, and words where it has them.

        See Task.
        """
        task = Task(scenario, route, preset, dt, settings or {})
        if self.curves or not isinstance(scenario.action, CurveBelt):
            return task
        level, words = curve_of(scenario.slider, scenario.action, self.native if route == "joint" else frozenset())
        # the curve ends at the break-away force by itself
        plain = replace(scenario, slider=replace(scenario.slider, f_s=None))
        return replace(task, scenario=plain, law=level, words=words)

    @abstractmethod
    def simulate(self, task: Task) -> Trajectory:
        """Run a task; sample 0 is the start, one sample a step follows.

        extra holds "friction_force" (N, on the left-hand side), on the contact route also "lift" (m) and
        "normal_force" (N). source.settings holds every setting in force, source.ignored what the engine does not
        honour. Raises InputError for settings that do not exist, SimulationError (with the reason) for what the engine
        cannot do or a run that diverged.
        """

    def simulate_all(self, tasks: Sequence[Task]) -> list[Trajectory | HarnessError]:
        """Run many tasks; one that fails is its error, in its place. What ran at once shares its wall time."""
        found: list[Trajectory | HarnessError] = []
        for task in tasks:
            try:
                found.append(self.simulate(task))
            except HarnessError as error:
                found.append(error)
        return found


def resolve(engine: Engine, task: Task) -> dict[str, Any]:
    """The preset's settings with the task's overrides; values keep the type of the preset's.

    Raises InputError listing the settings there are for a name that is unknown, and for a value of a wrong type;
    SimulationError for a route the engine does not have.
    """
    if task.route not in engine.routes:
        raise SimulationError(f"{engine.name}: no {task.route} route; there is {', '.join(engine.routes)}")
    if isinstance(task.scenario.action, Body) and not (engine.bodies and task.route == "contact"):
        raise SimulationError(f"{engine.name}: no bodies with six freedoms on the {task.route} route")
    if task.words is not None and (not engine.native or task.route != "joint"):
        raise SimulationError(f"{engine.name}: its joint has no words for polynomials on the {task.route} route")
    if isinstance(task.scenario.action, CurveBelt) and task.law is None and not engine.curves:
        raise SimulationError(f"{engine.name}: the belt's curve is none of the task's laws; Engine.task makes it one")
    if not engine.calls and (task.law is not None or task.restoring == "pendulum"):
        raise SimulationError(f"{engine.name}: no force laws and no pendulum: nothing can be called within its steps")
    settings = engine.presets(task.route, task.preset, task.dt)
    for name, value in task.settings.items():
        where = f"{engine.name} setting {name}"
        if name == "dt":
            raise InputError(where, "dt among the settings", "the step is given as dt itself")
        if name not in settings:
            raise InputError(where, "unknown", f"one of {', '.join(sorted(settings))}")
        settings[name] = _like(where, settings[name], value)
    return settings


def _like(where: str, pattern: object, value: Any) -> Any:
    """``value`` as the type of ``pattern``: bool, int, float, str, or a tuple of as many floats."""
    try:
        if isinstance(pattern, tuple):
            numbers = tuple(float(number) for number in value)
            if len(numbers) == len(pattern) and all(map(math.isfinite, numbers)):
                return numbers
            raise ValueError
        if isinstance(pattern, bool) or isinstance(value, bool):
            if type(pattern) is type(value):
                return value
            raise ValueError
        if isinstance(pattern, str):
            if isinstance(value, str):
                return value
            raise ValueError
        number = float(value)
        if not math.isfinite(number) or (isinstance(pattern, int) and number != int(number)):
            raise ValueError
        return int(number) if isinstance(pattern, int) else number
    except (TypeError, ValueError):
        kind = f"{len(pattern)} numbers" if isinstance(pattern, tuple) else type(pattern).__name__
        raise InputError(where, repr(value), f"{kind}, such as {pattern!r}") from None
