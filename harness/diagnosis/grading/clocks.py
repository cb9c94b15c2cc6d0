"""Laws with a clock of their own, and when it keeps time with the motion: such a law follows any other.

A resonator is a clock too, at its own frequency: shaken on the swing it answers with whatever phase is asked. And a
recording's clock may drift in rate, which one channel does not tell from a spring whose stiffness does.
"""

import math
from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import replace

import numpy as np

from harness.core.arrays import FloatArray
from harness.core.errors import SimulationError
from harness.diagnosis.fit.model_fit import Fit, fit
from harness.diagnosis.parameters import free_of
from harness.diagnosis.problem import P, Problem
from harness.diagnosis.problems.free_decay import FreeDecay
from harness.diagnosis.problems.simulated import observe
from harness.diagnosis.residual_tests.structure import Left, left_by
from harness.diagnosis.rules import BEAT, CLOCK_DRIFT, SAME_CLOCK
from harness.diagnosis.search.extend import settle
from harness.diagnosis.search.search import Search, noise_of, under
from harness.fit.series import lagged
from harness.kernels.solve import Scales
from harness.model.model import ModelTerm
from harness.model.term import Slot
from harness.model.terms import clock_drift, stiffness_drift

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


_WITHIN = (0.5, 0.05, 0.005)
"""Of a rate, how far from it others are tried, turn by turn, beginning at the one that stands for the stiffness's."""
_APART = (0.1, 0.02)
"""Of half of it and of its square: how far pairs of rate and bend are tried, turn by turn."""
_SHARE = 1e-3
"""Of a rate, over which a slope by it is taken."""


def with_clock(found: Search, scales: Scales) -> Search:
    """The search with a drifting clock among the rivals of a lone drift of stiffness that clocks are known to have.

    As many numbers follow the same recording: the base under another time. Where its acceleration is measured beside
    its position, the clock leaves more, and is no rival.
    """
    problem, terms = found.problem, found.chosen.model.terms
    if (
        not found.explained
        or [e.term.name for e in terms] != [stiffness_drift.TERM.name]
        or not isinstance(problem, FreeDecay)
    ):
        return found
    # a frequency goes with the root of a stiffness
    slope = 0.5 * terms[0].values[0]
    if abs(slope) * problem.duration > CLOCK_DRIFT.value:
        return found
    with suppress(SimulationError):
        rival = _as_law(found.base, problem, _rate(found.base, problem, slope, scales), scales)
        rivals = sorted((*found.rivals, rival), key=lambda one: one.bic)
        return replace(found, rivals=tuple(rivals))
    return found


def off_the_clock(found: Search, scales: Scales) -> tuple[Search, str] | None:
    """The search on a clock that drifts as clocks do, and a sentence on it, where viscous and Coulomb friction then
    meet the noise and no law did by the recording's own; None else.

    Where two channels are measured, a stiffness that drifts leaves what such a clock explains.
    """
    problem = found.problem
    if found.explained or not isinstance(problem, FreeDecay) or not found.singles:
        return None
    nearest = found.singles[0]
    if [e.term.name for e in nearest.model.terms] != [stiffness_drift.TERM.name]:
        return None
    slope = 0.5 * nearest.model.terms[0].values[0]
    if abs(slope) * problem.duration > CLOCK_DRIFT.value:
        return None
    with suppress(SimulationError):
        slope, bend = _bend(found.base, problem, _rate(found.base, problem, slope, scales), scales)
        timed = _timed(found.base, problem, slope, bend)
        here = fit(found.base.model, timed, found.base.free, scales)
        timed = replace(timed, noise=noise_of(here, timed, scales.omega), clock=(problem.t, timed.t - problem.t))
        here = settle(under(here, timed), timed, scales)
        if left_by(here, timed, scales.omega, here) is Left.NOISE:
            percent = 100.0 * slope * problem.duration
            note = f"the recording's clock drifts: its rate changes by {percent:.2g} % from begin to end, allowed for"
            return Search(timed, here, here, (), (), Left.NOISE), note
    return None


def _rate(base: Fit, problem: Problem, slope: float, scales: Scales) -> float:
    """The rate (1/s) near ``slope`` by which the clock drifts that leaves least."""
    for within in _WITHIN:
        slope = _least(lambda rate: _under_clock(base, problem, rate, scales).chi2, slope, within * abs(slope))
    return slope


def _bend(base: Fit, problem: Problem, slope: float, scales: Scales) -> tuple[float, float]:
    """The same with the rate's own change beside (1/s^2): in which time the rate changes evenly, nobody knows."""

    def chi2(at: FloatArray) -> float:
        return fit(base.model, _timed(base, problem, float(at[0]), float(at[1])), base.free, scales).chi2

    best = np.array([slope, 0.0])
    for within in _APART:
        one, other = np.diag([0.5 * abs(slope), slope**2]) * within
        here, up, down, right, left = map(chi2, (best, best + one, best - one, best + other, best - other))
        cross = chi2(best + one + other) - up - right + here
        curved = np.array([[up - 2.0 * here + down, cross], [cross, right - 2.0 * here + left]])
        if np.linalg.det(curved) <= 0.0 or curved[0, 0] <= 0.0:
            break
        step = -np.linalg.solve(curved, 0.5 * np.array([up - down, right - left]))
        best = best + step[0] * one + step[1] * other
    return float(best[0]), float(best[1])


def _least(chi2: Callable[[float], float], middle: float, apart: float) -> float:
    """Where a parabola through three numbers beside each other is least; the best of them where it has no bottom."""
    tried = [(at, chi2(at)) for at in (middle - apart, middle, middle + apart)]
    low, here, high = (value for _, value in tried)
    curved = low - 2.0 * here + high
    return middle + 0.5 * apart * (low - high) / curved if curved > 0.0 else min(tried, key=lambda one: one[1])[0]


def _under_clock(base: Fit, problem: Problem, slope: float, scales: Scales) -> Fit:
    """The base fitted to the recording by a clock whose rate changes by ``slope`` (1/s)."""
    return fit(base.model, _timed(base, problem, slope), base.free, scales)


def _timed(base: Fit, problem: P, slope: float, bend: float = 0.0) -> P:
    since = problem.t - base.model.t0
    return replace(problem, t=problem.t + 0.5 * slope * since**2 + bend * since**3)


def _as_law(base: Fit, problem: Problem, slope: float, scales: Scales) -> Fit:
    """The same as a fit of a model that has the clock for a term, so that it is counted and said like any law."""
    here = _under_clock(base, problem, slope, scales)
    beside = observe(here.model, _timed(base, problem, (1.0 + _SHARE) * slope), scales=scales).y
    dy = {
        c: np.column_stack([partials, (beside[c] - here.shown.y[c]) / (_SHARE * slope)])
        for c, partials in here.shown.dy.items()
    }
    model = here.model.with_terms(ModelTerm(clock_drift.TERM, (slope,)))
    free = (*here.free, *free_of(model, ()))
    return under(replace(here, model=model, free=free, shown=replace(here.shown, dy=dy)), problem)
