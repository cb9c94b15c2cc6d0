"""The plant side's own viscous and Coulomb fits: is an effect concealed and decidable, and what part is it of a misfit?

Of a recording on a bench with its noise: ``fit_decay`` in closed form, ``fit_simulated`` otherwise. Of a machine, free
of noise, with what is left and its partials, since shares are measured on them: ``fit_motion``, ``fit_force``. A decay
on a spring has a closed form; a pendulum is stepped, since its period depends on its swing.
"""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from typing import Any

import numpy as np
from scipy.interpolate import PPoly, make_interp_spline
from scipy.optimize import least_squares

from harness.core.arrays import BoolArray, FloatArray
from harness.core.errors import SimulationError
from harness.proof.plant.base import Base
from harness.proof.plant.hidden import build
from harness.proof.plant.integrate import PlantRun, simulate
from harness.proof.plant.model import Drive
from harness.proof.plant.stepped import swing

Residual = Callable[[FloatArray], FloatArray]
Channels = Mapping[str, FloatArray]
"""By channel, shape (n,)."""
FIRST_DAMPING, MOST_DAMPING = 1e-4, 1e6
POOR = 0.25
"""Share of a promised gain below which partials that are not fresh are taken anew."""


@dataclass(frozen=True, slots=True)
class BaseFit:
    """A fit.

    parameters : (omega_n, zeta, x_k, x0, v0[, zero]) of a decay; (m, c, f_k[, k[, offset]]) of a force; or those of the
    caller. chi2 : of the noise, r2 : of each channel, on a bench. left : what it leaves of each channel, slopes : its
    partials there, shape (n, p), in the channel's unit, of a machine.
    """

    parameters: FloatArray
    chi2: float = math.nan
    r2: Mapping[str, float] = field(default_factory=dict)
    left: Channels = field(default_factory=dict)
    slopes: Channels = field(default_factory=dict)


@dataclass(frozen=True, slots=True)
class Descent:
    """Where a descent ended: z (q,), the residual there (N,), its partials (N, q) as last known, chi-square."""

    z: FloatArray
    residual: FloatArray
    slopes: FloatArray
    chi2: float


def differences(residual: Residual, z: FloatArray, here: FloatArray, step: float) -> FloatArray:
    """Partials (N, q) by forward differences."""
    return np.column_stack([(residual(z + step * e) - here) / step for e in np.eye(z.size)])


def descend(
    residual: Residual,
    z: FloatArray,
    step: float,
    iterations: int,
    bounds: tuple[float, float] = (-math.inf, math.inf),
) -> Descent:
    """Least squares from z; a step that promises less than half a unit of chi-square is the last.

    step : of the differences. bounds : chi-square below which there is no point in going on, and chi-square above which
    a tenth of what lies above is not worth a step.
    """
    enough, plenty = bounds
    here = residual(z)
    chi2 = float(here @ here)
    j, fresh = differences(residual, z, here, step), True
    damping = FIRST_DAMPING
    for _ in range(iterations):
        if chi2 < enough:
            break
        size = np.sqrt(np.einsum("ij,ij->j", j, j))
        size[size == 0.0] = 1.0
        scaled = j / size
        normal, gradient = scaled.T @ scaled, scaled.T @ here
        move = -np.linalg.lstsq(normal + damping * np.eye(z.size), gradient, rcond=1e-12)[0]
        promised = -float(2.0 * move @ gradient + move @ normal @ move)
        if promised < max(0.5, 0.1 * (chi2 - plenty)) or damping > MOST_DAMPING:
            if fresh or chi2 > plenty:
                break
            j, fresh, damping = differences(residual, z, here, step), True, FIRST_DAMPING
            continue
        shift = move / size
        # a step far astray ends in infinities, and is not taken
        with np.errstate(over="ignore", invalid="ignore"):
            there = residual(z + shift)
            new = float(there @ there)
        gained = (chi2 - new) / promised
        if gained > 0.0:
            j = j + np.outer((there - here - j @ shift) / float(shift @ shift), shift)
            z, here, chi2, fresh = z + shift, there, new, False
            damping *= 0.1 if gained > 0.75 else 1.0
        else:
            damping = max(10.0 * damping, 1e-3)
        if gained < POOR and not fresh:
            j, fresh = differences(residual, z, here, step), True
    return Descent(z, here, j, chi2)


MOST_HALF_CYCLES = 400
_NONE = 1e-14
"""Share of the swing's speed below which a speed is none."""


