"""The slider in which something is hidden, and the scales to which strengths are relative."""

import math
from dataclasses import dataclass, replace

import numpy as np

from harness.core.arrays import FloatArray
from harness.proof.plant.model import Drive, Level, PlantModel, coulomb

MOST_SAMPLES = 6000


@dataclass(frozen=True, slots=True)
class Base:
    """A slider and how it is recorded.

    m : kg. omega_n : rad/s; on a free axis the frequency to which damping and strengths are relative.
    zeta : damping ratio. x_k : f_k/(m omega_n^2), m. x0, v0 : start, m and m/s. length : scale of the motion, m.
    duration : s. samples : number in the recording.
    """

    m: float
    omega_n: float
    zeta: float
    x_k: float
    x0: float
    v0: float
    length: float
    duration: float
    samples: int
    restoring: str = "spring"
    drive: Drive | None = None
    release: float = 0.0

    @property
    def k(self) -> float:
        """m omega_n^2, N/m; the spring unless the axis is free."""
        return self.m * self.omega_n**2

    @property
    def f_k(self) -> float:
        """Kinetic friction, N."""
        return self.k * self.x_k

    @property
    def speed(self) -> float:
        """Scale of the speed, m/s."""
        return self.length * self.omega_n

    @property
    def force(self) -> float:
        """Scale of the force, N."""
        return self.k * self.length

    @property
    def times(self) -> FloatArray:
        """Sampling times, s, shape (samples,)."""
        return np.linspace(0.0, self.duration, self.samples)

    def model(self) -> PlantModel:
        """The plant with nothing hidden in it."""
        return PlantModel(
            m=self.m,
            c=2.0 * self.zeta * self.m * self.omega_n,
            k=self.k if self.restoring != "none" else 0.0,
            friction=coulomb(Level(self.f_k, self.f_k)),
            x0=self.x0,
            v0=self.v0,
            restoring=self.restoring,
            drive=self.drive,
            release=self.release,
            length=self.length,
        )

    def moved(self, values: FloatArray) -> "Base":
        """The same with (omega_n or, on a free axis, m; zeta; x_k; x0; v0) replaced; damping and friction forces stay
        those of zeta and x_k."""
        first = {"m": float(values[0])} if self.restoring == "none" else {"omega_n": float(values[0])}
        rest = dict(zip(("zeta", "x_k", "x0", "v0"), (float(v) for v in values[1:]), strict=True))
        return replace(self, **first, **rest)  # type: ignore[arg-type]

    @property
    def values(self) -> FloatArray:
        """What ``moved`` replaces."""
        return np.array([self.m if self.restoring == "none" else self.omega_n, self.zeta, self.x_k, self.x0, self.v0])


def log_uniform(rng: np.random.Generator, low: float, high: float) -> float:
    return float(math.exp(rng.uniform(math.log(low), math.log(high))))


def draw_decay(
    rng: np.random.Generator, *, at_rest: bool, restoring: str = "spring", length: float | None = None
) -> Base:
    """A free decay that takes 5 to 20 periods to stick; the recording ends about there or somewhat after.

    at_rest : released from rest; else one in three starts with a speed.
    """
    n = 0
    while not 10 <= n <= 40:
        zeta, x_k = log_uniform(rng, 0.005, 0.045), log_uniform(rng, 0.008, 0.045)
        n = _half_cycles(zeta, x_k)
    omega_n = log_uniform(rng, 4.0, 150.0)
    size = log_uniform(rng, 0.004, 0.28) if length is None else length
    x0 = size * float(rng.choice([-1.0, 1.0]))
    v0 = 0.0
    if not at_rest and rng.random() < 1.0 / 3.0:
        angle = rng.uniform(0.0, 2.0 * math.pi)
        x0, v0 = size * math.cos(angle), -size * omega_n * math.sin(angle)
    periods = 0.5 * n * rng.uniform(0.92, 1.2)
    per_period = log_uniform(rng, 30.0, 350.0)
    samples = int(min(periods * per_period, MOST_SAMPLES))
    duration = periods * 2.0 * math.pi / omega_n
    return Base(1.0, omega_n, zeta, x_k * size, x0, v0, size, duration, samples, restoring)


