"""What a sensor makes of one channel of a motion."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal, TypeAlias

from harness.core.arrays import FloatArray


@dataclass(frozen=True, slots=True)
class Shown:
    """A channel behind a sensor, y (n,); by_y (n,) : its partial by what came in. by : partials (n,) by parameters."""

    y: FloatArray
    by_y: FloatArray
    by: tuple[FloatArray, ...]


Read: TypeAlias = Callable[[tuple[float, ...], FloatArray, FloatArray, FloatArray], Shown]
"""From the values of a term's parameters, times t (n,), the channel (n,) and its rate (n,), zeros for a."""


@dataclass(frozen=True, slots=True)
class Sensor:
    """The law of a term in slot O. channel : which one it changes. Those of a channel act in catalogue order.

    delays : the term's first parameter is by how much x is late, s; ``read`` is then given the channel of that moment.
    """

    channel: Literal["x", "a"]
    read: Read
    delays: bool = False
