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
from harness.core.jit import compiled
from harness.proof.machines.rigs import Rig
from harness.proof.plant.base_fit import decay_motion, descend, differences
from harness.proof.plant.integrate import PlantRun

STEPS = 64
"""A period of small swings."""
MOST_STEPS = 2_000_000
"""Beyond which a fit has gone astray."""
_HALVINGS = 45


def swing(
    t: FloatArray, omega_n: float, zeta: float, x_k: float, x0: float, v0: float
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """x (rad), v (rad/s), a (rad/s^2), shape (n,), of x'' + 2 zeta omega_n x' + omega_n^2 (sin x + x_k sgn x') = 0.

    t : s, shape (n,), increasing; x0, v0 at t = 0. Raises SimulationError beyond ``MOST_STEPS``.
    """
    c, w2 = 2.0 * abs(zeta) * omega_n, omega_n**2
    longest, end = 2.0 * math.pi / (abs(omega_n) * STEPS), float(t[-1])
    # no swing has more reversals than twice the periods of the smallest ones
    steps = (1.0 + 4.0 / STEPS) * end / longest
    if not steps < MOST_STEPS:
        raise SimulationError(f"machines: a pendulum of {abs(omega_n):.3g} rad/s over {end:.3g} s")
    room = np.empty((4, int(steps) + 8))
    count = _knots(end, c, w2, w2 * abs(x_k), x0, v0, longest, room)
    at, x, v, f = room[:, :count]
    i = np.clip(np.searchsorted(at, t, side="right") - 1, 0, count - 2)
    h = at[i + 1] - at[i]
    s = (t - at[i]) / h
    r = 1.0 - s
    place = r**2 * ((1.0 + 2.0 * s) * x[i] + s * h * v[i]) + s**2 * ((1.0 + 2.0 * r) * x[i + 1] - r * h * v[i + 1])
    speed = 6.0 * s * r * (x[i + 1] - x[i]) / h + r * (1.0 - 3.0 * s) * v[i] + s * (1.0 - 3.0 * r) * v[i + 1]
    still = (v[i] == 0.0) & (v[i + 1] == 0.0)
    return place, speed, np.where(still, 0.0, -c * speed - w2 * np.sin(place) - f[i])


@compiled
def _step(x: float, v: float, f: float, h: float, c: float, w2: float) -> tuple[float, float, float]:
    """x and v after h, and the acceleration at its start, friction f held."""
    half = 0.5 * h
    a1 = -c * v - w2 * math.sin(x) - f
    v2 = v + half * a1
    a2 = -c * v2 - w2 * math.sin(x + half * v) - f
    v3 = v + half * a2
    a3 = -c * v3 - w2 * math.sin(x + half * v2) - f
    v4 = v + h * a3
    a4 = -c * v4 - w2 * math.sin(x + h * v3) - f
    return x + h * (v + 2.0 * (v2 + v3) + v4) / 6.0, v + h * (a1 + 2.0 * (a2 + a3) + a4) / 6.0, a1


@compiled
def _zero(v: float, new_v: float, rise: float, new_rise: float) -> float:
    """Where the cubic through values and slopes of both ends is zero, as a share of the step."""
    lo, hi = 0.0, 1.0
    for _ in range(_HALVINGS):
        s = 0.5 * (lo + hi)
        r = 1.0 - s
        value = r * r * ((1.0 + 2.0 * s) * v + s * rise) + s * s * ((1.0 + 2.0 * r) * new_v - r * new_rise)
        if (value > 0.0) == (v > 0.0):
            lo = s
        else:
            hi = s
    return hi


@compiled
def _knots(
    end: float, c: float, w2: float, level: float, x0: float, v0: float, longest: float, room: FloatArray
) -> int:
    """Fill ``room`` (t, x, v, friction from there on) with steps up to ``end`` (s); how many."""
    at, x, v, count = 0.0, x0, v0, 0
    while count < room.shape[1] - 2:
        resting = v == 0.0 and w2 * abs(math.sin(x)) <= level
        d = math.copysign(1.0, v) if v != 0.0 else -math.copysign(1.0, math.sin(x))
        f = 0.0 if resting else level * d
        room[0, count], room[1, count], room[2, count], room[3, count] = at, x, v, f
        count += 1
        if resting:
            room[0, count], room[1, count], room[2, count], room[3, count] = max(end, at) + longest, x, 0.0, 0.0
            return count + 1
        if at > end:
            return count
        h = longest
        new_x, new_v, rise = _step(x, v, f, h, c, w2)
        if new_v * d < 0.0 and v != 0.0:
            h *= _zero(v, new_v, h * rise, h * (-c * new_v - w2 * math.sin(new_x) - f))
            new_x, new_v, rise = _step(x, v, f, h, c, w2)
            new_v = 0.0
        at, x, v = at + h, new_x, new_v
    room[0, count], room[1, count], room[2, count], room[3, count] = max(end, at) + longest, x, v, 0.0
    return count + 1


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
