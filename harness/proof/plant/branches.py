"""Things with states of their own that hang on the slider."""

import math
from collections.abc import Sequence

from harness.proof.plant.pieces import Branch


def maxwell(k_m: float, tau: float) -> Branch:
    """A Maxwell branch in parallel: force k_m y, y' = v - y/tau, relaxed at the start."""
    return Branch(
        start=lambda x0, v0: (0.0,),
        derivative=lambda x, v, own: (v - own[0] / tau,),
        force=lambda x, v, own: k_m * own[0],
    )


def attached_mode(m: float, omega_2: float, mass_ratio: float, zeta_2: float) -> Branch:
    """A second mass m2 = mass_ratio m on a spring on the slider, at rest relative to it at the start.

    omega_2 = sqrt(k2/m2) with the slider held, zeta_2 = c2/(2 sqrt(k2 m2)).
    """
    m2 = mass_ratio * m
    k2, c2 = m2 * omega_2**2, 2.0 * zeta_2 * m2 * omega_2

    def pull(x: float, v: float, own: Sequence[float]) -> float:
        return k2 * (own[0] - x) + c2 * (own[1] - v)

    return Branch(
        start=lambda x0, v0: (x0, v0),
        derivative=lambda x, v, own: (own[1], -pull(x, v, own) / m2),
        force=lambda x, v, own: -pull(x, v, own),
        rate=omega_2 * math.sqrt(1.0 + mass_ratio),
    )


def rattle(m: float, mass_ratio: float, clearance: float, omega_c: float, zeta_c: float) -> Branch:
    """A loose mass in a cage of half-width ``clearance`` (m): free flight, and impacts on springs with dampers.

    omega_c : contact frequency of the loose mass on its wall, rad/s. No catalogue holds this one.
    """
    m2 = mass_ratio * m
    k2, c2 = m2 * omega_c**2, 2.0 * zeta_c * m2 * omega_c

    def push(x: float, v: float, own: Sequence[float]) -> float:
        r, w = own[0] - x, own[1] - v
        if r > clearance:
            return max(0.0, k2 * (r - clearance) + c2 * w)
        if r < -clearance:
            return min(0.0, k2 * (r + clearance) + c2 * w)
        return 0.0

    return Branch(
        start=lambda x0, v0: (x0, v0),
        derivative=lambda x, v, own: (own[1], -push(x, v, own) / m2),
        force=lambda x, v, own: -push(x, v, own),
        switches=(lambda x, v, own: own[0] - x - clearance, lambda x, v, own: own[0] - x + clearance),
        rate=omega_c,
    )