def decay_motion(
    t: FloatArray, omega_n: float, zeta: float, x_k: float, x0: float, v0: float
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """x (m), v (m/s) and a (m/s^2), shape (n,), of a unit mass on a spring with viscous and Coulomb friction.

    0 <= zeta < 1.
    """
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
    envelope = np.asarray(amplitude)[i] * np.exp(-sigma * s)
    y = envelope * np.cos(angle)
    y_rate = -sigma * y - omega_d * envelope * np.sin(angle)
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


@dataclass(frozen=True, slots=True)
class Seen:
    """The channels x, a of a recording, shape (n,), with the noise in them."""

    channels: Channels
    sigma: Mapping[str, float]
    correlation: float = 0.0

    def misses(self, said: Channels, n: int) -> FloatArray:
        """What a motion leaves of the first n samples, in units of the noise, shape (n channels,)."""
        seen = self.channels
        return np.concatenate([whiten(seen[c][:n] - said[c], self.sigma[c], self.correlation) for c in seen])

    def r2(self, said: Channels) -> dict[str, float]:
        return {
            c: 1.0 - float(np.sum((y - said[c]) ** 2) / np.sum((y - y.mean()) ** 2)) for c, y in self.channels.items()
        }


WHOLE, COARSE, FINE = (1.0,), (0.35, 0.7, 1.0), (0.15, 0.3, 0.45, 0.6, 0.75, 0.9, 1.0)
"""Parts of a recording over which a fit grows."""


def fit_decay(t: FloatArray, seen: Seen, start: Sequence[float]) -> BaseFit:
    """Best base fit in closed form; start : the truth (omega_n, zeta, x_k, x0, v0), from which and beside which."""
    scale = np.array(
        [start[0], max(start[1], 1e-3), max(start[2], 1e-4 * abs(start[3])), abs(start[3]), abs(start[3]) * start[0]]
    )

    def said(z: FloatArray, n: int) -> dict[str, FloatArray]:
        x, _, a = decay_motion(t[:n], *(np.append(z, np.zeros(5 - z.size)) * scale))
        return {"x": x, "a": a}

    def residual(z: FloatArray, n: int) -> FloatArray:
        return seen.misses(said(z, n), n)

    found = []
    # from rest, v0 = 0 is held once: a speed of the wrong sign turns friction round at the first sample, a step in the
    # error. The first part alone knows nothing of sticking, where the error is not smooth in x_k: then it comes first
    # and how the parts grow decides which minimum is met
    for parts, held in ((WHOLE, start[4] == 0.0), (COARSE, False), (FINE, False)):
        z = (np.asarray(start) / scale)[: 4 if held else 5]
        for part in parts:
            z = least_squares(residual, z, method="lm", args=(max(50, int(part * t.size)),), max_nfev=60).x
        z = np.append(z, np.zeros(5 - z.size))
        found.append((float(np.sum(residual(z, t.size) ** 2)), z))
    chi2, z = min(found, key=lambda one: one[0])
    return BaseFit(z * scale, chi2, seen.r2(said(z, t.size)))


FIT_TOLERANCE, SIMULATED_STEP, SIMULATED_ITERATIONS = 1e-7, 1e-4, 30
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
    seen: Seen,
    u: FloatArray | None = None,
    bounds: tuple[float, float] = (-math.inf, math.inf),
    least_r2: float = -math.inf,
) -> BaseFit:
    """Best fit of base parameters, start and the numbers in ``effects``.

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

    def residual(z: FloatArray, n: int = t.size) -> FloatArray:
        if np.any(np.abs(z) > reach[: z.size]):
            return np.full(n * len(seen.channels), FAR)
        try:
            return seen.misses(predicted(z, n), n)
        except (SimulationError, ArithmeticError, ValueError):
            # a step into parameters that no plant can have
            return np.full(n * len(seen.channels), FAR)

    def fitted(found: Descent) -> BaseFit:
        return BaseFit(parameters(found.z), found.chi2, seen.r2(predicted(found.z, t.size)))

    # as for the closed form: from the truth at once, and over growing parts, which knows nothing of sticking at first;
    # v0 = 0 is held in the one, as its sign turns friction round, and in both where the slider is stuck at first
    still = base.v0 == 0.0
    downhill = partial(descend, step=SIMULATED_STEP, iterations=SIMULATED_ITERATIONS)
    best = downhill(residual, np.zeros(start.size - still), bounds=bounds)
    first = fitted(best)
    if not bounds[0] < best.chi2 < bounds[1] or min(first.r2.values()) < least_r2:
        return first
    part = partial(residual, n=max(50, int(PART * t.size)))
    other = downhill(part, np.zeros(start.size - (still and base.drive is not None)))
    other = downhill(residual, other.z, bounds=bounds)
    return first if best.chi2 <= other.chi2 else fitted(other)


SETTLED = 0.12
"""Of a period: how long after the hand is gone the fit begins, so that the first speed has a sign."""
STEP, ITERATIONS = 1e-6, 20
FINENESS = 1e-4
"""Of a channel's size: residuals are counted in this, so that the descent ends where nothing is left to gain."""
PLAIN = 0.008
"""What a quick fit leaves, of a channel's size, from which it is done as thoroughly as any other."""
PARTS, FEWEST = (0.1, 0.2, 0.3, 0.5, 0.7), 30
"""Parts of the recording over which a fit grows, and least samples."""
OTHERWISE = (0.4, 2.0)
"""Factors on friction from which it is fitted once more."""
LEAST_SLIDING = 50
"""Samples in motion without which a driven recording says nothing."""


