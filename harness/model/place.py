"""Where an effect acts: times, a regime, a plain condition; and the motion from which a term tells it."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np

from harness.core.arrays import BoolArray, FloatArray
from harness.core.events import Regime

Spans: TypeAlias = tuple[tuple[float, float], ...]


@dataclass(frozen=True, slots=True)
class Seen:
    """A fitted motion at the times of a recording.

    t (n,), s. x (n,), m. channels : what the sensors show of it, each (n,). omega : its angular frequency, rad/s.
    """

    t: FloatArray
    x: FloatArray
    channels: Mapping[str, FloatArray]
    omega: float

    def where(self, inside: BoolArray) -> Spans:
        """Time spans (s) in which ``inside`` (n,) holds: each ends midway to the sample that is outside."""
        t = self.t
        edges = np.flatnonzero(np.diff(np.concatenate(([False], inside, [False])).astype(np.int8)))
        between = np.concatenate((t[:1], 0.5 * (t[1:] + t[:-1]), t[-1:]))
        return tuple((float(between[a]), float(between[b])) for a, b in zip(edges[::2], edges[1::2], strict=True))

    @property
    def whole(self) -> Spans:
        """The whole recording, s."""
        return ((float(self.t[0]), float(self.t[-1])),)


@dataclass(frozen=True, slots=True)
class Place:
    """Where an effect acts: times (s), regime, and the condition in words."""

    regime: Regime
    condition: str
    spans: Spans


Placed: TypeAlias = Callable[[tuple[float, ...], Seen], Place]
"""From the values of a term's parameters and the motion to the place."""


def always(regime: Regime = "throughout", condition: str = "always") -> Placed:
    """An effect that is bound to no part of the recording; regime and condition say where it shows most."""
    return lambda values, seen: Place(regime, condition, seen.whole)
