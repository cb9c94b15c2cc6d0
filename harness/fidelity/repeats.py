"""Whether an engine repeats itself: from run to run, from world to world of a batch, from device to device."""

from dataclasses import replace

import numpy as np

from harness.core.errors import HarnessError
from harness.core.trajectory import Trajectory
from harness.engines.base import Engine, Task

SCENARIO = "free-decay"
"""Whose rows, as shipped and tuned, are run again."""
WORLDS = 16
DEVICES = ("cpu", "gpu")


def repeats(engine: Engine, task: Task, first: Trajectory) -> dict[str, float]:
    """Largest difference of position in m between ``first`` and what the same task gives once more.

    runs : another run. worlds : between as many worlds of one batch, where the engine has batches. devices : on the
    other device, where the engine has a choice and the machine has both. 0 is the same to the last bit. What fails
    is left out.
    """
    found: dict[str, float] = {}
    device = first.source.settings.get("device")
    try:
        found["runs"] = _far(first, [engine.simulate(task)])
        if engine.batches:
            one, *others = (world for world in engine.simulate_all([task] * WORLDS) if isinstance(world, Trajectory))
            found["worlds"] = _far(one, others)
        if device is not None:
            other = next(one for one in DEVICES if one != device)
            found["devices"] = _far(
                first, [engine.simulate(replace(task, settings={**task.settings, "device": other}))]
            )
    except HarnessError:
        pass
    return found


def _far(one: Trajectory, others: list[Trajectory]) -> float:
    return max((float(np.max(np.abs(one.x - other.x))) for other in others), default=0.0)
