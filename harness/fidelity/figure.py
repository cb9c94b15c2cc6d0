"""Figures of the scorecard: a metric of a scenario as a distance from exact, over what it is measured against."""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

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


def belt_speed(row: Row) -> float:
    """Speed of the belt, m/s."""
    return float(row["setup"]["action"]["speed"])


def exact(metric: str) -> Scale:
    """The exact value of a metric."""
    return lambda row: float(row["exact"][metric])


def one(row: Row) -> float:
    """A figure that is a share already."""
    return 1.0
