"""What viscous and Coulomb friction leave of a recording: of the motion of a decay, of the force where one is measured.

A decay on a spring has the closed form of ``harness.proof.plant.base_fit``; a pendulum is stepped, since its period
depends on its swing. The zero is free unless it is known. What is left is noise-free: shares are of it.
"""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial

import numpy as np
from scipy.optimize import least_squares

from harness.core.arrays import FloatArray
from harness.core.errors import SimulationError
from harness.proof.machines.pendulum import swing
from harness.proof.machines.rigs import Rig
from harness.proof.plant.base_fit import decay_motion
from harness.proof.plant.descent import descend, differences
from harness.proof.plant.integrate import PlantRun

SETTLED = 0.12
"""Of a period: how long after the hand is gone the fit begins, so that the first speed has a sign."""
STEP, ITERATIONS = 1e-6, 20
FINE = 1e-4
"""Of a channel's size: residuals are counted in this, so that the descent ends where nothing is left to gain."""
PLAIN = 0.008
"""What a quick fit leaves, of a channel's size, from which it is done as thoroughly as any other."""
PARTS, FEWEST = (0.1, 0.2, 0.3, 0.5, 0.7), 30
"""Parts of the recording over which a fit grows, and least samples."""
OTHERWISE = (0.4, 2.0)
"""Factors on friction from which it is fitted once more."""
LEAST_SLIDING = 50
"""Samples in motion without which a driven recording says nothing."""

Left = Mapping[str, FloatArray]
Motion = Callable[[FloatArray, float, float, float, float, float], tuple[FloatArray, FloatArray, FloatArray]]


@dataclass(frozen=True, slots=True)
class BaseFit:
    """A base fit: what it leaves of each channel, shape (n,), and its partials there (n, p), in the channel's unit.

    parameters : (omega_n, zeta, x_k, x0, v0[, zero]) of a decay; (m, c, f_k[, k[, offset]]) of a force.
    """

    parameters: FloatArray
    left: Left
    slopes: Mapping[str, FloatArray]

    def mean_squares(self) -> dict[str, float]:
        """Mean square left of each channel."""
        return {c: float(np.mean(r**2)) for c, r in self.left.items()}


def fit_base(
    rig: Rig,
    run: PlantRun,
    clean: Mapping[str, FloatArray],
    weight: Mapping[str, float] | None = None,
    quick: bool = False,
) -> BaseFit:
    """The base fit of a noise-free recording.

    weight : of the channels of a decay; by their size when left out. quick : from one start, where that does well.
    """
    return fit_force(rig, run, clean) if rig.kind.driven else fit_motion(rig, clean, weight, quick)


def fit_motion(
    rig: Rig, clean: Mapping[str, FloatArray], weight: Mapping[str, float] | None = None, quick: bool = False
) -> BaseFit:
    """Of the free part of a decay; every channel counts by its weight or, without one, by its size."""
    base = rig.base
    after = rig.t >= rig.free_from + SETTLED * 2.0 * math.pi / base.omega_n
    t = rig.t[after] - rig.t[after][0]
    motion: Motion = swing if base.restoring == "pendulum" else decay_motion
    channels, seen = list(rig.channels), {c: clean[c][after] for c in rig.channels}
    fine = {c: FINE * rig.scale(c) for c in channels}
    if weight is not None:
        least = min(1.0 / (math.sqrt(weight[c]) * rig.scale(c)) for c in channels)
        fine = {c: FINE / (math.sqrt(weight[c]) * least) for c in channels}
    first = {c: float(clean[c][after][0]) for c in ("x", "v")}
    scale = np.array(
        [base.omega_n, max(base.zeta, 1e-3), max(base.x_k, 1e-3 * base.length), base.length, base.speed, base.length]
    )

    def said(z: FloatArray, n: int) -> dict[str, FloatArray]:
        p = z * scale[: z.size]
        x, v, a = motion(t[:n], *(float(one) for one in p[:5]))
        zero = float(p[5]) if z.size > 5 else 0.0
        return {"x": x + zero, "v": v, "a": a}

    def residual(z: FloatArray, n: int = t.size) -> FloatArray:
        now = said(z, n)
        return np.concatenate([(seen[c][:n] - now[c]) / fine[c] for c in channels])

    free_zero = not rig.told_zero and "x" in channels
    start = np.array([base.omega_n, base.zeta, base.x_k, first["x"], first["v"], 0.0]) / scale
    start = start if free_zero else start[:5]
    best = descend(residual, start, STEP, ITERATIONS)
    # far from the truth's parameters the phase may have been lost on the way, and where a decay ends the misfit is not
    # smooth in its friction
    if not quick or best.chi2 > t.size * len(channels) * (PLAIN / FINE) ** 2:
        z = start
        for part in PARTS:
            z = descend(partial(residual, n=max(int(part * t.size), FEWEST)), z, STEP, ITERATIONS).z
        others = [z] if quick else [z, *(best.z * np.where(np.arange(start.size) == 2, f, 1.0) for f in OTHERWISE)]
        best = min((best, *(descend(residual, z, STEP, ITERATIONS) for z in others)), key=lambda found: found.chi2)
    slopes = differences(residual, best.z, best.residual, STEP)
    unit = np.repeat([-fine[c] for c in channels], t.size)
    left = np.split(-unit * best.residual, len(channels))
    columns = np.split(unit[:, None] * slopes, len(channels))
    return BaseFit(
        best.z * scale[: best.z.size],
        dict(zip(channels, left, strict=True)),
        dict(zip(channels, columns, strict=True)),
    )


def fit_force(rig: Rig, run: PlantRun, clean: Mapping[str, FloatArray]) -> BaseFit:
    """Of the measured force: m a + c v + f_k sgn v (+ k x (+ offset)), with the motion that x tells.

    While it sticks, friction may be anything up to f_k: what is left is what lies beyond. An accelerometer beside it is
    held against the motion that x tells.
    """
    x, u = clean["x"], clean["u"]
    # what sensors add to the motion is smooth: its differences are good enough
    v = run.v + np.gradient(x - run.x, rig.t)
    a = run.a + np.gradient(v - run.v, rig.t)
    sliding = ~run.stuck
    columns = [a, v, np.where(sliding, np.sign(np.where(v == 0.0, a, v)), 0.0)]
    if rig.kind.restoring != "none":
        columns += [x] if rig.told_zero else [x, np.ones_like(x)]
    design = np.column_stack(columns)
    size = np.sqrt(np.mean(design**2, axis=0))
    if not size.all() or np.count_nonzero(sliding) < LEAST_SLIDING:
        raise SimulationError("machines: it hardly moves")

    def residual(z: FloatArray) -> FloatArray:
        r = u - design @ (z / size)
        level = abs(z[2]) / size[2]
        return np.asarray(np.where(sliding, r, r - np.clip(r, -level, level)))

    start = np.linalg.lstsq(design[sliding] / size, u[sliding], rcond=None)[0]
    found = least_squares(residual, start, method="lm", diff_step=STEP)
    left, slopes = {"u": found.fun}, {"u": found.jac}
    if "a" in rig.channels:
        left["a"], slopes["a"] = clean["a"] - a, np.zeros_like(found.jac)
    return BaseFit(found.x / size, left, slopes)
