"""A force that wanders at random: no law of (x, v, t) that a catalogue could hold."""

import math
from collections.abc import Callable

import numpy as np


def random_walk(
    size: float, interval: float, duration: float, seed: int
) -> tuple[Callable[[float, float, float, float], float], float]:
    """A random walk of knots ``interval`` (s) apart, joined by smooth steps, without mean, of rms ``size`` (N).

    Returns the law, as it stands on the left, and the fastest rate in it, rad/s.
    """
    rng = np.random.default_rng(seed)
    knots = np.cumsum(rng.standard_normal(math.ceil(duration / interval) + 2))
    knots -= knots.mean()
    levels: list[float] = (knots * (size / math.sqrt(float(np.mean(knots**2))))).tolist()

    def law(t: float, x: float, v: float, d: float) -> float:
        place = t / interval
        i = min(int(place), len(levels) - 2)
        s = place - i
        return -(levels[i] + (levels[i + 1] - levels[i]) * s * s * (3.0 - 2.0 * s))

    return law, math.pi / interval
