"""A first look at the catalogue on a model: what each law promises, and which of them are worth a fit.

Whether a law that repeats, relaxes or bends does so within what was recorded: less or finer of it is another law.

Where the residual of a fit stands out: what terms choose their starting values from.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from harness.core.arrays import FloatArray
from harness.core.errors import SimulationError
from harness.diagnosis.fit.model_fit import Fit
from harness.diagnosis.problem import Problem
from harness.diagnosis.rules import (
    PAIR_PROMISE,
    PRESLIDING_SEEN,
    RELAXATION_SEEN,
    SAMPLED,
    SCREEN_GAIN,
    SCREEN_GAIN_OF_ONE,
    SCREEN_SHARE,
)
from harness.diagnosis.search.screen import Candidate, direct, screen
from harness.fit.series import peaks
from harness.kernels.solve import Scales
from harness.model.model import ModelTerm
from harness.model.term import Evidence, Term


@dataclass(frozen=True, slots=True)
class Recorded:
    """What a recording holds at most and at least: travel (m), span (s), stride (m), fastest (rad/s).

    stride : as far as a sample goes in the slower half of the way; none of a free swing, which turns slowly at every
    place in its time. fastest : half the rate of the samples.
    """

    travel: float
    span: float
    stride: float = 0.0
    fastest: float = math.inf

    @classmethod
    def of(cls, t: FloatArray, x: FloatArray, driven: bool) -> "Recorded":
        """By times t (n,) and positions x (n,)."""
        step = np.sort(np.abs(np.diff(x)))
        way = np.cumsum(step)
        slower = int(np.searchsorted(way, SAMPLED.value * way[-1]))
        stride = float(step[slower]) if driven else 0.0
        return cls(float(np.ptp(x)), float(t[-1] - t[0]), stride, fastest(t))


def fastest(t: FloatArray) -> float:
    """Half the rate of samples at t (n,), rad/s: what is faster shows as something slower (Nyquist)."""
    return math.pi / float(np.median(np.diff(t)))


def within(entry: ModelTerm, f_k: float, seen: Recorded, least: float = 1.0) -> bool:
    """Whether a recording holds what a law repeats or forgets, or its slide; laws of neither kind pass.

    That is a whole period along the travel, within the span this share of a period in time, and the time in which it
    relaxes; two samples of each period; of a bristle under friction f_k (N) that it comes to slide.
    """
    period, omega, tau = entry.repeats("travel"), entry.repeats("time"), entry.relaxation
    bent = entry.presliding(f_k)
    return (
        (period is None or 2.0 * seen.stride <= period <= seen.travel)
        and (omega is None or 2.0 * math.pi * least / seen.span <= omega <= seen.fastest)
        and (tau is None or tau <= RELAXATION_SEEN.value * seen.span)
        and (bent is None or bent <= PRESLIDING_SEEN.value * seen.travel)
    )


_PEAKS = 48
_KNOCKS_PER_CYCLE = 12
_MOST_KNOCKS = 400
"""Frequencies and times that are tried: they bound the work."""
_HIGHEST = 12.0
"""Times the swing's frequency: a force further up hardly moves the slider (1/144 of what it would at rest)."""


def frequencies(fit: Fit, problem: Problem, omega: float) -> FloatArray:
    """Angular frequencies (rad/s) at which the whitened residual stands out, strongest first."""
    t = problem.t
    span = float(t[-1] - t[0])
    n = int(min(max(256, t.size), 1 << 16))
    grid = np.linspace(t[0], t[-1], n)
    power = np.zeros(2 * n + 1)
    for i in range(len(problem.channels)):
        part = fit.residual[i * t.size : (i + 1) * t.size]
        power += np.abs(np.fft.rfft(np.interp(grid, t, part), 4 * n)) ** 2
    step = 2.0 * math.pi * (n - 1) / (4.0 * n * span)
    tops = peaks(power)
    highest = min(_HIGHEST * omega, fastest(t))
    order = tops[(tops * step > math.pi / span) & (tops * step < highest)][:_PEAKS]
    # a slow or a resonant force hides below a peak of something else: a few fixed places besides
    fixed = omega * np.array([0.25, 0.5, 0.75, 0.9, 1.1, 1.3, 1.6, 2.0, 2.5, 3.0, 3.7, 4.5])
    return np.concatenate((order * step, fixed[fixed < highest]))


