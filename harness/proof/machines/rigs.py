"""One machine and how it was recorded, at random: its slider, the hand that let it go, what was read at which times."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from scipy.signal import lfilter

from harness.core.arrays import FloatArray
from harness.core.errors import SimulationError
from harness.proof.machines.kinds import IRREGULAR, JITTER, ROUNDED, Kind
from harness.proof.plant.base import MOST_SAMPLES, Base, log_uniform
from harness.proof.plant.base_fit import FINENESS, SETTLED, BaseFit, fit_force, fit_motion
from harness.proof.plant.effects import DRY, ECCENTRIC, FROM_ZERO
from harness.proof.plant.hidden import build
from harness.proof.plant.integrate import PlantRun, simulate
from harness.proof.plant.model import Force, PlantModel
from harness.proof.plant.stepped import step_through

TOLERANCE = 1e-8
PIECES = 400
"""Most smooth pieces of a motion; one that chatters has no end of them."""
Effects = Mapping[str, Mapping[str, Any]]


@dataclass(frozen=True, slots=True)
class Hand:
    """A hand that holds the slider until ``until`` (s). fades : time over which it gives way after that, s.

    shift : distance from which it moves the slider to x0 meanwhile, m.
    """

    until: float = 0.0
    fades: float = 0.0
    shift: float = 0.0

    def holds(self, model: PlantModel) -> PlantModel:
        if self.until > 0.0:
            model = replace(model, release=self.until)
        if self.fades <= 0.0:
            return model
        at = (self.until, model.x0, 0.0, 0.0)
        held = sum(force.law(*at) for force in model.forces)
        held += model.k * (math.sin(model.x0) if model.restoring == "pendulum" else model.x0)

        def push(t: float, x: float, v: float, d: float) -> float:
            s = min(max((t - self.until) / self.fades, 0.0), 1.0)
            return -held * (1.0 - s * s * (3.0 - 2.0 * s))

        # the motion begins with it, so the solver's first steps are short enough
        return replace(model, forces=(*model.forces, Force(push)))


@dataclass(frozen=True, slots=True)
class Rig:
    """A machine as it is recorded.

    base : the slider; its clock starts when a hand first holds it. cut : when the recording begins on that clock, s.
    t : when samples were taken, s after that, shape (n,). stamps : when the file says so, shape (n,).
    clock, release : how the times and the hand are, in a word. zero : what x reads in the middle.
    told_zero : whether the user says that x is measured from the spring.
    delay : of the channel in the key, a first-order low-pass, s. gain : of a channel.
    """

    kind: Kind
    base: Base
    channels: str
    t: FloatArray
    stamps: FloatArray
    clock: str
    hand: Hand = field(default_factory=Hand)
    release: str = "driven"
    cut: float = 0.0
    zero: float = 0.0
    told_zero: bool = False
    delay: Mapping[str, float] = field(default_factory=dict)
    gain: Mapping[str, float] = field(default_factory=dict)

    def scale(self, channel: str) -> float:
        b = self.base
        return {"x": b.length, "v": b.speed, "a": b.length * b.omega_n**2}[channel]

    @property
    def free_from(self) -> float:
        """When the hand is gone, s after the recording began."""
        return max(self.hand.until + self.hand.fades - self.cut, 0.0)

    def arguments(self) -> list[str]:
        """What the user of the machine would say: how it is held, never what is hidden."""
        if self.base.restoring == "none":
            return ["--restoring", "none"]
        return ["--restoring", self.base.restoring, "--zero", "spring" if self.told_zero else "free"]

    def motion(self, effects: Effects, quick: bool = False) -> tuple[PlantRun, dict[str, FloatArray]]:
        """The true motion with these effects and what the sensors read of it before noise, without the zero.

        quick : at a fixed step, where that serves. Raises SimulationError when the motion has no end of events.
        """
        model, sensors = build(self.base, effects)
        run, clean = sensors.read(self.hand.holds(model), self.t + self.cut, _stepped if quick else _simulated)
        before = run.t < self.hand.until
        if self.hand.shift != 0.0 and before.any():
            s = 1.0 - run.t[before] / self.hand.until
            clean["x"][before] += self.hand.shift * s**2
            clean["v"][before] -= 2.0 * self.hand.shift * s / self.hand.until
        if ECCENTRIC in effects:
            p = effects[ECCENTRIC]
            clean["x"] = clean["x"] + p["size"] * np.sin(2.0 * math.pi * clean["x"] / p["period"] + p["phase"])
        read = {c: self._read(c, clean[c]) for c in clean}
        if not all(np.all(np.isfinite(y)) for y in read.values()):
            raise SimulationError("machines: a motion without end")
        return run, read

    def _read(self, channel: str, y: FloatArray) -> FloatArray:
        y = self.gain.get(channel, 1.0) * y
        delay = self.delay.get(channel, 0.0)
        if delay == 0.0:
            return y
        # y' = (x - y)/delay with x straight between samples, stepped by the trapezoidal rule
        h = 0.5 * float(self.t[-1] - self.t[0]) / (self.t.size - 1) / delay
        b = [h / (1.0 + h), h / (1.0 + h)]
        a = [1.0, (h - 1.0) / (1.0 + h)]
        return np.asarray(lfilter(b, a, y, zi=[y[0] * (b[1] - a[1])])[0])

    def base_fit(
        self,
        run: PlantRun,
        clean: Mapping[str, FloatArray],
        weight: Mapping[str, float] | None = None,
        quick: bool = False,
    ) -> BaseFit:
        """The base fit of a noise-free recording: of the free part of a decay, of a measured force.

        weight : of the channels of a decay; by their size when left out. quick : from one start, where that does well.
        """
        if self.kind.driven:
            x = clean["x"]
            springs = [] if self.kind.restoring == "none" else [x] if self.told_zero else [x, np.ones_like(x)]
            return fit_force(run, clean, springs, "a" if "a" in self.channels else "")
        after = self.t >= self.free_from + SETTLED * 2.0 * math.pi / self.base.omega_n
        unit = {c: FINENESS * self.scale(c) for c in self.channels}
        if weight is not None:
            least = min(1.0 / (math.sqrt(weight[c]) * self.scale(c)) for c in self.channels)
            unit = {c: FINENESS / (math.sqrt(weight[c]) * least) for c in self.channels}
        seen = {c: clean[c][after] for c in {*"xv", *self.channels}}
        free_zero = not self.told_zero and "x" in self.channels
        return fit_motion(self.base, self.t[after], seen, unit, free_zero, quick)


def _stepped(model: PlantModel, t: FloatArray) -> PlantRun:
    if model.friction.states:
        return _simulated(model, t)
    try:
        return step_through(model, t)
    # beyond all numbers, or the sine of what is
    except (OverflowError, ValueError) as error:
        raise SimulationError(f"machines: {error}") from None


def _simulated(model: PlantModel, t: FloatArray) -> PlantRun:
    """Bristles are stiff where they are short: they have a solver that knows of it."""
    solver = "LSODA" if model.friction.states else "DOP853"
    try:
        with np.errstate(invalid="raise"):
            return simulate(model, t, tolerance=TOLERANCE, pieces=PIECES, solver=solver)
    except (FloatingPointError, OverflowError, ValueError) as error:
        raise SimulationError(f"machines: {error}") from None


CLEAN, MID, HOLD, GIVES_WAY, MOVES = "clean", "mid", "hold", "gives-way", "moves"
RELEASES = {CLEAN: 0.2, MID: 0.25, HOLD: 0.2, GIVES_WAY: 0.25, MOVES: 0.1}
"""How a free decay begins, with its share: at rest, in mid-swing, held, a hand that gives way, one that moves."""


def draw_rig(kind: Kind, main: str, rng: np.random.Generator) -> Rig:
    """A machine on which the effect ``main`` can show ("" for a control)."""
    if kind.drive is None:
        return _free(kind, main, rng)
    base = kind.drive(rng)
    if main in DRY and base.x_k < 0.06 * base.length:
        base = replace(base, x_k=0.06 * base.length)
    clock = _clock(kind, base.omega_n, base.duration, base.samples, rng)
    told = kind.restoring == "spring" and _told_zero(main, rng)
    zero = 0.0 if told or kind.restoring == "none" else base.length * float(rng.normal(0.0, 0.3))
    return Rig(kind, base, str(rng.choice(kind.shows(main))), *clock, zero=zero, told_zero=told)


def _free(kind: Kind, main: str, rng: np.random.Generator) -> Rig:
    cycles, left = log_uniform(rng, *kind.cycles), log_uniform(rng, *kind.left)
    dry = float(rng.uniform(0.35, 0.85)) if main in DRY else log_uniform(rng, *kind.dry)
    omega_n, length = log_uniform(rng, *kind.omega_n), log_uniform(rng, *kind.length)
    period = 2.0 * math.pi / omega_n
    # a decay to ``left`` of the start, of which dry friction makes about the share ``dry``
    zeta = (1.0 - dry) * math.log(1.0 / left) / (2.0 * math.pi * cycles)
    x_k = 0.7 * dry * (1.0 - left) / (4.0 * cycles)
    release, cut, hand = _release(period, rng)
    duration = cycles * period + max(hand.until - cut, 0.0)
    samples = int(min(duration / period * log_uniform(rng, *kind.per_cycle), MOST_SAMPLES))
    clock = _clock(kind, omega_n, duration, samples, rng)
    x0 = length * float(rng.choice([-1.0, 1.0]))
    base = Base(1.0, omega_n, zeta, x_k * length, x0, 0.0, length, cut + duration, samples, kind.restoring)
    channels = str(rng.choice(kind.shows(main)))
    told = kind.restoring == "spring" and "x" in channels and _told_zero(main, rng)
    return _read_by(Rig(kind, base, channels, *clock, hand, release, cut, told_zero=told), main, rng)


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
    if style == GIVES_WAY:
        return style, 0.0, Hand(until, fades=min(float(rng.uniform(0.01, 0.05)), 0.3 * period))
    return style, 0.0, Hand(until, shift=1.0 if style == MOVES else 0.0)


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


def _clock(
    kind: Kind, omega_n: float, duration: float, samples: int, rng: np.random.Generator
) -> tuple[FloatArray, FloatArray, str]:
    """Times of the samples, times in the file (s, shape (samples,)), and how the two differ."""
    even = np.linspace(0.0, duration, samples)
    step = duration / (samples - 1)
    style = str(rng.choice(list(kind.stamps)))
    if style == IRREGULAR:
        t = even + step * np.clip(rng.normal(0.0, 0.12, samples), -0.4, 0.4)
        t -= t[0]
        return t, t, style
    if style == JITTER:
        late = min(float(rng.uniform(0.002, 0.05)) * step, float(rng.uniform(1e-4, 2e-3)) / omega_n)
        t = even + np.clip(rng.normal(0.0, late, samples), -0.3 * step, 0.3 * step)
        return t - t[0], even, style
    if style == ROUNDED:
        digits = math.ceil(-math.log10(0.04 * step))
        return even, np.round(even, digits), style
    return even, even, style
