"""Residuals of a recording whose force is noisy: a simulation follows that noise too, which the slider has not felt."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from harness.core.arrays import BoolArray, FloatArray
from harness.diagnosis.problems.innovations import MOTION, carry, innovations
from harness.estimate.noise import Noise

_MOSTLY = 0.3
"""Share of what a model leaves of an acceleration that is the sensor's own, from which that is told from it.

Below it the channel alone tells more: of N samples of white noise the variance of a channel by itself (windows of one
freedom each) is off by 6.1 / sqrt(N) of it, what a model leaves by 1.7 / sqrt(N), which counts over the share
(tests/diagnosis/test_own_noise.py draws them).
"""

FAR = 5.0
"""Standard deviations beyond which a sample says no more: it may be on the other side of a jump."""


@dataclass(frozen=True, slots=True)
class ForceNoise:
    """What the noise of a force does to a slider, at the instants t (N,), s, of a whole recording.

    noise : of the force, N. moves (N - 1, 2, 4) : position and speed at the next instant by both, and by the force now
    and then. pull (N,), drag, push : partials of acceleration by position and speed, 1/s^2 and 1/s, and by force, 1/kg.
    slips (N,) : where it moves. jumps (N, 4) : of the acceleration at the event next to an instant, how far off that
    is, s, the acceleration before it, and how exactly a force of samples places it, s. averaged : whether samples are
    means, which show little of the force at an instant.
    told : the noise as the force's own samples tell it, of which the motion may show less.
    start (N, 2) : standard deviations of position and speed, m and m/s, where the motion is followed anew, 0 elsewhere.
    beyond : chi-square that such noise may leave beyond first order.
    """

    t: FloatArray
    noise: Noise
    moves: FloatArray
    pull: FloatArray
    drag: float
    push: float
    slips: BoolArray
    jumps: FloatArray
    start: FloatArray
    averaged: bool = False
    beyond: float = 0.0
    told: Noise | None = None

    def as_told(self) -> Noise:
        """The noise as the force's own samples tell it."""
        return self.noise if self.told is None else self.told

    def at(self, sigma: float) -> "ForceNoise":
        """With a noise of this level, N, known to be as large as it was told."""
        told = self.as_told()
        return replace(self, noise=replace(told, sigma=sigma, found=sigma > 0.0), told=told)

    def unlikely(self, t: FloatArray, noise: Mapping[str, Noise], weight: Mapping[str, FloatArray],
                 values: Mapping[str, FloatArray]) -> float:  # fmt: skip
        """Minus twice the logarithm of the likelihood of residuals (n,) of channels at t, but for a constant."""
        white, variance = self.whitened(t, noise, weight, values)
        return sum(float(np.sum(w**2 + (weight[c] > 0.0) * np.log(variance[c]))) for c, w in white.items())

    def whitened(
        self,
        t: FloatArray,
        noise: Mapping[str, Noise],
        weight: Mapping[str, FloatArray],
        values: Mapping[str, FloatArray],
    ) -> tuple[dict[str, FloatArray], dict[str, FloatArray]]:
        """Residuals (n,) or partials (n, q) of channels at t, as innovations in units of their deviation.

        Also the variances (n,) of the innovations, in the channel's unit squared.
        """
        place = np.minimum(np.searchsorted(self.t, t - 1e-9 * (self.t[-1] - self.t[0])), self.t.size - 1)
        y = np.stack([np.atleast_2d(v.T).T for v in values.values()])
        push = 0.0 if self.averaged else self.push
        seen = np.stack([self._seen(c, push)[place] for c in values])
        sensor = np.array([[noise[c].sigma, noise[c].phi] for c in values])
        jumps = np.stack([self.jumps[place] if c == "a" else np.zeros((t.size, 4)) for c in values])
        out, variance = np.empty_like(y), np.empty(y.shape[:2])
        innovations(
            self.moves, np.array([self.noise.sigma, self.noise.phi]), place, seen, sensor,
            np.stack([weight[c] for c in values]), jumps, self.start, y, out, variance,
        )  # fmt: skip
        shaped = {c: out[i].reshape(v.shape) for i, (c, v) in enumerate(values.items())}
        return shaped, dict(zip(values, variance, strict=True))

    def _seen(self, channel: str, push: float) -> FloatArray:
        """What a channel shows (N, 3) of position, speed and force."""
        seen = np.zeros((self.t.size, MOTION))
        if channel == "a":
            seen[:, 0], seen[:, 1], seen[:, 2] = -self.pull * self.slips, -self.drag * self.slips, push * self.slips
        else:
            seen[:, "xv".index(channel)] = 1.0
        return seen

    def felt(self, w: FloatArray) -> dict[str, FloatArray]:
        """What a force's noise w (N,), N, adds to position, speed and acceleration (N,)."""
        x, v = np.zeros(w.size), np.zeros(w.size)
        carry(self.moves, w, x, v)
        return {"x": x, "v": v, "a": self.slips * (self.push * w - self.pull * x - self.drag * v)}

    def own(self, channel: str, left: Noise, before: Noise) -> Noise:
        """A sensor's own noise, where ``left`` is what a model leaves and ``before`` what the channel alone tells.

        A simulated acceleration takes the force's noise over from sample to sample, a speed adds it up.
        """
        if channel == "x":
            return left
        share = 1.0 - (self.push * self.noise.sigma / left.sigma) ** 2
        return replace(left, sigma=left.sigma * math.sqrt(share)) if channel == "a" and share > _MOSTLY else before
