"""Residuals of a recording whose force is noisy: a simulation follows that noise too, which the slider has not felt.

Residuals under the noise of a force: what each sample adds to all before it, by a Kalman filter.

The state is what noise alone has done: position, speed, the force's noise, and the noise of each sensor. The filter is
linear and knows nothing of a residual but its times, so that residuals and partials go through the same one.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from harness.core.arrays import BoolArray, FloatArray, IntArray
from harness.core.jit import compiled
from harness.estimate.noise import Noise

MOTION = 3
"""Places of the state before the sensors: position, speed, force."""


def _move(m: FloatArray, phi: float, fresh: float, mean: FloatArray, p: FloatArray) -> None:
    """The state and its covariance an instant later; phi : of the force's noise, fresh : deviation of its new part."""
    size, q = mean.shape
    # in numbers and not in an array: this is done for every instant, and an array would cost as much as all the rest
    x_x, x_v, x_f = m[0, 0], m[0, 1], m[0, 2] + phi * m[0, 3]
    v_x, v_v, v_f = m[1, 0], m[1, 1], m[1, 2] + phi * m[1, 3]
    for b in range(q):
        x, v, f = mean[0, b], mean[1, b], mean[2, b]
        mean[0, b], mean[1, b], mean[2, b] = x_x * x + x_v * v + x_f * f, v_x * x + v_v * v + v_f * f, phi * f
    for b in range(size):
        x, v, f = p[0, b], p[1, b], p[2, b]
        p[0, b], p[1, b], p[2, b] = x_x * x + x_v * v + x_f * f, v_x * x + v_v * v + v_f * f, phi * f
    for b in range(size):
        x, v, f = p[b, 0], p[b, 1], p[b, 2]
        p[b, 0], p[b, 1], p[b, 2] = x_x * x + x_v * v + x_f * f, v_x * x + v_v * v + v_f * f, phi * f
    by = (fresh * m[0, 3], fresh * m[1, 3], fresh)
    for a in range(MOTION):
        for b in range(MOTION):
            p[a, b] += by[a] * by[b]


def _own_variance(sigma: float, weight: float) -> float:
    """Variance of a sensor's noise at a sample of such a weight, of which one of none has nothing to say."""
    return sigma**2 / weight**2 if weight != 0.0 else sigma**2


_compiled_own_variance = compiled(_own_variance)


def _colour(sensor: FloatArray, weight: FloatArray, mean: FloatArray, p: FloatArray) -> None:
    """The noise of each sensor (k, 2) a sample later, where it has a weight (k,)."""
    for c in range(sensor.shape[0]):
        at, phi = MOTION + c, sensor[c, 1]
        for b in range(p.shape[0]):
            p[at, b] *= phi
        for b in range(p.shape[0]):
            p[b, at] *= phi
        for b in range(mean.shape[1]):
            mean[at, b] *= phi
        p[at, at] += (1.0 - phi**2) * _compiled_own_variance(sensor[c, 0], weight[c])


def _seen_by(h: FloatArray, at: int, p: FloatArray, ph: FloatArray) -> float:
    """Covariance ph (size,) of the state with what a sensor shows, its own noise in place ``at``; variance of that."""
    for a in range(ph.size):
        ph[a] = p[a, at] + p[a, 0] * h[0] + p[a, 1] * h[1] + p[a, 2] * h[2]
    variance: float = ph[at] + ph[0] * h[0] + ph[1] * h[1] + ph[2] * h[2]
    return variance


def _take_in(ph: FloatArray, s: float, left: FloatArray, mean: FloatArray, p: FloatArray) -> None:
    """The state and its covariance after a look of variance s, left (q,) : what it shows beyond what was expected."""
    for a in range(ph.size):
        gain = ph[a] / s
        for b in range(left.size):
            mean[a, b] += gain * left[b]
        for b in range(ph.size):
            p[a, b] -= gain * ph[b]


def _misplaced(jump: FloatArray, speed_variance: float) -> float:
    """Variance of which side of an event a sample is on; jump (4,) as below."""
    late = math.sqrt(max(speed_variance, 0.0) / jump[2] ** 2 + jump[3] ** 2)
    wrong = 0.5 * math.erfc(jump[1] / late / math.sqrt(2.0))
    variance: float = wrong * (1.0 - wrong) * jump[0] ** 2
    return variance


_compiled_move, _compiled_colour = compiled(_move), compiled(_colour)
_compiled_seen_by, _compiled_misplaced = compiled(_seen_by), compiled(_misplaced)
_compiled_take_in = compiled(_take_in)


