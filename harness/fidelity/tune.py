"""Search of settings: coordinate by coordinate from what ships, on some sliders, to be scored on others.

What can be set, engine by engine: axes of values, and the settings that a choice of them means.
"""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from harness.core.errors import HarnessError
from harness.core.scenario import Scenario
from harness.engines.base import Engine, Preset, Route
from harness.fidelity.kind import Sliders, drawn, suite
from harness.fidelity.row import Spec, run_row, task
from harness.fidelity.scores import Point
from harness.results.sweep import SweepRow

Choice = Mapping[str, Any]


@dataclass(frozen=True, slots=True)
class Axis:
    """One thing to choose. values : the first is what ships. origins : how many of them are put back to, in turn."""

    name: str
    values: tuple[Any, ...]
    origins: int = 1


@dataclass(frozen=True, slots=True)
class Space:
    """axes : what to choose. settings : overrides of the as-shipped preset for a choice and a step (s).

    sets : the setting behind an axis that has another name.
    """

    axes: tuple[Axis, ...]
    settings: Callable[[Choice, float], dict[str, Any]]
    sets: Mapping[str, str] = field(default_factory=dict)

    def shipped(self) -> dict[str, Any]:
        """The choice that changes nothing."""
        return {axis.name: axis.values[0] for axis in self.axes}

    def of_file(self, own: Mapping[str, Any], defaults: Mapping[str, Any]) -> "Space":
        """The space of a model whose file has settings of its own: each goes back to that, and to the engine's default.

        own : the file's. defaults : of the engine.
        """

        def axis(one: Axis) -> Axis:
            name = self.sets.get(one.name, one.name)
            if name not in own or own[name] == defaults[name]:
                return one
            first = (SHIPPED, DEFAULT) if name != one.name else (own[name], defaults[name])
            return Axis(one.name, tuple(dict.fromkeys((*first, *one.values))), origins=2)

        def settings(choice: Choice, dt: float) -> dict[str, Any]:
            back = {name: self.sets[name] for name, value in choice.items() if value == DEFAULT}
            found = self.settings({**choice, **dict.fromkeys(back, SHIPPED)}, dt)
            return found | {name: defaults[name] for name in back.values()}

        return replace(self, axes=tuple(map(axis, self.axes)), settings=settings)

    def with_effort(self, defaults: Mapping[str, Any]) -> "Space":
        """With the effort of the solver as axes, where the engine has it."""
        mine = [axis for axis in _EFFORT if axis.name in defaults and axis.values[0] == defaults[axis.name]]
        return replace(self, axes=(*self.axes, *mine)) if len(mine) == len(_EFFORT) else self


SHIPPED = "as shipped"
"""A value that leaves a setting alone."""
DEFAULT = "the engine's default"
"""A value that takes a file's setting back."""
_EFFORT = (Axis("iterations", (100, 4, 1)), Axis("ls_iterations", (50, 30, 8)))

_INTEGRATORS = Axis("integrator", ("Euler", "implicitfast", "implicit", "RK4", "discrete"))
_NOSLIP = Axis("noslip_iterations", (0, 5, 50))


def _plain(choice: Choice, dt: float) -> dict[str, Any]:
    return {name: value for name, value in choice.items() if value != SHIPPED}


def _mujoco_joint(choice: Choice, dt: float) -> dict[str, Any]:
    """rate : friction follows at b = rate/dt, as solreffriction (-1, -rate d/dt). impedance : d, of solimpfriction."""
    settings = _plain({k: v for k, v in choice.items() if k not in ("rate", "impedance")}, dt)
    d = 0.95 if choice["impedance"] == SHIPPED else choice["impedance"]
    if choice["impedance"] != SHIPPED:
        settings["solimpfriction"] = (d, d, 0.001, 0.5, 2.0)
    if choice["rate"] != SHIPPED:
        settings["solreffriction"] = (-1.0, -choice["rate"] * d / dt)
    return settings


def _mujoco_contact(choice: Choice, dt: float) -> dict[str, Any]:
    """steps : time constant of the contact in steps. impedance : of solimp, at any depth."""
    settings = _plain({k: v for k, v in choice.items() if k not in ("steps", "impedance")}, dt)
    if choice["impedance"] != SHIPPED:
        settings["solimp"] = (choice["impedance"], choice["impedance"], 0.001, 0.5, 2.0)
    if choice["steps"] != SHIPPED:
        settings["solref"] = (choice["steps"] * dt, 1.0)
    return settings


