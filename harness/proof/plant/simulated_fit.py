"""Fits through the plant itself: for recordings the closed form of the base does not cover, and for models that hold
one of two hidden effects. Started at the truth."""

import math
from collections.abc import Mapping
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np
from scipy.interpolate import PPoly, make_interp_spline

from harness.core.arrays import FloatArray
from harness.core.errors import SimulationError
from harness.proof.plant.base import Base
from harness.proof.plant.base_fit import BaseFit, r_squared, whiten
from harness.proof.plant.descent import descend
from harness.proof.plant.hidden import build
from harness.proof.plant.integrate import simulate
from harness.proof.plant.pieces import Drive

FIT_TOLERANCE = 1e-7
STEP = 1e-4
ITERATIONS = 30
PART = 0.4
"""Share of a recording over which the second of two fits begins."""

FAR = 1e6
"""Residual of parameters that are not worth a simulation."""


quick = partial(simulate, tolerance=FIT_TOLERANCE)


def replayed(t: FloatArray, u: FloatArray, rate: float) -> Drive:
    """The recorded force as a function of time: a cubic spline through its samples."""
    spline = PPoly.from_spline(make_interp_spline(t, u, k=3))
    pieces: list[tuple[float, float, float, float]] = spline.c.T.tolist()
    edges, step = spline.x, float(t[1] - t[0])
    at: list[float] = edges.tolist()
    first, last = at[3], len(pieces) - 1

    def law(now: float, x: float, v: float) -> float:
        i = min(max(3 + int((now - first) / step), 3), last)
        # the knots of a not-a-knot spline are not evenly spaced at its ends
        while i > 0 and now < at[i]:
            i -= 1
        while i < last and now >= at[i + 1]:
            i += 1
        a, b, c, d = pieces[i]
        s = now - at[i]
        return ((a * s + b) * s + c) * s + d

    return Drive(law, rate=rate)


def fit_simulated(
    base: Base,
    effects: Mapping[str, Mapping[str, Any]],
    seen: Mapping[str, FloatArray],
    noise: Mapping[str, float],
    correlation: float = 0.0,
    u: FloatArray | None = None,
    bounds: tuple[float, float] = (-math.inf, math.inf),
    least_r2: float = -math.inf,
) -> BaseFit:
    """Best fit of base parameters, start and the numbers in ``effects`` to the channels x, a in ``seen``.

    u : the recorded force, replayed; needed when the drive closes a loop over the true motion.
    bounds : chi-square below which the recording is of no use, and chi-square beyond all doubt about that: only between
    them is a second fit worth it. least_r2 : R^2 of a channel below which the recording is of no use either.
    """
    t = base.times
    if u is not None and base.drive is not None:
        base = replace(base, drive=replayed(t, u, base.drive.rate))
    free = [(name, key) for name, p in effects.items() for key, v in p.items() if isinstance(v, float) and v != 0.0]
    start = np.concatenate([base.values, [effects[name][key] for name, key in free]])
    scale = np.abs(start)
    scale[:5] = np.maximum(scale[:5], [0.0, 1e-3, 1e-4 * base.length, base.length, base.speed])
    order = np.append(np.delete(np.arange(start.size), 4), 4)

    # how far the first parameter, damping and friction, the start, and the numbers of the effects may go from the truth
    reach = np.array([0.3, 30.0, 30.0, 1.0, *[0.9] * len(free), 1.0])

    def parameters(z: FloatArray) -> FloatArray:
        p = start.copy()
        # the start speed stands last in z and is left out where it is held
        p[order[: z.size]] += z * scale[order[: z.size]]
        p[1:3] = np.abs(p[1:3])
        return p

    def predicted(z: FloatArray, n: int) -> dict[str, FloatArray]:
        p = parameters(z)
        changed = {name: dict(values) for name, values in effects.items()}
        for (name, key), value in zip(free, p[5:], strict=True):
            changed[name][key] = float(value)
        model, sensors = build(base.moved(p[:5]), changed)
        return sensors.read(model, t[:n], quick)[1]

    def residual(z: FloatArray, n: int) -> FloatArray:
        if np.any(np.abs(z) > reach[: z.size]):
            return np.full(n * len(seen), FAR)
        try:
            said = predicted(z, n)
        except (SimulationError, ArithmeticError, ValueError):
            # a step into parameters that no plant can have
            return np.full(n * len(seen), FAR)
        return np.concatenate([whiten(seen[c][:n] - said[c], noise[c], correlation) for c in seen])

    # as for the closed form: from the truth at once, and over growing parts, which knows nothing of sticking at first;
    # v0 = 0 is held in the one, as its sign turns friction round, and in both where the slider is stuck at first
    still = base.v0 == 0.0
    best = descend(lambda z: residual(z, t.size), np.zeros(start.size - still), STEP, ITERATIONS, bounds=bounds)
    held = still and base.drive is not None

    def fitted(z: FloatArray, chi2: float) -> BaseFit:
        said = predicted(z, t.size)
        return BaseFit(parameters(z), chi2, {c: r_squared(seen[c], said[c]) for c in seen})

    found = fitted(best.z, best.chi2)
    if not bounds[0] < best.chi2 < bounds[1] or min(found.r2.values()) < least_r2:
        return found
    n = max(50, int(PART * t.size))
    z = descend(lambda z: residual(z, n), np.zeros(start.size - held), STEP, ITERATIONS).z
    other = descend(lambda z: residual(z, t.size), z, STEP, ITERATIONS, bounds=bounds)
    return found if best.chi2 <= other.chi2 else fitted(other.z, other.chi2)
