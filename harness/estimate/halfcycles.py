"""Each half-cycle by itself: the damped form with a free amplitude and phase, rate and frequency shared by all.

Inside a half-cycle the base model is linear, so a and v are exp(-sigma s)(c1 cos omega s + c2 sin omega s), with
sigma = zeta omega_n, omega = omega_d, and x is that about a centre of its own. c is eliminated half-cycle by half-cycle
(variable projection), so that the cost is linear in the samples whatever their number.
"""

import math
from dataclasses import dataclass
from itertools import product

import numpy as np

from harness.core.arrays import BoolArray, FloatArray, IntArray
from harness.estimate.reversals import HalfCycles, Kind
from harness.fit.least_squares import Bounds, Until, inverse_of, least_squares

_SINGULAR = 1e-14
"""Determinant of normal equations, scaled to a unit diagonal, below which a half-cycle holds too few samples."""


@dataclass(frozen=True, slots=True)
class Sums:
    """Sum of squares at some parameters (p,), and their normal equations; parameters that are none have no squares."""

    squares: float
    normal: FloatArray
    pull: FloatArray
    used: int = 0

    def normal_equations(self) -> tuple[FloatArray, FloatArray]:
        """J'J (p, p) and J'r (p,)."""
        return self.normal, self.pull


@dataclass(frozen=True, slots=True)
class SeparateFit:
    """Half-cycles fitted apart, with shared sigma = zeta omega_n and omega = omega_d (rad/s).

    edges : (K+1,) s. c : (K,3) cosine and sine amplitude at the start of the half-cycle, and the centre (x only), in
    the channel's unit. inverse : (K,3,3) covariance of c per unit of variance, rates known. slope : (K,3,2) dc/d(sigma,
    omega). rates : (2,2) covariance of sigma and omega per unit of variance. variance : of the residual. freedom :
    degrees of freedom.
    """

    kind: Kind
    edges: FloatArray
    guard: float
    sigma: float
    omega: float
    c: FloatArray
    inverse: FloatArray
    slope: FloatArray
    rates: FloatArray
    variance: float
    freedom: int

    def __len__(self) -> int:
        return int(self.edges.size - 1)

    @property
    def rate(self) -> complex:
        """-sigma + i omega: the form is the real part of (c1 - i c2) exp(rate s), its derivative rate times as much."""
        return complex(-self.sigma, self.omega)

    def basis(self, k: IntArray, time: FloatArray) -> FloatArray:
        """Values at ``time`` (n,) of the three functions that c of half-cycle k (n,) multiplies, (n, 3)."""
        wave = np.exp(self.rate * (time - self.edges[k]))
        centre = np.full(wave.shape, 1.0 if self.kind is Kind.DISPLACEMENT else 0.0)
        return np.stack([wave.real, wave.imag, centre], axis=-1)

    def value(self, k: IntArray, time: FloatArray) -> FloatArray:
        """The forms of half-cycles k (n,), continued to ``time`` (n,)."""
        return np.asarray(np.sum(self.basis(k, time) * self.c[k], axis=-1), dtype=np.float64)

    def stops(self) -> FloatArray:
        """Times nearest to the two edges of each half-cycle at which its own form has speed zero, (K, 2) s."""
        power = {Kind.DISPLACEMENT: 1, Kind.VELOCITY: 0, Kind.ACCELERATION: -1}[self.kind]
        speed = (self.c[:, 0] - 1j * self.c[:, 1]) * self.rate**power
        half = math.pi / self.omega
        first = np.arctan2(-speed.real, -speed.imag) / self.omega
        begin = first - half * np.round(first / half)
        if len(self) > 1:  # a record can begin in motion: the edge that is a reversal counts
            begin[0] = first[0] + half * (np.round((self.edges[1] - self.edges[0] - first[0]) / half) - 1.0)
        return np.stack([self.edges[:-1] + begin, self.edges[:-1] + begin + half], axis=1)

    @property
    def known(self) -> BoolArray:
        """Which half-cycles hold enough samples to be fitted, (K,)."""
        return np.asarray(self.inverse[:, 0, 0] > 0.0, dtype=np.bool_)


def windows(t: FloatArray, edges: FloatArray, guard: float) -> tuple[IntArray, IntArray]:
    """Samples (n,) at least ``guard`` s away from both edges (K+1,) of their half-cycle, and which that is (n,)."""
    lo = np.searchsorted(t, edges[:-1] + guard)
    many = np.maximum(np.searchsorted(t, edges[1:] - guard, side="right") - lo, 0)
    cycle = np.repeat(np.arange(many.size), many)
    return np.arange(cycle.size) + np.repeat(lo - (np.cumsum(many) - many), many), cycle


