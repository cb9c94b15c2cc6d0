"""Each half-cycle by itself: the damped form with a free amplitude and phase, rate and frequency shared by all.

Inside a half-cycle the base model is linear, so a and v are exp(-sigma s)(c1 cos omega s + c2 sin omega s), with
sigma = zeta omega_n, omega = omega_d, and x is that about a centre of its own. c is eliminated half-cycle by half-cycle
(variable projection), so that the cost is linear in the samples whatever their number.

Kernel: the amplitudes of every half-cycle, and what they leave for the decay rate and the frequency.
"""

import math
from dataclasses import dataclass, replace

import numpy as np

from harness.core.arrays import BoolArray, FloatArray, IntArray
from harness.core.jit import compiled
from harness.estimate.reversals import HalfCycles, Kind
from harness.fit.covariance import inverse_of
from harness.fit.least_squares import Bounds, Until, least_squares

_LINEAR = 3  # c1, c2 and the centre


def _solve(gram: FloatArray, size: int, inverse: FloatArray) -> None:
    """Inverse of the leading ``size`` block of a symmetric positive matrix, scaled to a unit diagonal first."""
    for i in range(_LINEAR):
        for j in range(_LINEAR):
            inverse[i, j] = 0.0
    scale = np.ones(_LINEAR)
    for i in range(size):
        scale[i] = 1.0 / math.sqrt(gram[i, i]) if gram[i, i] > 0.0 else 0.0
    a = scale[0] * scale[0] * gram[0, 0]
    b = scale[0] * scale[1] * gram[0, 1]
    d = scale[1] * scale[1] * gram[1, 1]
    if size == 2:
        det = a * d - b * b
        if det > 1e-14:
            inverse[0, 0], inverse[1, 1] = d / det * scale[0] ** 2, a / det * scale[1] ** 2
            inverse[0, 1] = inverse[1, 0] = -b / det * scale[0] * scale[1]
        return
    c = scale[0] * scale[2] * gram[0, 2]
    e = scale[1] * scale[2] * gram[1, 2]
    f = scale[2] * scale[2] * gram[2, 2]
    det = a * (d * f - e * e) - b * (b * f - c * e) + c * (b * e - c * d)
    if det > 1e-14:
        inverse[0, 0] = (d * f - e * e) / det
        inverse[1, 1] = (a * f - c * c) / det
        inverse[2, 2] = (a * d - b * b) / det
        inverse[0, 1] = inverse[1, 0] = (c * e - b * f) / det
        inverse[0, 2] = inverse[2, 0] = (b * e - c * d) / det
        inverse[1, 2] = inverse[2, 1] = (b * c - a * e) / det
        for i in range(3):
            for j in range(3):
                inverse[i, j] *= scale[i] * scale[j]


compiled_inverse = compiled(_solve)


def _times(matrix: FloatArray, column: FloatArray, out: FloatArray) -> None:
    """out (3,) = matrix (3, 3) times column (3,), written out: a library's sums are compiled much longer."""
    for i in range(_LINEAR):
        out[i] = matrix[i, 0] * column[0] + matrix[i, 1] * column[1] + matrix[i, 2] * column[2]


_compiled_times = compiled(_times)


def _normal_equations(
    t: FloatArray,
    y: FloatArray,
    start: float,
    lo: int,
    hi: int,
    sigma: float,
    omega: float,
    gram: FloatArray,
    right: FloatArray,
) -> None:
    """Products of the three basis functions with each other (3,3) and with y (3,), over samples lo to hi."""
    gram[:] = 0.0
    right[:] = 0.0
    for n in range(lo, hi):
        s = t[n] - start
        e = math.exp(-sigma * s)
        p, q = e * math.cos(omega * s), e * math.sin(omega * s)
        gram[0, 0] += p * p
        gram[0, 1] += p * q
        gram[1, 1] += q * q
        gram[0, 2] += p
        gram[1, 2] += q
        gram[2, 2] += 1.0
        right[0] += p * y[n]
        right[1] += q * y[n]
        right[2] += y[n]
    gram[1, 0], gram[2, 0], gram[2, 1] = gram[0, 1], gram[0, 2], gram[1, 2]


