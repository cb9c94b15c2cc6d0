"""Friction of engines that do not tell it: what is missing in the momentum of a step."""

import math
from typing import Any

import numpy as np

from harness.core.arrays import FloatArray
from harness.engines.base import Task
from harness.engines.stepping import Native, Plan

SINGLE = float(np.finfo(np.float32).eps)
"""Rounding of a number in single precision, relative."""
ROUNDINGS = 8.0
"""Roundings of a speed in a step: two a sub-step, of four sub-steps."""


class Momentum:
    """Friction over a step of n equal sub-steps v+ = (v + (h/n) (u - f - k x+)/m) / (1 + h c/(n m)), x+ = x + (h/n) v+.

    m in kg; c in N s/m and k in N/m are what the engine takes at the end of every sub-step, zero for what is pushed
    with; h in s. The speed after the step is linear, v+ = A x + B v + C u - D f, so that f follows from it. last : the
    impulse of friction comes after the spring and damper of a sub-step have been solved for, so that they do not weigh
    it: v+ = (v + (h/n) (u - k x+)/m) / (1 + h c/(n m)) - (h/n) f/m, x+ on the right that of a step without f. first :
    impulses of the whole step, h u and h f, come in the first sub-step.
    """

    def __init__(
        self, m: float, c: float, k: float, h: float, n: int, *, last: bool = False, first: bool = False
    ) -> None:
        part = h / n
        weight = 1.0 / (1.0 + part * (c + part * k) / m)
        once: FloatArray = np.array([[1.0 - part**2 * k * weight / m, part * weight], [-part * k * weight / m, weight]])
        given: FloatArray = part * weight / m * np.array([part, 1.0])
        rubbed: FloatArray = part / m * np.array([part, 1.0]) if last else given
        powers: list[FloatArray] = [np.eye(2)]
        for _ in range(n):
            powers.append(once @ powers[-1])
        state = powers[n]
        sums: FloatArray = n * powers[n - 1] if first else np.sum(powers[:n], axis=0)
        gained, lost = sums @ given, sums @ rubbed
        self._of_x, self._of_v = float(state[1, 0]), float(state[1, 1])
        self._gain, self._loss = float(gained[1]), float(lost[1])

    def friction(self, x: float, v: float, after: float, push: float, limit: float) -> float:
        """Friction force on the left-hand side, N, held constant over the step.

        x (m) and v (m/s) before the step, ``after`` (m/s) behind it; push in N. A force that is ``limit`` (N) to
        within the rounding of single precision is the limit.
        """
        kept = self._of_x * x + self._of_v * v
        force = (self._gain * push + kept - after) / self._loss
        slack = ROUNDINGS * SINGLE * ((abs(kept) + abs(after)) / self._loss + abs(push))
        return math.copysign(limit, force) if abs(abs(force) - limit) < slack else force


def own_or_pushed(task: Task, settings: dict[str, Any]) -> tuple[Plan, tuple[str, ...]]:
    """The plan of a task whose engine has some of these settings, and what it does not honour.

    own_spring : spring and damper are words of the joint, which the engine takes at the end of every sub-step; a
    pendulum is pushed with all the same. Without it they are a force held over the whole step. own_viscous : the damper
    is the viscous part of the joint's friction. own_break_away : the joint breaks away by itself, on the joint route.
    leapfrog : that step is read as the leapfrog of harness.engines.stepping.Plan; with a spring or damper of its own
    the engine takes none.
    """
    spring = bool(settings.get("own_spring", False))
    damping = spring or bool(settings.get("own_viscous", False))
    ignored = ("leapfrog: the joint's own spring or damper is taken at the end of a step",)
    lines = ignored if damping and settings["leapfrog"] else ()
    away = bool(settings.get("own_break_away", False)) and task.route == "joint"
    native = Native(spring, damping, implicit=damping, break_away=away)
    return Plan(task, settings | {"leapfrog": settings["leapfrog"] and not damping}, native), lines
