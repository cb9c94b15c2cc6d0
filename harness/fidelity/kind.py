"""What the suite knows of a scenario; a file in harness/fidelity/scenarios makes one."""

from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass
from typing import TypeAlias

from harness.core.arrays import FloatArray
from harness.core.scenario import Scenario
from harness.core.trajectory import Trajectory
from harness.engines.base import ROUTES, Route
from harness.fidelity.figure import Figure
from harness.fidelity.sliders import Sliders

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
