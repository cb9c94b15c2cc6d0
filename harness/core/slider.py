"""The slider: m x'' + c x' + k x + f(x') = u(t) with dry friction f."""

import math
from dataclasses import dataclass

from harness.core.checks import not_negative, positive
from harness.core.errors import InputError


@dataclass(frozen=True, slots=True)
class Slider:
    """One mass on a spring with viscous and dry friction, in SI units.

    Parameters
    ----------
    m : mass, kg. k : stiffness, N/m. c : viscous damping, N s/m.
    f_k : kinetic (sliding) friction force, N.
    f_s : break-away (static) friction force, N; ``f_k`` when not given.

    Raises InputError for m or k not above 0, c or f_k below 0, f_s below f_k, or anything not finite.
    Source: Liang, eq. 1 (with omega_n = sqrt(k/m); the paper prints k/m).
    """

    m: float
    c: float
    k: float
    f_k: float
    f_s: float | None = None

    def __post_init__(self) -> None:
        object.__setattr__(self, "m", positive("slider: m", self.m, "kg"))
        object.__setattr__(self, "k", positive("slider: k", self.k, "N/m"))
        object.__setattr__(self, "c", not_negative("slider: c", self.c, "N s/m"))
        object.__setattr__(self, "f_k", not_negative("slider: f_k", self.f_k, "N"))
        f_s = self.f_k if self.f_s is None else not_negative("slider: f_s", self.f_s, "N")
        if f_s < self.f_k:
            raise InputError("slider: f_s", f"{f_s:g} N, below f_k = {self.f_k:g} N", "f_s >= f_k")
        object.__setattr__(self, "f_s", f_s)

    @property
    def break_away(self) -> float:
        """Break-away force f_s in N, never None."""
        return self.f_k if self.f_s is None else self.f_s

    @property
    def omega_n(self) -> float:
        """Undamped natural frequency sqrt(k/m), rad/s."""
        return math.sqrt(self.k / self.m)

    @property
    def zeta(self) -> float:
        """Damping ratio c / (2 sqrt(k m))."""
        return self.c / (2.0 * math.sqrt(self.k * self.m))

    @property
    def x_k(self) -> float:
        """Kinetic friction as a displacement f_k/k, m."""
        return self.f_k / self.k

    @property
    def x_s(self) -> float:
        """Break-away friction as a displacement f_s/k, m."""
        return self.break_away / self.k

    @property
    def omega_d(self) -> float:
        """Damped natural frequency, rad/s; nan when the slider is not underdamped."""
        z = self.zeta
        return self.omega_n * math.sqrt((1.0 - z) * (1.0 + z)) if z < 1.0 else math.nan

    @property
    def beta(self) -> float:
        """zeta / sqrt(1 - zeta^2); inf when the slider is not underdamped."""
        z = self.zeta
        return z / math.sqrt((1.0 - z) * (1.0 + z)) if z < 1.0 else math.inf

    @property
    def q(self) -> float:
        """Amplitude ratio of successive half-cycles about their own centre, exp(-beta pi)."""
        return math.exp(-self.beta * math.pi)


PAPER = Slider(m=1.0, c=1.0, k=100.0, f_k=3.0)
"""The numerical example of the paper, section 3 (released from x = 1 m at rest)."""

EXPERIMENT = Slider(m=2.42, c=4.79, k=2310.0, f_k=0.351)
"""The experimental system of the paper, section 4 (Fig. 6)."""
