"""Internal states that a recorded motion implies: how a window of a recording starts, and inverse dynamics."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import TypeAlias

from harness.core.arrays import FloatArray


@dataclass(frozen=True, slots=True)
class History:
    """The recorded motion up to the times asked for.

    t (n,), s, v (n,), m/s : recorded speed. at (m,), s : times asked for. v_at (m,) : speed there, 0 at rest. f_k : N.
    """

    t: FloatArray
    v: FloatArray
    at: FloatArray
    v_at: FloatArray
    f_k: float


@dataclass(frozen=True, slots=True)
class States:
    """Internal states (m, internal) at the times asked for, speeds relative to the slider's, and their partials.

    by : partials (m, internal) by the index of a parameter of the term or the name of a base parameter.
    """

    values: FloatArray
    by: Mapping[int | str, FloatArray] = field(default_factory=dict)


Implied: TypeAlias = Callable[[tuple[float, ...], History], States]
"""From the values of a term's parameters and the motion to its internal states."""