def fit_motion(
    base: Base, t: FloatArray, clean: Channels, unit: Mapping[str, float], free_zero: bool, quick: bool
) -> BaseFit:
    """Of a free decay without noise.

    t : s, shape (n,), from ``SETTLED`` on. clean : its channels and x, v. unit : of each channel that is fitted, in
    which its residual counts. quick : from one start, where that does well.
    """
    t = t - t[0]
    motion = swing if base.restoring == "pendulum" else decay_motion
    scale = np.array(
        [base.omega_n, max(base.zeta, 1e-3), max(base.x_k, 1e-3 * base.length), base.length, base.speed, base.length]
    )

    def residual(z: FloatArray, n: int = t.size) -> FloatArray:
        p = z * scale[: z.size]
        x, v, a = motion(t[:n], *(float(one) for one in p[:5]))
        said = {"x": x + (float(p[5]) if z.size > 5 else 0.0), "v": v, "a": a}
        return np.concatenate([(clean[c][:n] - said[c]) / one for c, one in unit.items()])

    first = [base.omega_n, base.zeta, base.x_k, float(clean["x"][0]), float(clean["v"][0]), 0.0]
    start = (np.array(first) / scale)[: 6 if free_zero else 5]
    best = descend(residual, start, STEP, ITERATIONS)
    # far from the truth's parameters the phase may have been lost on the way, and where a decay ends the misfit is not
    # smooth in its friction
    if not quick or best.chi2 > t.size * len(unit) * (PLAIN / FINENESS) ** 2:
        z = start
        for part in PARTS:
            z = descend(partial(residual, n=max(int(part * t.size), FEWEST)), z, STEP, ITERATIONS).z
        others = [z] if quick else [z, *(best.z * np.where(np.arange(start.size) == 2, f, 1.0) for f in OTHERWISE)]
        best = min((best, *(descend(residual, z, STEP, ITERATIONS) for z in others)), key=lambda found: found.chi2)
    slopes = differences(residual, best.z, best.residual, STEP)
    back = np.repeat([-one for one in unit.values()], t.size)
    left = np.split(-back * best.residual, len(unit))
    columns = np.split(back[:, None] * slopes, len(unit))
    return BaseFit(
        best.z * scale[: best.z.size],
        left=dict(zip(unit, left, strict=True)),
        slopes=dict(zip(unit, columns, strict=True)),
    )


def fit_force(run: PlantRun, clean: Channels, laws: Sequence[FloatArray], also: str) -> BaseFit:
    """Of the measured force: m a + c v + f_k sgn v and ``laws`` (n,) beside, with the motion that x tells.

    While it sticks, friction may be anything up to f_k: what is left is what lies beyond. An accelerometer beside it
    (``also``, "a" or "") is held against the motion that x tells.
    """
    u = clean["u"]
    # what sensors add to the motion is smooth: its differences are good enough
    v = run.v + np.gradient(clean["x"] - run.x, run.t)
    a = run.a + np.gradient(v - run.v, run.t)
    sliding: BoolArray = ~run.stuck
    design = np.column_stack([a, v, np.where(sliding, np.sign(np.where(v == 0.0, a, v)), 0.0), *laws])
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
    if also:
        left[also], slopes[also] = clean[also] - a, np.zeros_like(found.jac)
    return BaseFit(found.x / size, left=left, slopes=slopes)
