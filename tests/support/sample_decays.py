"""Decays that the tests of the estimators share, and the Cramer-Rao bound of the model they come from."""

import math
from dataclasses import dataclass

import numpy as np

from harness.core.arrays import FloatArray
from harness.exact.decay import Decay, free_decay


def half_cycles(decay: Decay) -> int:
    """Half-cycles until it sticks, at most 400 (Liang, eq. 6)."""
    q = math.exp(-math.pi * decay.zeta / math.sqrt(1.0 - decay.zeta**2))
    size, count = abs(decay.x0), 0
    while size > decay.x_k and count < 400:
        size = q * size - (1.0 + q) * decay.x_k
        count += 1
    return count


def half_time(decay: Decay) -> float:
    return math.pi / (decay.omega_n * math.sqrt(1.0 - decay.zeta**2))


def _acceleration(t: FloatArray, p: FloatArray) -> FloatArray:
    """a of a decay whose release is at p[4], dealt to half-cycles by p itself, written afresh from eqs. 3, 5 and 6."""
    omega_n, zeta, x_k, start, begin = p
    omega, beta = omega_n * math.sqrt(1.0 - zeta**2), zeta / math.sqrt(1.0 - zeta**2)
    k = np.floor((t - begin) * omega / math.pi).astype(int)
    turning = [start]
    for _ in range(int(k.max()) + 1):
        turning.append(
            -math.exp(-beta * math.pi) * turning[-1] + (1 + math.exp(-beta * math.pi)) * x_k * np.sign(turning[-1])
        )
    size = np.array(turning)[k]
    s = t - begin - k * math.pi / omega
    swing = size - np.sign(size) * x_k
    form = np.cos(omega * s) - beta * np.sin(omega * s)
    return np.asarray(-(omega_n**2) * swing * np.exp(-zeta * omega_n * s) * form, dtype=np.float64)


def cramer_rao(decay: Decay, t: FloatArray, sigma: float) -> FloatArray:
    """Least standard errors of (omega_n, zeta, x_k) from a at t with white noise sigma; X_0 and t_0 unknown too.

    Central differences of the closed form; samples at a reversal itself (within 1e-6 of a half-cycle) are left out.
    """
    p = np.array([decay.omega_n, decay.zeta, decay.x_k, decay.x0, 0.0])
    step = np.array([1e-7 * decay.omega_n, 1e-7, 1e-7 * abs(decay.x0), 1e-7 * abs(decay.x0), 1e-7 * half_time(decay)])
    place = t / half_time(decay)
    inside = (place < half_cycles(decay)) & (np.abs(place - np.round(place)) > 1e-4 * (1.0 + place))
    slope = np.stack(
        [(_acceleration(t[inside], p + e) - _acceleration(t[inside], p - e)) / (2.0 * e.max()) for e in np.diag(step)],
        axis=1,
    )
    scale = np.linalg.norm(slope, axis=0)
    covariance = np.linalg.inv((slope / scale).T @ (slope / scale)) / np.outer(scale, scale) * sigma**2
    return np.asarray(np.sqrt(np.diag(covariance)[:3]), dtype=np.float64)


@dataclass(frozen=True)
class Draw:
    """One random recording: the decay, its samples of a, their noise, and the bound of (omega_n, zeta, x_k)."""

    decay: Decay
    t: FloatArray
    a: FloatArray
    sigma: float
    bound: FloatArray


def draw(rng: np.random.Generator) -> Draw:
    """Four half-cycles or more, 40 to 400 samples a period, x_k at least three standard errors of the bound."""
    while True:
        omega_n, zeta = math.exp(rng.uniform(math.log(2.0), math.log(60.0))), rng.uniform(0.0, 0.15)
        decay = Decay(omega_n, zeta, math.exp(rng.uniform(math.log(1e-3), math.log(0.12))), rng.choice([-1.0, 1.0]))
        count = half_cycles(decay)
        if count < 4:
            continue
        shown = min(count, int(rng.integers(4, 41))) * rng.choice([1.0, rng.uniform(1.0, 2.0)])
        interval = 2.0 * half_time(decay) / math.exp(rng.uniform(math.log(40.0), math.log(400.0)))
        t = np.arange(0.0, shown * half_time(decay), interval)
        unit = cramer_rao(decay, t, 1.0)
        sigma = decay.x_k / 3.0 / unit[2] * 10.0 ** rng.uniform(-3.0, 0.0)
        a = free_decay(decay, t).a + sigma * rng.standard_normal(t.size)
        return Draw(decay, t, a, sigma, unit * sigma)
