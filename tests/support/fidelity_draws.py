"""What several test files of the fidelity suite share."""

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from harness.core.scenario import Harmonic, Scenario
from harness.core.slider import Slider
from harness.fidelity.scenarios.belt import BELT
from harness.fidelity.scenarios.decay import FREE_DECAY, FREE_DECAY_NO_FRICTION
from harness.fidelity.scenarios.harmonic import HARMONIC, HARMONIC_STOPS
from harness.fidelity.scenarios.hold import HOLD_97


def drawn_suites(seed: int, count: int) -> Iterator[Scenario]:
    """Scenarios of random sliders, of every kind that the suite has."""
    rng = np.random.default_rng(seed)
    for _ in range(count):
        m, omega = float(np.exp(rng.uniform(-1.0, 1.0))), float(rng.uniform(4.0, 20.0))
        k, zeta = m * omega**2, float(rng.uniform(0.0, 0.1))
        slider = Slider(m, 2.0 * zeta * m * omega, k, float(k * rng.uniform(0.02, 0.06)))
        yield FREE_DECAY.release(slider, float(rng.choice([-1.0, 1.0])), 20.0 / omega)
        yield FREE_DECAY_NO_FRICTION.release(replace(slider, f_k=0.0, f_s=0.0), 0.5, 20.0 / omega)
        sticky = Slider(m, slider.c, k, slider.f_k, slider.f_k * float(rng.uniform(1.2, 1.8)))
        yield BELT.ride(sticky, float(0.3 * slider.x_k * omega * rng.uniform(0.3, 1.0)), 3)
        ratio = float(rng.uniform(0.5, 0.9))
        yield HARMONIC.shake(slider, Harmonic(slider.f_k * float(rng.uniform(2.0, 5.0)), ratio * omega), 3)
        yield HARMONIC_STOPS.shake(slider, Harmonic(slider.f_k * float(rng.uniform(1.2, 1.7)), 0.4 * omega), 2)
        yield HOLD_97.load(slider)
