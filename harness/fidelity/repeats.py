"""Whether an engine repeats itself: from run to run, from world to world of a batch, from device to device."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from harness.core.errors import HarnessError, NoDeviceError
from harness.core.trajectory import Trajectory
from harness.engines.base import Engine, Task

SCENARIO = "free-decay"
"""Whose rows, as shipped and tuned, are run again."""
WORLDS = 16
DEVICES = ("cpu", "gpu")


@dataclass(frozen=True, slots=True)
class Repeated:
    """apart_m : largest difference of position, 0 the same to the last bit. failed : why it did not run again.

    Both by runs (another run), worlds (between as many of one batch, where the engine has batches), devices (the other
    device, where the engine has a choice and the machine has both).
    """

    apart_m: dict[str, float]
    failed: dict[str, str]


def repeats(engine: Engine, task: Task, first: Trajectory) -> Repeated:
    """The task of ``first`` once more."""
    device = first.source.settings.get("device")
    ways: dict[str, Callable[[], Sequence[Trajectory | HarnessError]]] = {"runs": lambda: [engine.simulate(task)]}
    if engine.batches:
        ways["worlds"] = lambda: engine.simulate_all([task] * WORLDS)
    if device is not None:
        other = next(one for one in DEVICES if one != device)
        ways["devices"] = lambda: [engine.simulate(replace(task, settings={**task.settings, "device": other}))]
    found = Repeated({}, {})
    for way, run in ways.items():
        try:
            again = [_run(one) for one in run()]
            found.apart_m[way] = _far(again[0] if way == "worlds" else first, again)
        except NoDeviceError:
            pass
        except HarnessError as error:
            found.failed[way] = str(error)
    return found


def _run(one: Trajectory | HarnessError) -> Trajectory:
    if isinstance(one, HarnessError):
        raise one
    return one


def _far(one: Trajectory, others: Sequence[Trajectory]) -> float:
    return max(float(np.max(np.abs(one.x - other.x))) for other in others)
