"""All half-cycles as one motion: five numbers for the whole decay, by least squares with exact derivatives.

Liang's eqs. 2-6 and 11 in one: the half-cycles last pi/omega_d each, and the swing after a reversal is q times the one
before less 2 x_k. Written with P = omega_n^2 (|X| - x_k) and D = omega_n^2 x_k so that a alone needs no omega_n.
"""

import math
from dataclasses import dataclass

import numpy as np

from harness.core.arrays import FloatArray
from harness.core.jit import compiled
from harness.estimate.reversals import Kind
from harness.fit.covariance import inverse_of
from harness.fit.least_squares import Until, least_squares

_SIZE = 6
SIGMA, OMEGA, D, P0, T0, OFFSET = range(_SIZE)


def _chain(theta: FloatArray, count: int, swing: FloatArray, partial: FloatArray) -> None:
    """P of each half-cycle (count+1,) and its derivatives by sigma, omega, D and P0 (count+1, 4)."""
    sigma, omega = theta[0], theta[1]
    q = math.exp(-math.pi * sigma / omega)
    swing[0] = theta[3]
    partial[0, :] = 0.0
    partial[0, 3] = 1.0
    for k in range(count):
        swing[k + 1] = q * swing[k] - 2.0 * theta[2]
        for i in range(4):
            partial[k + 1, i] = q * partial[k, i]
        partial[k + 1, 0] -= math.pi / omega * q * swing[k]
        partial[k + 1, 1] += math.pi * sigma / (omega * omega) * q * swing[k]
        partial[k + 1, 2] -= 2.0


_compiled_chain = compiled(_chain)


def _form(kind: int, theta: FloatArray, s: float, p: float, side: float, row: FloatArray) -> float:
    """Value at s after a reversal of a (0), v (1) or x (2), and ``row`` (8,): by sigma, omega, D, P, s, offset."""
    sigma, omega = theta[0], theta[1]
    e = math.exp(-sigma * s)
    cos, sin = math.cos(omega * s), math.sin(omega * s)
    rho = sigma / omega
    row[5] = 1.0
    if kind == 0:
        h = -side * e * (cos - rho * sin)
        row[0] = -s * p * h + side * p * e * sin / omega
        row[1] = -side * p * e * (-s * sin - rho * s * cos + rho / omega * sin)
        row[2] = 0.0
        row[3] = h
        row[4] = -side * p * e * (-2.0 * sigma * cos + (sigma * rho - omega) * sin)
        return float(p * h + theta[5])
    if kind == 1:
        h = -side / omega * e * sin
        row[0] = -s * p * h
        row[1] = -p * h / omega - side * p / omega * e * s * cos
        row[2] = 0.0
        row[3] = h
        row[4] = -side * p / omega * e * (omega * cos - sigma * sin)
        return float(p * h + theta[5])
    per = side / (sigma * sigma + omega * omega)
    h = per * e * (cos + rho * sin)
    value = per * theta[2] + p * h
    row[0] = -s * p * h + per * p * e * sin / omega - 2.0 * sigma * abs(per) * value
    row[1] = per * p * e * (-s * sin + rho * s * cos - rho / omega * sin) - 2.0 * omega * abs(per) * value
    row[2] = per
    row[3] = h
    row[4] = -side * p / omega * e * sin
    return float(value + theta[5])


_compiled_form = compiled(_form)


def _normal(
    t: FloatArray,
    y: FloatArray,
    kind: int,
    theta: FloatArray,
    side: int,
    count: int,
    swing: FloatArray,
    partial: FloatArray,
    member: FloatArray,
    guard: float,
    normal: FloatArray,
    pull: FloatArray,
) -> tuple[float, int]:
    """Sum of squares, samples used, and the normal equations (6,6), (6,) of all half-cycles.

    member : t_0 and half-cycle time by which samples are dealt to half-cycles (kept while theta is improved), and the
    first and last time to use.
    """
    normal[:] = 0.0
    pull[:] = 0.0
    row, g = np.empty(8), np.empty(6)
    squares, used = 0.0, 0
    step = math.pi / theta[1]
    first = np.searchsorted(t, max(member[2], member[0]))
    for n in range(first, t.size):
        if t[n] > member[3]:
            break
        at = (t[n] - member[0]) / member[1]
        k = math.floor(at)
        if k >= count:
            break
        if (at - k) * member[1] < guard or (k + 1 - at) * member[1] < guard:
            continue
        sign = float(side) if k % 2 == 0 else -float(side)
        m = _compiled_form(kind, theta, t[n] - theta[4] - k * step, swing[k], sign, row)
        r = y[n] - m
        g[0] = row[0] + row[3] * partial[k, 0]
        g[1] = row[1] + row[3] * partial[k, 1] + row[4] * k * step / theta[1]
        g[2] = row[2] + row[3] * partial[k, 2]
        g[3] = row[3] * partial[k, 3]
        g[4] = -row[4]
        g[5] = 1.0
        squares += r * r
        used += 1
        for i in range(6):
            pull[i] += g[i] * r
            for j in range(i + 1):
                normal[i, j] += g[i] * g[j]
    for i in range(6):
        for j in range(i):
            normal[j, i] = normal[i, j]
    return squares, used