_compiled_equations = compiled(_normal_equations)


def _residual_products(
    t: FloatArray,
    y: FloatArray,
    start: float,
    lo: int,
    hi: int,
    sigma: float,
    omega: float,
    c: FloatArray,
    right: FloatArray,
    cross: FloatArray,
    rates: FloatArray,
    pull: FloatArray,
) -> float:
    """Sum of squares of the residual of amplitudes c (3,), and the products of it and of the basis with the slopes.

    right (3,): basis and residual. cross (3,2): basis and slopes by sigma and omega. rates (2,2): slopes among
    themselves. pull (2,): slopes and residual.
    """
    right[:] = 0.0
    cross[:] = 0.0
    rates[:] = 0.0
    pull[:] = 0.0
    squares = 0.0
    for n in range(lo, hi):
        s = t[n] - start
        e = math.exp(-sigma * s)
        p, q = e * math.cos(omega * s), e * math.sin(omega * s)
        r = y[n] - c[0] * p - c[1] * q - c[2]
        d0, d1 = -s * (c[0] * p + c[1] * q), s * (c[1] * p - c[0] * q)
        squares += r * r
        right[0] += p * r
        right[1] += q * r
        right[2] += r
        cross[0, 0] += p * d0
        cross[0, 1] += p * d1
        cross[1, 0] += q * d0
        cross[1, 1] += q * d1
        cross[2, 0] += d0
        cross[2, 1] += d1
        rates[0, 0] += d0 * d0
        rates[0, 1] += d0 * d1
        rates[1, 1] += d1 * d1
        pull[0] += d0 * r
        pull[1] += d1 * r
    rates[1, 0] = rates[0, 1]
    return squares


_compiled_products = compiled(_residual_products)


def _project(
    t: FloatArray,
    y: FloatArray,
    start: FloatArray,
    lo: IntArray,
    hi: IntArray,
    sigma: float,
    omega: float,
    size: int,
    c: FloatArray,
    inverse: FloatArray,
    slope: FloatArray,
    information: FloatArray,
    gradient: FloatArray,
) -> float:
    """Fit every half-cycle; return the sum of squares and, for sigma and omega, what is left of them after c.

    c (K,3), inverse (K,3,3): amplitudes and inverse normal matrices. slope (K,3,2): change of c with sigma and omega.
    information (2,2), gradient (2,): normal equations of sigma and omega with every c eliminated.
    """
    gram, right = np.empty((3, 3)), np.empty(3)
    cross, rates, pull = np.empty((3, 2)), np.empty((2, 2)), np.empty(2)
    step = np.empty(3)
    information[:] = 0.0
    gradient[:] = 0.0
    squares = 0.0
    for k in range(start.size):
        _compiled_equations(t, y, start[k], lo[k], hi[k], sigma, omega, gram, right)
        compiled_inverse(gram, size, inverse[k])
        _compiled_times(inverse[k], right, c[k])
        squares += _compiled_products(t, y, start[k], lo[k], hi[k], sigma, omega, c[k], right, cross, rates, pull)
        _compiled_times(inverse[k], right, step)  # what rounding left of it
        for i in range(_LINEAR):
            c[k, i] += step[i]
        for m in range(2):
            gradient[m] += pull[m]
            for i in range(_LINEAR):
                slope[k, i, m] = 0.0
                for j in range(_LINEAR):
                    slope[k, i, m] -= inverse[k, i, j] * cross[j, m]
                gradient[m] += right[i] * slope[k, i, m]
        for m in range(2):
            for j in range(2):
                information[m, j] += rates[m, j]
                for i in range(_LINEAR):
                    information[m, j] += cross[i, m] * slope[k, i, j]
    return squares


compiled_project = compiled(_project)


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
