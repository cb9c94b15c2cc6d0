"""Laws with a clock of their own, and when it keeps time with the motion: such a law follows any other.

A resonator is a clock too, at its own frequency: shaken on the swing it answers with whatever phase is asked.
"""

import math
from collections.abc import Sequence

import numpy as np

from harness.diagnosis.fit.model_fit import Fit
from harness.diagnosis.problem import Problem
from harness.diagnosis.rules import BEAT, SAME_CLOCK
from harness.fit.autocorrelation import lagged
from harness.model.model import ModelTerm
from harness.model.term import Slot

_RESONATOR, _DAMPED = "omega_2", "zeta_2"
"""Of a mass that rides on the slider: its frequency, and its damping, half its band over that."""
_MULTIPLES = range(5)
"""Of the motion's frequency; the first is none, which a clock slower than the recording cannot be told from."""
_SOONEST, _LATEST = 0.5, 2.0
"""Times a motion's period between which it repeats itself, if it does."""
_NOTHING = 1e-300
"""(m/s)^2, of a motion that never moves."""


def beat(base: Fit, problem: Problem, omega: float) -> float:
    """Rate (rad/s) with which a clock keeps time: a free motion's own, that at which a driven one repeats itself, or 0.

    What moves as it is told to, now so and now so, no clock follows. omega : of the motion, rad/s, about.
    """
    if problem.drive is None or omega == 0.0:
        return omega
    t = np.linspace(problem.t[0], problem.t[-1], problem.t.size)
    v = np.interp(t, problem.t, base.shown.v)
    square = np.cumsum(v**2)
    # of what is behind a lag, and of what is before it
    both = square[::-1] + square[-1] - np.concatenate(([0.0], square[:-1]))
    alike = 2.0 * lagged(v, v.size) / np.maximum(both, _NOTHING)
    period = 2.0 * math.pi / omega / float(t[1] - t[0])
    near = slice(max(int(_SOONEST * period), 1), min(int(_LATEST * period), v.size // 2) + 1)
    if alike[near].size == 0:
        return omega
    most = near.start + int(np.argmax(alike[near]))
    return 2.0 * math.pi / float(t[most] - t[0]) if alike[most] > BEAT.value else 0.0


def on_the_swing(entry: ModelTerm, omega: float, span: float) -> bool:
    """Whether a law with a clock of its own keeps time with a motion or a multiple of it: then it follows anything.

    omega : of the motion, rad/s. span : of the recording, s.
    """
    rates = [m * omega for m in _MULTIPLES]
    return any(_one(rate, own, span) for own in _clocks((entry,)) for rate in rates) or _resonates(entry, omega, span)


def in_step(entry: ModelTerm, period: float, span: float) -> bool:
    """Whether a clock keeps time with a drive that repeats itself: a to-and-fro push keeps time and place together.

    period, span : of the drive and of the recording, s.
    """
    rate = 2.0 * math.pi / period
    return any(_one(own, max(round(own / rate), 1) * rate, span) for own in _clocks((entry,)))


def unresolved(entries: Sequence[ModelTerm], omega: float, span: float) -> bool:
    """Whether a force with a clock has the motion's own, one slower than the recording can show, or another's.

    A model that explains a recording by such a force follows what it does not say: in step with the motion it is a
    spring or a damper, two in step with each other are one that changes. At a multiple of the motion a force that
    explains all may be one, and friction whose load changes in step with it is no force in step. omega : of the
    motion, rad/s. span : of the recording, s.
    """
    clocks = _clocks([entry for entry in entries if entry.term.slot is Slot.SMOOTH])
    alike = any(_one(a, b, span) for i, a in enumerate(clocks) for b in clocks[:i])
    swung = any(_resonates(entry, omega, span) for entry in entries)
    return alike or swung or any(_one(own, rate, span) for own in clocks for rate in (0.0, omega))


def _resonates(entry: ModelTerm, omega: float, span: float) -> bool:
    """Whether a law is a resonator whose band reaches the swing, or that is slower than the recording shows.

    One that is damped as strongly as it swings is a delay, and reaches everywhere.
    """
    if _RESONATOR not in entry.term.names:
        return False
    own, width = entry.value(_RESONATOR), entry.value(_DAMPED) * entry.value(_RESONATOR)
    return any(_one(max(abs(own - rate) - width, 0.0), 0.0, span) for rate in (0.0, omega))


def _clocks(entries: Sequence[ModelTerm]) -> list[float]:
    """Rates, rad/s."""
    return [entry.value("Omega") for entry in entries if "Omega" in entry.term.names]


def _one(first: float, second: float, span: float) -> bool:
    """Whether a recording of ``span`` s cannot tell two rates (rad/s) apart."""
    return abs(first - second) < _apart(span)


def _apart(span: float) -> float:
    """Least difference, rad/s, of two rates that a recording of ``span`` s tells apart."""
    return SAME_CLOCK.value * 2.0 * math.pi / span
