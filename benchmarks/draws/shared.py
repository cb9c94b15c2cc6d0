"""What every kind of draw has in common."""

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True, slots=True)
class Answer:
    """What was said of one draw. said : in a line."""

    right: bool
    said: str


def log_uniform(r: np.random.Generator, low: float, high: float) -> float:
    """Between two numbers, their decades alike."""
    return float(np.exp(r.uniform(math.log(low), math.log(high))))


Draw = Callable[[int, int], Answer]
"""From a seed and a number."""


def interval(right: int, of: int) -> tuple[float, float]:
    """Wilson's interval of a rate at 95 %."""
    if of == 0:
        return 0.0, 1.0
    z, p = 1.96, right / of
    middle, half = p + z * z / (2 * of), z * math.sqrt(p * (1.0 - p) / of + z * z / (4 * of * of))
    return (middle - half) / (1.0 + z * z / of), (middle + half) / (1.0 + z * z / of)
