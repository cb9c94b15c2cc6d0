"""What the compiled functions hand each other: a model as arrays, and the scratch arrays of one run, in one record.

A record goes as a single pointer where an array goes as seven numbers: with arrays the calls cost more than the laws.
Its sizes are fixed, so that there is one compiled form.
"""

import threading
from typing import Annotated, Final, Protocol, cast

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
_N, _Q = MAX_STATES, MAX_COLUMNS


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

    h_max: Annotated[float, ()]
    sensitivity_error: Annotated[float, ()]
    spec: Annotated[IntArray, (MAX_SPEC,)]
    theta: Annotated[FloatArray, (MAX_THETA,)]
    columns: Annotated[IntArray, (_Q,)]
    scale: Annotated[FloatArray, (_N,)]
    count: Annotated[IntArray, (2,)]
    z: Annotated[FloatArray, (_N,)]
    s: Annotated[FloatArray, (_N, _Q)]
    z1: Annotated[FloatArray, (_N,)]
    s1: Annotated[FloatArray, (_N, _Q)]
    zi: Annotated[FloatArray, (_N,)]
    si: Annotated[FloatArray, (_N, _Q)]
    ks: Annotated[FloatArray, (STAGES + 1, _N)]
    kss: Annotated[FloatArray, (STAGES + 1, _N, _Q)]
    jac: Annotated[FloatArray, (_N, _N)]
    jacs: Annotated[FloatArray, (STAGES, _N, _N)]
    pushes: Annotated[FloatArray, (STAGES, _N, _Q)]
    by_theta: Annotated[FloatArray, (_N, MAX_PLACES)]
    cz: Annotated[FloatArray, (_N, 6)]
    size_s: Annotated[FloatArray, (_Q,)]
    off: Annotated[FloatArray, (_Q,)]
    row: Annotated[FloatArray, (COLUMNS,)]
    rows: Annotated[FloatArray, (3, INTERNAL_COLUMNS)]
    level: Annotated[FloatArray, (COLUMNS,)]


_TYPES = {FloatArray: np.float64, IntArray: np.int64, float: np.float64}
_RECORD = np.dtype(
    [(name, _TYPES[one.__origin__], one.__metadata__[0]) for name, one in Work.__annotations__.items()], align=True
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
            raise InputError("model", f"{size} {what}", f"at most {most}")
    own = _OWN
    n, q = start.size, columns.size
    own.spec[: spec.size], own.theta[: theta.size] = spec, theta
    own.columns[:q], own.scale[:n] = columns, scale
    own.count[:] = places, q
    own.z[:n], own.s[:n, :q] = start, start_s
    # what is added to, or written only where a law has something to say
    own.jac[:n, :n] = own.by_theta[:n, :places] = 0.0
    # a sensitivity counts from where all of its parameter moves the state by the error that a step may have
    own.size_s[:q] = 1.0 / np.where((columns >= 0) & (theta[columns] != 0.0), np.abs(theta[columns]), np.inf)
    return own.record
