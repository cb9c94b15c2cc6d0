"""All half-cycles as one motion: five numbers for the whole decay, by least squares with exact derivatives.

Liang's eqs. 2-6 and 11 in one: the half-cycles last pi/omega_d each, and the swing after a reversal is q times the one
before less 2 x_k. Written with P = omega_n^2 (|X| - x_k) and D = omega_n^2 x_k so that a alone needs no omega_n.
"""

import math
from dataclasses import dataclass

import numpy as np

from harness.core.arrays import FloatArray, IntArray
from harness.estimate.halfcycles import Sums
from harness.estimate.reversals import Kind
from harness.estimate.sequence import powers
from harness.fit.least_squares import Until, inverse_of, least_squares

_SIZE = 6
SIGMA, OMEGA, D, P0, T0, OFFSET = range(_SIZE)


def _swings(theta: FloatArray, count: int) -> tuple[FloatArray, FloatArray]:
    """P of each half-cycle (count,) and its derivatives by sigma, omega, D and P0 (4, count)."""
    sigma, omega, d, first = theta[:4]
    q = math.exp(-math.pi * sigma / omega)
    with np.errstate(over="ignore", invalid="ignore"):  # a trial may grow without bounds; it is then refused
        power, by_power, total, by_total = powers(q, count)
        by_q = first * by_power - 2.0 * d * by_total
        slope = [-math.pi / omega * q * by_q, math.pi * sigma / omega**2 * q * by_q, -2.0 * total, power]
        return first * power - 2.0 * d * total, np.stack(slope)


def _form(
    kind: Kind, theta: FloatArray, s: FloatArray, k: IntArray, side: int, count: int
) -> tuple[FloatArray, FloatArray]:
    """Values (n,) of a, v or x at s (n,) after the reversals k (n,), and their derivatives (6, n) by theta.

    With rate = -sigma + i omega, a after a reversal is Re(i rate e^(rate s)) P / omega, v and x are its integrals.
    """
    sigma, omega, d = theta[:3]
    order, rate = {Kind.ACCELERATION: 1, Kind.VELOCITY: 0, Kind.DISPLACEMENT: -1}[kind], complex(-sigma, omega)
    p, by_chain = (found[..., k] for found in _swings(theta, count))
    sign = np.where(k % 2 == 0, float(side), -float(side))
    wave = 1j * rate**order * np.exp(rate * s) * sign / omega
    by_rate, h = (order / rate + s) * wave, wave.real
    by_s = p * (rate * wave).real
    out = np.zeros((_SIZE, s.size))
    out[:4] = h * by_chain
    out[SIGMA] -= p * by_rate.real
    out[OMEGA] += by_s * k * math.pi / omega**2 - p * (by_rate.imag + h / omega)
    out[T0] = -by_s
    out[OFFSET] = 1.0
    value = p * h + theta[OFFSET]
    if kind is Kind.DISPLACEMENT:
        per = sign / (sigma**2 + omega**2)
        value = value + per * d
        out[D] += per
        out[SIGMA] -= 2.0 * sigma * np.abs(per) * per * d
        out[OMEGA] -= 2.0 * omega * np.abs(per) * per * d
    return value, out


@dataclass(frozen=True, slots=True)
class TiedFit:
    """The whole decay by one set of numbers.

    theta : (6,) sigma (1/s), omega_d (rad/s), D = omega_n^2 x_k, P_0 = omega_n^2 (|X_0| - x_k) (m/s^2), t_0 (s),
    offset (in the channel's unit). covariance : (6,6) per unit of variance; rows of what was held are 0. side : sign of
    X_0. count : half-cycles. squares : of the residual. freedom : degrees of freedom.
    """

    kind: Kind
    theta: FloatArray
    covariance: FloatArray
    side: int
    count: int
    guard: float
    squares: float
    freedom: int

    @property
    def variance(self) -> float:
        """Residual variance in the channel's unit squared."""
        return self.squares / self.freedom

    @property
    def half_time(self) -> float:
        """Half-cycle time pi/omega_d, s."""
        return math.pi / float(self.theta[OMEGA])

    @property
    def edges(self) -> FloatArray:
        """Reversal times, start and stop included, (count+1,) s."""
        return np.asarray(self.theta[T0] + self.half_time * np.arange(self.count + 1), dtype=np.float64)

    def swings(self, count: int) -> FloatArray:
        """P of the first ``count`` half-cycles, (count,) m/s^2."""
        return _swings(self.theta, count)[0]


def fit_tied(
    t: FloatArray,
    y: FloatArray,
    kind: Kind,
    start: FloatArray,
    side: int,
    count: int,
    guard: float,
    span: tuple[float, float],
    offset: bool,
) -> TiedFit:
    """Least squares of the tied form over ``count`` half-cycles, from ``start`` (6,), with samples in ``span`` (s)
    alone.

    Samples are dealt to half-cycles anew until that settles. offset : whether theta's last is free.
    """
    free = _SIZE if offset else _SIZE - 1
    fixed = np.zeros(_SIZE - free)
    until = Until(1e-28 * float(y @ y), 1e-10, 60)
    at = start[:free]
    for _ in range(8):
        began, omega = float(at[T0]), float(at[OMEGA])
        half = math.pi / omega
        place = (t - began) / half
        part = np.floor(place)
        near = np.minimum(place - part, part + 1.0 - place) * half < guard
        use = (t >= max(span[0], began)) & (t <= span[1]) & (part < count) & ~near
        times, values, k = t[use], y[use], part[use].astype(np.int64)

        def evaluated(
            at: FloatArray,
            omega: float = omega,
            times: FloatArray = times,
            values: FloatArray = values,
            k: IntArray = k,
        ) -> Sums:
            if not (0.5 * omega < at[OMEGA] < 2.0 * omega and abs(at[SIGMA]) < 3.0 * at[OMEGA]):
                return Sums(math.inf, np.zeros((free, free)), np.zeros(free))
            theta = np.concatenate((at, fixed))
            model, slope = _form(kind, theta, times - at[T0] - k * math.pi / at[OMEGA], k, side, count)
            left, slope = values - model, slope[:free]
            return Sums(float(left @ left), slope @ slope.T, slope @ left, times.size)

        found = least_squares(evaluated, at, until)
        at = found.coordinates
        if abs(at[T0] - began) + count * abs(math.pi / at[OMEGA] - half) < 1e-7 * half:
            break
    covariance = np.zeros((_SIZE, _SIZE))
    covariance[:free, :free] = inverse_of(found.point.normal)
    theta, sums = np.concatenate((at, fixed)), found.point
    return TiedFit(kind, theta, covariance, side, count, guard, sums.squares, max(sums.used - free, 1))


def value_at(t: FloatArray, kind: Kind, theta: FloatArray, side: int, count: int) -> FloatArray:
    """The tied form at ``t`` (n,), nan outside its half-cycles; theta (6,) as in TiedFit."""
    half = math.pi / theta[OMEGA]
    k = np.floor((t - theta[T0]) / half).astype(np.int64)
    within = (k >= 0) & (k < count)
    k = np.where(within, k, 0)
    return np.where(within, _form(kind, theta, t - theta[T0] - k * half, k, side, count)[0], np.nan)
