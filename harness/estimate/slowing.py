"""Damping and dry friction of what slows down or is held at speeds, under each assumption by itself.

Of m v' = -f_k - c v dry friction alone leaves a straight line of the speed, damping alone an exponential; of a table of
steady speeds dry friction is a step at rest, damping a slope. Each is fitted, and both together.
"""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np

from harness.core.arrays import FloatArray
from harness.estimate.noise import Noise
from harness.fit.least_squares import covariance_of
from harness.fit.series import memory

METHODS = {"linear": ("f_k",), "exponential": ("c",), "both": ("c", "f_k")}
"""What each fits; the other is taken to be nought."""
_SHARES, _MOST = (0.5, 0.1, 0.9), 60
"""Of the speed lost that starts give to the first, and how often a fit is looked at."""
_SMALL = 1e-5
"""Of damping times time, below which its series says as much."""


@dataclass(frozen=True, slots=True)
class Slowing:
    """values, errors : of c (1/s per unit mass, or N s/m) and f_k that a method fits. chi2 : a point, of the noise.

    shown : by channel, what it makes of the recording (n,).
    """

    values: Mapping[str, float]
    errors: Mapping[str, float]
    chi2: float
    shown: Mapping[str, FloatArray]


def run_down(t: FloatArray, v0: float, c: float, f: float) -> tuple[FloatArray, FloatArray]:
    """Way and speed at t (n,), s since the speed v0 > 0, of v' = -f - c v until it stands; c, f >= 0."""
    ends = math.inf if f <= 0.0 else v0 / f if c * v0 < _SMALL * f else math.log1p(c * v0 / f) / c
    s = np.minimum(t, ends)
    e = c * s
    series = e < _SMALL
    safe = np.where(series, 1.0, e)
    one = s * np.where(series, 1.0 - 0.5 * e, -np.expm1(-safe) / safe)
    two = s**2 * np.where(series, 0.5 - e / 6.0, (safe + np.expm1(-safe)) / safe**2)
    return v0 * one - f * two, np.where(t < ends, v0 * np.exp(-e) - f * one, 0.0)


def of_run_down(t: FloatArray, channels: Mapping[str, FloatArray], noise: Mapping[str, Noise]) -> dict[str, Slowing]:
    """Each method on x, v or both (n,) at t (n,), s; c and f_k per unit mass, in the motion's own direction."""
    s = t - t[0]
    if "v" in channels:
        edge = max(t.size // 30, 1)
        first, last = float(np.median(channels["v"][:edge])), float(np.median(channels["v"][-edge:]))
    else:
        x = channels["x"]
        first, last = ((x[j] - x[i]) / (t[j] - t[i]) for i, j in ((0, t.size // 16), (-t.size // 16, -1)))
    way = math.copysign(1.0, first)
    v0, lost = abs(first), max(abs(first) - abs(last), 1e-3 * abs(first))
    # what it loses is given to both in several shares
    rate = {"c": 2.0 * lost / v0 / s[-1], "f_k": lost / s[-1]}
    begin = {
        method: [[share * rate[names[0]], *((1.0 - share) * rate[name] for name in names[1:])] for share in _SHARES]
        for method, names in METHODS.items()
    }

    def shown(at: FloatArray, names: tuple[str, ...]) -> dict[str, FloatArray]:
        given = {"c": 0.0, "f_k": 0.0, **dict(zip(names, at[2:].tolist(), strict=True))}
        x, v = run_down(s, float(at[1]), given["c"], given["f_k"])
        return {c: at[0] + way * x if c == "x" else way * v for c in channels}

    return {
        method: _fitted(
            channels, noise, partial(shown, names=names), names, [(_first(channels), v0, *at) for at in begin[method]]
        )
        for method, names in METHODS.items()
    }


def _first(channels: Mapping[str, FloatArray]) -> float:
    return float(channels["x"][0]) if "x" in channels else 0.0


def of_curve(v: FloatArray, u: FloatArray, noise: Noise) -> dict[str, Slowing]:
    """Each method on forces u (n,), N, at speeds v (n,), m/s, none of them at rest."""
    columns = {"c": v, "f_k": np.sign(v)}

    def shown(at: FloatArray, names: tuple[str, ...]) -> dict[str, FloatArray]:
        return {"u": np.column_stack([columns[name] for name in names]) @ at[2:]}

    most = float(np.max(np.abs(u)))
    start = {"c": 0.5 * most / float(np.max(np.abs(v))), "f_k": 0.5 * most}
    return {
        method: _fitted({"u": u}, {"u": noise}, partial(shown, names=names), names,
                        [(0.0, 0.0, *(start[name] for name in names))])
        for method, names in METHODS.items()
    }  # fmt: skip


def _fitted(
    channels: Mapping[str, FloatArray],
    noise: Mapping[str, Noise],
    shown: Callable[[FloatArray], dict[str, FloatArray]],
    names: tuple[str, ...],
    starts: Sequence[tuple[float, ...]],
) -> Slowing:
    """Least squares from the best of several starts: place, speed, and what is named.

    Errors allow for a misfit and its memory.
    """

    from scipy.optimize import least_squares  # where it is needed: it is slow to import

    def residual(at: FloatArray) -> FloatArray:
        found = shown(at)
        return np.concatenate([(y - found[c]) / noise[c].sigma for c, y in channels.items()])

    low = np.array([-np.inf, 0.0, *(0.0 for _ in names)])
    tries = []
    for start in starts:
        size = np.maximum(np.abs(start), 1e-9 + 1e-6 * max(map(abs, start)))
        tries.append(least_squares(residual, np.array(start), bounds=(low, np.inf), x_scale=size, max_nfev=_MOST))
    found = min(tries, key=lambda one: float(one.cost))
    left, freedom = found.fun, max(found.fun.size - len(starts[0]), 1)
    chi2 = float(left @ left) / freedom
    parts = np.split(left, np.cumsum([y.size for y in channels.values()])[:-1])
    longest = max(memory(part).time for part in parts)
    covariance = covariance_of(found.jac) * max(chi2, 1.0) * longest
    errors = np.sqrt(np.diag(covariance))[2:]
    values = dict(zip(names, found.x[2:].tolist(), strict=True))
    return Slowing(values, dict(zip(names, errors.tolist(), strict=True)), chi2, shown(found.x))
