"""The sliders of a suite: its own, random ones, and those with the values somebody gave."""

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from harness.core.errors import InputError
from harness.core.scenario import Harmonic
from harness.core.slider import PAPER, Slider
from harness.engines.base import Route

CONTACT_SCALE = 0.1
"""Sizes and forces on the floor, as a share of those of the joint: a fast box with much friction lifts, a slow one does
not; x/x_k and zeta stay the same, so that relative figures compare."""


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


OWN = Sliders(
    decay=PAPER,
    x0=1.0,
    sticky=Slider(m=1.0, c=0.2, k=100.0, f_k=3.0, f_s=4.0),
    belt_speed=0.1,
    # Den Hartog's r = 0.8, f = 0.3, without stops; r = 0.4, f = 0.6 stops twice a period
    driven=Slider(m=1.0, c=0.0, k=100.0, f_k=3.0),
    drive=Harmonic(10.0, 8.0),
    stopping=Harmonic(5.0, 4.0),
)
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


def scale_of(route: Route) -> float:
    """Lengths and forces on a route over those of the joint."""
    return CONTACT_SCALE if route == "contact" else 1.0


def scaled(slider: Slider, scale: float) -> Slider:
    """The slider with ``scale`` times the friction."""
    return replace(slider, f_k=plain(scale * slider.f_k), f_s=plain(scale * slider.break_away))


def plain(value: float) -> float:
    """Without the last digit that a product leaves behind (0.30000000000000004)."""
    return float(f"{value:.14g}")


VALUES = ("m", "c", "k", "f_k", "f_s")


def only(name: str, given: Mapping[str, float], accepted: tuple[str, ...]) -> None:
    """Raise InputError for a value that the scenario ``name`` does not take."""
    for key, value in given.items():
        if key not in accepted:
            found = f"{value:g}, given with {name}"
            raise InputError(f"--{key.replace('_', '-')}", found, f"{', '.join(accepted)} are accepted with it")


def with_values(slider: Slider, given: Mapping[str, float]) -> Slider:
    """The slider with the values given (VALUES); a friction that is given takes break-away along, in proportion."""
    own = {key: value for key, value in given.items() if key in VALUES}
    if "f_k" in own and "f_s" not in own:
        own["f_s"] = slider.break_away / slider.f_k * own["f_k"]
    return replace(slider, **own)
