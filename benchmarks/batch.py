"""Batches of an engine that runs many sliders at once, against one slider in the same run, without compilation."""

from typing import Any

import numpy as np

from benchmarks.registry import Pair, benchmark
from harness.core.scenario import Scenario
from harness.core.slider import Slider
from harness.engines import registry
from harness.engines.base import Task, resolve
from harness.engines.mujoco.at_once import AtOnce, held

STEP, STEPS = 2e-3, 500
SLIDERS = 1024
ON_GPU = 65_536


def _tasks(count: int, settings: dict[str, Any], steps: int) -> list[Task]:
    """Decays of random sliders with friction as stiff as the step allows."""
    random = np.random.default_rng(5)
    stiff = {"solreffriction": (2.0 * STEP, 1.0), "solimpfriction": (0.9999, 0.9999, 0.001, 0.5, 2.0)}
    found = []
    for _ in range(count):
        slider = Slider(float(random.uniform(0.3, 3.0)), 1.0, 100.0, float(random.uniform(1.0, 5.0)))
        scenario = Scenario("free-decay", slider, 1.0, 0.0, (steps - 1) * STEP)
        found.append(Task(scenario, "joint", "as-shipped", STEP, settings | stiff))
    return found


def _runs(name: str, tasks: list[Task], copies: int = 1) -> Any:
    """Compiled. copies : of every task, where they are many."""
    engine = registry.load(name)
    assert isinstance(engine, AtOnce)
    settings = [resolve(engine, task) for task in tasks]
    ready = [(held(task, engine.of_mujoco(one)), one) for task, one in zip(tasks, settings, strict=True)]
    return engine.ready(ready * copies)


def _pair(name: str, iterations: int, ls_iterations: int) -> Pair:
    effort = {"iterations": iterations, "ls_iterations": ls_iterations}
    many = _runs(name, _tasks(SLIDERS, effort, STEPS))
    alone = _runs(name, _tasks(1, effort, STEPS))
    return Pair(many.run, alone.run, rounds=5)


_TIMED = f"{SLIDERS} random sliders of {STEPS} steps at once on the CPU, single precision, compiled before"
_PEER = "one of them by the same code"


@benchmark("batch.mjx-100-50", peer=_PEER, timed=f"{_TIMED}, iterations 100, ls_iterations 50", target=350.0)
def full() -> Pair:
    return _pair("mjx", 100, 50)


@benchmark("batch.mjx-4-8", peer=_PEER, timed=f"{_TIMED}, iterations 4, ls_iterations 8", target=350.0)
def cut() -> Pair:
    return _pair("mjx", 4, 8)


@benchmark("batch.mjx-1-50", peer=_PEER, timed=f"{_TIMED}, iterations 1, ls_iterations 50", target=350.0)
def recommended() -> Pair:
    return _pair("mjx", 1, 50)


@benchmark("batch.warp-1-50", peer=_PEER, timed=f"{_TIMED}, iterations 1, ls_iterations 50", target=350.0)
def of_warp() -> Pair:
    return _pair("warp", 1, 50)


_TIMED_GPU = (
    f"{ON_GPU} sliders x 1,000 steps at once on a GPU, single precision, iterations 1, ls_iterations 50; 3 s are good"
)


@benchmark("batch.mjx-gpu", peer="1,024 of them", timed=_TIMED_GPU, target=None)
def gpu() -> Pair:
    return _on_gpu("mjx")


@benchmark("batch.warp-gpu", peer="1,024 of them", timed=_TIMED_GPU, target=None)
def gpu_of_warp() -> Pair:
    return _on_gpu("warp")


def _on_gpu(name: str) -> Pair:
    tasks = _tasks(SLIDERS, {"iterations": 1, "ls_iterations": 50, "device": "gpu"}, 1000)
    alone = _runs(name, tasks)  # where there is no GPU, it is said here
    return Pair(_runs(name, tasks, ON_GPU // SLIDERS).run, alone.run, rounds=3)
