"""A friction curve made ready: rows by speed, and the noise of a force as neighbours say it."""

from collections.abc import Mapping

import numpy as np

from harness.core.arrays import FloatArray
from harness.core.errors import InputError
from harness.core.recording import FEWEST_STEADY, Recording
from harness.diagnosis.covariates.values import Acting, values_in
from harness.diagnosis.problems.curve import Curve
from harness.diagnosis.request import Asked
from harness.estimate.noise import Noise
from harness.model.model import Restoring

_LEAST = 1e-4
"""Of the largest force: no table is better."""
ALONE = "a friction curve: one direction alone, so that f_k holds an offset of the force besides"


def curve_problem(recording: Recording, asked: Asked) -> tuple[Curve, tuple[str, ...]]:
    """A friction curve as a problem, and what was done to it, one sentence each.

    Raises InputError for options that contradict it, and for rows that are too few.
    """
    if asked.restoring not in (None, Restoring.NONE):
        accepted = "--restoring none with a table of speeds and forces"
        raise InputError(recording.file, "no time: a friction curve", accepted)
    v, u = recording["v"], recording["u"]
    order = np.argsort(v, kind="stable")
    order = order[v[order] != 0.0]
    if order.size < FEWEST_STEADY:
        raise InputError(recording.file, f"{order.size} speeds", f"at least {FEWEST_STEADY} beside 0")
    rest = v.size - order.size
    v, u = v[order], u[order]
    beside = {name: values[order] for name, values in values_in(asked.covariates, recording).items()}
    acting = tuple(Acting.of(one, recording) for one in asked.covariates)
    notes = [f"{rest} rows at rest, where friction may have any value, are skipped"] if rest else []
    if float(np.sum(u * v)) < 0.0:
        u = -u
        notes.append("the force points against the speed: its sign is turned, to be the force that holds the speed")
    noise = {"u": Noise(max(_noise(v, _without(beside, v, u)), _LEAST * float(np.max(np.abs(u)))), True, 0.0, 0.0)}
    # no motion says a mass: of what forces make, a unit of it is as good as any
    problem = Curve(
        np.arange(order.size, dtype=np.float64), {"u": u}, noise, mass=asked.mass or 1.0, v=v, order=order,
        angular=recording.angular, covariates=beside, acting=acting,
    )  # fmt: skip
    return problem, (*notes, *(() if problem.both_ways else (ALONE,)))


def _without(beside: Mapping[str, FloatArray], v: FloatArray, u: FloatArray) -> FloatArray:
    """u (n,) without what columns (n,) add to it in proportion, and to friction and damping."""
    if not beside:
        return u
    ways = np.column_stack((np.sign(v), v, np.ones(v.size)))
    changes = np.column_stack([ways * (y - np.mean(y))[:, None] for y in beside.values()])
    table = np.column_stack((ways, changes))
    table /= np.max(np.abs(table), axis=0)
    found = np.linalg.lstsq(table, u, rcond=1e-9)[0]
    left: FloatArray = u - table[:, ways.shape[1] :] @ found[ways.shape[1] :]
    return left


def _noise(v: FloatArray, u: FloatArray) -> float:
    """Standard deviation of u (n,): of each row from the line through its neighbours on its side.

    Gasser, Sroka and Jennen-Steinmetz 1986, Biometrika 73, 625.
    """
    squares = []
    for side in (v < 0.0, v > 0.0):
        s, y = v[side], u[side]
        span = np.where(s[2:] == s[:-2], 1.0, s[2:] - s[:-2])
        a = np.where(s[2:] == s[:-2], 0.5, (s[2:] - s[1:-1]) / span)
        left = a * y[:-2] + (1.0 - a) * y[2:] - y[1:-1]
        squares += (left**2 / (a**2 + (1.0 - a) ** 2 + 1.0)).tolist()
    # a bend at one end is no noise
    return float(np.sqrt(np.median(squares) / 0.4549)) if squares else 0.0
