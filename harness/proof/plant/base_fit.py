"""The plant side's own viscous + Coulomb fit, to see that an effect is concealed and decidable.

A decay on a spring is followed half-cycle by half-cycle from its turning points; the fit is SciPy's.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from scipy.optimize import least_squares

from harness.core.arrays import FloatArray

MOST_HALF_CYCLES = 400
_NONE = 1e-14
"""Share of the swing's speed below which a speed is none."""
WHOLE, COARSE, FINE = (1.0,), (0.35, 0.7, 1.0), (0.15, 0.3, 0.45, 0.6, 0.75, 0.9, 1.0)
"""Parts of a recording over which a fit grows."""


@dataclass(frozen=True, slots=True)
class BaseFit:
    """A fit: parameters (omega_n, zeta, x_k, x0, v0) or those of the caller, chi-square, R^2 of each channel."""

    parameters: FloatArray
    chi2: float
    r2: dict[str, float]


def decay(
    t: FloatArray, omega_n: float, zeta: float, x_k: float, x0: float, v0: float
) -> tuple[FloatArray, FloatArray]:
    """x (m) and a (m/s^2), shape (n,), of a unit mass on a spring with viscous and Coulomb friction, 0 <= zeta < 1."""
    x, _, a = decay_motion(t, omega_n, zeta, x_k, x0, v0)
    return x, a


def decay_motion(
    t: FloatArray, omega_n: float, zeta: float, x_k: float, x0: float, v0: float
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """x (m), v (m/s) and a (m/s^2) of the same motion."""
    zeta, x_k = min(abs(zeta), 0.99), abs(x_k)
    omega_d, sigma = omega_n * math.sqrt(1.0 - zeta * zeta), zeta * omega_n
    start, amplitude, phase, centre = [], [], [], []
    # a speed that is none to rounding has turned already
    at, x, v = 0.0, x0, v0 if abs(v0) > _NONE * omega_n * (abs(x0) + x_k) else 0.0
    rest = math.inf
    for _ in range(MOST_HALF_CYCLES):
        if v == 0.0 and abs(x) <= x_k:
            rest = at
            break
        d = math.copysign(1.0, v) if v != 0.0 else -math.copysign(1.0, x)
        c = -d * x_k
        # x - c = A exp(-sigma s) cos(omega_d s + p) from here to the next v = 0
        p = math.atan2(-(v + sigma * (x - c)) / omega_d, x - c)
        big = math.hypot(x - c, (v + sigma * (x - c)) / omega_d)
        start.append(at)
        amplitude.append(big)
        phase.append(p)
        centre.append(c)
        # v = 0 where tan(omega_d s + p) = -sigma/omega_d, the first with s > 0
        turn = (-math.atan2(sigma, omega_d) - p) % math.pi
        if v == 0.0 and turn < 1e-3:
            turn += math.pi
        lasts = turn / omega_d
        x = c + big * math.exp(-sigma * lasts) * math.cos(turn + p)
        v = 0.0
        at += lasts
        if at > t[-1]:
            break
    if not start:
        return np.full(t.size, x0), np.zeros(t.size), np.zeros(t.size)
    begun = np.asarray(start)
    i = np.clip(np.searchsorted(begun, t, side="right") - 1, 0, begun.size - 1)
    s = t - begun[i]
    angle = omega_d * s + np.asarray(phase)[i]
    swing = np.asarray(amplitude)[i] * np.exp(-sigma * s)
    y = swing * np.cos(angle)
    y_rate = -sigma * y - omega_d * swing * np.sin(angle)
    position = y + np.asarray(centre)[i]
    acceleration = -(omega_n**2) * y - 2.0 * sigma * y_rate
    still = t >= rest
    position[still], y_rate[still], acceleration[still] = x, 0.0, 0.0
    return position, y_rate, acceleration


def whiten(residual: FloatArray, sigma: float, correlation: float) -> FloatArray:
    """Residual over its noise; for first-order correlated noise the innovations over theirs."""
    if correlation == 0.0:
        return residual / sigma
    innovation = residual.copy()
    innovation[1:] -= correlation * residual[:-1]
    innovation[1:] /= math.sqrt(1.0 - correlation**2)
    return innovation / sigma


def r_squared(seen: FloatArray, said: FloatArray) -> float:
    """Coefficient of determination of one channel."""
    return 1.0 - float(np.sum((seen - said) ** 2) / np.sum((seen - seen.mean()) ** 2))


def fit_decay(
    t: FloatArray,
    seen: Mapping[str, FloatArray],
    noise: Mapping[str, float],
    start: tuple[float, float, float, float, float],
    correlation: float = 0.0,
) -> BaseFit:
    """Best base fit of the channels "x" and "a" in ``seen``, started at the truth and beside it."""
    scale = np.array(
        [start[0], max(start[1], 1e-3), max(start[2], 1e-4 * abs(start[3])), abs(start[3]), abs(start[3]) * start[0]]
    )

    def residual(z: FloatArray, n: int) -> FloatArray:
        x, a = decay(t[:n], *(np.append(z, np.zeros(5 - z.size)) * scale))
        said = {"x": x, "a": a}
        return np.concatenate([whiten(seen[c][:n] - said[c], noise[c], correlation) for c in seen])

    best: tuple[float, FloatArray] | None = None
    # from rest, v0 = 0 is held once: a speed of the wrong sign turns friction round at the first sample, a step in the
    # error. The first part alone knows nothing of sticking, where the error is not smooth in x_k: then it comes first
    # and how the parts grow decides which minimum is met
    for parts, held in ((WHOLE, start[4] == 0.0), (COARSE, False), (FINE, False)):
        z = (np.asarray(start) / scale)[: 4 if held else 5]
        for part in parts:
            n = max(50, int(part * t.size))
            z = least_squares(residual, z, method="lm", args=(n,), max_nfev=60).x
        z = np.append(z, np.zeros(5 - z.size))
        chi2 = float(np.sum(residual(z, t.size) ** 2))
        if best is None or chi2 < best[0]:
            best = (chi2, z)
    assert best is not None
    x, a = decay(t, *(best[1] * scale))
    said = {"x": x, "a": a}
    return BaseFit(best[1] * scale, best[0], {c: r_squared(seen[c], said[c]) for c in seen})
