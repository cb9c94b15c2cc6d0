"""Machines whose force is measured: an axis on a spring, a ball screw, a cylinder; what drives them, what they hide."""

import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np

from harness.proof.machines.kinds import AROUND, DAMPING, FRICTION, ROUNDED, SENSORS, STEADY, STIFFNESS, Kind
from harness.proof.plant.base import MOST_SAMPLES, Base, draw_axis, draw_driven, log_uniform
from harness.proof.plant.model import Drive

REPEATED = 0.35
"""Share of the drives that repeat themselves."""


def spring_axis(rng: np.random.Generator) -> Base:
    """A slider on a spring under a slow multisine or, one in three, a few periods of one frequency."""
    base = draw_driven(rng)
    if rng.random() > REPEATED:
        return _heavier(base, rng)
    omega, force = base.omega_n * log_uniform(rng, 0.12, 0.35), base.force * float(rng.uniform(0.6, 1.2))
    fade = 2.0 * math.pi / base.omega_n

    def law(t: float, x: float, v: float) -> float:
        s = min(t / fade, 1.0)
        return s * s * (3.0 - 2.0 * s) * force * math.sin(omega * t)

    duration = float(rng.uniform(3.0, 6.0)) * 2.0 * math.pi / omega
    samples = int(min(base.samples * duration / base.duration, MOST_SAMPLES))
    return _heavier(replace(base, drive=Drive(law, rate=base.omega_n), duration=duration, samples=samples), rng)


def _heavier(base: Base, rng: np.random.Generator) -> Base:
    """The same motion of another mass: all forces are larger by its ratio."""
    m, drive = log_uniform(rng, 0.3, 30.0), base.drive
    assert drive is not None
    return replace(base, m=m, drive=Drive(lambda t, x, v: m * drive.law(t, x, v), rate=drive.rate))


def ball_screw(rng: np.random.Generator) -> Base:
    """A free axis that follows a multisine or, one in three, smooth strokes to and fro."""
    base = draw_axis(rng, unit_mass=False)
    return base if rng.random() > REPEATED else _strokes(base, rng, flat=float(rng.uniform(0.1, 0.6)))


def cylinder(rng: np.random.Generator) -> Base:
    """A free axis that is moved to and fro at nearly constant speed: most of its force is friction."""
    base = draw_axis(rng, unit_mass=False)
    size = log_uniform(rng, 0.01, 0.06)
    ratio = size / base.length
    slow = replace(base, length=size, x_k=base.x_k * ratio * 3.0, m=log_uniform(rng, 0.1, 3.0))
    return _strokes(slow, rng, flat=float(rng.uniform(0.7, 0.95)))


def _strokes(base: Base, rng: np.random.Generator, flat: float) -> Base:
    """A position loop along strokes that are straight for a share ``flat`` of their time and round at their ends."""
    omega = base.omega_n * log_uniform(rng, 0.15, 0.5)
    wave, slope = _rounded_triangle(flat)
    k_p, k_d = base.m * (4.0 * base.omega_n) ** 2, 2.0 * base.m * 4.0 * base.omega_n

    def law(t: float, x: float, v: float) -> float:
        phase = omega * t
        return k_p * (base.length * wave(phase) - x) + k_d * (base.length * omega * slope(phase) - v)

    duration = float(rng.uniform(3.0, 6.0)) * 2.0 * math.pi / omega
    per_second = base.samples / base.duration
    samples = int(min(max(per_second * duration, 800), MOST_SAMPLES))
    drive = Drive(law, rate=2.0 * base.omega_n)
    return replace(base, x0=base.length * wave(0.0), drive=drive, duration=duration, samples=samples)


def _rounded_triangle(flat: float) -> tuple[Callable[[float], float], Callable[[float], float]]:
    """A wave of period 2 pi between -1 and 1 and its slope: parabolas about its turns, straight lines between."""
    half = 0.5 * math.pi * (1.0 - flat)
    speed = 1.0 / (0.5 * math.pi - 0.5 * half)

    def place(phase: float) -> tuple[float, float]:
        # the distance from the nearest turn, the upper one at 0, the lower at pi
        s = (phase + math.pi) % (2.0 * math.pi) - math.pi
        up = abs(s) <= 0.5 * math.pi
        near = s if up else s - math.copysign(math.pi, s)
        return near, 1.0 if up else -1.0

    def wave(phase: float) -> float:
        s, sign = place(phase)
        drop = 0.5 * speed * s * s / half if abs(s) < half else speed * (abs(s) - 0.5 * half)
        return sign * (1.0 - drop)

    def slope(phase: float) -> float:
        s, sign = place(phase)
        return -sign * speed * min(max(s / half, -1.0), 1.0)

    return wave, slope


_DRIVEN_NAMES = (*FRICTION, "static-friction", *DAMPING, *AROUND, "constant-force")
SPRING_AXIS = Kind(
    *("spring-axis", "spring", ("x", "xa"), False, (6.0, 60.0), (0.01, 0.2), (0.0, 0.0), (0.0, 0.0), (0.0, 0.0)),
    *((40.0, 160.0), (1e-5, 1e-3), (STEADY,)),
    names=(*_DRIVEN_NAMES, *STIFFNESS, "pendulum-stiffness", *SENSORS, "sensor-drift"),
    drive=spring_axis,
)
BALL_SCREW = Kind(
    *("ball-screw", "none", ("x", "xa"), False, (3.0, 20.0), (0.03, 0.3), (0.0, 0.0), (0.0, 0.0), (0.0, 0.0)),
    *((100.0, 300.0), (1e-5, 3e-4), (STEADY,)),
    names=(*(name for name in _DRIVEN_NAMES if name != "load-dependent-friction"), "end-stop", *SENSORS),
    drive=ball_screw,
)
CYLINDER = Kind(
    *("cylinder", "none", ("x",), False, (3.0, 12.0), (0.01, 0.06), (0.0, 0.0), (0.0, 0.0), (0.0, 0.0)),
    *((60.0, 200.0), (3e-5, 1e-3), (STEADY, ROUNDED)),
    names=tuple(name for name in _DRIVEN_NAMES if name not in ("load-dependent-friction", "viscoelastic")),
    drive=cylinder,
)

DRIVEN = {kind.name: kind for kind in (SPRING_AXIS, BALL_SCREW, CYLINDER)}
