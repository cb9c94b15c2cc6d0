"""One machine and how it was recorded: its slider, the hand that let it go, what was read at which times."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from scipy.signal import lfilter

from harness.core.arrays import FloatArray
from harness.core.errors import SimulationError
from harness.proof.machines.effects import ECCENTRIC, EFFECTS
from harness.proof.machines.kinds import IRREGULAR, JITTER, ROUNDED, Kind
from harness.proof.machines.stepped import step_through
from harness.proof.plant.base import Base
from harness.proof.plant.hidden import build
from harness.proof.plant.integrate import PlantRun, simulate
from harness.proof.plant.model import Force, PlantModel

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

    @property
    def gone(self) -> float:
        """When it is gone, s."""
        return self.until + self.fades

    def push(self, force: float) -> Force:
        """What it takes to hold the slider, fading."""

        def law(t: float, x: float, v: float, d: float) -> float:
            s = min(max((t - self.until) / self.fades, 0.0), 1.0)
            return -force * (1.0 - s * s * (3.0 - 2.0 * s))

        # the motion begins with it, so the solver's first steps are short enough
        return Force(law)


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
        """The size that a channel has."""
        b = self.base
        return {"x": b.length, "v": b.speed, "a": b.length * b.omega_n**2}[channel]

    @property
    def free_from(self) -> float:
        """When the hand is gone, s after the recording began."""
        return max(self.hand.gone - self.cut, 0.0)

    def arguments(self) -> list[str]:
        """What the user of the machine would say: how it is held, never what is hidden."""
        if self.base.restoring == "none":
            return ["--restoring", "none"]
        return ["--restoring", self.base.restoring, "--zero", "spring" if self.told_zero else "free"]

    def motion(self, effects: Effects, quick: bool = False) -> tuple[PlantRun, dict[str, FloatArray]]:
        """The true motion with these effects and what the sensors read of it before noise, without the zero.

        quick : at a fixed step, where that serves. Raises SimulationError when the motion has no end of events.
        """
        model, sensors = build(self.base, effects, EFFECTS)
        model = self._held(model)
        run, clean = sensors.read(model, self.t + self.cut, _stepped if quick else _simulated)
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

    def _held(self, model: PlantModel) -> PlantModel:
        if self.hand.until > 0.0:
            model = replace(model, release=self.hand.until)
        if self.hand.fades > 0.0:
            at = (self.hand.until, model.x0, 0.0, 0.0)
            holds = sum(force.law(*at) for force in model.forces)
            holds += model.k * (math.sin(model.x0) if model.restoring == "pendulum" else model.x0)
            model = replace(model, forces=(*model.forces, self.hand.push(holds)))
        return model

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


def draw_clock(
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