_compiled_normal = compiled(_normal)


@dataclass(frozen=True, slots=True)
class TiedFit:
    """The whole decay by one set of numbers.

    theta : (6,) sigma (1/s), omega_d (rad/s), D = omega_n^2 x_k, P_0 = omega_n^2 (|X_0| - x_k) (m/s^2), t_0 (s),
    offset (in
    the channel's unit). covariance : (6,6) per unit of variance; rows of what was held are 0. side : sign of X_0.
    count : half-cycles. variance : of the residual. freedom : degrees of freedom.
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

    def swings(self) -> FloatArray:
        """P of each half-cycle and of the one that would follow, (count+1,) m/s^2."""
        swing, partial = np.empty(self.count + 1), np.empty((self.count + 1, 4))
        _compiled_chain(self.theta, self.count, swing, partial)
        return swing


@dataclass(frozen=True, slots=True)
class _Point:
    """Sums over all half-cycles at one theta; a theta that is no oscillation has no squares."""

    squares: float
    used: int
    normal: FloatArray
    pull: FloatArray

    def normal_equations(self) -> tuple[FloatArray, FloatArray]:
        """Of what is free."""
        return self.normal, self.pull


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
        omega = float(at[OMEGA])
        member = np.array([at[T0], math.pi / omega, span[0], span[1]])

        def evaluated(at: FloatArray, omega: float = omega, member: FloatArray = member) -> _Point:
            normal, pull = np.zeros((_SIZE, _SIZE)), np.zeros(_SIZE)
            if not (0.5 * omega < at[OMEGA] < 2.0 * omega and abs(at[SIGMA]) < 3.0 * at[OMEGA]):
                return _Point(math.inf, 0, normal, pull)
            theta, swing, partial = np.concatenate((at, fixed)), np.empty(count + 1), np.empty((count + 1, 4))
            _compiled_chain(theta, count, swing, partial)
            squares, used = _compiled_normal(
                t, y, int(kind), theta, side, count, swing, partial, member, guard, normal, pull
            )
            return _Point(squares, used, normal[:free, :free], pull[:free])

        found = least_squares(evaluated, at, until)
        at = found.coordinates
        moved = abs(at[T0] - member[0]) + count * abs(math.pi / at[OMEGA] - member[1])
        if moved < 1e-7 * member[1]:
            break
    covariance = np.zeros((_SIZE, _SIZE))
    covariance[:free, :free] = inverse_of(found.point.normal)
    theta, sums = np.concatenate((at, fixed)), found.point
    return TiedFit(kind, theta, covariance, side, count, guard, sums.squares, max(sums.used - free, 1))


def _sample(
    t: FloatArray, kind: int, theta: FloatArray, side: int, count: int, swing: FloatArray, out: FloatArray
) -> None:
    row = np.empty(8)
    step = math.pi / theta[1]
    for n in range(t.size):
        k = math.floor((t[n] - theta[4]) / step)
        out[n] = math.nan
        if 0 <= k < count:
            sign = float(side) if k % 2 == 0 else -float(side)
            out[n] = _compiled_form(kind, theta, t[n] - theta[4] - k * step, swing[k], sign, row)


_compiled_sample = compiled(_sample)


def value_at(t: FloatArray, kind: Kind, theta: FloatArray, side: int, count: int) -> FloatArray:
    """The tied form at ``t`` (n,), nan outside its half-cycles; theta (6,) as in TiedFit."""
    swing, partial, out = np.empty(count + 1), np.empty((count + 1, 4)), np.empty(t.size)
    _compiled_chain(theta, count, swing, partial)
    _compiled_sample(t, int(kind), theta, side, count, swing, out)
    return out
