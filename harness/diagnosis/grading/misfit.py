"""A recording as its misfit tells of it: from the first turning point, each channel weighed by what the base leaves."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from harness.core.arrays import FloatArray
from harness.diagnosis.baseline.base_fit import baseline
from harness.diagnosis.baseline.residual_noise import residual_noise
from harness.diagnosis.baseline.words import Strokes, evidence, strokes_of, words_of
from harness.diagnosis.fit.model_fit import Fit, fit
from harness.diagnosis.problem import Problem
from harness.diagnosis.problems.force_noise import ForceNoise
from harness.estimate.noise import Noise
from harness.kernels.solve import Scales

_CHI2_A_WORD = 30.0
"""Chi-square of the base a word, in the units of the search: a share of a thirtieth of a word is then not pruned."""
_FEWEST = 50
"""Samples that must stay."""


@dataclass(frozen=True, slots=True)
class Misfit:
    """What viscous and Coulomb friction leave, where no model explains it.

    problem : from the first turning point, each channel's noise set to what the base leaves of it, and that of a force
    enlarged alike. base : fit under it. noise, force : of the sensors and of a force, as they were seen before.
    strokes, words : of the motion. left_out : s, before the first turning point.
    """

    problem: Problem
    base: Fit
    noise: Mapping[str, Noise]
    force: ForceNoise | None
    scales: Scales
    strokes: Strokes
    words: float
    left_out: float

    def noise_left(self, shown: Fit) -> dict[str, Noise]:
        """The sensors' noise by channel: what a fit leaves within short windows.

        It is no more than was seen before, nor than all that the fit leaves. Beside a noisy force it is what was seen.
        """
        if self.force is not None:
            return dict(self.noise)
        t, period = self.problem.t, 2.0 * math.pi / self.scales.omega
        left = {c: self.problem.even(c, y - shown.shown.y[c]) for c, y in self.problem.channels.items()}
        found = {c: residual_noise(t, r, self.problem.channels[c], period) for c, r in left.items()}
        least = {c: n if n.sigma < self.noise[c].sigma else self.noise[c] for c, n in found.items()}
        return {c: replace(n, sigma=min(n.sigma, _rms(left[c]) or n.sigma)) for c, n in least.items()}

    def sensed(self, noise: Mapping[str, Noise]) -> Problem:
        """The problem under this noise of the sensors, and under its force's own."""
        return replace(self.problem, noise=noise, force_noise=self.force)

    def floor(self, noise: Mapping[str, Noise]) -> float:
        """What noise alone would leave of chi-square, in the units of the search."""
        return sum(self._left_by(c, n) for c, n in noise.items())

    def known(self, noise: Mapping[str, Noise]) -> float:
        """What the base leaves beyond noise, over that and its standard error: squares of noise scatter by chance.

        A share of what is hardly known says little, and 1 where nothing is beyond.
        """
        beyond = max(self.base.chi2 - self.floor(noise), 0.0)
        scatter = math.sqrt(sum(2.0 / max(self._samples(c), 1.0) * self._left_by(c, n) ** 2 for c, n in noise.items()))
        return beyond / (beyond + scatter) if beyond + scatter > 0.0 else 1.0

    def evidence_of(self, one: Fit, noise: Mapping[str, Noise], cells: float = 1.0) -> float:
        """Evidence of a fit over the base, with the sensors' noise as it is left; cells : see ``evidence``.

        A word is said over many samples, over which noise averages out: what it leaves beside the words is taken off.
        """
        return self.evidence_by(one.chi2, len(one.free) - len(self.base.free), noise, cells)

    def evidence_by(self, squares: float, more: float, noise: Mapping[str, Noise], cells: float = 1.0) -> float:
        """The same of a fit with so many numbers more that leaves so many squares."""
        beside = sum(self._left_by(c, n) * (1.0 - self._in_words(c, n)) for c, n in noise.items())
        least = self.floor(noise)
        before, left = (max(size, least) - beside for size in (self.base.chi2, squares))
        return evidence(before, left, self.words, more, cells)

    def _left_by(self, channel: str, noise: Noise) -> float:
        """What a channel's noise leaves of chi-square."""
        return self._samples(channel) * (noise.sigma / self.problem.noise[channel].sigma) ** 2

    def _in_words(self, channel: str, noise: Noise) -> float:
        """Share of a channel's noise that is in the words, more of one that is slow."""
        return min(self.words * noise.inflation(0.0, 1.0) / max(self._samples(channel), 1.0), 1.0)

    def _samples(self, channel: str) -> float:
        return float(np.sum(self.problem.weight[channel]))


def _rms(r: FloatArray) -> float:
    return math.sqrt(float(np.mean(r**2)))


def misfit(problem: Problem, base: Fit, scales: Scales, *, whole: bool = False) -> Misfit:
    """The misfit of a recording whose base model is fitted. Raises SimulationError.

    A free decay is looked at from its first turning point, unless it is known to be free as a ``whole``; a driven
    recording whole: no hand lets it go.
    """
    problem, left_out = (problem, 0.0) if whole else problem.of_hand_free(_FEWEST)
    if left_out > 0.0:
        base, scales = baseline(problem)
    strokes = strokes_of(base, problem)
    words = words_of(strokes)
    points = sum(float(np.sum(w)) for w in problem.weight.values())
    level = math.sqrt(points / (_CHI2_A_WORD * words))
    weighed = _weighed(problem, {c: y - base.shown.y[c] for c, y in problem.channels.items()}, level)
    base = fit(base.model, weighed, base.free, scales, thorough=False)
    return Misfit(weighed, base, problem.noise, problem.force_noise, scales, strokes, words, left_out)


def _weighed(problem: Problem, left: Mapping[str, FloatArray], level: float) -> Problem:
    """A problem whose noise is ``level`` times what a base model leaves (n,) of each channel.

    Beside a noisy force that is what each sample adds to those before, and the force's noise grows as the sensors' do.
    """
    force = problem.force_noise
    if force is None:
        sizes = {c: _rms(problem.even(c, r)) for c, r in left.items()}
        return problem.under_noise({c: Noise(level * max(s, problem.noise[c].sigma), True) for c, s in sizes.items()})
    white = problem.whitened(left)
    over = {c: level * max(_rms(w), 1.0) for c, w in white.items()}
    all_over = level * max(_rms(np.concatenate(list(white.values()))), 1.0)
    grown = replace(force.at(all_over * force.noise.sigma), beyond=force.beyond / all_over**2)
    noise = {c: replace(n, sigma=over[c] * n.sigma) for c, n in problem.noise.items()}
    return replace(problem, noise=noise, force_noise=grown)
