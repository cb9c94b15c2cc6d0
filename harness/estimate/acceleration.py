"""Methods acceleration and acceleration-local: the jumps of the acceleration at the reversals, seen from both sides.

Where the whole decay is one motion of the base model, that is what acceleration fits: each half-cycle obeys a known
linear equation, the jump ties it to the next (Liang, eqs. 6, 9 to 11), and least squares weights all of it by its
covariance. Where it is not (friction that reverses early or is smeared), half-cycles are fitted apart without a guard,
and continued to the reversal: the jumps between them give x_k, and the decay inside them zeta. A jump shares each
half-cycle with its neighbour, so jumps are correlated: a plain mean wastes what they say together.

acceleration-local takes the last sample before and the first after each reversal, no guard and no window. It sees what
acts at the reversal itself: where an engine smears or anticipates the jump, this reads less friction than was put in.
The samples at the two ends of the interval that holds the reversal belong to the very step in which a simulation
reverses, to neither side; the ones beside them are taken, each carried to the reversal by the form it must follow
(eqs. 3 and 5), since a slope over one interval would else read as friction.
"""

import math
from dataclasses import dataclass, replace

import numpy as np

from harness.core.arrays import FloatArray, IntArray
from harness.estimate.channel import ChannelFit
from harness.estimate.halfcycles import SeparateFit
from harness.estimate.result import Estimate, Reversal, damped, quantity, rates_to_modal
from harness.estimate.reversals import Kind
from harness.estimate.sequence import Model, fit_sequence, loss_of, powers
from harness.estimate.tied import OMEGA, SIGMA, D


@dataclass(frozen=True, slots=True)
class Jumps:
    """Jumps at the inner edges of K half-cycles; arrays have shape (K-1,) unless said.

    t : s. before, after : acceleration either side, m/s^2. size : omega_n^2 2 x_k as this jump shows it, m/s^2,
    positive
    for friction. variance, neighbour : variance of each size and covariance with the next (K-2,), per unit of variance.
    by_rates : (K-1,2) change of size with sigma and omega. lead : s by which the jump precedes ``t``.
    """

    t: FloatArray
    before: FloatArray
    after: FloatArray
    size: FloatArray
    variance: FloatArray
    neighbour: FloatArray
    by_rates: FloatArray
    lead: FloatArray


def as_acceleration(fit: SeparateFit) -> SeparateFit:
    """The same half-cycles as accelerations, from a fit to the acceleration or the speed."""
    if fit.kind is Kind.ACCELERATION:
        return fit
    rate = np.array([[-fit.sigma, fit.omega, 0.0], [-fit.omega, -fit.sigma, 0.0], [0.0, 0.0, 0.0]])
    slope = np.einsum("ij,kjm->kim", rate, fit.slope)
    slope[:, :2, 0] -= fit.c[:, :2]
    slope[:, 0, 1] += fit.c[:, 1]
    slope[:, 1, 1] -= fit.c[:, 0]
    return replace(fit, kind=Kind.ACCELERATION, c=fit.c @ rate.T, inverse=rate @ fit.inverse @ rate.T, slope=slope)


def find_jumps(fit: SeparateFit, side: int, follow: bool) -> Jumps:
    """Jumps of an acceleration fit; side is the sign of x at the start.

    follow : look for the jump where both sides have one speed, which is where friction reversed, not where the speed
    did.
    """
    edges = fit.edges[1:-1]
    k = np.arange(edges.size)
    sign = side * (-1.0) ** (k + 1)
    reach = 0.2 * math.pi / fit.omega
    speed = (fit.c[:, 0] - 1j * fit.c[:, 1]) / fit.rate

    def speed_at(k: IntArray, time: FloatArray) -> FloatArray:
        return np.asarray((speed[k] * np.exp(fit.rate * (time - fit.edges[k]))).real, dtype=np.float64)

    time = edges.copy()
    if follow:
        for _ in range(6):  # Newton: the slope of the difference in speed is the jump itself
            slope = fit.value(k + 1, time) - fit.value(k, time)
            step = (speed_at(k + 1, time) - speed_at(k, time)) / np.where(np.abs(slope) > 0.0, slope, 1.0)
            time = np.clip(time - step, edges - reach, edges + reach)
    before, after = fit.value(k, time), fit.value(k + 1, time)
    late, early = fit.basis(k, time), fit.basis(k + 1, time)
    variance = np.einsum("ki,kij,kj->k", late, fit.inverse[k], late)
    variance += np.einsum("ki,kij,kj->k", early, fit.inverse[k + 1], early)
    neighbour = np.einsum("ki,kij,kj->k", early[:-1], fit.inverse[k[:-1] + 1], late[1:])
    by_rates = sign[:, None] * (_by_rates(fit, k + 1, time, early) - _by_rates(fit, k, time, late))
    known = fit.known[:-1] & fit.known[1:]
    # only the outermost half-cycles can hold too few samples
    shared = neighbour[known[:-1] & known[1:]]
    t, before, after, size, variance, lead = (
        one[known] for one in (edges, before, after, sign * (after - before), variance, edges - time)
    )
    return Jumps(t, before, after, size, variance, shared, by_rates[known], lead)