_IMPEDANCE = (SHIPPED, 0.5, 0.8, 0.9, 0.95, 0.99, 0.999, 0.9999)
_BULLET = (
    Axis("linearDamping", (0.04, 0.0)),
    Axis("angularDamping", (0.04, 0.0)),
    Axis("maxJointVelocity", (100.0, 1e9)),
    Axis("leapfrog", (False, True)),
    Axis("numSubSteps", (0, 2, 4)),
)
_BULLET_CONTACT = (
    Axis("numSolverIterations", (50, 10, 200, 500)),
    Axis("solverResidualThreshold", (1e-7, 0.0)),
    Axis("frictionAnchor", (False, True)),
)

_LEAPFROG = Axis("leapfrog", (False, True))
_OWN_SPRING = (Axis("own_spring", (True, False)), _LEAPFROG)
_RAPIER = (Axis("num_solver_iterations", (4, 1, 2, 8)), Axis("num_internal_pgs_iterations", (1, 4)))
_PHYSX = (
    *_OWN_SPRING,
    Axis("solverType", ("TGS", "PGS")),
    Axis("solverPositionIterationCount", (4, 1, 8, 16)),
    Axis("solverVelocityIterationCount", (1, 0, 4)),
    Axis("enableExternalForcesEveryIteration", (True, False)),
)
_DRAKE_CONTACT = (
    _LEAPFROG,
    Axis("contact_approximation", ("kLagged", "kTamsi", "kSimilar", "kSap")),
    Axis("stiction_tolerance", (1e-4, 1e-5, 1e-6, 1e-8)),
)

_NEWTON = (
    _LEAPFROG,
    Axis("integrator", ("euler", "implicitfast", "rk4")),
)

_RATE = Axis("rate", (SHIPPED, 0.05, 0.1, 0.2, 0.5, 1.0, 1.4, 1.7, 1.9, 1.98))
_JOINT = {"rate": "solreffriction", "impedance": "solimpfriction"}


def _of_mujoco(integrators: Axis, *more: Axis) -> dict[Route, Space]:
    """By route, for an engine that runs MuJoCo's models. more : its own axes, which a force of ours does not see."""
    joint = (integrators, _RATE, Axis("impedance", _IMPEDANCE), *more)
    contact = (
        integrators,
        Axis("cone", ("pyramidal", "elliptic")),
        Axis("impratio", (1.0, 10.0, 100.0, 1e3, 1e5)),
        Axis("steps", (SHIPPED, 2.0, 3.0, 4.0, 6.0, 10.0)),
        Axis("impedance", _IMPEDANCE),
        *more,
        Axis("tolerance", (1e-8, 1e-12)),
    )
    return {
        "joint": Space(joint, _mujoco_joint, _JOINT),
        "contact": Space(contact, _mujoco_contact, {"steps": "solref", "impedance": "solimp"}),
        "law": Space((integrators,), _plain),
    }


_MUJOCO = {
    "mujoco": _of_mujoco(_INTEGRATORS, _NOSLIP),
    "mjx": _of_mujoco(Axis("integrator", ("Euler", "implicitfast", "RK4")), Axis("precision", (32, 64))),
    "warp": _of_mujoco(Axis("integrator", ("Euler", "implicitfast", "implicit", "RK4")), _NOSLIP),
}
_SPACES: dict[tuple[str, Route], Space] = {
    **{(name, route): found for name, spaces in _MUJOCO.items() for route, found in spaces.items()},
    ("pybullet", "joint"): Space(_BULLET, _plain),
    ("pybullet", "law"): Space(_BULLET, _plain),
    ("pybullet", "contact"): Space((*_BULLET, *_BULLET_CONTACT), _plain),
    ("dart", "joint"): Space((_LEAPFROG,), _plain),
    ("dart", "law"): Space((_LEAPFROG,), _plain),
    ("rapier", "joint"): Space((*_OWN_SPRING, *_RAPIER), _plain),
    ("rapier", "law"): Space((*_OWN_SPRING, *_RAPIER), _plain),
    ("rapier", "contact"): Space((_LEAPFROG, *_RAPIER, Axis("friction_model", ("SIMPLIFIED", "COULOMB"))), _plain),
    ("physx", "joint"): Space(_PHYSX, _plain),
    ("physx", "law"): Space(_PHYSX, _plain),
    ("drake", "contact"): Space(_DRAKE_CONTACT, _plain),
    ("drake", "law"): Space((_LEAPFROG,), _plain),
    ("newton", "joint"): Space((*_NEWTON, _RATE, Axis("impedance", _IMPEDANCE)), _mujoco_joint, _JOINT),
    ("newton", "law"): Space(_NEWTON, _plain),
}


