"""Is what a fitted force leaves no more than noise leaves of a true model? Compared with simulated draws of that.

A fitted force where nothing is left out: the model's own motion, seen as it was measured.

Smoothing rounds off what friction does at reversals, noise is amplified by two differences, and some law of a whole
catalogue always fits what comes of both. How well, and how much stays, is simulated: the fitted model moves as the
slider did, its motion and the force get the noise that was found and pass the same smoothing, the same fit and the same
search (a parametric bootstrap; Davison and Hinkley 1997, ch. 4).
"""

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from itertools import chain

import numpy as np

from harness.core.arrays import FloatArray
from harness.core.errors import SimulationError
from harness.diagnosis.fit.model_fit import HASTY, Fit, fit
from harness.diagnosis.fit.rmse import motion_followed
from harness.diagnosis.problems.inverse import InverseDynamics, Q
from harness.diagnosis.problems.measured import Measured
from harness.diagnosis.problems.simulated import COARSE, observe
from harness.diagnosis.residual_tests.structure import Left
from harness.diagnosis.rules import BETWEEN_SAMPLES, NULL_DRAWS, OVER_SIMULATED
from harness.diagnosis.smoothed_state.state import Course
from harness.estimate.noise import Noise, channel_noise
from harness.kernels.solve import Drive, Scales
from harness.model.model import Model, Restoring

_HANDS = (0.03, 0.1, 0.3)
"""Rates of the hand that leads a slider, times the sampling interval: the slowest that keeps it on its way is taken,
for a fast one passes on noise."""
_ON_THE_WAY = 99.0
"""% of the motion (NRMSE)."""


def draws(current: Fit, problem: Q, scales: Scales, count: int, beside: float = math.inf) -> Iterator[tuple[Fit, Q]]:
    """A fitted model as the truth, recorded and fitted again, so many times. Raises SimulationError.

    beside : times the noise of the sensors, that what remains beside it is at most.
    """
    parts = problem.alone or (problem,)
    each = [_Moved.by(current.model.of_recording(r), one, scales) for r, one in enumerate(parts)]
    # of the same way the same blocks
    same = problem.measured.moving if problem.restoring is Restoring.NONE else None
    random, each_sample = np.random.default_rng(0), problem.sample_by_sample
    for _ in range(count):
        drawn = Measured.of_several([one.measured(random, beside, each_sample) for one in each], problem)
        if same is not None:
            drawn = drawn.part(same)
        again = replace(problem, fixed=drawn)
        yield fit(current.model, again, current.free, scales), again


