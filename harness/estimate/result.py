"""What an estimator returns."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace

import numpy as np

from harness.core.arrays import FloatArray
from harness.core.quantity import Quantity
from harness.estimate.noise import Noise


@dataclass(frozen=True, slots=True)
class Reversal:
    """Figures of one reversal; None where the method does not see the figure.

    t : s. x : turning point X_i, m, from the rest position of the spring. a_before, a_after : m/s^2 on either side
    of the
    jump (Liang, eqs. 9 and 10). x_k : from this reversal alone (eq. 11, or eq. 6 for displacement), m. stderr : of x_k.
    zeta : from this reversal and its neighbours where the method has such a figure.
    """

    t: float
    x: float | None = None
    a_before: float | None = None
    a_after: float | None = None
    x_k: float | None = None
    stderr: float | None = None
    zeta: float | None = None

    def as_dict(self) -> dict[str, float | None]:
        """The names of the result file."""
        return {
            "t": self.t,
            "X": self.x,
            "a_before": self.a_before,
            "a_after": self.a_after,
            "x_k": self.x_k,
            "stderr": self.stderr,
            "zeta": self.zeta,
        }


@dataclass(frozen=True, slots=True)
class Estimate:
    """What one method reads from one recording.

    omega_n : rad/s. zeta : 1. x_k : m (or rad). reversals : how many the figures rest on.
    per_reversal : in order of time. guard : time left out on each side of a reversal, s, None for methods without one.
    lead : by how much friction reverses before the speed does, s (method acceleration on a smeared or early jump).
    notes : what the method assumed or met, one sentence each.
    """

    omega_n: Quantity
    zeta: Quantity
    x_k: Quantity
    reversals: int = 0
    per_reversal: tuple[Reversal, ...] = ()
    guard: float | None = None
    lead: Quantity | None = None
    notes: tuple[str, ...] = ()

    @classmethod
    def refused(cls, why: str, unit: str = "m") -> "Estimate":
        """No figures at all, with the reason."""
        return cls(Quantity.refused("rad/s", why), Quantity.refused("1", why), Quantity.refused(unit, why))


@dataclass(frozen=True, slots=True)
class Estimation:
    """What all methods read from one recording.

    methods : by the METHOD names of the result files, always all of them. sensor_phase : lead of the accelerometer
    before
    the displacement sensor, rad, already removed. lag : the same in s (0 when not known). noise : per channel.
    edges : times of release (or start), reversals and stop (or end), s; empty when there is no free decay.
    """

    methods: Mapping[str, Estimate]
    sensor_phase: Quantity
    lag: float = 0.0
    noise: Mapping[str, Noise] = field(default_factory=dict)
    edges: FloatArray = field(default_factory=lambda: np.empty(0))
    warnings: tuple[str, ...] = ()

    def floored(self, rounding: float, size: float) -> "Estimation":
        """With no standard error below what rounding leaves: of omega_n this share, of zeta so much, of x_k so much of
        a size (m): an amplitude.
        """
        least = {"omega_n": rounding, "zeta": rounding, "x_k": rounding * size}
        methods = {
            method: replace(
                one,
                omega_n=_at_least(one.omega_n, least["omega_n"] * abs(one.omega_n.value or 0.0)),
                zeta=_at_least(one.zeta, least["zeta"]),
                x_k=_at_least(one.x_k, least["x_k"]),
            )
            for method, one in self.methods.items()
        }
        return replace(self, methods=methods)

    def __getitem__(self, method: str) -> Estimate:
        return self.methods[method]


def _at_least(one: Quantity, error: float) -> Quantity:
    return one if one.stderr is None or one.stderr >= error else replace(one, stderr=error)


def quantity(value: float, stderr: float, unit: str) -> Quantity:
    """A figure with its standard error, or a refusal when the data do not fix it."""
    if not math.isfinite(value):
        return Quantity.refused(unit, "the data do not determine it")
    if not math.isfinite(stderr):
        return Quantity(value, None, unit, "its uncertainty could not be computed")
    return Quantity(float(value), float(stderr), unit)


def damped(omega_d: tuple[float, float], beta: tuple[float, float]) -> tuple[Quantity, Quantity]:
    """omega_n (rad/s) and zeta from the damped frequency and beta = zeta/sqrt(1 - zeta^2), each with its error."""
    root = math.sqrt(1.0 + beta[0] * beta[0])
    error = math.hypot(omega_d[1] * root, omega_d[0] * beta[0] / root * beta[1])
    return quantity(omega_d[0] * root, error, "rad/s"), quantity(beta[0] / root, beta[1] / root**3, "1")


def rates_to_modal(sigma: float, omega: float, covariance: FloatArray) -> tuple[float, float, float, float]:
    """omega_n, its standard error, zeta, its standard error from sigma = zeta omega_n, omega_d and their (2,2)
    covariance.
    """
    omega_n = math.hypot(sigma, omega)
    by_n = np.array([sigma, omega]) / omega_n
    by_z = np.array([omega * omega, -sigma * omega]) / omega_n**3
    return (
        omega_n,
        math.sqrt(max(float(by_n @ covariance @ by_n), 0.0)),
        sigma / omega_n,
        math.sqrt(max(float(by_z @ covariance @ by_z), 0.0)),
    )
