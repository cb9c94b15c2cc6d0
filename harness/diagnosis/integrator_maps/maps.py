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
    """Samples x, v, a of a stepped motion, each (n,)."""

    x: FloatArray
    v: FloatArray
    a: FloatArray


def _march(
    p: FloatArray, h: float, each: int, scheme: int, pendulum: bool, late: bool, x: FloatArray, v: FloatArray,
    a: FloatArray,
) -> None:  # fmt: skip
    """Fill x, v, a (n,) with every ``each``-th state; p : c/m, k/m, f_k/m, x0, v0, v_r, lead.

    late : the acceleration is the one that led to the state, not the one at it.
    """
    c, k, f, at, speed, v_r, lead = p[0], p[1], p[2], p[3], p[4], p[5], p[6]
    inertia = 1.0 + h * c + h * h * k
    before = 0.0
    for step in range((x.size - 1) * each + 1):
        pull = k * np.sin(at) if pendulum else k * at
        acting = -pull - c * speed
        free = (acting - h * k * speed) / inertia if scheme == 2 else acting
        share = min(1.0, max(-1.0, (speed + lead * free) / v_r))
        now = acting - f * share
        if step % each == 0:
            i = step // each
            x[i], v[i], a[i] = at, speed, before if late and step > 0 else now
        before = now
        if scheme == 2:
            speed += h * (free - f * share / inertia)
        else:
            speed += h * now / (1.0 + h * c) if scheme == 1 else h * now
        at += h * speed


_compiled_march = compiled(_march)


def stepped(p: FloatArray, h: float, each: int, scheme: Scheme, pendulum: bool, late: bool, n: int) -> Stepped:
    """n samples, one every ``each`` steps of h s. See ``_march``."""
    out = Stepped(np.empty(n), np.empty(n), np.empty(n))
    _compiled_march(p, h, each, SCHEMES.index(scheme), pendulum, late, out.x, out.v, out.a)
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
