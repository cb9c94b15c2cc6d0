"""A machine of a kind, at random: how it swings, how it was let go, with which sensors it was read."""

import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np

from harness.proof.machines.effects import DRY, FROM_ZERO, NEEDS
from harness.proof.machines.kinds import Kind, Range
from harness.proof.machines.rigs import Hand, Rig, draw_clock
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


DRIVES: dict[str, Callable[[np.random.Generator], Base]] = {
    "spring-axis": spring_axis,
    "ball-screw": ball_screw,
    "cylinder": cylinder,
}


CLEAN, MID, HOLD, GIVES_WAY, MOVES = "clean", "mid", "hold", "gives-way", "moves"
RELEASES = {CLEAN: 0.2, MID: 0.25, HOLD: 0.2, GIVES_WAY: 0.25, MOVES: 0.1}
"""How a free decay begins, with its share: at rest, in mid-swing, held, a hand that gives way, one that moves."""


def draw_rig(kind: Kind, main: str, rng: np.random.Generator) -> Rig:
    """A machine on which the effect ``main`` can show ("" for a control)."""
    return _driven(kind, main, rng) if kind.driven else _free(kind, main, rng)


def _of(rng: np.random.Generator, span: Range) -> float:
    return log_uniform(rng, *span)


def _channels(kind: Kind, main: str, rng: np.random.Generator) -> str:
    fitting = [c for c in kind.channels if set(NEEDS.get(main, "")) <= set(c)]
    return str(rng.choice(fitting))


def _free(kind: Kind, main: str, rng: np.random.Generator) -> Rig:
    cycles, left = _of(rng, kind.cycles), _of(rng, kind.left)
    dry = float(rng.uniform(0.35, 0.85)) if main in DRY else _of(rng, kind.dry)
    omega_n, length = _of(rng, kind.omega_n), _of(rng, kind.length)
    period = 2.0 * math.pi / omega_n
    # a decay to ``left`` of the start, of which dry friction makes about the share ``dry``
    zeta = (1.0 - dry) * math.log(1.0 / left) / (2.0 * math.pi * cycles)
    x_k = 0.7 * dry * (1.0 - left) / (4.0 * cycles)
    release, cut, hand = _release(period, rng)
    duration = cycles * period + max(hand.until - cut, 0.0)
    samples = int(min(duration / period * _of(rng, kind.per_cycle), MOST_SAMPLES))
    t, stamps, style = draw_clock(kind, omega_n, duration, samples, rng)
    base = Base(
        m=1.0,
        omega_n=omega_n,
        zeta=zeta,
        x_k=x_k * length,
        x0=length * float(rng.choice([-1.0, 1.0])),
        v0=0.0,
        length=length,
        duration=cut + duration,
        samples=samples,
        restoring=kind.restoring,
    )
    channels = _channels(kind, main, rng)
    told = kind.restoring == "spring" and "x" in channels and _told_zero(main, rng)
    rig = Rig(kind, base, channels, t, stamps, style, hand, release, cut, told_zero=told)
    return _read_by(rig, main, rng)


def _told_zero(main: str, rng: np.random.Generator) -> bool:
    return main == "constant-force" or rng.random() < (0.6 if main in FROM_ZERO else 0.12)


def _release(period: float, rng: np.random.Generator) -> tuple[str, float, Hand]:
    """How it is let go, when the recording begins on the slider's clock, and the hand."""
    style = str(rng.choice(list(RELEASES), p=list(RELEASES.values())))
    if style == CLEAN:
        return style, 0.0, Hand()
    if style == MID:
        return style, float(rng.uniform(0.1, 1.2)) * period, Hand()
    until = float(rng.uniform(0.1, 0.5)) * min(period, 2.0)
    if style == HOLD:
        return style, 0.0, Hand(until)
    if style == GIVES_WAY:
        return style, 0.0, Hand(until, fades=min(float(rng.uniform(0.01, 0.05)), 0.3 * period))
    return style, 0.0, Hand(until, shift=1.0)


def _read_by(rig: Rig, main: str, rng: np.random.Generator) -> Rig:
    """Zero, low-pass, and an accelerometer that is less honest than the encoder beside it."""
    length = rig.base.length
    zero = 0.0 if rig.told_zero else length * float(rng.normal(0.0, 0.5 if rng.random() < 0.7 else 0.03))
    hand = replace(rig.hand, shift=rig.hand.shift * length * float(rng.uniform(-0.12, 0.12)))
    delay: dict[str, float] = {}
    gain: dict[str, float] = {}
    # what the sensors do is left alone where one of them is what is looked for
    if not main.startswith("sensor-"):
        # a low-pass acts before the samples are taken, evenly or not: here it is stepped along them
        if rng.random() < 0.25 and np.ptp(np.diff(rig.t)) < 1e-6 * rig.t[-1]:
            slow = 1.0 / (rig.base.omega_n * log_uniform(rng, 15.0, 80.0))
            delay = dict.fromkeys(rig.channels, slow)
        if rig.channels == "xa" and rng.random() < 0.4:
            gain["a"] = 1.0 + float(rng.normal(0.0, 0.004))
    return replace(rig, zero=zero, hand=hand, delay=delay, gain=gain)


def _driven(kind: Kind, main: str, rng: np.random.Generator) -> Rig:
    base = DRIVES[kind.name](rng)
    if main in DRY and base.x_k < 0.06 * base.length:
        base = replace(base, x_k=0.06 * base.length)
    t, stamps, style = draw_clock(kind, base.omega_n, base.duration, base.samples, rng)
    told = kind.restoring == "spring" and _told_zero(main, rng)
    zero = 0.0 if told or kind.restoring == "none" else base.length * float(rng.normal(0.0, 0.3))
    return Rig(kind, base, _channels(kind, main, rng), t, stamps, style, zero=zero, told_zero=told)
