"""What the joint itself computes, and what is a force from outside: spring, damper, break-away."""

from typing import Any

from harness.engines.base import Task
from harness.engines.stepping import Native, Plan


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