def _half_cycles(zeta: float, x_k: float) -> int:
    """Of a decay from 1 until it sticks."""
    q = math.exp(-math.pi * zeta / math.sqrt(1.0 - zeta**2))
    x, n = 1.0, 0
    while x > x_k and n < 1000:
        x, n = q * x - (1.0 + q) * x_k, n + 1
    return n


def _multisine(
    rng: np.random.Generator, low: float, high: float, lines: int, size: float
) -> list[tuple[float, float, float]]:
    """Frequencies (rad/s), rising, amplitudes (squares add up to 2 size^2) and phases of a multisine."""
    omega = np.sort(np.exp(rng.uniform(math.log(low), math.log(high), lines)))
    amplitude = rng.uniform(0.5, 1.0, lines)
    amplitude = size * (amplitude * math.sqrt(2.0 / np.sum(amplitude**2)))
    phase = rng.uniform(0.0, 2.0 * math.pi, lines)
    return list(zip(omega.tolist(), amplitude.tolist(), phase.tolist(), strict=True))


def draw_driven(rng: np.random.Generator) -> Base:
    """A slider on its spring under a slow measured force, at rest at first: it sticks and breaks away many times."""
    omega_n, size = log_uniform(rng, 6.0, 60.0), log_uniform(rng, 0.01, 0.2)
    lines = _multisine(rng, 0.12 * omega_n, 0.4 * omega_n, int(rng.integers(2, 5)), omega_n**2 * size)
    zeta, x_k = log_uniform(rng, 0.02, 0.1), log_uniform(rng, 0.03, 0.12) * size
    # faded in over a period of the slider, so that the start is at rest without a blow
    fade = 2.0 * math.pi / omega_n

    def law(t: float, x: float, v: float) -> float:
        s = min(t / fade, 1.0)
        return s * s * (3.0 - 2.0 * s) * sum(b * math.cos(w * t + p) for w, b, p in lines)

    duration = rng.uniform(2.5, 4.0) * 2.0 * math.pi / lines[0][0]
    per_period = log_uniform(rng, 40.0, 160.0)
    samples = int(min(duration * omega_n / (2.0 * math.pi) * per_period, MOST_SAMPLES))
    return Base(1.0, omega_n, zeta, x_k, 0.0, 0.0, size, duration, samples, drive=Drive(law, rate=omega_n))


def draw_axis(rng: np.random.Generator, *, unit_mass: bool) -> Base:
    """A free axis in a position loop that follows a multisine; the force of the loop is what is measured."""
    m = 1.0 if unit_mass else log_uniform(rng, 0.5, 150.0)
    omega_n, size = log_uniform(rng, 3.0, 20.0), log_uniform(rng, 0.03, 0.3)
    lines = _multisine(rng, 0.25 * omega_n, omega_n, 4, size / 2.0)
    start = sum(b * math.cos(p) for _, b, p in lines)
    k_p, k_d = m * (4.0 * omega_n) ** 2, 2.0 * m * 4.0 * omega_n

    def law(t: float, x: float, v: float) -> float:
        r = sum(b * math.cos(w * t + p) for w, b, p in lines)
        r_rate = -sum(b * w * math.sin(w * t + p) for w, b, p in lines)
        return k_p * (r - x) + k_d * (r_rate - v)

    duration = rng.uniform(8.0, 14.0) * 2.0 * math.pi / omega_n
    samples = int(min(duration * omega_n / (2.0 * math.pi) * log_uniform(rng, 100.0, 300.0), MOST_SAMPLES))
    zeta, x_k = log_uniform(rng, 0.02, 0.2), log_uniform(rng, 0.03, 0.2) * size
    return Base(m, omega_n, zeta, x_k, start, 0.0, size, duration, samples, "none", Drive(law, rate=2.0 * omega_n))
