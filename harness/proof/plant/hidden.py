"""From the names and the parameters of effects to a plant and its sensors, and where in a recording they act."""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from scipy.signal import lfilter

from harness.core.arrays import BoolArray, FloatArray
from harness.proof.plant.base import Base
from harness.proof.plant.effects import EFFECTS, Values
from harness.proof.plant.integrate import PlantRun, simulate
from harness.proof.plant.model import Level, PlantModel, coulomb

Motion = Callable[[PlantModel, FloatArray], PlantRun]
"""What makes the motion of a plant at given times: SciPy's solvers, or an engine."""


@dataclass(frozen=True, slots=True)
class Sensors:
    """x: late by ``lag`` (s), gains ``drift`` t (m/s).

    a: scaled by ``gain``, plus ``bias`` (m/s^2), held within +-``limit`` (m/s^2).
    """

    lag: float = 0.0
    drift: float = 0.0
    gain: float = 1.0
    bias: float = 0.0
    limit: float = math.inf

    def read(
        self, model: PlantModel, t: FloatArray, motion: Motion = simulate
    ) -> tuple[PlantRun, dict[str, FloatArray]]:
        """The true motion at t and the noise-free channels x, v, a, u. Before the lag has passed a late x shows x_0."""
        if self.lag > 0.0:
            late = np.maximum(t - self.lag, t[0])
            grid, where = np.unique(np.concatenate([t, late]), return_inverse=True)
            both = motion(model, grid)
            run, x = both.at(where[: t.size]), both.x[where[t.size :]]
        else:
            run = motion(model, t)
            x = run.x
        a = np.clip(self.gain * run.a + self.bias, -self.limit, self.limit)
        return run, {"x": x + self.drift * t, "v": run.v, "a": a, "u": run.u}

    def saturated(self, run: PlantRun) -> BoolArray:
        """Where a stands at its limit, shape (n,)."""
        return np.asarray(np.abs(self.gain * run.a + self.bias) >= self.limit)


@dataclass(frozen=True, slots=True)
class Noise:
    """Sensor noise. sigma : standard deviation of a channel. correlation : of neighbouring samples (first order).

    step : resolution of a channel; the value is rounded to it after the noise was added.
    """

    sigma: dict[str, float]
    correlation: float = 0.0
    step: dict[str, float] | None = None

    def spoil(self, channel: str, clean: FloatArray, rng: np.random.Generator) -> FloatArray:
        white = rng.standard_normal(clean.size)
        r = self.correlation
        if r != 0.0:
            shaped = white * math.sqrt(1.0 - r * r)
            shaped[0] = white[0]
            white = lfilter([1.0], [1.0, -r], shaped)
        noisy = clean + self.sigma[channel] * white
        if self.step and channel in self.step:
            noisy = np.round(noisy / self.step[channel]) * self.step[channel]
        return np.asarray(noisy)

    def total(self, channel: str) -> float:
        """Standard deviation of all the error in a channel, rounding included."""
        step = (self.step or {}).get(channel, 0.0)
        return math.hypot(self.sigma[channel], step / math.sqrt(12.0))


def build(base: Base, effects: Mapping[str, Values]) -> tuple[PlantModel, Sensors]:
    """The plant and its sensors with these effects, each a name with its parameters (SI)."""
    parts = [EFFECTS[name].build(values, base) for name, values in effects.items()]
    level: dict[str, Any] = {"f_s": base.f_k}
    sensors: dict[str, float] = {}
    for part in parts:
        level |= part.level
        sensors |= part.sensors
    of: dict[str, Any] = {
        kind: tuple(one for part in parts for one in getattr(part, kind))
        for kind in ("forces", "branches", "knocks", "kinks", "modulations")
    }
    changed = Level(base.f_k, **level, modulations=of.pop("modulations"))
    law = next((part.law for part in parts if part.law is not None), coulomb)
    return replace(base.model(), friction=law(changed), **of), Sensors(**sensors)


def regions(effects: Mapping[str, Values], base: Base, x: Any, saturated: Any) -> list[list[float]] | None:
    """Time spans in which effects bound to a place act, or None when no effect is: end-stop, saturation, knock."""
    t, inside, bound = base.times, np.zeros(base.samples, dtype=bool), False
    for name, p in effects.items():
        if name == "end-stop":
            bound = True
            inside |= (x > p["gap"]) & (p["side"] != "lower") | (x < -p["gap"]) & (p["side"] != "upper")
        elif name == "sensor-clipping":
            bound = True
            inside |= saturated
        elif name == "impulse":
            bound = True
            inside |= np.abs(t - p["time"]) <= 0.5 * math.pi / base.omega_n
    if not bound:
        return None
    edges = np.flatnonzero(np.diff(np.concatenate([[0], inside.astype(np.int8), [0]])))
    ends = np.append(t, 2.0 * t[-1] - t[-2])
    return [[float(t[i]), float(ends[j])] for i, j in zip(edges[::2], edges[1::2], strict=True)]
