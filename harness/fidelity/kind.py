"""What the suite knows of a scenario, and its figures: a metric as a distance from exact."""

import math
from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, TypeAlias

from harness.core.arrays import FloatArray
from harness.core.scenario import Scenario
from harness.core.trajectory import Trajectory
from harness.engines.base import ROUTES, Route
from harness.fidelity.sliders import Sliders

Row = Mapping[str, Any]
Scale = Callable[[Row], float]


@dataclass(frozen=True, slots=True)
class Figure:
    """One column: which metric, against what, and what a good value is. A row's slider, setup and exact are read."""

    label: str
    metric: str
    scale: Scale
    good: str


def release(row: Row) -> float:
    """Distance of the release from x = 0, m."""
    return abs(float(row["setup"]["release"]["x0"]))


def x_k(row: Row) -> float:
    """Friction displacement f_k/k, m."""
    return float(row["slider"]["f_k"]) / float(row["slider"]["k"])


def period(row: Row) -> float:
    """Period without friction and damping, s."""
    return 2.0 * math.pi / math.sqrt(float(row["slider"]["k"]) / float(row["slider"]["m"]))


def speed_of_belt(row: Row) -> float:
    """Speed of the belt, m/s."""
    return float(row["setup"]["action"]["speed"])


def exact(metric: str) -> Scale:
    """The exact value of a metric."""
    return lambda row: float(row["exact"][metric])


def one(row: Row) -> float:
    """A figure that is a share already."""
    return 1.0


Answers: TypeAlias = dict[str, float]
Metrics: TypeAlias = dict[str, float | None]


@dataclass(frozen=True, slots=True, kw_only=True)
class Kind(ABC):
    """A scenario that has an exact answer and starts on the motion it is about. Implementations are final.

    name : as commands and results say it. place : where it stands in tables. figures : its columns of the scorecard.
    routes : those it is run on; the first is that of harness run.
    """

    name: str
    place: int
    figures: tuple[Figure, ...] = ()
    routes: tuple[Route, ...] = ROUTES

    @abstractmethod
    def of_suite(self, sliders: Sliders, scale: float) -> Scenario:
        """The scenario of these sliders, lengths and forces ``scale`` times as large."""

    @abstractmethod
    def chosen(self, given: Mapping[str, float]) -> Scenario:
        """The scenario with values somebody gave (m, c, k, f_k, f_s, x0, v0, duration) in place of its own.

        Raises InputError for a value it does not take, or one with which there is no such motion.
        """

    @abstractmethod
    def exact(self, scenario: Scenario, t: FloatArray) -> Trajectory:
        """The exact motion at times t (n,) in s from 0 on; InputError for a start that is not on it."""

    @abstractmethod
    def answers(self, scenario: Scenario) -> Answers:
        """Exact values of the metrics that have one; the others are errors, whose exact value is 0."""

    @abstractmethod
    def measure(self, trace: Trajectory, scenario: Scenario) -> Metrics:
        """Metrics of a trace, SI units at the end of their names; None where the trace has no such figure."""
