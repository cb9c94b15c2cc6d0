"""How a measured covariate enters: as a force, on friction or on damping, by a regression of the force.

Every one of the three is linear in the force that is fitted, beside the base model and a constant; so each rival costs
one least squares, and they are compared by what they leave, in values that count as independent.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace

import numpy as np

from harness.core.arrays import FloatArray
from harness.core.errors import InputError
from harness.core.recording import Recording
from harness.diagnosis.covariates.values import NAMED, Rival, little, said, values_in
from harness.diagnosis.inverse_dynamics.force_fit import ForceFit, fit_force
from harness.diagnosis.parameters import free_of
from harness.diagnosis.problems.driven import InverseDynamics
from harness.diagnosis.problems.measured import BLOCK, Measured
from harness.diagnosis.request import AskedCovariate
from harness.diagnosis.rules import COVARIATE_VARIES
from harness.estimate.noise import channel_noise
from harness.model.covariate import Acts, Covariate

_ALONE = 1e-9
"""Share of a column's squares below which others say it whole, but for rounding."""
_EPSILON = 1e-12
"""Of a least squares: a direction so weak is none."""


@dataclass(frozen=True, slots=True)
class _Rival(Rival):
    """What it leaves of the force, N. column (m,), N : of the regression."""

    column: FloatArray


def entered(problem: InverseDynamics, recording: Recording, asked: tuple[AskedCovariate, ...]) -> InverseDynamics:
    """The problem with its covariates, and the rough base model with each where it enters best.

    Raises InputError for one that is no column, hardly varies, or follows from the base model and time.
    """
    values = values_in(recording, asked)
    problem = replace(problem, covariates=values)
    measured = Measured.of(problem)
    base = fit_force(problem.first, measured, free_of(problem.first, problem.base_names))
    columns = [*base.jacobian.T, np.ones(base.residual.size)]
    chosen: list[Covariate] = []
    sentences = []
    for one in asked:
        about, unit = float(np.mean(values[one.name])), recording.units.get(one.name, "")
        found: list[_Rival] = []
        shares: dict[Acts, float] = {}
        refused: dict[Acts, float] = {}
        for acts in Acts if one.acts is None else (one.acts,):
            column = _column(acts, measured, measured.covariates[one.name] - about)
            own = _own(acts, column, columns, measured, _block_noise(recording, one.name))
            shares[acts] = own.share
            if own.noisy:
                refused[acts] = own.share
            else:
                found += _rivals(Covariate(one.name, acts, 0.0, about, unit), column, columns, base)
        where = f"{recording.file}: covariate {one.name}"
        if not found and refused:
            parts = ", ".join(f"as {NAMED[acts]} {100.0 * (1.0 - share):.3g} %" for acts, share in refused.items())
            accepted = "one that varies by itself beyond its noise is accepted"
            raise InputError(where, f"the base model and time say what it does: {parts}", accepted)
        if not found:
            raise InputError(where, "the fit has no friction or damping for it to act on", "--covariate NAME:force is")
        found.sort(key=lambda rival: float(rival.left @ rival.left))
        text = said(found, _left(base.residual, columns), one.acts is not None, tuple(refused))
        sentences.append(f"{text}{little(one.name, shares[found[0].covariate.acts])}")
        chosen.append(found[0].covariate)
        columns.append(found[0].column)
    return replace(problem, first=replace(problem.first, covariates=tuple(chosen)), enters=tuple(sentences))


def _column(acts: Acts, measured: Measured, change: FloatArray) -> FloatArray:
    """Force (m,) that a change (n,) of the covariate adds, up to its gain."""
    return measured.blocks(_basis(acts, measured) * change)


def _basis(acts: Acts, measured: Measured) -> FloatArray:
    by: Mapping[Acts, FloatArray] = {
        Acts.FORCE: np.ones(measured.v.size),
        Acts.FRICTION: np.sign(measured.v),
        Acts.DAMPING: measured.v,
    }
    return by[acts]


def _left(y: FloatArray, columns: list[FloatArray]) -> FloatArray:
    """What columns (m,) leave of y (m,)."""
    table = np.column_stack(columns)
    table /= np.maximum(np.linalg.norm(table, axis=0), 1e-300)
    left: FloatArray = y - table @ np.linalg.lstsq(table, y, rcond=_EPSILON)[0]
    return left


@dataclass(frozen=True, slots=True)
class _Own:
    """What of a column neither the others say nor the same effect in proportion to time.

    share : of its squares. noisy : whether that is too little beside the covariate's noise for a regression on it.
    """

    share: float
    noisy: bool


def _block_noise(recording: Recording, name: str) -> float:
    """Noise of a block's mean of a covariate, in its unit."""
    return channel_noise(recording.t, recording.covariates[name]).of_means(BLOCK).sigma


def _own(acts: Acts, column: FloatArray, columns: list[FloatArray], measured: Measured, noise: float) -> _Own:
    """See _Own; noise : of the covariate in a block."""
    basis, t = _basis(acts, measured), measured.t - measured.t.mean()
    alone = _left(column, [measured.blocks(basis)])
    rest = _left(column, [*columns, measured.blocks(basis), measured.blocks(basis * t)])
    left, whole = float(rest @ rest), max(float(alone @ alone), 1e-300)
    least = (COVARIATE_VARIES.value * noise) ** 2 * float(np.sum(measured.blocks(basis**2)))
    return _Own(left / whole, left <= max(least, _ALONE * whole))


def _rivals(covariate: Covariate, column: FloatArray, columns: list[FloatArray], base: ForceFit) -> Iterator[_Rival]:
    """The covariate with a first gain; none where there is nothing for it to act on."""
    table = np.column_stack((*columns, column))
    size = np.maximum(np.linalg.norm(table, axis=0), 1e-300)
    found = np.linalg.lstsq(table / size, base.residual, rcond=_EPSILON)[0] / size
    left = base.residual - table @ found
    if covariate.acts is Acts.FORCE:
        yield _Rival(replace(covariate, gain=-float(found[-1])), left, column)
        return
    name = "f_k" if covariate.acts is Acts.FRICTION else "c"
    at = next(i for i, f in enumerate(base.free) if f.name == name)
    level = float(getattr(base.model, name) + found[at])
    if level > 0.0:
        yield _Rival(replace(covariate, gain=float(found[-1]) / level), left, column)
