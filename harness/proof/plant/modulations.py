"""Factors on the friction level."""

import math

from harness.proof.plant.friction import Modulation


def along_slope(slope: float) -> Modulation:
    """1 + slope x."""
    return lambda t, x, net, work: 1.0 + slope * x


def along_cosine(depth: float, period: float, phase: float) -> Modulation:
    """1 + depth cos(2 pi x/period + phase)."""
    number = 2.0 * math.pi / period
    return lambda t, x, net, work: 1.0 + depth * math.cos(number * x + phase)


def drifting(rate: float) -> Modulation:
    """1 + rate t."""
    return lambda t, x, net, work: 1.0 + rate * t


def pulsing(depth: float, omega: float, phase: float) -> Modulation:
    """1 + depth cos(Omega t + phase)."""
    return lambda t, x, net, work: 1.0 + depth * math.cos(omega * t + phase)


def heated(gain: float, energy: float) -> Modulation:
    """1 + gain (work done against friction)/energy: warm friction. No catalogue holds this one."""
    return lambda t, x, net, work: 1.0 + gain * work / energy


def loaded_by_inertia(gain: float, force: float) -> Modulation:
    """1 + gain |net force|/force: the load on the guide grows with acceleration. No catalogue holds this one."""
    return lambda t, x, net, work: 1.0 + gain * abs(net) / force


def growing_outwards(gain: float, length: float) -> Modulation:
    """1 + gain |x|/length: structural (hysteretic) damping beside Coulomb friction. No catalogue holds this one."""
    return lambda t, x, net, work: 1.0 + gain * abs(x) / length
