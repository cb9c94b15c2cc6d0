"""Who computes spring and damper: the joint itself at the end of every sub-step, or a force from outside."""

from typing import Any

from harness.engines.base import Task
from harness.engines.stepping import Native, Plan


def own_or_pushed(task: Task, settings: dict[str, Any]) -> tuple[Plan, tuple[str, ...]]:
    """The plan of a task whose engine has the setting own_spring, and what it does not honour.

    own_spring : spring and damper are words of the joint, which the engine takes at the end of every sub-step; a
    pendulum is pushed with all the same. Without it they are a force held over the whole step. leapfrog : that step is
    read as the leapfrog of harness.engines.stepping.Plan; with springs of its own the engine takes none.
    """
    own = bool(settings.get("own_spring", False))
    ignored = ("leapfrog: spring and damper are the joint's own, taken at the end of a step",)
    lines = ignored if own and settings["leapfrog"] else ()
    native = Native(spring=own, damping=own, implicit=own)
    return Plan(task, settings | {"leapfrog": settings["leapfrog"] and not own}, native), lines
