"""Forces that no engine has by nature: laws given as compiled functions, driving forces given as samples."""

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any, TypeAlias

import numpy as np

from harness.core.arrays import FloatArray
from harness.core.checks import finite, increasing, positive, vector
from harness.core.errors import InputError

Function: TypeAlias = Callable[..., Any]


def _none() -> FloatArray:
    return np.empty(0)


@dataclass(frozen=True, slots=True)
class ForceLaw:
    """What acts on the slider besides spring, viscous damper and constant dry friction.

    Each part is a function compiled with harness.core.jit.compiled, or None; x in m, v in m/s, t in s, forces in N.

    force : (t, x, v, state, params) -> extra force on the right-hand side of m x'' + c x' + k x + f = u + force.
        Evaluated at every stage of the integrator where the engine has stages, else at every step.
    level : (t, x, v, state, params) -> f_k, the level of dry friction that stands for slider.f_k; break-away keeps the
        ratio f_s/f_k. Evaluated as ``force`` is.
    advance : (t, x, v, dt, state, params) -> None, called once at the start of every step with the state of that
        moment; moves internal states (a bristle, a Maxwell branch) in place. ``force`` sees what it left behind.
    params, state : float64 vectors handed to all three; a run works on its ``own`` copies.
    """

    force: Function | None = None
    level: Function | None = None
    advance: Function | None = None
    params: FloatArray = field(default_factory=_none)
    state: FloatArray = field(default_factory=_none)

    def __post_init__(self) -> None:
        object.__setattr__(self, "params", vector("force law: params", self.params))
        object.__setattr__(self, "state", vector("force law: state", self.state))
        if self.force is None and self.level is None:
            raise InputError("force law", "neither force nor level", "at least one of them")

    def own(self) -> tuple[FloatArray, FloatArray]:
        """State and params of one run; writable, as MuJoCo hands them on: a law is compiled once for all engines."""
        return self.state.copy(), self.params.copy()


@dataclass(frozen=True, slots=True)
class Drive:
    """A driving force u(t) given as samples, straight lines between them, held at its end values outside.

    t : s, increasing, shape (n,). u : N, shape (n,). Raises InputError for lengths that differ or times that go back.
    """

    t: FloatArray
    u: FloatArray

    def __post_init__(self) -> None:
        t = vector("drive: t", self.t)
        increasing("drive: t", t)
        if not t.size:
            raise InputError("drive: t", "no samples", "at least 1")
        object.__setattr__(self, "t", t)
        object.__setattr__(self, "u", vector("drive: u", self.u, t.size))

    @classmethod
    def none(cls) -> "Drive":
        """No force at all; something to add a knock to."""
        return cls(np.zeros(1), np.zeros(1))

    def with_knock(self, time: float, impulse: float, dt: float) -> "Drive":
        """The same drive and a knock of ``impulse`` (N s) at ``time`` (s), for a run with step ``dt`` (s).

        The knock is a triangle two steps wide. Sampled once a step, or at the start, middle and end of steps as
        Runge-Kutta does, it passes on exactly its impulse, with the right mean time, wherever it falls between steps.
        """
        positive("knock: dt", dt, "s")
        corners = finite("knock: time", time) + dt * np.array([-1.0, 0.0, 1.0])
        t = np.union1d(self.t, corners)
        pulse = np.interp(t, corners, [0.0, finite("knock: impulse", impulse) / dt, 0.0])
        return Drive(t, np.interp(t, self.t, self.u) + pulse)