def evidence(fit: Fit, problem: Problem, scales: Scales) -> Evidence:
    """What the terms may look at."""
    t, model = problem.t, fit.model
    span = problem.duration
    count = int(min(_KNOCKS_PER_CYCLE * span * scales.omega / (2.0 * math.pi), _MOST_KNOCKS))
    knocks = np.linspace(t[0], t[0] + span, count + 2)[1:-1]
    peak = float(np.max(np.abs(problem.channels.get("a", fit.shown.a))))
    return Evidence(
        x_scale=float(np.max(np.abs(fit.shown.x))),
        v_scale=float(np.max(np.abs(fit.shown.v))),
        peak_a=peak,
        low=float(np.min(fit.shown.x)),
        high=float(np.max(fit.shown.x)),
        f_k=model.f_k,
        k=model.k,
        omega=scales.omega,
        duration=span,
        frequencies=frequencies(fit, problem, scales.omega),
        knock_times=knocks,
        driven="driven" in problem.given,
        angular=problem.angular,
        periods=problem.periods(fit.shown.x, fit.residual),
    )


_BEYOND = 3.0
"""Standard deviations of chi-square from which a fit leaves something, so that knocks are looked for."""


@dataclass(frozen=True, slots=True)
class Look:
    """What laws promise on a model, most promising first.

    fitted : the model, in ``part`` of a recording. terms : those that were looked at. found : of those with a linear
    amplitude; None on a model too stiff for a first look, on which nothing is built.
    """

    fitted: Fit
    part: Problem
    seen: Evidence
    terms: Sequence[Term]
    found: tuple[Candidate, ...] | None

    @classmethod
    def at(cls, fitted: Fit, part: Problem, scales: Scales, terms: Sequence[Term]) -> "Look":
        """One simulation or a few."""
        seen = evidence(fitted, part, scales)
        try:
            found = tuple(screen(fitted, part, seen, scales, terms))
        except SimulationError:
            return cls(fitted, part, seen, terms, None)
        return cls(fitted, part, seen, terms, found)

    @property
    def most(self) -> float:
        """The best promise, chi-square."""
        return self.found[0].gain if self.found else 0.0

    def gain_of(self, name: str) -> float | None:
        """The best promise of a catalogue name, chi-square; None where it promises nothing."""
        return max((c.gain for c in self.found or () if c.term.name == name), default=None)

    def worthy(self) -> list[Candidate]:
        """What is worth a fit, and the laws that no first look can tell of where something is left for them."""
        if self.found is None:
            return []
        least = max(SCREEN_GAIN.value, SCREEN_SHARE.value * self.most)
        of_one = SCREEN_GAIN_OF_ONE.value
        worthy = [c for c in self.found if c.gain >= (least if len(c.term.parameters) > 1 else of_one)]
        excess = self.fitted.chi2 - self.fitted.points
        if excess > _BEYOND * math.sqrt(2.0 * self.fitted.points) or self.most > 2.0 * math.log(self.fitted.points):
            worthy += direct(self.fitted, self.part, self.seen, self.terms)
        return worthy

    @property
    def promises_an_end(self) -> bool:
        """Whether a law may bring the model near the noise: else no pair with it explains."""
        return bool(self.found) and self._left(self.most) <= PAIR_PROMISE.value

    def ending(self) -> list[Candidate]:
        """Of what is worth a fit, that which may bring the model near the noise, or of which no look can tell."""
        least = SCREEN_SHARE.value * self.most
        return [
            c
            for c in self.worthy()
            if c.term.amplitude is None or (c.gain >= least and self._left(c.gain) <= PAIR_PROMISE.value)
        ]

    def _left(self, gain: float) -> float:
        """Chi-square a point beyond a gain."""
        return (self.fitted.chi2 - gain) / self.fitted.points
