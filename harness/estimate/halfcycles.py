"""Each half-cycle by itself: the damped form with a free amplitude and phase, rate and frequency shared by all.

Inside a half-cycle the base model is linear, so a and v are exp(-sigma s)(c1 cos omega s + c2 sin omega s), with
sigma = zeta omega_n, omega = omega_d, and x is that about a centre of its own. c is eliminated half-cycle by half-cycle
(variable projection), so that the cost is linear in the samples whatever their number.
"""

import math
from dataclasses import dataclass, replace

import numpy as np

from harness.core.arrays import BoolArray, FloatArray, IntArray
from harness.estimate.projection import compiled_project
from harness.estimate.reversals import HalfCycles, Kind
from harness.fit.covariance import inverse_of
from harness.fit.least_squares import Bounds, Until, least_squares


@dataclass(frozen=True, slots=True)
class Windows:
    """Which samples of each half-cycle are used: lo, hi (K,) indices, start (K,) s the times amplitudes refer to."""

    start: FloatArray
    lo: IntArray
    hi: IntArray

    @classmethod
    def of(cls, t: FloatArray, edges: FloatArray, guard: float) -> "Windows":
        """Samples at least ``guard`` s away from both edges (K+1,) of their half-cycle."""
        lo = np.searchsorted(t, edges[:-1] + guard).astype(np.int64)
        hi = np.searchsorted(t, edges[1:] - guard, side="right").astype(np.int64)
        return cls(np.ascontiguousarray(edges[:-1]), lo, np.maximum(hi, lo))

    @property
    def samples(self) -> int:
        """Samples used in all."""
        return int(np.sum(self.hi - self.lo))


@dataclass(frozen=True, slots=True)
class SeparateFit:
    """Half-cycles fitted apart, with shared sigma = zeta omega_n and omega = omega_d (rad/s).

    edges : (K+1,) s. c : (K,3) cosine and sine amplitude at the start of the half-cycle, and the centre (x only), in
    the
    channel's unit. inverse : (K,3,3) covariance of c per unit of variance, rates known. slope : (K,3,2) dc/d(sigma,
    omega). rates : (2,2) covariance of sigma and omega per unit of variance. variance : of the residual. freedom :
    degrees of freedom.
    """

    kind: Kind
    edges: FloatArray
    windows: Windows
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

    def basis(self, k: int, time: float) -> FloatArray:
        """Values at ``time`` of the three functions c multiplies, shape (3,)."""
        s = time - self.edges[k]
        e = math.exp(-self.sigma * s)
        centre = 1.0 if self.kind is Kind.DISPLACEMENT else 0.0
        return np.array([e * math.cos(self.omega * s), e * math.sin(self.omega * s), centre])

    def value(self, k: int, time: float) -> float:
        """The form of half-cycle k, continued to ``time``."""
        return float(self.basis(k, time) @ self.c[k])

    def stops(self, k: int) -> tuple[float, float]:
        """Times nearest to the two edges of half-cycle k at which its own form has speed zero, s."""
        c1, c2 = self.c[k, 0], self.c[k, 1]
        if self.kind is Kind.DISPLACEMENT:  # its derivative
            c1, c2 = -self.sigma * c1 + self.omega * c2, -self.sigma * c2 - self.omega * c1
        elif self.kind is Kind.ACCELERATION:  # its integral
            c1, c2 = -self.sigma * c1 - self.omega * c2, -self.sigma * c2 + self.omega * c1
        half = math.pi / self.omega
        first = math.atan2(-c1, c2) / self.omega  # c1 cos + c2 sin = 0
        if k == 0 and len(self) > 1:  # a record can begin in motion: the edge that is a reversal counts
            begin = first + half * (round((self.edges[1] - self.edges[0] - first) / half) - 1)
        else:
            begin = first - half * round(first / half)
        return float(self.edges[k] + begin), float(self.edges[k] + begin + half)

    @property
    def known(self) -> BoolArray:
        """Which half-cycles hold enough samples to be fitted, (K,)."""
        return np.asarray(self.inverse[:, 0, 0] > 0.0, dtype=np.bool_)


@dataclass(frozen=True, slots=True)
class _Point:
    """Sum of squares at one sigma and omega, and their normal equations with every amplitude eliminated."""

    squares: float
    information: FloatArray
    gradient: FloatArray

    def normal_equations(self) -> tuple[FloatArray, FloatArray]:
        """Of sigma and omega."""
        return self.information, self.gradient


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
    windows = Windows.of(t, edges, guard)
    count, size = edges.size - 1, 3 if kind is Kind.DISPLACEMENT else 2
    c, inverse, slope = np.zeros((count, 3)), np.zeros((count, 3, 3)), np.zeros((count, 3, 2))
    information, gradient = np.zeros((2, 2)), np.zeros(2)

    def evaluate(sigma: float, omega: float) -> float:
        return compiled_project(
            t, y, windows.start, windows.lo, windows.hi, sigma, omega, size, c, inverse, slope, information, gradient
        )

    def evaluated(at: FloatArray) -> _Point:
        possible = at[1] > 0.0 and abs(at[0]) < 3.0 * at[1]
        squares = evaluate(*at.tolist()) if possible else math.inf
        return _Point(squares, information.copy(), gradient.copy())

    sigma, omega = start
    if not fixed:
        until = Until(1e-28 * float(y @ y), 1e-10, 40)
        found = least_squares(evaluated, np.array(start), until, Bounds.of(2, longest=0.3 * omega))
        sigma, omega = found.coordinates.tolist()
    squares = evaluate(sigma, omega)
    freedom = max(windows.samples - (size * count + 2), 1)
    return SeparateFit(
        kind,
        edges,
        windows,
        guard,
        sigma,
        omega,
        c,
        inverse,
        slope,
        inverse_of(information),
        squares / freedom,
        freedom,
    )


def moved_edges(fit: SeparateFit, cycles: HalfCycles, t: FloatArray) -> FloatArray:
    """Reversal times (K+1,) from where the fitted forms have speed zero, each as far as it can be trusted."""
    edges, reach = fit.edges.copy(), 0.2 * math.pi / fit.omega
    stops = np.array([fit.stops(k) for k in range(len(fit))])
    strength = np.hypot(fit.c[:, 0], fit.c[:, 1])
    for k in range(1, edges.size - 1):
        weight = np.array([strength[k - 1], strength[k]]) ** 2
        if weight.sum() == 0.0:
            continue
        time = float(weight @ np.array([stops[k - 1, 1], stops[k, 0]]) / weight.sum())
        if abs(time - edges[k]) < reach:
            edges[k] = time
    for k, time, inside in ((0, stops[0, 0], stops[0, 0] > t[0]), (edges.size - 1, stops[-1, 1], stops[-1, 1] < t[-1])):
        if inside and abs(time - edges[k]) < reach:
            edges[k] = time
    return edges if np.all(np.diff(edges) > 0.0) else fit.edges


def with_variance(fit: SeparateFit, least: float) -> SeparateFit:
    """The same fit with a residual variance of at least ``least``."""
    return replace(fit, variance=max(fit.variance, least))
