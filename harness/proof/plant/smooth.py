"""Forces of (x, v, t): damping, stiffness, environment. Each returns what stands on the left of the equation."""

import math

from harness.proof.plant.pieces import Force


def quadratic_drag(c2: float) -> Force:
    """c2 |v| v."""
    return Force(lambda t, x, v, d: c2 * d * v * v)


def asymmetric_viscous(c_diff: float) -> Force:
    """c_diff |v|: damping c + c_diff forwards, c - c_diff backwards."""
    return Force(lambda t, x, v, d: c_diff * d * v)


def power_law_damping(c_p: float, exponent: float) -> Force:
    """c_p |v|^p sgn v."""
    return Force(lambda t, x, v, d: c_p * d * abs(v) ** exponent)


def cubic_stiffness(k3: float) -> Force:
    """k3 x^3."""
    return Force(lambda t, x, v, d: k3 * x * x * x)


def quadratic_stiffness(k2: float) -> Force:
    """k2 x^2."""
    return Force(lambda t, x, v, d: k2 * x * x)


def pendulum_stiffness(k: float) -> Force:
    """k (sin x - x), so that with k x of the base the restoring force is k sin x."""
    return Force(lambda t, x, v, d: k * (math.sin(x) - x))


def end_stop(gap: float, k_stop: float, side: str) -> Force:
    """k_stop (x - gap) beyond gap; side is "upper", "lower" (beyond -gap) or "both"."""
    upper, lower = side in ("upper", "both"), side in ("lower", "both")

    def law(t: float, x: float, v: float, d: float) -> float:
        if upper and x > gap:
            return k_stop * (x - gap)
        if lower and x < -gap:
            return k_stop * (x + gap)
        return 0.0

    return Force(law, kinks=(gap,) * upper + (-gap,) * lower)


def backlash(k: float, gap: float) -> Force:
    """-k clip(x, -gap, gap): with k x of the base, a dead zone of the spring."""
    return Force(lambda t, x, v, d: -k * min(max(x, -gap), gap), kinks=(gap, -gap))


def stiffness_drift(k: float, rate: float) -> Force:
    """k rate t x."""
    return Force(lambda t, x, v, d: k * rate * t * x)


def constant_force(force: float) -> Force:
    """A constant push on the right, hence with a minus here."""
    return Force(lambda t, x, v, d: -force)


def force_ripple(amplitude: float, period: float, phase: float) -> Force:
    """amplitude cos(2 pi x/period + phase)."""
    number = 2.0 * math.pi / period
    return Force(lambda t, x, v, d: amplitude * math.cos(number * x + phase))


def harmonic_force(amplitude: float, omega: float, phase: float) -> Force:
    """A cos(Omega t + phase) on the right, hence with a minus here."""
    return Force(lambda t, x, v, d: -amplitude * math.cos(omega * t + phase), rate=omega)
