"""Residuals of a driven recording in units of what was to be expected, one sample after the other.

A force that was not measured, or measured wrongly, pushes the state off for good: simulation errors in a window are
coloured and grow. The Kalman filter of that error (state: position, speed, first-order force noise; measured: each
channel's residual) turns them into innovations, which are white and of unit variance; it does the same to partials. A
closed loop feeds past errors into the drive and never coming ones, so that innovations stay unbiased where plain
residuals would not be (Ljung 1999, System Identification, 13.4). The start of a window is left open ten times as wide
as its standard error, so that the data that follow decide it.
"""

import math
from collections.abc import Mapping

import numpy as np

from harness.core.arrays import FloatArray, IntArray
from harness.core.jit import compiled
from harness.diagnosis.problem import Problem

CHANNELS = ("x", "v", "a")
_OPEN = 10.0
"""Standard errors by which a window's start is left open."""
_JITTER = 1e-2
"""Share by which intervals may differ and still count as one."""
_SHORT = 0.02
"""Longest step of the series, in units of the fastest rate; longer ones are doubled from it."""


def _transition(h: float, c: float, k: float, rate: float, drift: float, phi: FloatArray, q: FloatArray) -> None:
    """Transition (3, 3) over h s of (x, v, d): x' = v, v' = d - c v - k x, d' = -rate d + noise, and noise (3, 3)."""
    fastest = max(rate, c, math.sqrt(k))
    doublings = max(0, math.ceil(math.log2(max(h * fastest / _SHORT, 1.0))))
    s = h / 2.0**doublings
    a = np.zeros((3, 3))
    a[0, 1], a[1, 0], a[1, 1], a[1, 2], a[2, 2] = s, -k * s, -c * s, s, -rate * s
    a2 = a @ a
    phi[:] = np.eye(3) + a + a2 / 2.0 + a2 @ a / 6.0 + a2 @ a2 / 24.0
    # noise through a short step: the response of d, v, x to a push tau before its end
    q[:] = 0.0
    for i in range(3):
        for j in range(3):
            q[i, j] = drift * s ** (1 + (2 - i) + (2 - j)) / (1 + (2 - i) + (2 - j))
    q[0, :] *= 0.5
    q[:, 0] *= 0.5
    for _ in range(doublings):
        q[:] = q + phi @ q @ phi.T
        phi[:] = phi @ phi


transition = compiled(_transition)


def _innovations(  # noqa: PLR0912  (one loop is one loop: calls cost what laws cost)
    t: FloatArray,
    values: FloatArray,
    weight: FloatArray,
    variance: FloatArray,
    starts: FloatArray,
    bounds: IntArray,
    system: FloatArray,
) -> float:
    """Turn values (C, n, q) of residuals or partials into innovations in place; returns the sum of ln S.

    weight (C, n) : 0 leaves a measurement out. variance (C,) : of channels x, v, a; negative for one that is not there.
    starts (w, 3) : time and variances of position and speed. bounds (w, 2). system : c/m, k/m, rate of the force noise
    (1/s), its variance as acceleration.
    """
    c, k, rate, power = system[0], system[1], system[2], system[3]
    columns = values.shape[2]
    phi, q, p, half = np.empty((3, 3)), np.empty((3, 3)), np.zeros((3, 3)), np.empty((3, 3))
    state, moved = np.zeros((3, columns)), np.zeros((3, columns))
    row, gain = np.zeros(3), np.zeros(3)
    total, before = 0.0, 0.0
    for w in range(bounds.shape[0]):
        p[:], state[:] = 0.0, 0.0
        p[0, 0], p[1, 1], p[2, 2] = starts[w, 1], starts[w, 2], power
        last = starts[w, 0]
        for n in range(bounds[w, 0], bounds[w, 1]):
            h = t[n] - last
            last = t[n]
            if h > 0.0:
                if abs(h - before) > _JITTER * before:
                    transition(h, c, k, rate, 2.0 * power * rate, phi, q)
                    before = h
                for i in range(3):
                    for j in range(3):
                        half[i, j] = phi[i, 0] * p[0, j] + phi[i, 1] * p[1, j] + phi[i, 2] * p[2, j]
                for i in range(3):
                    for j in range(3):
                        p[i, j] = half[i, 0] * phi[j, 0] + half[i, 1] * phi[j, 1] + half[i, 2] * phi[j, 2] + q[i, j]
                for j in range(columns):
                    for i in range(3):
                        moved[i, j] = phi[i, 0] * state[0, j] + phi[i, 1] * state[1, j] + phi[i, 2] * state[2, j]
                for i in range(3):
                    for j in range(columns):
                        state[i, j] = moved[i, j]
            for channel in range(3):
                if variance[channel] < 0.0:
                    continue
                if weight[channel, n] == 0.0:
                    for j in range(columns):
                        values[channel, n, j] = 0.0
                    continue
                row[0], row[1], row[2] = 1.0, 0.0, 0.0
                if channel == 1:
                    row[0], row[1] = 0.0, 1.0
                elif channel == 2:
                    row[0], row[1], row[2] = -k, -c, 1.0
                s = variance[channel]
                for i in range(3):
                    gain[i] = p[i, 0] * row[0] + p[i, 1] * row[1] + p[i, 2] * row[2]
                    s += row[i] * gain[i]
                total += math.log(s)
                root = math.sqrt(s)
                for j in range(columns):
                    left = values[channel, n, j] - row[0] * state[0, j] - row[1] * state[1, j] - row[2] * state[2, j]
                    values[channel, n, j] = left / root
                    for i in range(3):
                        state[i, j] += gain[i] / s * left
                for i in range(3):
                    for j in range(3):
                        p[i, j] -= gain[i] * gain[j] / s
    return total


innovations = compiled(_innovations)


def whiten_driven(problem: Problem, values: Mapping[str, FloatArray]) -> tuple[FloatArray, float]:
    """Whitened residuals (n,) or partials (n, q) of the channels, one after another, and the sum of ln S.

    The noise of the channels and of the force is the problem's; phi of the force's is at the median interval.
    """
    restarts = problem.restarts
    assert restarts is not None
    t, names = problem.t, list(problem.channels)
    one = values[names[0]]
    columns = 1 if one.ndim == 1 else one.shape[1]
    block, weight = np.zeros((3, t.size, columns)), np.zeros((3, t.size))
    variance = np.full(3, -1.0)
    for i, channel in enumerate(CHANNELS):
        if channel in problem.channels:
            block[i] = values[channel].reshape(t.size, columns)
            weight[i] = problem.weight[channel]
            variance[i] = problem.noise[channel].sigma ** 2
    force = problem.noise["u"]
    rate = -math.log(min(max(force.phi, 1e-12), 1.0 - 1e-9)) / float(np.median(np.diff(t)))
    first = restarts.first
    system = np.array([first.c / first.m, first.k / first.m, rate, (force.sigma / first.m) ** 2])
    starts = np.array([(w.t0, (_OPEN * w.x_sd) ** 2, (_OPEN * w.v_sd) ** 2) for w in restarts.windows])
    bounds = np.array([(w.start, w.stop) for w in restarts.windows], dtype=np.int64)
    total = innovations(t, block, weight, variance, starts, bounds, system)
    out = np.concatenate([block[CHANNELS.index(c)] for c in names])
    return (out[:, 0] if one.ndim == 1 else out), float(total)
