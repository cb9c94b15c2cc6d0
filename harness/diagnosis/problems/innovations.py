"""Residuals under the noise of a force: what each sample adds to all before it, by a Kalman filter.

The state is what noise alone has done: position, speed, the force's noise, and the noise of each sensor. The filter is
linear and knows nothing of a residual but its times, so that residuals and partials go through the same one.
"""

import math

import numpy as np

from harness.core.arrays import FloatArray, IntArray
from harness.core.jit import compiled

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


def _colour(sensor: FloatArray, mean: FloatArray, p: FloatArray) -> None:
    """The noise of each sensor (k, 2) a sample later."""
    for c in range(sensor.shape[0]):
        at, phi = MOTION + c, sensor[c, 1]
        for b in range(p.shape[0]):
            p[at, b] *= phi
        for b in range(p.shape[0]):
            p[b, at] *= phi
        for b in range(mean.shape[1]):
            mean[at, b] *= phi
        p[at, at] += (1.0 - phi**2) * sensor[c, 0] ** 2


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

    moves (N - 1, 2, 4) : position and speed at the next instant by both, the force now and then. force (2,) : its
    noise's standard deviation and lag-one correlation. place (n,) : the instants at which there are samples.
    seen (k, n, 3) : what each sensor shows of the motion. sensor (k, 2) : noise and lag-one correlation. weight (k, n).
    jumps (k, n, 4) : by how much each sensor jumps at the event next to a sample, how far off that is, s, the
    acceleration before it, m/s^2, by which an uncertain speed moves the event, and how far it may lie off besides, s.
    start (N, 2) : standard deviations of position and speed at an instant from which the motion is followed anew, or 0.
    """
    k, n, q = y.shape
    size = MOTION + k
    fresh = force[0] * math.sqrt(1.0 - force[1] ** 2)
    mean, p, ph, left = np.zeros((size, q)), np.zeros((size, size)), np.zeros(size), np.zeros(q)
    p[2, 2] = force[0] ** 2
    for a in range(2):
        p[a, a] = start[place[0], a] ** 2
    for c in range(k):
        p[MOTION + c, MOTION + c] = sensor[c, 0] ** 2
    for i in range(n):
        if i > 0:
            for at in range(place[i - 1], place[i]):
                _compiled_move(moves[at], force[1], fresh, mean, p)
                for a in range(2):
                    p[a, a] += start[at + 1, a] ** 2
            _compiled_colour(sensor, mean, p)
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
                    out[c, i, b] = weight[c, i] * left[b] / math.sqrt(s)
                _compiled_take_in(ph, s, left, mean, p)


innovations = compiled(_innovations)


def _carry(moves: FloatArray, w: FloatArray, x: FloatArray, v: FloatArray) -> None:
    """Position and speed (N,) that noise w (N,) of a force makes from none; moves as above."""
    for i in range(w.size - 1):
        for out, m in ((x, moves[i, 0]), (v, moves[i, 1])):
            out[i + 1] = m[0] * x[i] + m[1] * v[i] + m[2] * w[i] + m[3] * w[i + 1]


carry = compiled(_carry)