def _by_rates(fit: SeparateFit, k: IntArray, time: FloatArray, basis: FloatArray) -> FloatArray:
    """Total change (n,2) of the forms at ``time`` with sigma and omega, amplitudes following."""
    s, c = time - fit.edges[k], fit.c[k]
    direct = [-s * np.sum(basis * c, axis=1), s * (c[:, 1] * basis[:, 0] - c[:, 0] * basis[:, 1])]
    return np.asarray(np.stack(direct, axis=1) + np.einsum("ki,kim->km", basis, fit.slope[k]), dtype=np.float64)


@dataclass(frozen=True, slots=True)
class WeightedJump:
    """The common size of all jumps, m/s^2; variance as stated by the weights; by_rates (2,); scatter chi-square per
    degree.
    """

    size: float
    variance: float
    by_rates: FloatArray
    scatter: float


def combine(jumps: Jumps, variance: float) -> WeightedJump:
    """Generalised least squares of one size through all jumps; variance is that of one sample."""
    # imported when it is needed: it brings half of its library along
    from scipy.linalg import solve_banded

    n = jumps.size.size
    bands = np.zeros((3, n))
    bands[0, 1:], bands[1], bands[2, :-1] = jumps.neighbour, jumps.variance, jumps.neighbour
    weighted = solve_banded((1, 1), bands, np.ones(n))
    total = float(weighted.sum())
    size = float(weighted @ jumps.size) / total
    left = jumps.size - size
    chi2 = float(left @ solve_banded((1, 1), bands, left))
    scatter = chi2 / (n - 1) / variance if n > 1 and variance > 0.0 else 1.0
    return WeightedJump(size, variance / total, weighted @ jumps.by_rates / total, scatter)


def _rows(jumps: Jumps, omega_n: float, x_k: float, variance: float) -> tuple[Reversal, ...]:
    per = 0.5 / omega_n**2
    return tuple(
        Reversal(
            t=float(t),
            x=float(-after / omega_n**2 - math.copysign(x_k, after)),
            a_before=float(before),
            a_after=float(after),
            x_k=float(size * per),
            stderr=math.sqrt(max(float(var) * variance, 0.0)) * per,
        )
        for t, before, after, size, var in zip(
            jumps.t, jumps.before, jumps.after, jumps.size, jumps.variance, strict=True
        )
    )


def acceleration(fit: ChannelFit, unit: str = "m") -> Estimate:
    """omega_n, zeta and x_k (in ``unit``) from the fit of an acceleration, or of a speed."""
    notes: list[str] = []
    if fit.kind is Kind.VELOCITY:
        notes.append("from the speed: the acceleration is the derivative of the form fitted to it")
    if fit.offset:
        notes.append(f"a constant of {fit.offset:.4g} was found in the channel and taken away")
    separate = as_acceleration(fit.separate)
    return (_from_tied if fit.holds else _from_jumps)(
        fit, find_jumps(separate, fit.cycles.side, not fit.holds), unit, notes
    )


def _from_tied(fit: ChannelFit, jumps: Jumps, unit: str, notes: list[str]) -> Estimate:
    theta, covariance = fit.tied.theta, fit.tied.covariance * fit.variance
    modal = rates_to_modal(fit.sigma, fit.omega, covariance[:2, :2])
    omega_n, x_k = modal[0], float(theta[D]) / modal[0] ** 2
    gradient = np.zeros(theta.size)
    gradient[[SIGMA, OMEGA, D]] = -2.0 * x_k * fit.sigma / omega_n**2, -2.0 * x_k * fit.omega / omega_n**2, omega_n**-2
    spread = math.sqrt(max(float(gradient @ covariance @ gradient), 0.0))
    return Estimate(
        quantity(omega_n, modal[1], "rad/s"),
        quantity(modal[2], modal[3], "1"),
        quantity(x_k, spread, unit),
        fit.tied.count - 1,
        _rows(jumps, omega_n, x_k, fit.variance),
        guard=fit.guard,
        notes=tuple(notes),
    )


def _from_jumps(fit: ChannelFit, jumps: Jumps, unit: str, notes: list[str]) -> Estimate:
    separate, variance = fit.separate, fit.variance
    rates = separate.rates * variance
    omega_n, omega_error, zeta, zeta_error = rates_to_modal(separate.sigma, separate.omega, rates)
    common = combine(jumps, variance)
    x_k = 0.5 * common.size / omega_n**2
    by_rates: FloatArray = 0.5 * common.by_rates / omega_n**2
    by_rates = by_rates - 2.0 * x_k / omega_n**2 * np.array([separate.sigma, separate.omega])
    spread = 0.25 * common.variance * max(common.scatter, 1.0) / omega_n**4 + float(by_rates @ rates @ by_rates)
    weights = 1.0 / np.maximum(jumps.variance, 1e-300)
    lead = float(np.median(jumps.lead))
    notes.append(
        "the half-cycles are not one motion of the base model: jumps were read one by one, standard errors hold for"
        " what these jumps have in common"
    )
    lead_error = float(np.std(jumps.lead)) / math.sqrt(jumps.lead.size) if weights.size > 1 else math.inf
    return Estimate(
        quantity(omega_n, omega_error, "rad/s"),
        quantity(zeta, zeta_error, "1"),
        quantity(x_k, math.sqrt(max(spread, 0.0)), unit),
        jumps.t.size,
        _rows(jumps, omega_n, x_k, variance),
        guard=fit.guard,
        lead=quantity(lead, lead_error, "s"),
        notes=tuple(notes),
    )


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