def _inverses(normal: FloatArray) -> FloatArray:
    """Inverses (K,3,3) of normal equations (K,3,3); 0 for numbers that do not show and half-cycles without samples."""
    size = np.sqrt(np.einsum("kii->ki", normal))
    scale = np.where(size > 0.0, 1.0 / np.where(size > 0.0, size, 1.0), 0.0)
    units = scale[:, :, None] * scale[:, None, :]
    scaled = normal * units + np.eye(3) * (scale == 0.0)[:, None, :]
    solvable = np.linalg.det(scaled) > _SINGULAR
    scaled[~solvable] = np.eye(3)
    return np.asarray(np.linalg.inv(scaled) * units * solvable[:, None, None], dtype=np.float64)


def fit_separately(
    t: FloatArray,
    y: FloatArray,
    kind: Kind,
    edges: FloatArray,
    guard: float,
    start: tuple[float, float],
    fixed: bool = False,
) -> SeparateFit:
    """Least squares over all half-cycles between ``edges`` (K+1,), leaving out ``guard`` s beside each.

    start : first guess of sigma and omega in rad/s, which alone are searched for; all else has a closed form.
    fixed : sigma and omega are known already.
    """
    count = edges.size - 1
    at, cycle = windows(t, edges, guard)
    since, values = t[at] - edges[cycle], y[at]
    centre = np.full(at.size, 1.0 if kind is Kind.DISPLACEMENT else 0.0)
    begin = np.flatnonzero(np.diff(cycle, prepend=-1))
    filled = cycle[begin]

    def sums(rows: list[FloatArray], others: list[FloatArray]) -> FloatArray:
        """Products of rows (n,) with others (n,), summed over each half-cycle, (K, rows, others)."""
        out = np.zeros((count, len(rows), len(others)))
        for (i, one), (j, other) in product(enumerate(rows), enumerate(others)):
            out[filled, i, j] = np.add.reduceat(one * other, begin)
        return out

    def amplitudes(sigma: float, omega: float) -> tuple[FloatArray, FloatArray, FloatArray, Sums]:
        """c, inverse and slope as in SeparateFit, and the sums of sigma and omega with every c eliminated."""
        wave = np.exp(complex(-sigma, omega) * since)
        basis = [wave.real, wave.imag, centre]
        inverse = _inverses(sums(basis, basis))
        c = np.einsum("kij,kj->ki", inverse, sums(basis, [values])[:, :, 0])
        form = (c[:, 0] - 1j * c[:, 1])[cycle] * wave
        left = values - form.real - c[cycle, 2] * centre
        by_rates = [-since * form.real, -since * form.imag]
        right, cross = sums(basis, [left])[:, :, 0], sums(basis, by_rates)
        slope = -inverse @ cross
        normal = np.sum(sums(by_rates, by_rates) + np.swapaxes(cross, 1, 2) @ slope, axis=0)
        pull = np.sum(sums(by_rates, [left])[:, :, 0] + np.einsum("kim,ki->km", slope, right), axis=0)
        c = c + np.einsum("kij,kj->ki", inverse, right)  # what rounding left of it
        return c, inverse, slope, Sums(float(left @ left), normal, pull)

    def evaluated(rates: FloatArray) -> Sums:
        possible = rates[1] > 0.0 and abs(rates[0]) < 3.0 * rates[1]
        return amplitudes(*rates.tolist())[3] if possible else Sums(math.inf, np.zeros((2, 2)), np.zeros(2))

    sigma, omega = start
    if not fixed:
        until = Until(1e-28 * float(y @ y), 1e-10, 40)
        found = least_squares(evaluated, np.array(start), until, Bounds.of(2, longest=0.3 * omega))
        sigma, omega = found.coordinates.tolist()
    c, inverse, slope, of_rates = amplitudes(sigma, omega)
    freedom = max(at.size - ((3 if kind is Kind.DISPLACEMENT else 2) * count + 2), 1)
    rates, variance = inverse_of(of_rates.normal), of_rates.squares / freedom
    return SeparateFit(kind, edges, guard, sigma, omega, c, inverse, slope, rates, variance, freedom)


def moved_edges(fit: SeparateFit, cycles: HalfCycles, t: FloatArray) -> FloatArray:
    """Reversal times (K+1,) from where the fitted forms have speed zero, each as far as it can be trusted."""
    edges, reach = fit.edges.copy(), 0.2 * math.pi / fit.omega
    stops, weight = fit.stops(), np.hypot(fit.c[:, 0], fit.c[:, 1]) ** 2
    total = weight[:-1] + weight[1:]
    between = (weight[:-1] * stops[:-1, 1] + weight[1:] * stops[1:, 0]) / np.where(total > 0.0, total, 1.0)
    near = (total > 0.0) & (np.abs(between - edges[1:-1]) < reach)
    edges[1:-1][near] = between[near]
    for k, time, inside in ((0, stops[0, 0], stops[0, 0] > t[0]), (edges.size - 1, stops[-1, 1], stops[-1, 1] < t[-1])):
        if inside and abs(time - edges[k]) < reach:
            edges[k] = time
    return edges if np.all(np.diff(edges) > 0.0) else fit.edges
