"""The force left over, without a law for it: over time, and over displacement and speed.

Near the base model's motion what is left of x obeys delta x'' + 2 zeta omega_n delta x' + omega^2 delta x = -f, f being
the force left over, per unit mass, on the left of the equation. A Kalman filter and smoother (Rauch, Tung and Striebel
1965) with f a random walk turns residuals of any channels into f with its uncertainty; how fast f may wander is chosen
by likelihood. At rest the equation does not hold, and nothing is said.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from harness.core.arrays import BoolArray, FloatArray, IntArray, read_only
from harness.core.jit import compiled
from harness.diagnosis.motion import Motion
from harness.diagnosis.smoothed_state.local_cubics import at, over, times, times_turned

_CHANNELS = ("x", "v", "a")
_CELLS = 15
"""Along each side of the map."""
_RATES = tuple(10.0 ** (0.5 * i) for i in range(-8, 5))
"""Wander of f over one radian of the swing, in units of the force scale."""


@dataclass(frozen=True, slots=True)
class ForceMap:
    """Force left over per unit mass (m/s^2), on the left of the equation of motion, with one standard error.

    t, at_x, at_v, force, stderr : (n,), over time; nan at rest. x, v, cell_force, cell_stderr, samples : (m,), means
    over the cells of displacement and speed that were visited. wander : rate at which it was let wander, None where
    the force was measured.
    """

    t: FloatArray
    at_x: FloatArray
    at_v: FloatArray
    force: FloatArray
    stderr: FloatArray
    x: FloatArray
    v: FloatArray
    cell_force: FloatArray
    cell_stderr: FloatArray
    samples: IntArray
    wander: float | None = None


def _smooth(  # noqa: PLR0912, PLR0915  (one loop is one loop)
    t: FloatArray,
    r: FloatArray,
    variance: FloatArray,
    damping: float,
    stiffness: FloatArray,
    stuck: BoolArray,
    wander: float,
    start: FloatArray,
    keep: bool,
    force: FloatArray,
    spread: FloatArray,
) -> float:
    """Filter and smoother; state (delta x, delta v, f). r (n, 3) and variance (3,), infinite for a channel not there.

    Writes f and its variance, returns -2 log-likelihood. keep : smooth too.
    """
    # entry by entry: of slices the sentences of their errors are compiled too, for seconds
    n = t.size
    count = n if keep else 1
    means, covs = np.zeros((count, 3)), np.zeros((count, 3, 3))
    before, before_p, moves = np.zeros((count, 3)), np.zeros((count, 3, 3)), np.zeros((count, 3, 3))
    m, p = np.zeros(3), np.zeros((3, 3))
    for i in range(3):
        p[i, i] = start[i]
    cost = 0.0
    a, part, whole, ahead = np.zeros((3, 3)), np.zeros((3, 3)), np.zeros((3, 3)), np.zeros((3, 3))
    h, ph, moved = np.zeros(3), np.zeros(3), np.zeros(3)
    for k in range(n):
        if k > 0:
            dt = t[k] - t[k - 1]
            w2 = stiffness[k]
            # x and v over dt by the equation, to third order; f stays
            a[0, 0], a[0, 1], a[0, 2] = 1.0 - 0.5 * w2 * dt * dt, dt - 0.5 * damping * dt * dt, -0.5 * dt * dt
            a[1, 0] = -w2 * dt + 0.5 * damping * w2 * dt * dt
            a[1, 1] = 1.0 - damping * dt + 0.5 * (damping * damping - w2) * dt * dt
            a[1, 2] = -dt + 0.5 * damping * dt * dt
            a[2, 0], a[2, 1], a[2, 2] = 0.0, 0.0, 1.0
            at(a, m, moved)
            for i in range(3):
                m[i] = moved[i]
            times(a, p, part)
            times_turned(part, a, p)
            p[2, 2] += wander * dt
            if stuck[k]:
                # held: whatever offset there is stays, the force says nothing
                m[1], m[2] = 0.0, 0.0
                p[0, 0] += start[0]
                p[1, 1] += start[1]
                for i in range(2):
                    p[i, 2], p[2, i] = 0.0, 0.0
                p[2, 2] = start[2]
        if keep:
            for i in range(3):
                before[k, i] = m[i]
                for j in range(3):
                    before_p[k, i, j], moves[k, i, j] = p[i, j], a[i, j]
        for c in range(3):
            if math.isinf(variance[c]) or stuck[k]:
                continue
            h[0], h[1], h[2] = 0.0, 0.0, 0.0
            if c < 2:
                h[c] = 1.0
            else:
                h[0], h[1], h[2] = -stiffness[k], -damping, -1.0
            at(p, h, ph)
            s, e = variance[c], r[k, c]
            for i in range(3):
                s += h[i] * ph[i]
                e -= h[i] * m[i]
            cost += e * e / s + math.log(s)
            for i in range(3):
                m[i] += ph[i] / s * e
                for j in range(3):
                    p[i, j] -= ph[i] / s * ph[j]
        if keep:
            for i in range(3):
                means[k, i] = m[i]
                for j in range(3):
                    covs[k, i, j] = p[i, j]
    if keep:
        force[n - 1], spread[n - 1] = m[2], p[2, 2]
        for k in range(n - 2, -1, -1):
            if stuck[k + 1]:
                for i in range(3):
                    m[i] = means[k, i]
                    for j in range(3):
                        p[i, j] = covs[k, i, j]
            else:
                for i in range(3):
                    for j in range(3):
                        ahead[i, j] = before_p[k + 1, i, j]
                    ahead[i, i] *= 1.0 + 1e-12
                times_turned(covs[k], moves[k + 1], part)
                over(part, ahead, whole)
                for i in range(3):
                    h[i] = m[i] - before[k + 1, i]
                    for j in range(3):
                        part[i, j] = p[i, j] - before_p[k + 1, i, j]
                at(whole, h, moved)
                times(whole, part, ahead)
                times_turned(ahead, whole, p)
                for i in range(3):
                    m[i] = means[k, i] + moved[i]
                    for j in range(3):
                        p[i, j] += covs[k, i, j]
            force[k], spread[k] = m[2], p[2, 2]
    return cost


_compiled_smooth = compiled(_smooth)


def force_map(
    t: FloatArray,
    residual: Mapping[str, FloatArray],
    sigma: Mapping[str, float],
    motion: Motion,
    damping: float,
    stiffness: FloatArray,
    wander: float | None = None,
) -> ForceMap:
    """The force left over by a base model.

    t : (n,), s. residual : data minus model by channel (x, v, a), (n,), SI units. sigma : noise of each, its white
    equivalent. motion : of the base model. damping : c/m, 1/s. stiffness : k/m along the motion, (n,), 1/s^2 (zeros for
    a free axis). wander : (m/s^2)^2/s, None for the likeliest. Linear in samples.
    """
    n = t.size
    r, variance = np.zeros((n, 3)), np.full(3, math.inf)
    for i, c in enumerate(_CHANNELS):
        if c in residual:
            r[:, i], variance[i] = residual[c], sigma[c] ** 2
    omega = motion.omega
    rms = {c: float(np.sqrt(np.mean(y * y))) for c, y in residual.items()}
    scale = max(rms.get("a", 0.0), rms.get("v", 0.0) * omega, rms.get("x", 0.0) * omega**2, 1e-300)
    start = np.array([(scale / omega**2) ** 2, (scale / omega) ** 2, scale**2]) * 4.0
    force, spread = np.empty(n), np.empty(n)
    t_s = read_only(t)

    def run(wander: float, keep: bool) -> float:
        return float(
            _compiled_smooth(t_s, r, variance, damping, stiffness, motion.stuck, wander, start, keep, force, spread)
        )

    if wander is None:
        wander = min(((rate * scale) ** 2 * omega for rate in _RATES), key=lambda one: run(one, False))
    run(wander, True)
    stderr = np.sqrt(np.maximum(spread, 0.0))
    force[motion.stuck], stderr[motion.stuck] = np.nan, np.nan
    return ForceMap(t, motion.x, motion.v, force, stderr, *_cells(motion, force, stderr), wander)


def measured_map(t: FloatArray, force: FloatArray, sigma: float, motion: Motion) -> ForceMap:
    """The map of a force (n,) that is left over by itself, per unit mass, with noise sigma; t (n,), s."""
    force, stderr = force.copy(), np.full(t.size, sigma)
    force[motion.stuck], stderr[motion.stuck] = np.nan, np.nan
    return ForceMap(t, motion.x, motion.v, force, stderr, *_cells(motion, force, stderr))


def _cells(
    motion: Motion, force: FloatArray, stderr: FloatArray
) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray, IntArray]:
    """Means over cells; samples of one visit to a cell share one error, visits are independent of each other."""
    moving = ~motion.stuck
    x, v, f, s = motion.x[moving], motion.v[moving], force[moving], stderr[moving]

    def place(y: FloatArray) -> IntArray:
        low, wide = float(y.min()), max(float(np.ptp(y)), 1e-300)
        found: IntArray = np.minimum(((y - low) / wide * _CELLS).astype(np.int64), _CELLS - 1)
        return found

    cell = place(x) * _CELLS + place(v)
    visit = np.cumsum(np.concatenate(([0], (np.diff(cell) != 0).astype(np.int64))))
    size = np.bincount(visit).astype(np.float64)
    mean, error = np.bincount(visit, f) / size, np.bincount(visit, s) / size
    owner = cell[np.concatenate(([0], np.flatnonzero(np.diff(cell)) + 1))]
    _, index = np.unique(owner, return_inverse=True)
    weight = np.bincount(index, size)
    cell_force = np.bincount(index, size * mean) / weight
    noise = np.sqrt(np.bincount(index, (size * error) ** 2)) / weight
    visits = np.bincount(index)
    # visits that disagree say that x and v are not all the force depends on
    scatter = np.bincount(index, size * (mean - cell_force[index]) ** 2) / weight
    cell_stderr = np.maximum(noise, np.sqrt(scatter / np.maximum(visits - 1, 1)))
    _, at = np.unique(cell, return_inverse=True)
    samples = np.bincount(at)
    return np.bincount(at, x) / samples, np.bincount(at, v) / samples, cell_force, cell_stderr, samples


def write_map(path: Path, found: ForceMap) -> None:
    """Columns x, v, force, stderr, samples: means over the cells that were visited."""
    rows = np.column_stack([found.x, found.v, found.cell_force, found.cell_stderr, found.samples])
    np.savetxt(path, rows, "%.9g", ",", header="x,v,force,stderr,samples", comments="")


def write_history(path: Path, found: ForceMap) -> None:
    """Columns t, force, stderr: over time, without the stretches at rest."""
    rows = np.column_stack([found.t, found.force, found.stderr])[np.isfinite(found.force)]
    np.savetxt(path, rows, "%.9g", ",", header="t,force,stderr", comments="")
