"""What several test files of the engines share."""

from typing import Any

import numpy as np

from harness.core.scenario import Scenario
from harness.core.slider import PAPER, Slider
from harness.engines import registry
from harness.engines.base import Engine, Task

INSTALLED = tuple(name for name, reason in registry.available().items() if reason is None)
"""Every engine that can be used here; the conformance tests run over all of them."""

GENTLE = Slider(m=1.0, c=1.0, k=100.0, f_k=0.3)
"""Friction low enough for a box not to lift when it slides at 1 m/s."""

TABLE = [(name, route) for name in INSTALLED for route in registry.load(name).routes]
"""Every route of every one of them."""

OFF_FLOOR = [(name, route) for name, route in TABLE if route != "contact"]
"""Without the contact: fast sliders with much friction."""

CALLING = [(name, route) for name, route in OFF_FLOOR if registry.load(name).calls]
"""Those within whose steps something can be called: pendulums, force laws."""

JOINTED = tuple(name for name, route in TABLE if route == "joint")
"""Engines whose joints have dry friction."""


def engine(name: str) -> Engine:
    return registry.load(name)


def decay(slider: Slider = PAPER, x0: float = 1.0, duration: float = 3.0, v0: float = 0.0) -> Scenario:
    return Scenario("free-decay", slider, x0, v0, duration)


def short(route: str, **more: Any) -> Task:
    """Half a second of a decay that suits every route."""
    return Task(decay(GENTLE, 0.1, 0.5), route, **more)  # type: ignore[arg-type]


def stiff(dt: float) -> dict[str, Any]:
    """MuJoCo's joint friction with a time constant of two steps."""
    return {"solreffriction": (2.0 * dt, 1.0), "solimpfriction": (0.9999, 0.9999, 0.001, 0.5, 2.0)}


def sliders(seed: int, count: int) -> list[Slider]:
    """Sliders of random mass, frequency, damping and friction."""
    rng = np.random.default_rng(seed)
    made = []
    for _ in range(count):
        m, omega = np.exp(rng.uniform(-2.0, 2.0)), np.exp(rng.uniform(1.0, 3.2))
        k, zeta, x_k = m * omega**2, rng.uniform(0.0, 0.3), rng.uniform(0.01, 0.08)
        made.append(Slider(m=m, c=2.0 * zeta * m * omega, k=k, f_k=k * x_k))
    return made
