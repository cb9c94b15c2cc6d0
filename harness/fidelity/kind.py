"""What the suite knows of a scenario, and its figures: a metric as a distance from exact.

The sliders of a suite: its own, random ones, and those with the values somebody gave.

The scenarios of the suite by name: those of harness.fidelity.scenarios, then those that other packages register.

A package adds one by an entry point of group ``harness.scenarios`` whose value is the Kind ("package.module:SCENARIO").
"""

import math
import pkgutil
from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import cache
from importlib import import_module
from typing import Any, Literal, TypeAlias

import numpy as np

from harness.core.arrays import FloatArray
from harness.core.errors import InputError, did_you_mean
from harness.core.registered import registered
from harness.core.scenario import Harmonic, Scenario
from harness.core.slider import PAPER, Slider
from harness.core.trajectory import Trajectory
from harness.engines.base import ROUTES, Route
from harness.fidelity import scenarios

CONTACT_SCALE = 0.1
"""Sizes and forces on the floor, as a share of those of the joint: a fast box with much friction lifts, a slow one does
not; x/x_k and zeta stay the same, so that relative figures compare."""


@dataclass(frozen=True, slots=True)
class Sliders:
    """What a suite is made of; lengths and forces are those of the joint routes.

    decay, x0 (m) : the free decay, 3.5 periods of 1 s at omega_n = 10. sticky, belt_speed (m/s) : the belt.
    driven, drive, stopping : harmonic forcing without and with stops.
    """

    decay: Slider
    x0: float
    sticky: Slider
    belt_speed: float
    driven: Slider
    drive: Harmonic
    stopping: Harmonic


OWN = Sliders(
    decay=PAPER,
    x0=1.0,
    sticky=Slider(m=1.0, c=0.2, k=100.0, f_k=3.0, f_s=4.0),
    belt_speed=0.1,
    # Den Hartog's r = 0.8, f = 0.3, without stops; r = 0.4, f = 0.6 stops twice a period
    driven=Slider(m=1.0, c=0.0, k=100.0, f_k=3.0),
    drive=Harmonic(10.0, 8.0),
    stopping=Harmonic(5.0, 4.0),
)
"""The paper's slider, the checked belt and Den Hartog's case."""


def drawn(number: int) -> Sliders:
    """A random suite, always the same for the same number: mass, frequency, damping and friction all vary.

    It takes about as many steps as the suite's own: omega_n lies between 7 and 14 rad/s.
    """
    rng = np.random.default_rng([20240, number])

    def one(zeta: float) -> Slider:
        m, omega = float(np.exp(rng.uniform(-1.0, 1.0))), float(rng.uniform(7.0, 14.0))
        k = m * omega**2
        return Slider(m, 2.0 * zeta * m * omega, k, float(k * rng.uniform(0.02, 0.05)))

    decay, sticky, driven = one(rng.uniform(0.02, 0.1)), one(rng.uniform(0.0, 0.03)), one(0.0)
    sticky = replace(sticky, f_s=sticky.f_k * float(rng.uniform(1.2, 1.6)))
    speed = float((sticky.x_s - sticky.x_k) * sticky.omega_n * rng.uniform(0.5, 1.5))
    drive = Harmonic(driven.f_k * float(rng.uniform(2.5, 4.0)), float(driven.omega_n * rng.uniform(0.6, 0.85)))
    stopping = Harmonic(driven.f_k * float(rng.uniform(1.4, 1.8)), 0.4 * driven.omega_n)
    return Sliders(decay, 1.0, sticky, speed, driven, drive, stopping)


def scale_of(route: Route) -> float:
    """Lengths and forces on a route over those of the joint."""
    return CONTACT_SCALE if route == "contact" else 1.0


def scaled(slider: Slider, scale: float) -> Slider:
    """The slider with ``scale`` times the friction."""
    return replace(slider, f_k=plain(scale * slider.f_k), f_s=plain(scale * slider.break_away))


def plain(value: float) -> float:
    """Without the last digit that a product leaves behind (0.30000000000000004)."""
    return float(f"{value:.14g}")


VALUES = ("m", "c", "k", "f_k", "f_s")


def only(name: str, given: Mapping[str, float], accepted: tuple[str, ...]) -> None:
    """Raise InputError for a value that the scenario ``name`` does not take."""
    for key, value in given.items():
        if key not in accepted:
            found = f"{value:g}, given with {name}"
            raise InputError(f"--{key.replace('_', '-')}", found, f"one of {', '.join(accepted)}")


def with_values(slider: Slider, given: Mapping[str, float]) -> Slider:
    """The slider with the values given (VALUES); a friction that is given takes break-away along, in proportion."""
    own = {key: value for key, value in given.items() if key in VALUES}
    if "f_k" in own and "f_s" not in own:
        own["f_s"] = slider.break_away / slider.f_k * own["f_k"]
    return replace(slider, **own)


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


Part: TypeAlias = Literal["suite", "trained", "bodies", "laws"]
"""trained : as people train policies, with less effort of the solver. bodies : with six freedoms, in contact. laws :
friction that is a curve over the speed."""
Answers: TypeAlias = dict[str, float]
Metrics: TypeAlias = dict[str, float | None]


@dataclass(frozen=True, slots=True, kw_only=True)
class Kind(ABC):
    """A scenario that has an exact answer and starts on the motion it is about. Implementations are final.

    name : as commands and results say it. place : where it stands in tables. figures : its columns of the scorecard.
    routes : those it is run on; the first is that of harness run. part : of the matrix; what is not of the suite has
    settings of its own there, and no column of the scorecard.
    """

    name: str
    place: int
    figures: tuple[Figure, ...] = ()
    routes: tuple[Route, ...] = ROUTES
    part: Part = "suite"

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


GROUP = "harness.scenarios"


@cache
def kinds() -> Mapping[str, Kind]:
    """Every scenario by its name, in the order in which they are shown. Raises InputError for a name that is taken."""
    modules = pkgutil.iter_modules(scenarios.__path__)
    files = [import_module(f"{scenarios.__name__}.{found.name}") for found in modules]
    own = [one for file in files for one in vars(file).values() if isinstance(one, Kind)]
    found: dict[str, Kind] = {}
    others = (k for _, k in registered(GROUP, Kind, "scenario"))  # type: ignore[type-abstract]  # only asked for
    for one in sorted((*own, *others), key=lambda kind: kind.place):
        if one.name in found:
            raise InputError(f"scenario {one.name}", "registered twice", "one")
        found[one.name] = one
    return found


def kind(name: str) -> Kind:
    """The scenario of this name; InputError lists those there are."""
    found = kinds().get(name)
    if found is None:
        raise InputError("scenario", repr(name), f"{', '.join(kinds())}{did_you_mean(name, kinds())}")
    return found


def kind_of(scenario: Scenario) -> Kind:
    """What a scenario is an example of; InputError for a name that is not in the suite."""
    return kind(scenario.name)


def chosen(name: str, given: Mapping[str, float | None]) -> Scenario:
    """A scenario with the values given in place of its own; None is not given. Raises InputError, see Kind.chosen."""
    return kind(name).chosen({key: value for key, value in given.items() if value is not None})


def names(route: Route, part: Part = "suite") -> tuple[str, ...]:
    """Scenarios of a route, in the order in which they are shown."""
    return tuple(name for name, kind in kinds().items() if route in kind.routes and kind.part == part)


def suite(route: Route, sliders: Sliders = OWN, part: Part = "suite") -> dict[str, Scenario]:
    """Every scenario of a route by its name."""
    return {name: kind(name).of_suite(sliders, scale_of(route)) for name in names(route, part)}
