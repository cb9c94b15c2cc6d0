"""Search of the cheapest settings that meet a figure: creep below so many m/s, zeta off by less than so much."""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

import numpy as np

from harness.fidelity.tune import (
    HELD_OUT,
    SEARCH,
    STARTS,
    WORTH,
    Choice,
    Progress,
    Space,
    Trial,
    put_back,
    random_choice,
)

METRICS: dict[str, tuple[str, str]] = {
    "creep": ("creep_m_s", "m/s"),
    "drift": ("drift_m", "m"),
    "rest": ("rest_error_m", "m"),
    "position": ("max_error_m", "m"),
    "lift": ("lift_m", "m"),
    "lead": ("reversal_lead_s", "s"),
    "period": ("period_s", "s"),
    "zeta": ("zeta_rel_error", "1"),
    "x_k": ("x_k_rel_error", "1"),
    "energy": ("energy_error", "1"),
}
"""What may be asked for: its metric, whose distance from exact is meant, and the unit of that."""
_MARGINS = (0.8, 0.4, 0.1)
"""Shares of the limit that are searched for, one after the other, until what was not searched on meets it too."""
_CHEAPER = 0.97
"""A change for the sake of cost takes it below this share."""


@dataclass(frozen=True, slots=True)
class Goal:
    """A figure, by its name in METRICS, that is to stay below a limit (SI units) wherever it is measured."""

    name: str
    limit: float

    @property
    def metric(self) -> str:
        return METRICS[self.name][0]

    @property
    def unit(self) -> str:
        return METRICS[self.name][1]


@dataclass(slots=True)
class Meeting:
    """Settings of a space against goals. scenarios : those in which a goal's figure is measured."""

    trial: Trial
    space: Space
    goals: Sequence[Goal]
    scenarios: tuple[str, ...] = ()
    _worst: dict[str, tuple[float, ...]] = field(default_factory=dict)

    def __post_init__(self) -> None:
        metrics = {goal.metric for goal in self.goals}
        rows = self.trial.rows({}, SEARCH[:1])
        self.scenarios = tuple(row.scenario for row in rows if metrics & row.metrics.keys())

    def worst(self, choice: Choice, draws: Sequence[int] = SEARCH) -> tuple[float, ...]:
        """The largest distance from exact of each goal's figure, SI units; inf where a scenario could not be run."""
        changed = self.trial.changed(self.space, choice)
        key = repr((sorted(changed.items()), tuple(draws)))
        if key not in self._worst:
            self.trial.count += 1
            rows = self.trial.rows(changed, draws, scenarios=self.scenarios)
            failed = any(row.error is not None for row in rows)
            found = []
            for metric in (goal.metric for goal in self.goals):
                values = [
                    abs(y - row.exact.get(metric, 0.0)) for row in rows if (y := row.metrics.get(metric)) is not None
                ]
                found.append(math.inf if failed or not values else max(values))
            self._worst[key] = tuple(found)
        return self._worst[key]

    def excess(self, choice: Choice, draws: Sequence[int] = SEARCH) -> float:
        """The largest of the goals' figures over their limits; all are met at 1 or less."""
        return max(value / goal.limit for value, goal in zip(self.worst(choice, draws), self.goals, strict=True))

    def cost(self, choice: Choice) -> float:
        return self.trial.cost(self.trial.changed(self.space, choice))


def meet(meeting: Meeting, seed: int = 0, tell: Progress = lambda done: None) -> Choice:
    """The cheapest choice that meets all goals, also on sliders that were not searched on; else the nearest to them.

    From what ships, and from random choices: one axis at a time until the goals are met, then until none is cheaper.
    """
    rng = np.random.default_rng(seed)
    space = meeting.space
    starts = [space.shipped(), *(random_choice(rng, space) for _ in range(STARTS - 1))]
    nearest: Choice = starts[0]
    for margin in _MARGINS:
        met = list[Choice]()
        for start in starts:
            reached = _steps(space, start, meeting.excess, WORTH, lambda far: far <= margin, tell, meeting)  # noqa: B023
            nearest = min(nearest, reached, key=meeting.excess)
            if meeting.excess(reached) <= margin:
                met.append(_cheapest(meeting, reached, margin, tell))
        if not met:
            return nearest
        cheapest = min(met, key=meeting.cost)
        if meeting.excess(cheapest, HELD_OUT) <= 1.0:
            return cheapest
    return nearest


def _cheapest(meeting: Meeting, choice: Choice, margin: float, tell: Progress) -> Choice:
    def price(other: Choice) -> float:
        return meeting.cost(other) if meeting.excess(other) <= margin else math.inf

    choice = _steps(meeting.space, choice, price, _CHEAPER, lambda cost: False, tell, meeting)
    most = price(choice) / _CHEAPER
    return put_back(meeting.space, choice, lambda other: price(other) <= most)


def _steps(
    space: Space,
    choice: Choice,
    of: Callable[[Choice], float],
    worth: float,
    enough: Callable[[float], bool],
    tell: Progress,
    meeting: Meeting,
) -> Choice:
    """One axis at a time while that takes ``of`` below ``worth`` times what it was, until it is enough."""
    value, improved = of(choice), True
    while improved and not enough(value):
        improved = False
        for axis in space.axes:
            for one in axis.values:
                other = {**choice, axis.name: one}
                if one != choice[axis.name] and (found := of(other)) < worth * value:
                    choice, value, improved = other, found, True
                tell(meeting.trial.count)
                if enough(value):
                    return choice
    return choice
