"""Forces that no engine has by nature: laws as compiled functions, a curve over the sliding speed, driving samples."""

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any, TypeAlias

import numpy as np

from harness.core.arrays import FloatArray
from harness.core.checks import finite, increasing, positive, vector
from harness.core.errors import InputError
from harness.core.jit import compiled
from harness.core.scenario import CurveBelt
from harness.core.slider import Slider
from harness.engines.joint_words import JointWords, Kinds
from harness.model.term import Polynomial

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


# params of both: speed of the belt, f_k, f_s - f_k, v_s, c_2, c_3


@compiled
def level(t: float, x: float, v: float, state: FloatArray, params: FloatArray) -> float:
    """Level of dry friction at a speed v, N."""
    u = (v - params[0]) / params[3]
    return float(params[1] + params[2] * np.exp(-u * u))


@compiled
def viscous(t: float, x: float, v: float, state: FloatArray, params: FloatArray) -> float:
    """The polynomial, on the right-hand side, N."""
    u = v - params[0]
    return float(-u * (params[4] * abs(u) + params[5] * u * u))


def curve_of(slider: Slider, belt: CurveBelt, native: Kinds) -> tuple[ForceLaw, JointWords | None]:
    """What says a belt's curve to an engine whose joint, which lives in the belt's frame, has these native words.

    The level is a law that sets the limit of the engine's own friction in every step; the polynomial is said in words
    where the joint has them, else it is a force of that law.
    """
    numbers = np.array([belt.speed, slider.f_k, slider.break_away - slider.f_k, belt.v_s, belt.c_2, belt.c_3])
    if belt.c_2 == 0.0 == belt.c_3:
        return ForceLaw(None, level, params=numbers), None
    if Polynomial in native:
        return ForceLaw(None, level, params=numbers), JointWords(damping=(0.0, belt.c_2, belt.c_3))
    return ForceLaw(viscous, level, params=numbers), None
