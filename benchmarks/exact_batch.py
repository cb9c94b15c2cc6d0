"""Thousands of free decays at once, on all cores."""

import os
from concurrent.futures import ThreadPoolExecutor

import numpy as np

from harness.core.arrays import FloatArray
from harness.core.checks import finite, positive
from harness.core.errors import InputError
from harness.core.jit import compiled
from harness.exact.decay import Decay, check_outputs
from harness.exact.fill import fill_uniform

COLUMNS = ("omega_n", "zeta", "x_k", "x_s", "x0", "v0")


@compiled
def fill_rows(
    parameters: FloatArray, t0: float, dt: float, first: int, last: int, x: FloatArray, v: FloatArray, a: FloatArray
) -> None:
    """The kernel of ``fill_batch`` for the rows first <= i < last."""
    for i in range(first, last):
        p = parameters[i]
        fill_uniform(p[0], p[1], p[2], p[3], p[4], p[5], t0, dt, x[i], v[i], a[i])


def stack(decays: list[Decay]) -> FloatArray:
    """The parameters of several decays as ``fill_batch`` takes them, shape (len(decays), 6)."""
    return np.array([decay.arguments for decay in decays], dtype=np.float64).reshape(-1, len(COLUMNS))


def _check(parameters: FloatArray) -> None:
    """Raise InputError for the first row that is no slider, in the words of ``Decay``."""
    omega_n, zeta, x_k, x_s = (parameters[:, column] for column in range(4))
    good = np.isfinite(parameters).all(axis=1) & (omega_n > 0) & (zeta >= 0) & (x_k >= 0) & (x_s >= x_k)
    for row in np.flatnonzero(~good)[:1]:
        omega_n, zeta, x_k, x_s, x0, v0 = parameters[row].tolist()
        try:
            Decay(omega_n, zeta, x_k, x0, v0, x_s)
        except InputError as error:
            raise InputError(f"batch, row {row + 1}, {error.where}", error.found, error.accepted) from None


def fill_batch(
    parameters: FloatArray,
    t0: float,
    dt: float,
    x: FloatArray,
    v: FloatArray,
    a: FloatArray,
    threads: int | None = None,
) -> None:
    """Write x (m), v (m/s), a (m/s^2), each (sliders, n), at the times t0 + j dt (s).

    parameters : (sliders, 6), columns as in COLUMNS, SI units. threads : all cores when not given.
    The result does not depend on the number of threads. Raises InputError naming the first row that is no slider.
    """
    if parameters.ndim != 2 or parameters.shape[1] != len(COLUMNS):
        raise InputError("batch: parameters", f"shape {parameters.shape}", f"(sliders, {len(COLUMNS)})")
    finite("batch: t0", t0)
    positive("batch: dt", dt, "s")
    sliders = parameters.shape[0]
    check_outputs(parameters.shape, parameters)
    check_outputs((sliders, x.shape[-1]), x, v, a)
    _check(parameters)
    workers = max(1, min(sliders, threads or len(os.sched_getaffinity(0))))
    if workers == 1:
        fill_rows(parameters, t0, dt, 0, sliders, x, v, a)
        return
    # several pieces a worker: sliders differ in their number of half-cycles
    edges = np.linspace(0, sliders, 4 * workers + 1).astype(int)
    with ThreadPoolExecutor(workers) as pool:
        spans = zip(edges[:-1].tolist(), edges[1:].tolist(), strict=True)
        jobs = [pool.submit(fill_rows, parameters, t0, dt, i, j, x, v, a) for i, j in spans]
        for job in jobs:
            job.result()
