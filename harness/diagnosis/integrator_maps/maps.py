"""How engines step, as maps from one state to the next: what a recording looks like that is a trace of one.

Every scheme takes the friction of a soft constraint, f_k sat((v + lead a0)/v_r), which includes friction that acts
within one step (lead = h, v_r = h f_k/m); they differ in what they take at the end of the step:

    explicit          nothing: v' = v + h a, then x' = x + h v'
    damping-implicit  the damping: (m + h c) v' counts (MuJoCo: Euler and implicitfast)
    implicit          damping and spring: m + h c + h^2 k counts, in the friction too (MuJoCo: discrete)

Under the first two the acceleration is the step's own; under the last it is what acts on the state itself. Given as
the step's own, (v' - v)/h, an implicit step is the explicit map of another slider, of c + h k for c and with
m + h c + h^2 k for m: its damping is then part of what is found.
"""

from dataclasses import dataclass
from typing import Literal, TypeAlias

import numpy as np

from harness.core.arrays import FloatArray
from harness.core.jit import compiled
from harness.model.model import Model

Scheme: TypeAlias = Literal["explicit", "damping-implicit", "implicit"]
SCHEMES: tuple[Scheme, ...] = ("explicit", "damping-implicit", "implicit")


@dataclass(frozen=True, slots=True)
class Stepped:
    """Samples x, v, a of stepped motions, each (n, k)."""

    x: FloatArray
    v: FloatArray
    a: FloatArray


def _march(
    p: FloatArray, h: float, each: int, scheme: int, pendulum: bool, late: bool, state: FloatArray, x: FloatArray,
    v: FloatArray, a: FloatArray,
) -> None:  # fmt: skip
    """Fill x, v, a (n, k) with every ``each``-th state of k motions side by side; p (7, k) : c/m, k/m, f_k/m, x0, v0,
    v_r, lead.

    late : the acceleration is the one that led to the state, not the one at it. state (3, k) : room.
    """
    count = p.shape[1]
    for q in range(count):
        state[0, q], state[1, q], state[2, q] = p[3, q], p[4, q], 0.0
    for step in range((x.shape[0] - 1) * each + 1):
        i = step // each
        shown = step % each == 0
        for q in range(count):
            c, k, f = p[0, q], p[1, q], p[2, q]
            at, speed, before = state[0, q], state[1, q], state[2, q]
            inertia = 1.0 + h * c + h * h * k
            pull = k * np.sin(at) if pendulum else k * at
            acting = -pull - c * speed
            free = (acting - h * k * speed) / inertia if scheme == 2 else acting
            share = min(1.0, max(-1.0, (speed + p[6, q] * free) / p[5, q]))
            now = acting - f * share
            if shown:
                x[i, q], v[i, q], a[i, q] = at, speed, before if late and step > 0 else now
            if scheme == 2:
                speed += h * (free - f * share / inertia)
            else:
                speed += h * now / (1.0 + h * c) if scheme == 1 else h * now
            state[0, q], state[1, q], state[2, q] = at + h * speed, speed, now


_compiled_march = compiled(_march)


def stepped(p: FloatArray, h: float, each: int, scheme: Scheme, pendulum: bool, late: bool, n: int) -> Stepped:
    """n samples, one every ``each`` steps of h s, for each column of p (7, k). See ``_march``."""
    p = np.ascontiguousarray(p)
    shape = (n, p.shape[1])
    out = Stepped(np.empty(shape), np.empty(shape), np.empty(shape))
    room = np.empty((3, p.shape[1]))
    _compiled_march(p, h, each, SCHEMES.index(scheme), pendulum, late, room, out.x, out.v, out.a)
    return out


@dataclass(frozen=True, slots=True)
class Stepping:
    """How the engine steps whose trace this is.

    scheme : one of SCHEMES. h : its step, s. late : whether the acceleration is that of the step before. model : the
    physics that it steps. left : mean square that the steps leave, in units of the noise. within_a_step : friction
    turns round within one step.
    """

    scheme: Scheme
    h: float
    late: bool
    model: Model
    left: float
    within_a_step: bool

    @property
    def sentence(self) -> str:
        """What is said of it."""
        m = self.model
        soft = m.terms[0]
        read = ", and its acceleration is that of the step before" if self.late else ""
        return (
            f"this is the trace of a simulation with a step of {self.h * 1e3:.4g} ms ({self.scheme}){read}; the steps"
            f" themselves fit to the noise with m = {m.m:.6g}, c = {m.c:.5g}, k = {m.k:.6g}, f_k = {m.f_k:.5g},"
            f" v_r = {soft.value('v_r'):.4g} m/s, lead = {soft.value('lead') * 1e3:.4g} ms; what the integrator adds"
            " is counted as the engine's"
        )
