"""The scenarios of the fidelity suite: each has an exact answer, and each starts on the motion it is about."""

import math
from dataclasses import dataclass, replace

import numpy as np

from harness.core.errors import InputError
from harness.core.scenario import Belt, Harmonic, Hold, Scenario
from harness.core.slider import PAPER, Slider
from harness.engines.base import Route
from harness.exact.belt import LimitCycle, limit_cycle
from harness.exact.harmonic import Response, response

DECAY, FRICTIONLESS = "free-decay", "free-decay-no-friction"
HOLDS = {"hold-50": 0.50, "hold-97": 0.97}
"""Static holds with their load as a share of break-away."""
BELT, HARMONIC, STOPS = "belt", "harmonic", "harmonic-stops"
LIFTS = {"free-decay-x3": 3.0, "free-decay-x10": 10.0}
"""Contact route: the free decay from so many times as far, with so much more friction, until the box lifts."""

PERIODS = 8
"""Periods of a belt run; those of a forced run are MOST_PERIODS."""
FORCED_PERIODS = 10

BELT_SLIDER, BELT_SPEED = Slider(m=1.0, c=0.2, k=100.0, f_k=3.0, f_s=4.0), 0.1
DRIVEN_SLIDER, DRIVE = Slider(m=1.0, c=0.0, k=100.0, f_k=3.0), Harmonic(10.0, 8.0)
"""Den Hartog's r = 0.8, f = 0.3: no stops."""
STOPPING_DRIVE = Harmonic(5.0, 4.0)
"""r = 0.4, f = 0.6: the slider stops twice a period."""


@dataclass(frozen=True, slots=True)
class Sliders:
    """What a suite is made of; lengths and forces are those of the joint routes.

    decay, x0 (m) : the free decay, 3.5 periods of 1 s at omega_n = 10. sticky, belt_speed (m/s) : the belt.
    driven, drive, stopping : harmonic forcing without and with stops.
    """

    decay: Slider
    x0: float
    sticky: Slider
    belt_speed: float
    driven: Slider
    drive: Harmonic
    stopping: Harmonic


OWN = Sliders(PAPER, 1.0, BELT_SLIDER, BELT_SPEED, DRIVEN_SLIDER, DRIVE, STOPPING_DRIVE)
"""The paper's slider, the checked belt and Den Hartog's case."""


def drawn(number: int) -> Sliders:
    """A random suite, always the same for the same number: mass, frequency, damping and friction all vary.

    It takes about as many steps as the suite's own: omega_n lies between 7 and 14 rad/s.
    """
    rng = np.random.default_rng([20240, number])

    def one(zeta: float) -> Slider:
        m, omega = float(np.exp(rng.uniform(-1.0, 1.0))), float(rng.uniform(7.0, 14.0))
        k = m * omega**2
        return Slider(m, 2.0 * zeta * m * omega, k, float(k * rng.uniform(0.02, 0.05)))

    decay, sticky, driven = one(rng.uniform(0.02, 0.1)), one(rng.uniform(0.0, 0.03)), one(0.0)
    sticky = replace(sticky, f_s=sticky.f_k * float(rng.uniform(1.2, 1.6)))
    speed = float((sticky.x_s - sticky.x_k) * sticky.omega_n * rng.uniform(0.5, 1.5))
    drive = Harmonic(driven.f_k * float(rng.uniform(2.5, 4.0)), float(driven.omega_n * rng.uniform(0.6, 0.85)))
    stopping = Harmonic(driven.f_k * float(rng.uniform(1.4, 1.8)), 0.4 * driven.omega_n)
    return Sliders(decay, 1.0, sticky, speed, driven, drive, stopping)


SOFT = 0.01
"""Stiffness of a hold over that of the free decay: creep must not unload it."""

CONTACT_SCALE = 0.1
"""Sizes and forces on the floor, as a share of those of the joint: a fast box with much friction lifts, a slow one does
not; x/x_k and zeta stay the same, so that relative figures compare."""


