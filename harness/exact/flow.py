"""The linear motion inside one half-cycle, for every damping ratio with one pair of functions.

With y measured from the centre of the half-cycle, y'' + 2 sigma y' + omega_n^2 y = 0 has the solutions

    y(tau) = y_0 C + (y_0' + sigma y_0) S,      C = exp(-sigma tau) cos(omega_d tau),
                                                S = exp(-sigma tau) sin(omega_d tau) / omega_d.

The same form carries y', y'' and every further derivative. C and S are smooth functions of ``disc`` = omega_d^2 =
omega_n^2 (1 - zeta^2), which is negative for an overdamped slider, so nothing is lost near zeta = 1.
"""

import math

from harness.core.jit import compiled


@compiled
def flow(tau: float, omega_n: float, sigma: float, disc: float) -> tuple[float, float]:
    """C and S (s) at time ``tau`` >= 0 after the start of a half-cycle."""
    if disc > 0.0:
        omega_d = math.sqrt(disc)
        decay = math.exp(-sigma * tau)
        return decay * math.cos(omega_d * tau), decay * math.sin(omega_d * tau) / omega_d
    if disc < 0.0:
        # the slow root is sigma - kappa without its cancellation; cosh and sinh would overflow
        kappa = math.sqrt(-disc)
        slow = math.exp(-tau * omega_n * omega_n / (sigma + kappa))
        lost = -math.expm1(-2.0 * kappa * tau)
        return slow * (1.0 - 0.5 * lost), slow * lost / (2.0 * kappa)
    decay = math.exp(-sigma * tau)
    return decay, decay * tau


@compiled
def discriminant(omega_n: float, zeta: float) -> float:
    """omega_d^2 in (rad/s)^2, signed: above zero the slider oscillates."""
    return omega_n * omega_n * ((1.0 - zeta) * (1.0 + zeta))
