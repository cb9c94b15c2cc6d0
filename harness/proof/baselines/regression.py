"""Naming by regression of the force balance: by R^2, and sparse (pysindy), over every law of position, speed and time.

Numbers inside the laws are guessed. Regression sees a recording through its derivatives: position, smoothed, is
differentiated. What smoothing does to a jump of the acceleration it must do to the laws too, or every fit finds a law
that is Coulomb friction smeared.
"""

import math
import warnings
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.signal import savgol_filter

from harness.core.arrays import FloatArray
from harness.core.errors import SimulationError

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
    """Why there is nothing to work on here; empty when there is."""
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


def states_of(recording: Recording) -> States | str:
    """Smoothed position and its derivatives, the ends left out; or why there is nothing to work on."""
    why = refusal(recording)
    if why:
        return why
    t, x = recording["t"], recording["x"]
    dt, period = float(t[1] - t[0]), period_of(t, x)
    width = max(5, 2 * int(0.5 * WINDOW * period / dt) + 1) if math.isfinite(period) else t.size
    if width >= t.size:
        return "no oscillation"
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


LEAST_GAIN = 0.01
"""Share of what the base leaves unexplained that a law must explain to be named."""


def name_by_r2(recording: Recording) -> Named:
    """The one law that explains most of the acceleration beside spring, viscous and Coulomb friction, or nothing."""
    states = states_of(recording)
    if isinstance(states, str):
        return Named((), False, states)
    laws = {name: states.smoothed(law) for name, law in regressors(states).items()}
    base = [laws[name] for name in BASE]
    before = _r_squared(base, states.a)
    after = {name: _r_squared([*base, law], states.a) for name, law in laws.items() if name not in BASE}
    best = max(after, key=lambda name: after[name])
    enough = after[best] - before > LEAST_GAIN * (1.0 - before)
    return Named((best,) if enough else ())


def _r_squared(columns: list[FloatArray], a: FloatArray) -> float:
    matrix = np.column_stack(columns)
    matrix = matrix / np.linalg.norm(matrix, axis=0)
    left = a - matrix @ np.linalg.lstsq(matrix, a, rcond=None)[0]
    return 1.0 - float(np.sum(left**2) / np.sum((a - a.mean()) ** 2))


THRESHOLDS = tuple(float(x) for x in np.geomspace(0.002, 0.2, 15))
"""Smallest coefficients that may stay, of laws and acceleration scaled to a standard deviation of 1; BIC chooses."""
RIDGE = 1e-5


def name_by_sindy(recording: Recording, thresholds: Sequence[float] = THRESHOLDS) -> Named:
    """Names of the laws besides spring, viscous and Coulomb friction whose coefficients survive.

    Speed is the smoothed derivative of position; pysindy differentiates it once more by its smoothed finite
    difference. Of the thresholds the one with the lowest BIC of the regression is taken, one independent sample in each
    smoothing window. Raises SimulationError when pysindy is not installed.
    """
    try:
        import pysindy
    except ImportError:
        raise SimulationError("pysindy is not installed: pip install pysindy") from None
    s = states_of(recording)
    if isinstance(s, str):
        return Named((), False, s)
    names, columns = [], []
    for name, law in regressors(s).items():
        if name == "viscous":
            continue  # the state itself
        # speed is smoothed once, and once more where pysindy differentiates it
        for column in s.smoothed(s.smoothed(law)).reshape(s.t.size, -1).T:
            spread = float(np.std(column))
            names.append(name)
            # a constant is its own unit
            columns.append(column / spread if spread > 1e-9 * float(np.max(np.abs(column))) else np.ones(s.t.size))
    # time in units in which speed and acceleration are alike
    scale = float(np.std(s.a) / np.std(s.v))
    speed, laws, t = s.v[:, None] / float(np.std(s.v)), np.column_stack(columns), s.t * scale
    derivative = pysindy.SmoothedFiniteDifference(
        smoother_kws={"window_length": s.width, "polyorder": 3, "mode": "interp"}
    )
    independent = max(s.t.size / s.width, 10.0)
    best: tuple[float, FloatArray] | None = None
    for threshold in thresholds:
        model = pysindy.SINDy(
            optimizer=pysindy.STLSQ(threshold=threshold, alpha=RIDGE),
            feature_library=pysindy.IdentityLibrary(),
            differentiation_method=derivative,
        )
        with warnings.catch_warnings():
            # of coefficients all below the threshold, which is an answer
            warnings.simplefilter("ignore")
            model.fit(speed, t=t, u=laws)
        coefficients = np.asarray(model.coefficients(), dtype=np.float64)[0]
        left = derivative(speed, t=t)[:, 0] - np.column_stack([speed, laws]) @ coefficients
        bic = independent * math.log(float(np.mean(left**2))) + np.count_nonzero(coefficients) * math.log(independent)
        if best is None or bic < best[0]:
            best = (bic, coefficients)
    assert best is not None
    found = {name for name, c in zip(names, best[1][1:], strict=True) if c != 0.0}
    return Named(tuple(name for name in dict.fromkeys(names) if name in found and name not in BASE))
