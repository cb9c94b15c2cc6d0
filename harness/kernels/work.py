"""What the compiled functions hand each other: a model as arrays, and the scratch arrays of one run, in one record.

A record goes as a single pointer where an array goes as seven numbers: with arrays the calls cost more than the laws.
Its sizes are fixed, so that there is one compiled form.
"""

import threading
from typing import Final, Protocol, cast

import numpy as np

from harness.core.arrays import FloatArray, IntArray
from harness.core.errors import InputError
from harness.model.law import COLUMNS, INTERNAL_COLUMNS


def plain(number: int) -> int:
    """A constant that kernels are called with: Numba compiles a function anew for every literal int it is given."""
    return cast(int, np.int64(number))


STAGES: Final = 7
FIRST: Final = plain(0)
"""The stage at the start of a step."""
SPARE: Final = plain(STAGES)
"""The stage whose slopes belong to no step: for looks aside (samples, events)."""
ROW_V, ROW_BRISTLE = plain(1), plain(2)
"""Rows of the state."""

# room for a screen of the whole catalogue: some hundred probes answer in one run
MAX_STATES, MAX_PLACES, MAX_COLUMNS, MAX_SPEC = 12, 512, 160, 512
MAX_THETA: Final = 2560


class Work(Protocol):
    """Arrays of a run: n states, q columns of sensitivities, P places of parameters, in the corners of larger ones.

    h_max : longest step, s. sensitivity_error : allowed in a step, relative to the largest so far in each column.
    spec (s,), theta (P,) : see harness.kernels.layout. columns (q,) : place in theta each column belongs to, -1 for an
    initial condition. scale (n,) : error of the state allowed in a step. count (2,) : P and q.
    z (n,), s (n, q) : state and sensitivities at the start of a step; z1, s1 : at its end; zi, si : between.
    ks (STAGES + 1, n), kss (STAGES + 1, n, q) : slopes by stage. jac (n, n), by_theta (n, P) : partials of the slopes.
    jacs (STAGES, n, n), pushes (STAGES, n, q) : those of a step's stages, by the state and by each column's own.
    cz (n, 6) : interpolation. size_s (q,) : largest sensitivities so far. off (q,) : their errors
    in a step. row, rows : what a law writes into. level : what the last look at the level of friction by speed has
    written, with its partials.
    """

    h_max: float
    sensitivity_error: float
    spec: IntArray
    theta: FloatArray
    columns: IntArray
    scale: FloatArray
    count: IntArray
    z: FloatArray
    s: FloatArray
    z1: FloatArray
    s1: FloatArray
    zi: FloatArray
    si: FloatArray
    ks: FloatArray
    kss: FloatArray
    jac: FloatArray
    jacs: FloatArray
    pushes: FloatArray
    by_theta: FloatArray
    cz: FloatArray
    size_s: FloatArray
    off: FloatArray
    row: FloatArray
    rows: FloatArray
    level: FloatArray


_N, _Q = MAX_STATES, MAX_COLUMNS
_RECORD = np.dtype(
    [
        ("h_max", np.float64),
        ("sensitivity_error", np.float64),
        ("spec", np.int64, (MAX_SPEC,)),
        ("theta", np.float64, (MAX_THETA,)),
        ("columns", np.int64, (_Q,)),
        ("scale", np.float64, (_N,)),
        ("count", np.int64, (2,)),
        ("z", np.float64, (_N,)),
        ("s", np.float64, (_N, _Q)),
        ("z1", np.float64, (_N,)),
        ("s1", np.float64, (_N, _Q)),
        ("zi", np.float64, (_N,)),
        ("si", np.float64, (_N, _Q)),
        ("ks", np.float64, (STAGES + 1, _N)),
        ("kss", np.float64, (STAGES + 1, _N, _Q)),
        ("jac", np.float64, (_N, _N)),
        ("jacs", np.float64, (STAGES, _N, _N)),
        ("pushes", np.float64, (STAGES, _N, _Q)),
        ("by_theta", np.float64, (_N, MAX_PLACES)),
        ("cz", np.float64, (_N, 6)),
        ("size_s", np.float64, (_Q,)),
        ("off", np.float64, (_Q,)),
        ("row", np.float64, (COLUMNS,)),
        ("rows", np.float64, (3, INTERNAL_COLUMNS)),
        ("level", np.float64, (COLUMNS,)),
    ],
    align=True,
)
PLACES: Final = 0
ACROSS: Final = 1
"""In count: how many parameters, and how many columns of sensitivities."""


class _Own(threading.local):
    """The record of a thread, and its arrays as numpy sees them: to make it anew costs as much as a short run."""

    def __init__(self) -> None:
        whole = np.zeros(1, dtype=_RECORD)
        self.record = cast(Work, whole.view(np.recarray)[0])
        first = whole[0]
        self.spec, self.theta, self.columns = first["spec"], first["theta"], first["columns"]
        self.scale, self.count, self.z, self.s = first["scale"], first["count"], first["z"], first["s"]
        self.jac, self.by_theta, self.size_s = first["jac"], first["by_theta"], first["size_s"]


_OWN = _Own()


def workspace(
    spec: IntArray,
    theta: FloatArray,
    places: int,
    columns: IntArray,
    scale: FloatArray,
    start: FloatArray,
    start_s: FloatArray,
) -> Work:
    """The record of this thread for a model: start (n,) and start_s (n, q) are its state and sensitivities at the
    release. It is the next caller's then.

    places : how many of theta are parameters; what follows are tables.

    Raises InputError when the model has more terms than there is room for.
    """
    for size, most, what in (
        (start.size, MAX_STATES, "states"),
        (places, MAX_PLACES, "parameters"),
        (theta.size, MAX_THETA, "parameters and values of tables"),
        (columns.size, MAX_COLUMNS, "sensitivities"),
        (spec.size, MAX_SPEC, "entries"),
    ):
        if size > most:
            raise InputError("model", f"{size} {what}", f"at most {most} are accepted")
    own = _OWN
    n, q = start.size, columns.size
    own.spec[: spec.size], own.theta[: theta.size] = spec, theta
    own.columns[:q], own.scale[:n] = columns, scale
    own.count[:] = places, q
    own.z[:n], own.s[:n, :q] = start, start_s
    # what is added to, or written only where a law has something to say
    own.jac[:n, :n] = own.by_theta[:n, :places] = own.size_s[:q] = 0.0
    return own.record