def space(engine: str, route: Route) -> Space | None:
    """What can be searched; None for an engine or route without a table here."""
    return _SPACES.get((engine, route))


def tunable() -> tuple[str, ...]:
    """Engines with a table, with their routes in brackets."""
    names = dict.fromkeys(engine for engine, _ in _SPACES)
    return tuple(f"{name} ({', '.join(route for one, route in _SPACES if one == name)})" for name in names)


SEARCH, HELD_OUT = (101, 102), (201, 202, 203)
"""Numbers of the random suites that are searched on, and of those the outcome is scored on."""
SCENARIOS = ("free-decay", "hold-50", "hold-97", "belt", "harmonic")
WORTH = 0.99
"""A change is kept when it takes the score below this share of what it was; less is not worth a setting."""
STARTS = 3
REPEATS = 7
"""Runs of which the fastest is the cost: the machine's other work only ever slows a run down."""

Progress = Callable[[int], None]


@dataclass(frozen=True, slots=True)
class Subject:
    """What settings are tried on, by default random sliders.

    sliders : of a number of SEARCH or HELD_OUT. scenarios : names. own : settings in force where none is changed.
    given : settings as the engine is given them.
    """

    sliders: Callable[[int], Sliders] = drawn
    scenarios: tuple[str, ...] = SCENARIOS
    own: Mapping[str, Any] = field(default_factory=dict)
    given: Callable[[dict[str, Any]], dict[str, Any]] = dict


@dataclass(slots=True)
class Trial:
    """One engine, route and step (s): scores settings and remembers them."""

    engine: Engine
    route: Route
    dt: float
    subject: Subject = field(default_factory=Subject)
    count: int = 0
    _scores: dict[str, float] = field(default_factory=dict)
    _seconds: dict[str, float] = field(default_factory=dict)
    _shipped: float = math.inf
    _suites: dict[int, list[Scenario]] = field(default_factory=dict)

    def rows(
        self,
        changed: dict[str, Any],
        draws: Sequence[int],
        base: Preset = "as-shipped",
        scenarios: Sequence[str] = (),
    ) -> list[SweepRow]:
        """Every scenario of these suites, or some, with a preset's settings and these changes."""
        found = []
        for draw in draws:
            if draw not in self._suites:
                sliders = self.subject.sliders(draw)
                every = suite(self.route, sliders) | suite(self.route, sliders, "trained")
                self._suites[draw] = [every[name] for name in self.subject.scenarios]
            for scenario in self._suites[draw]:
                if not scenarios or scenario.name in scenarios:
                    found.append(run_row(self.engine, self._spec(changed, scenario, draw, base)))
        return found

    def score(self, changed: dict[str, Any], draws: Sequence[int] = SEARCH, base: Preset = "as-shipped") -> float:
        """Geometric mean of the distances from exact (pareto.Point); inf when a scenario could not be run."""
        key = repr((sorted(changed.items()), tuple(draws), base))
        if key not in self._scores:
            self.count += 1
            self._scores[key] = score_of(self.rows(changed, draws, base))
        return self._scores[key]

    def cost(self, changed: dict[str, Any]) -> float:
        """Wall time of a free decay over that of what ships, each the fastest of a few runs that take turns.

        inf when it could not be run.
        """
        key = repr(sorted(changed.items()))
        if key not in self._seconds and changed:
            scenario = suite(self.route, self.subject.sliders(SEARCH[0]))["free-decay"]
            mine, shipped = (self._spec(one, scenario, SEARCH[0], "as-shipped") for one in (changed, {}))
            turns = [(self._wall(mine), self._wall(shipped)) for _ in range(REPEATS)]
            self._seconds[key] = min(first for first, _ in turns)
            self._shipped = min(self._shipped, *(second for _, second in turns))
        return self._seconds[key] / self._shipped if changed else 1.0

    def seconds(self, changed: dict[str, Any]) -> float:
        """Wall time of a second of a free decay's motion, the fastest of a few runs, s."""
        scenario = suite(self.route, self.subject.sliders(SEARCH[0]))["free-decay"]
        spec = self._spec(changed, scenario, SEARCH[0], "as-shipped")
        return min(self._wall(spec) for _ in range(REPEATS)) / scenario.duration

    def _wall(self, spec: Spec) -> float:
        try:
            return self.engine.simulate(task(self.engine, spec)).source.wall_s or math.inf
        except HarnessError:
            return math.inf

    def changed(self, space: Space, choice: Choice) -> dict[str, Any]:
        """The settings a choice changes, without those that stay what ships."""
        shipped = self.engine.presets(self.route, "as-shipped", self.dt) | dict(self.subject.own)
        return {name: value for name, value in space.settings(choice, self.dt).items() if shipped[name] != value}

    def _spec(self, changed: dict[str, Any], scenario: Scenario, draw: int, base: Preset) -> Spec:
        own = self.subject.own
        if base != "as-shipped":
            preset = self.engine.presets(self.route, base, self.dt)
            own = {name: preset[name] for name in own}
        settings = tuple(sorted(self.subject.given({**own, **changed}).items()))
        return Spec(self.engine.name, self.engine.version(), self.route, base, base, settings, self.dt, scenario, draw)


