"""Search of settings: coordinate by coordinate from what ships, on some sliders, to be scored on others."""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from harness.core.errors import HarnessError
from harness.core.scenario import Scenario
from harness.engines.base import Engine, Preset, Route
from harness.fidelity.registry import suite
from harness.fidelity.row import Row, Spec, run_row, task
from harness.fidelity.scores import Point
from harness.fidelity.sliders import Sliders, drawn
from harness.fidelity.spaces import Choice, Space

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
    _costs: dict[str, float] = field(default_factory=dict)
    _suites: dict[int, list[Scenario]] = field(default_factory=dict)

    def rows(self, changed: dict[str, Any], draws: Sequence[int], base: Preset = "as-shipped") -> list[Row]:
        """Every scenario of these suites with a preset's settings and these changes."""
        found = []
        for draw in draws:
            if draw not in self._suites:
                scenarios = suite(self.route, self.subject.sliders(draw))
                self._suites[draw] = [scenarios[name] for name in self.subject.scenarios]
            for scenario in self._suites[draw]:
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
        if key not in self._costs:
            scenario = suite(self.route, self.subject.sliders(SEARCH[0]))["free-decay"]
            mine, shipped = (self._spec(one, scenario, SEARCH[0], "as-shipped") for one in (changed, {}))
            turns = [(self._seconds(mine), self._seconds(shipped)) for _ in range(REPEATS)]
            self._costs[key] = min(first for first, _ in turns) / min(second for _, second in turns) if changed else 1.0
        return self._costs[key]

    def _seconds(self, spec: Spec) -> float:
        try:
            return self.engine.simulate(task(spec)).source.wall_s or math.inf
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


def score_of(rows: Sequence[Row]) -> float:
    """The score of rows of one set of settings; inf when one could not be run."""
    if any(row.error is not None for row in rows):
        return math.inf
    point = Point(rows[0].as_dict())
    for row in rows:
        point.add(row.as_dict())
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
        choice: Choice = shipped if start == 0 else {axis.name: _any(rng, axis.values) for axis in space.axes}
        choice, score = _descend(trial, space, choice, limit, tell)
        if score < WORTH * best_score:
            best, best_score = choice, score
    return _simplest(trial, space, best, limit)


def _any(rng: np.random.Generator, values: Sequence[Any]) -> Any:
    return values[int(rng.integers(len(values)))]


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
    """Put back to what ships whatever does not matter."""
    score = _allowed(trial, space, choice, limit)
    for axis in space.axes:
        other = {**choice, axis.name: axis.values[0]}
        if other != choice and _allowed(trial, space, other, limit) <= score / WORTH:
            choice = other
    return choice


def _allowed(trial: Trial, space: Space, choice: Choice, limit: float, below: float = math.inf) -> float:
    """The score of a choice, inf when it costs too much; cost is measured only of what is good enough to matter."""
    changed = trial.changed(space, choice)
    score = trial.score(changed)
    if score >= below or math.isinf(limit):
        return score
    return score if trial.cost(changed) <= limit else math.inf