def _innovations(
    moves: FloatArray,
    force: FloatArray,
    phi: float,
    place: IntArray,
    seen: FloatArray,
    sensor: FloatArray,
    weight: FloatArray,
    jumps: FloatArray,
    start: FloatArray,
    y: FloatArray,
    out: FloatArray,
    variance: FloatArray,
) -> None:
    """Innovations in units of their standard deviation, of y (k, n, q), into out; their variances (k, n).

    moves (N - 1, 2, 4) : position and speed at the next instant by both, the force now and then. force (N,) : its
    noise's standard deviation, phi : and lag-one correlation. place (n,) : the instants at which there are samples.
    seen (k, n, 3) : what each sensor shows of the motion. sensor (k, 2) : noise and lag-one correlation. weight (k,
    n) : of samples, by which a sensor's noise is divided. jumps (k, n, 4) : by how much each sensor jumps at the
    event next to a sample, how far off that is, s, the acceleration before it, m/s^2, by which an uncertain speed
    moves the event, and how far it may lie off besides, s. start (N, 2) : standard deviations of position and speed
    at an instant from which the motion is followed anew, or 0.
    """
    k, n, q = y.shape
    size = MOTION + k
    new = math.sqrt(1.0 - phi**2)
    mean, p, ph, left = np.zeros((size, q)), np.zeros((size, size)), np.zeros(size), np.zeros(q)
    p[2, 2] = force[place[0]] ** 2
    for a in range(2):
        p[a, a] = start[place[0], a] ** 2
    for c in range(k):
        p[MOTION + c, MOTION + c] = _compiled_own_variance(sensor[c, 0], weight[c, 0])
    for i in range(n):
        if i > 0:
            for at in range(place[i - 1], place[i]):
                _compiled_move(moves[at], phi, new * force[at + 1], mean, p)
                for a in range(2):
                    p[a, a] += start[at + 1, a] ** 2
            _compiled_colour(sensor, weight[:, i], mean, p)
        for c in range(k):
            h = seen[c, i]
            s = _compiled_seen_by(h, MOTION + c, p, ph)
            if jumps[c, i, 0] != 0.0:
                s += _compiled_misplaced(jumps[c, i], p[1, 1])
            variance[c, i] = s
            for b in range(q):
                out[c, i, b] = 0.0
            if weight[c, i] != 0.0:
                for b in range(q):
                    shown = mean[MOTION + c, b] + h[0] * mean[0, b] + h[1] * mean[1, b] + h[2] * mean[2, b]
                    left[b] = y[c, i, b] - shown
                    out[c, i, b] = left[b] / math.sqrt(s)
                _compiled_take_in(ph, s, left, mean, p)


innovations = compiled(_innovations)


def _carry(moves: FloatArray, w: FloatArray, x: FloatArray, v: FloatArray) -> None:
    """Position and speed (N,) that noise w (N,) of a force makes from none; moves as above."""
    for i in range(w.size - 1):
        for out, m in ((x, moves[i, 0]), (v, moves[i, 1])):
            out[i + 1] = m[0] * x[i] + m[1] * v[i] + m[2] * w[i] + m[3] * w[i + 1]


carry = compiled(_carry)


_QUIETER = tuple(2.0 ** (-0.25 * i) for i in range(17))
"""Shares of a sensor's noise that may be its own beside a noisy force: each a sixth less than the last."""
_MEMORY = 1.0, 0.75, 0.5, 0.25, 0.0
"""Shares of its lag-one correlation."""

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
    beyond : chi-square that such noise may leave beyond first order. between (N,) : standard deviation, N, of what is
    not known of the force beside each sample. times (N,) : by which its noise counts, more where that may have stopped
    the slider: then it is no longer as often one way as the other.
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
    between: FloatArray | float = 0.0
    times: FloatArray | float = 1.0

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

    def sensors(self, t: FloatArray, noise: Mapping[str, Noise], weight: Mapping[str, FloatArray],
                values: Mapping[str, FloatArray]) -> dict[str, Noise]:  # fmt: skip
        """Noise of sensors, likeliest of residuals (n,) at t; no more than ``noise`` nor less than a rounding.

        What the force's noise does lasts, and was taken for a memory of the sensor: it has no more than was told.
        """
        found = dict(noise)
        for c, most in noise.items():
            rounding = most.step / math.sqrt(12.0)
            levels = [
                replace(most, sigma=one * most.sigma, phi=phi)
                for phi in (share * most.phi for share in (_MEMORY if most.phi else (1.0,)))
                for one in _QUIETER
                if one * most.sigma >= rounding
            ]
            by = [self.unlikely(t, {**found, c: one}, weight, values) for one in levels]
            found[c] = levels[int(np.argmin(by))] if most.found and levels else most
        return found

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
            self.moves, np.hypot(self.noise.sigma * self.times, self.between), self.noise.phi, place, seen, sensor,
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