def names(route: Route) -> tuple[str, ...]:
    """Scenarios of a route, in the order in which they are shown."""
    common = (DECAY, FRICTIONLESS, *HOLDS, BELT, HARMONIC, STOPS)
    return (*common, *LIFTS) if route == "contact" else common


def suite(route: Route, sliders: Sliders = OWN) -> dict[str, Scenario]:
    """Every scenario of a route by its name."""
    scale = CONTACT_SCALE if route == "contact" else 1.0
    slider, x0 = scaled(sliders.decay, scale), _plain(scale * sliders.x0)
    driven, drive, stopping = scaled(sliders.driven, scale), sliders.drive, sliders.stopping
    held = Slider(sliders.decay.m, 0.0, _plain(SOFT * sliders.decay.k), sliders.decay.f_k)
    made = [
        decay(slider, x0, 3.5),
        frictionless(slider, x0, 3.0),
        # a box at rest does not lift, so the friction of a hold need not be small
        *(hold(name, held) for name in HOLDS),
        belt(sliders.sticky, sliders.belt_speed),
        forced(HARMONIC, driven, Harmonic(_plain(scale * drive.amplitude), drive.omega)),
        forced(STOPS, driven, Harmonic(_plain(scale * stopping.amplitude), stopping.omega)),
    ]
    if route == "contact":
        for name, more in LIFTS.items():
            made.append(replace(decay(scaled(slider, more), _plain(x0 * more), 3.5), name=name))
    return {scenario.name: scenario for scenario in made}


def scaled(slider: Slider, scale: float) -> Slider:
    """The slider with ``scale`` times the friction."""
    return replace(slider, f_k=_plain(scale * slider.f_k), f_s=_plain(scale * slider.break_away))


def _plain(value: float) -> float:
    """Without the last digit that a product leaves behind (0.30000000000000004)."""
    return float(f"{value:.14g}")


def decay(slider: Slider, x0: float, duration: float) -> Scenario:
    """A release from rest at x0 (m); duration (s) should leave time at rest, in which creep shows."""
    return Scenario(DECAY, slider, x0, 0.0, duration)


def frictionless(slider: Slider, x0: float, duration: float) -> Scenario:
    """The same slider without dry friction: what the integrator alone gets wrong."""
    return Scenario(FRICTIONLESS, replace(slider, f_k=0.0, f_s=0.0), x0, 0.0, duration)


def hold(name: str, slider: Slider, duration: float = 0.5) -> Scenario:
    """A constant load below break-away on a slider whose spring is soft, so that creep does not unload it."""
    return Scenario(name, slider, 0.0, 0.0, duration, Hold(_plain(HOLDS[name] * slider.break_away)))


def belt(slider: Slider, speed: float, periods: int = PERIODS) -> Scenario:
    """Stick-slip on a belt, started half way through a stick.

    Raises InputError when the slider does not stick and slip at this speed.
    """
    cycle = cycle_of(slider, speed)
    start = cycle.stick_x + 0.5 * speed * cycle.stick_time
    return Scenario(BELT, slider, start, speed, periods * cycle.period, Belt(speed))


def cycle_of(slider: Slider, speed: float) -> LimitCycle:
    """The exact cycle; raises InputError with the reason when there is none."""
    cycle = limit_cycle(slider, speed)
    if not isinstance(cycle, LimitCycle):
        raise InputError("belt", f"no stick-slip ({cycle.why})", "a slider with f_s > f_k on a slow belt is accepted")
    return cycle


def forced(name: str, slider: Slider, drive: Harmonic, periods: int = FORCED_PERIODS) -> Scenario:
    """A harmonic force, started on the exact periodic motion, so that a run shows what an engine makes of it."""
    start = response_of(slider, drive).motion.table[0]
    return Scenario(name, slider, float(start[1]), float(start[2]), periods * 2.0 * math.pi / drive.omega, drive)


def response_of(slider: Slider, drive: Harmonic) -> Response:
    """The exact periodic motion."""
    return response(slider, drive)