def score_of(rows: Sequence[SweepRow]) -> float:
    """The score of rows of one set of settings; inf when one could not be run."""
    if any(row.error is not None for row in rows):
        return math.inf
    point = Point(rows[0].model_dump())
    for row in rows:
        point.add(row.model_dump())
    return point.score


def search(trial: Trial, space: Space, most: float | None, seed: int = 0, tell: Progress = lambda done: None) -> Choice:
    """The best choice that costs at most ``most`` times what ships at the same step (None: whatever it costs).

    From what ships, and from random choices, one axis at a time until none improves. What ships is the fallback.
    """
    rng = np.random.default_rng(seed)
    shipped = space.shipped()
    limit = math.inf if most is None else most
    best: Choice = shipped
    best_score = trial.score({})
    for start in range(STARTS):
        choice: Choice = shipped if start == 0 else random_choice(rng, space)
        choice, score = _descend(trial, space, choice, limit, tell)
        if score < WORTH * best_score:
            best, best_score = choice, score
    return _simplest(trial, space, best, limit)


def random_choice(rng: np.random.Generator, space: Space) -> dict[str, Any]:
    """Any value of every axis."""
    return {axis.name: axis.values[int(rng.integers(len(axis.values)))] for axis in space.axes}


def _descend(trial: Trial, space: Space, choice: Choice, limit: float, tell: Progress) -> tuple[Choice, float]:
    score = _allowed(trial, space, choice, limit)
    improved = True
    while improved:
        improved = False
        for axis in space.axes:
            for value in axis.values:
                other = {**choice, axis.name: value}
                if value != choice[axis.name]:
                    found = _allowed(trial, space, other, limit, below=WORTH * score)
                    if found < WORTH * score:
                        choice, score, improved = other, found, True
                tell(trial.count)
    return choice, score


def _simplest(trial: Trial, space: Space, choice: Choice, limit: float) -> Choice:
    """Put back whatever does not matter."""
    score = _allowed(trial, space, choice, limit)
    return put_back(space, choice, lambda other: _allowed(trial, space, other, limit) <= score / WORTH)


def put_back(space: Space, choice: Choice, good: Callable[[Choice], bool]) -> Choice:
    """Every axis back to the first of its origins with which the choice stays good."""
    for axis in space.axes:
        for value in axis.values[: axis.origins]:
            if value == choice[axis.name]:
                break
            other = {**choice, axis.name: value}
            if good(other):
                choice = other
                break
    return choice


def _allowed(trial: Trial, space: Space, choice: Choice, limit: float, below: float = math.inf) -> float:
    """The score of a choice, inf when it costs too much; cost is measured only of what is good enough to matter."""
    changed = trial.changed(space, choice)
    score = trial.score(changed)
    if score >= below or math.isinf(limit):
        return score
    return score if trial.cost(changed) <= limit else math.inf
