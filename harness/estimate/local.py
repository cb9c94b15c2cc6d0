"""Method acceleration-local: the last sample before and the first after each reversal, no guard and no window.

It sees what acts at the reversal itself: where an engine smears or anticipates the jump, this reads less friction than
was put in. The samples at the two ends of the interval that holds the reversal belong to the very step in which a
simulation turns round, to neither side; the ones beside them are taken, each carried to the reversal by the form
it must follow (eqs. 3 and 5), since a slope over one interval would else read as friction.
"""

import math

import numpy as np

from harness.core.arrays import FloatArray
from harness.estimate.result import Estimate, Reversal, damped, quantity
from harness.estimate.sequence import Model, fit_sequence, loss_of, powers


def samples_beside(
    t: FloatArray, a: FloatArray, times: FloatArray, rates: tuple[float, float]
) -> tuple[FloatArray, FloatArray]:
    """Acceleration before and after each of ``times`` (m,), from one sample of a (n,) a side; nan where there is none.

    rates : sigma = zeta omega_n and omega_d, by which a sample is carried to the reversal.
    """
    interval = float(np.median(np.diff(t))) * (1.0 + 1e-9)
    index = np.searchsorted(t, times - interval, side="right") - 1, np.searchsorted(t, times + interval)
    sigma, omega = rates
    out = []
    for i in index:
        inside = (i >= 0) & (i < t.size)
        n = np.where(inside, i, 0)
        s = t[n] - times
        form = np.exp(-sigma * s) * (np.cos(omega * s) - sigma / omega * np.sin(omega * s))
        near = inside & (np.abs(s) < 0.3 * math.pi / omega)
        out.append(np.where(near, a[n] / np.where(near, form, 1.0), np.nan))
    return out[0], out[1]


def _two_sequences(count: int) -> Model:
    """Magnitudes after and before from (q, first after, its constant, first before, its constant): eqs. 13 and 12."""

    def model(theta: FloatArray) -> tuple[FloatArray, FloatArray]:
        power, by_power, total, by_total = powers(float(theta[0]), count)
        values = np.empty((count, 2))
        slope = np.zeros((count, 2, 5))
        for end, at in ((0, 1), (1, 3)):
            values[:, end] = theta[at] * power - theta[at + 1] * total
            slope[:, end, 0] = theta[at] * by_power - theta[at + 1] * by_total
            slope[:, end, at], slope[:, end, at + 1] = power, -total
        return values, slope

    return model


def acceleration_local(
    t: FloatArray,
    a: FloatArray,
    sigma: float,
    edges: FloatArray,
    seen: tuple[bool, bool],
    side: int,
    omega_d: tuple[float, float],
    decay: float,
    unit: str = "m",
) -> Estimate:
    """omega_n, zeta and x_k (in ``unit``) from single samples of the acceleration a (n,), m/s^2, at t (n,), s.

    sigma : noise of one sample. edges (K+1,) : times at which the speed is zero, s; seen : whether the first and the
    last are such in the data. side : sign of x at the start. omega_d : with its standard error, rad/s. decay : sigma =
    zeta omega_n, 1/s, to carry a sample over an interval and a half.
    """
    count = edges.size - 1
    before, after = samples_beside(t, a, edges, (decay, omega_d[0]))
    q = math.exp(-math.pi * decay / omega_d[0])
    sign = side * (-1.0) ** np.arange(count + 1)
    start, end = -sign[:-1] * after[:-1], sign[:-1] * before[1:]
    if not seen[0]:
        start[0] = np.nan
    if not seen[1]:
        end[-1] = np.nan
    values = np.stack([start, end], axis=1)
    if np.count_nonzero(np.isfinite(start)) < 3 and np.count_nonzero(np.isfinite(end)) < 3:
        return Estimate.refused("eqs. 12 and 13 need three reversals in a row", unit)
    whiten = np.zeros((count, 2, 2))
    whiten[:, [0, 1], [0, 1]] = np.where(np.isfinite(values), 1.0 / sigma, 0.0)
    known = np.where(np.isfinite(values), values, np.nanmax(values))
    guess = np.array([q, known[0, 0], 0.0, known[0, 1], 0.0])
    guess[2], guess[4] = q * known[0, 0] - known[1, 0], q * known[0, 1] - known[1, 1]
    found = fit_sequence(values, whiten, _two_sequences(count), guess)
    spread = found.covariance[0, 0] * max(found.scatter, 1.0)
    q_found = float(found.theta[0])
    beta, beta_error = math.inf, math.inf
    if q_found > 0.0:
        beta, beta_error = -math.log(q_found) / math.pi, math.sqrt(spread) / (q_found * math.pi)
    notes = ["one sample on each side of a reversal, no guard: what acts at the reversal itself is in the figure"]
    loss = loss_of(sign[:-1] * start, np.full(count, sigma**2) * max(found.scatter, 1.0), beta_error)
    if loss is not None:
        beta, beta_error = loss.of(loss.beta)
        notes.append(loss.said)
    elif q_found <= 0.0:
        return Estimate.refused("the samples beside the reversals do not decay", unit)
    omega_n = omega_d[0] * math.sqrt(1.0 + beta * beta)
    jumps = sign[1:-1] * (after[1:-1] - before[1:-1])
    per = 0.5 / omega_n**2
    error = math.sqrt(2.0) * sigma * per
    scatter = float(np.std(jumps, ddof=1)) * per if jumps.size > 1 else error
    x_k = float(np.mean(jumps)) * per
    rows = tuple(
        Reversal(float(time), None, float(early), float(late), float(jump * per), error)
        for time, early, late, jump in zip(edges[1:-1], before[1:-1], after[1:-1], jumps, strict=True)
    )
    return Estimate(
        *damped(omega_d, (beta, beta_error)),
        quantity(x_k, max(error, scatter) / math.sqrt(jumps.size), unit),
        jumps.size,
        rows,
        notes=tuple(notes),
    )
