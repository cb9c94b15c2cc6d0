"""Bodies in contact: on a slope, in a pinch grip, rolling, spinning; condim 1, 3, 4, 6, pairs, other shapes."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import final

import numpy as np

from harness.core.arrays import FloatArray
from harness.core.errors import InputError
from harness.core.events import Mode
from harness.core.scenario import Body, Scenario
from harness.core.slider import Slider
from harness.core.trajectory import Source, Trajectory
from harness.fidelity import kind as suite
from harness.fidelity.metrics import GRAVITY

FREE_SPRING = 1e-9
"""N/m: a slider needs a spring, a body has none."""
_READ = (0.1, 0.9)
"""Shares of the time in motion between which a deceleration is read."""
DURATION, SPEED = 1.0, 1.0
"""s, and m/s of what rolls or spins."""


def deceleration(body: Body) -> float:
    """Of x, m/s^2: mu_r g/(1.4 r) rolling, mu_t g/(0.4 r) at the rim of a spinning ball, below 0 down a slope."""
    if body.place == "floor":
        return body.mu_t * GRAVITY / (0.4 * body.size) if body.spins else body.mu_r * GRAVITY / (1.4 * body.size)
    held = 0.0 if body.condim == 1 else min(body.load, 1.0)
    return (held - body.load) * body.mu * GRAVITY


def size_a_second(row: suite.Row) -> float:
    """The body's size in a second, m/s."""
    return float(row["setup"]["action"]["size"])


@final
@dataclass(frozen=True, slots=True, kw_only=True)
class BodyKind(suite.Kind):
    """A body that rests, or slows down as its friction has it."""

    body: Body

    def of_suite(self, sliders: suite.Sliders, scale: float) -> Scenario:
        """See Kind.of_suite; the mass is the slider's."""
        return self.scenario(sliders.decay.m, SPEED if self.body.place == "floor" else 0.0)

    def scenario(self, mass: float, speed: float, body: Body | None = None, duration: float = DURATION) -> Scenario:
        """The scenario of a mass (kg), a speed (m/s) and a body in place of the kind's own."""
        own = self.body if body is None else body
        slider = Slider(mass, 0.0, FREE_SPRING, suite.plain(own.mu * mass * GRAVITY))
        return Scenario(self.name, slider, 0.0, speed, duration, own)

    def chosen(self, given: Mapping[str, float]) -> Scenario:
        suite.only(self.name, given, ("m", "f_k", "v0", "duration"))
        mass = given.get("m", 1.0)
        mu = given["f_k"] / (mass * GRAVITY) if "f_k" in given else self.body.mu
        moves = self.body.place == "floor"
        if not moves and given.get("v0"):
            raise InputError("--v0", f"{given['v0']:g}, given with {self.name}", "one that rests without")
        speed = given.get("v0", SPEED if moves else 0.0)
        return self.scenario(mass, speed, replace(self.body, mu=mu), given.get("duration", DURATION))

    def exact(self, scenario: Scenario, t: FloatArray) -> Trajectory:
        """See Kind.exact; a constant deceleration until it stops."""
        assert isinstance(scenario.action, Body)
        slows = deceleration(scenario.action)
        stop = scenario.v0 / slows if slows > 0.0 else math.inf if slows < 0.0 else 0.0
        moving = t < stop
        s = np.minimum(t, stop)
        x = scenario.x0 + scenario.v0 * s - 0.5 * slows * s**2
        mode = np.where(moving & (scenario.action.place != "floor"), int(Mode.SLIP_POSITIVE), int(Mode.STICK))
        v, a = np.where(moving, scenario.v0 - slows * t, 0.0), np.where(moving, -slows, 0.0)
        return Trajectory(t, x, v, a, Source("reference", "exact"), None, mode.astype(np.int8))

    def answers(self, scenario: Scenario) -> suite.Answers:
        assert isinstance(scenario.action, Body)
        slows = deceleration(scenario.action)
        return {"creep_m_s": 0.0} if slows == 0.0 else {"deceleration_m_s2": slows}

    def measure(self, trace: Trajectory, scenario: Scenario) -> suite.Metrics:
        """Creep in the later half of a body that rests, m/s, the deceleration of one that does not, and its lift, m."""
        assert isinstance(scenario.action, Body)
        half, slows = len(trace) // 2, deceleration(scenario.action)
        found: suite.Metrics = {"lift_m": float(np.max(trace.extra.get("lift", np.zeros(1))))}
        if slows == 0.0:
            return found | {"creep_m_s": float((trace.x[-1] - trace.x[half]) / (trace.t[-1] - trace.t[half]))}
        ends = min(trace.t[-1], scenario.v0 / slows if slows > 0.0 else math.inf)
        inside = (trace.t > _READ[0] * ends) & (trace.t < _READ[1] * ends)
        return found | {"deceleration_m_s2": float(-np.polyfit(trace.t[inside], trace.v[inside], 1)[0])}


_CREEP = suite.Figure("body creep", "creep_m_s", size_a_second, "creep of a body that rests, over its size in a second")
_SLOWS = suite.Figure(
    "deceleration", "deceleration_m_s2", lambda row: abs(float(row["exact"]["deceleration_m_s2"])), "of a rolling body"
)


def _kinds() -> dict[str, Body]:
    slope = Body("slope", load=0.5)
    grip = Body("grip", size=0.02, mu=1.0, load=0.1)
    return {
        "incline": slope,
        "incline-97": replace(slope, load=0.97),
        "incline-condim-1": replace(slope, condim=1),
        "incline-condim-4": replace(slope, condim=4),
        "incline-condim-6": replace(slope, condim=6),
        "incline-pair": replace(slope, pair=True),
        "incline-cylinder": replace(slope, shape="cylinder"),
        "pinch": grip,
        "pinch-sphere": replace(grip, shape="sphere", condim=4),
        "rolling": Body("floor", "sphere", mu=1.0, condim=6),
        "spinning": Body("floor", "sphere", mu=1.0, condim=4, spins=True),
    }


(
    INCLINE, INCLINE_97, CONDIM_1, CONDIM_4, CONDIM_6, PAIR, CYLINDER, PINCH, PINCH_SPHERE, ROLLING, SPINNING,
) = (
    BodyKind(
        name=name,
        place=30 + place,
        part="bodies",
        routes=("contact",),
        body=body,
        figures=(_CREEP if deceleration(body) == 0.0 else _SLOWS,),
    )
    for place, (name, body) in enumerate(_kinds().items())
)  # fmt: skip
"""Half of friction and 97 %, on a slope; a tenth of it in a grip; 1 m/s."""
