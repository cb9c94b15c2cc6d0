"""What a plant is put together from: forces, branches with states of their own, knocks, drives.

Laws are plain callables. ``d`` is the direction of sliding (+1, -1, 0 while stuck), which stands for sgn(v): between
two reversals it is frozen, so that every piece of the motion is smooth and the solver keeps its order.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

ForceLaw = Callable[[float, float, float, float], float]
"""(t, x, v, d) -> force on the left of the equation of motion, N."""


@dataclass(frozen=True, slots=True)
class Force:
    """A force of (x, v, t), on the left of m x'' + c x' + k x + f = u.

    law : (t, x, v, d) -> N. kinks : positions at which the law is not smooth, m. rate : fastest frequency in it, rad/s.
    """

    law: ForceLaw
    kinks: tuple[float, ...] = ()
    rate: float = 0.0


@dataclass(frozen=True, slots=True)
class Branch:
    """Something with states of its own that hangs on the slider.

    start : (x0, v0) -> states at the start. derivative : (x, v, own) -> time derivatives of its states.
    force : (x, v, own) -> force on the left, N. switches : (x, v, own) -> functions whose zeros are kinks.
    rate : fastest frequency in it, rad/s.
    """

    start: Callable[[float, float], Sequence[float]]
    derivative: Callable[[float, float, Sequence[float]], Sequence[float]]
    force: Callable[[float, float, Sequence[float]], float]
    switches: tuple[Callable[[float, float, Sequence[float]], float], ...] = ()
    rate: float = 0.0


@dataclass(frozen=True, slots=True)
class Knock:
    """One blow at ``time`` (s): the momentum jumps by ``impulse`` (N s)."""

    time: float
    impulse: float


@dataclass(frozen=True, slots=True)
class Drive:
    """The measured force: (t, x, v) -> N, on the right; it may close a loop. rate : fastest frequency, rad/s."""

    law: Callable[[float, float, float], float]
    rate: float = 0.0