@dataclass(frozen=True, slots=True)
class _Moved:
    """A recording as a model moves. shown (n,) : by channel, without noise. drive, noise : of its force."""

    problem: InverseDynamics
    shown: Mapping[str, FloatArray]
    drive: Drive
    noise: Noise

    @classmethod
    def by(cls, model: Model, problem: InverseDynamics, scales: Scales) -> "_Moved":
        """Under the recorded force, and where nothing pulls back led along the recorded way. Raises SimulationError."""
        # over each stretch without a gap from one start: no window's edge is in the motion
        course = Course.of(problem.t, problem.channels, problem.noise)
        whole = replace(problem, starts=course.anew(math.inf))
        noise = channel_noise(problem.t, problem.drive.at(problem.t), rests=True)
        if problem.covariance is not None:
            noise = Noise(problem.covariance.force, found=True)
        if model.restoring is not Restoring.NONE:
            return cls(problem, observe(model, whole, (), scales, COARSE).y, problem.drive, noise)
        x, v, _ = course.state
        u, interval = problem.drive.straight.at(problem.t), float(np.median(np.diff(problem.t)))
        for rate in (share / interval for share in _HANDS):
            # a hand beside the recorded force: the slider turns and rests where the recorded one does
            k, c = model.m * rate**2, 2.0 * model.m * rate
            led = replace(model, k=k, c=model.c + c, restoring=Restoring.SPRING)
            hand = replace(whole, drive=Drive(problem.t, u + k * x + c * v))
            shown = observe(led, hand, (), Scales(scales.x, scales.v, rate), COARSE)
            if motion_followed(shown.y, problem) >= _ON_THE_WAY:
                break
        return cls(problem, shown.y, Drive(problem.t, u + k * (x - shown.x) + c * (v - shown.v)), noise)

    def drawn(self, random: np.random.Generator) -> InverseDynamics:
        """The recording with noise anew."""
        problem, drive = self.problem, self.drive
        channels = {c: problem.noise[c].over(self.shown[c], random) for c in problem.channels}
        by, known = problem.measured.by, problem.covariance
        if known is not None and (problem.each_sample or not problem.noise[by].found):
            alone = self.shown[by] if problem.each_sample else channels[by]
            channels[by] = alone + known.motion * random.standard_normal(problem.t.size)
        force = drive.u
        if self.noise.found:
            force = force + np.interp(drive.t, problem.t, self.noise.drawn(problem.t.size, random))
        return replace(problem, channels=channels, drive=replace(drive, u=force))

    def measured(self, random: np.random.Generator, beside: float, each_sample: bool) -> Measured:
        """The same, smoothed as the recording was."""
        found = Measured.of(self.drawn(random), other=self.problem.measured, each_sample=each_sample)
        known = self.problem.covariance
        if known is None:
            return found
        size = min(known.left, beside * known.sensors)
        more = size * random.standard_normal(found.moving.size)
        if each_sample:
            return replace(found, recorded=found.recorded + more)
        return replace(found, u=found.u + np.repeat(more, found.u.size // more.size))


_STEP = 0.01
"""Of what decides: a descent whose step gains less would need twice its most steps to come to it."""


def beyond_chance(
    better: Sequence[tuple[Fit, float]],
    current: Fit,
    problem: Q,
    scales: Scales,
    further: Callable[[Fit, Q, float], Iterator[Fit]],
) -> list[Fit]:
    """Of fits, each with the squares of force, N^2 a value, that chance may take: those of which it takes less.

    Chance takes what the best of ``further`` takes off a true model, the most of some draws. That is never more than a
    draw leaves: one that leaves too little to decide is not searched, and no search goes on when all is decided. What
    decides is far more than a hasty fit looks for: a descent ends where many of its steps would not come to it.
    Each law is begun there as it ended here, too: what follows noise is begun by the noise that it follows. All of
    them where the model cannot be simulated: then it says nothing of what chance does.
    """
    with suppress(SimulationError):
        for before, drawn in draws(current, problem, scales, NULL_DRAWS.count):
            size = before.residual.size
            decides = size * min(most for _, most in better)
            if before.chi2 < decides:
                continue
            as_here = _as_here([found for found, _ in better], drawn, scales)
            for after in chain(as_here, further(before, drawn, max(_STEP * decides / before.chi2, HASTY))):
                better = [(found, most) for found, most in better if before.chi2 - after.chi2 < size * most]
                if not better:
                    return []
    return [found for found, _ in better]


def _as_here(found: Sequence[Fit], drawn: Q, scales: Scales) -> Iterator[Fit]:
    """Laws fitted to a draw, from the numbers that they have in the recording; those that can be."""
    for one in found:
        with suppress(SimulationError):
            yield fit(one.model, drawn, one.free, scales)


_WIDER = 4
"""Each length of means is so many times the one before."""
_FEWEST = 16
"""Means of one length: fewer scatter too much to be compared."""


@dataclass(frozen=True, slots=True)
class LeftOver:
    """What a force leaves. ratio : its rms over the most of the draws', at the length of means where it is largest.

    noise : squares a value, N^2, that noise leaves of a true model; None where that could not be simulated.
    """

    ratio: float
    noise: float | None

    @property
    def left(self) -> Left:
        """Noise, where it is no more than the draws leave; what could not be tested is not called noise."""
        return Left.NOISE if self.ratio <= OVER_SIMULATED.value else Left.STRUCTURE


def left_over(found: Fit, problem: InverseDynamics, scales: Scales, laws: int) -> LeftOver:
    """What a model of so many laws leaves of a force beside what it would leave if it were the whole truth.

    In means over ever longer stretches too: what noise leaves is fast, what a law leaves is slow. What is left as if
    it were noise may be what happens between samples, if it is not many times that of the sensors; but several laws
    together leave nearly everything like that, so that beside them no more of it counts than is of the sensors' size.
    """
    try:
        count, beside = NULL_DRAWS.count, BETWEEN_SAMPLES.value if laws <= 1 else 1.0
        simulated = [_by_length(again.residual) for again, _ in draws(found, problem, scales, count, beside)]
    except SimulationError:
        return LeftOver(np.inf, None)
    seen = _by_length(found.residual)
    common = min(seen.size, *(s.size for s in simulated))
    most = np.max([s[:common] for s in simulated], axis=0)
    ratio = float(np.sqrt(np.max(seen[:common] / np.maximum(most, 1e-300))))
    return LeftOver(ratio, float(np.mean([s[0] for s in simulated])))


def _by_length(residual: FloatArray) -> FloatArray:
    """Mean squares of a residual (m,) and of its means over 4, 16, ... neighbours."""
    size = 1
    found: list[float] = []
    while not found or residual.size // size >= _FEWEST:
        used = residual.size // size * size
        found.append(float(np.mean(residual[:used].reshape(-1, size).mean(axis=1) ** 2)))
        size *= _WIDER
    return np.array(found)
