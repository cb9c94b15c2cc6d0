"""The catalogue as regressors: every law that is a function of position, speed and time, with numbers inside guessed.

Regression sees a recording through its derivatives: position, smoothed, is differentiated. What smoothing does to a
jump of the acceleration it must do to the laws too, or every fit finds a law that is Coulomb friction smeared.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from scipy.signal import savgol_filter

from harness.core.arrays import FloatArray

Recording = Mapping[str, FloatArray]
"""t (s) and x (m), a (m/s^2), u (N) as far as recorded, shape (n,) each."""

WINDOW = 1.0 / 10.0
"""Length of the smoothing window, periods."""

BASE = ("spring", "viscous", "coulomb")


@dataclass(frozen=True, slots=True)
class Named:
    """What a baseline names; ``applies`` is false, with the reason, where it has nothing to work on."""

    names: tuple[str, ...]
    applies: bool = True
    why: str = ""


@dataclass(frozen=True, slots=True)
class States:
    """t, x, v, a, shape (n,) each, v and a by differentiation; period of the motion, s; samples of the window."""

    t: FloatArray
    x: FloatArray
    v: FloatArray
    a: FloatArray
    period: float
    width: int

    def smoothed(self, law: FloatArray) -> FloatArray:
        """A law (n,) or (n, k) as a smoothed acceleration would show it."""
        return np.asarray(savgol_filter(law, self.width, _order(self.width), axis=0))


def _order(width: int) -> int:
    return 3 if width > 5 else 2


def refusal(recording: Recording) -> str:
    """Why regression has nothing to work on here; empty when it has."""
    if "u" in recording:
        return "a driven recording"
    return "" if "x" in recording else "no position was recorded"


def period_of(t: FloatArray, x: FloatArray) -> float:
    """Period of a decay, s, from the crossings of its first half; nan with fewer than two of them."""
    early = x[: max(3, x.size // 2)]
    crossed = np.flatnonzero(np.diff(np.signbit(early)))
    if crossed.size < 2:
        return math.nan
    # noise makes several crossings of one: those closer than half the longest gap are the same
    gaps = np.diff(t[crossed])
    apart = gaps[gaps > 0.5 * gaps.max()]
    return 2.0 * float(np.median(apart))


def states_of(recording: Recording) -> States | None:
    """Smoothed position and its derivatives, the ends left out; None where there is no oscillation."""
    t, x = recording["t"], recording["x"]
    dt, period = float(t[1] - t[0]), period_of(t, x)
    if not math.isfinite(period):
        return None
    width = max(5, 2 * int(0.5 * WINDOW * period / dt) + 1)
    if width >= t.size:
        return None
    smooth = [np.asarray(savgol_filter(x, width, _order(width), deriv=n, delta=dt)) for n in range(3)]
    inner = slice(width // 2, -(width // 2))
    return States(t[inner], smooth[0][inner], smooth[1][inner], smooth[2][inner], period, width)


def regressors(s: States) -> dict[str, FloatArray]:
    """Name of a law -> what multiplies its strength, shape (n,) or (n, 2) for amplitude and phase; the base first."""
    length, speed = float(np.max(np.abs(s.x))), float(np.max(np.abs(s.v)))
    d, along = np.sign(s.v), 2.0 * math.pi * s.x / (0.5 * length)
    base = {"spring": s.x, "viscous": s.v, "coulomb": d}
    fitted = np.column_stack(list(base.values()))
    left = s.a - fitted @ np.linalg.lstsq(fitted, s.a, rcond=None)[0]
    omega = _loudest(s, left)
    return base | {
        "constant-force": np.ones(s.t.size),
        "quadratic-stiffness": s.x**2,
        "cubic-stiffness": s.x**3,
        "stiffness-drift": s.t * s.x,
        "end-stop": np.sign(s.x) * np.maximum(np.abs(s.x) - 0.75 * length, 0.0),
        "backlash": np.clip(s.x, -0.02 * length, 0.02 * length),
        "quadratic-drag": np.abs(s.v) * s.v,
        "asymmetric-viscous": np.abs(s.v),
        "power-law-damping": np.sqrt(np.abs(s.v)) * d,
        "stribeck": np.exp(-((s.v / (0.12 * speed)) ** 2)) * d,
        "position-dependent-friction": s.x * d,
        "friction-drift": s.t * d,
        "force-ripple": np.column_stack([np.cos(along), np.sin(along)]),
        "harmonic-force": np.column_stack([np.cos(omega * s.t), np.sin(omega * s.t)]),
    }


def _loudest(s: States, left: FloatArray) -> float:
    """Frequency (rad/s) of the largest line in what the base leaves of the acceleration, away from the slider's own."""
    frequency = 2.0 * math.pi * np.fft.rfftfreq(left.size, float(s.t[1] - s.t[0]))
    power = np.abs(np.fft.rfft(left * np.hanning(left.size))) ** 2
    own = 2.0 * math.pi / s.period
    power[(frequency < 0.2 * own) | (np.abs(frequency - own) < 0.3 * own) | (frequency > 6.0 * own)] = 0.0
    return float(frequency[int(np.argmax(power))])
