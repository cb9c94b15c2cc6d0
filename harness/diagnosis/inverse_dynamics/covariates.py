"""How a measured covariate enters: as a force, on friction or on damping, by a regression of the force.

Every one of the three is linear in the force that is fitted, beside the base model and a constant; so each rival costs
one least squares, and they are compared by what they leave, in values that count as independent.
"""

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace

import numpy as np

from harness.core.arrays import FloatArray
from harness.core.errors import InputError
from harness.core.recording import Recording
from harness.diagnosis.fit.parameters import free_of
from harness.diagnosis.inverse_dynamics.force_fit import ForceFit, fit_force
from harness.diagnosis.inverse_dynamics.measured import BLOCK, Measured
from harness.diagnosis.problems.inverse_dynamics import InverseDynamics
from harness.diagnosis.request import AskedCovariate
from harness.diagnosis.rules import COVARIATE_APART, COVARIATE_VARIES, DECISIVE
from harness.estimate.noise import channel_noise
from harness.fit.autocorrelation import memory
from harness.model.covariate import Acts, Covariate

_NAMED = {Acts.FORCE: "a force", Acts.FRICTION: "friction", Acts.DAMPING: "damping"}
_ALONE = 1e-9
"""Share of a column's squares below which others say it whole, but for rounding."""
_EPSILON = 1e-12
"""Of a least squares: a direction so weak is none."""


@dataclass(frozen=True, slots=True)
class _Rival:
    """One way in. column (m,), N : of the regression. left (m,), N : what it leaves of the force."""

    covariate: Covariate
    column: FloatArray
    left: FloatArray


def values_in(recording: Recording, asked: tuple[AskedCovariate, ...]) -> dict[str, FloatArray]:
    """The columns (n,) that were asked for. Raises InputError for one that is not there or says nothing."""
    found = {}
    for one in asked:
        where = f"{recording.file}: covariate {one.name}"
        if one.name not in recording.covariates:
            there = ", ".join(recording.covariates) or "none"
            raise InputError(where, "no such column", f"a covariate of the recording is accepted ({there})")
        values = recording.covariates[one.name]
        spread, accepted = float(np.std(values)), f"a spread of {COVARIATE_VARIES.value:g} times its noise is accepted"
        if float(np.ptp(values)) == 0.0:
            raise InputError(where, f"the constant {values[0]:g}", accepted)
        noise = channel_noise(recording.t, values).sigma
        if spread < COVARIATE_VARIES.value * noise:
            found_too = f"hardly varies: {spread:.3g} about its mean, of which noise is {noise:.3g}"
            raise InputError(where, found_too, accepted)
        found[one.name] = values
    return found


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
    said = []
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
            parts = ", ".join(f"as {_NAMED[acts]} {100.0 * (1.0 - share):.3g} %" for acts, share in refused.items())
            accepted = "one that varies by itself beyond its noise is accepted"
            raise InputError(where, f"the base model and time say what it does: {parts}", accepted)
        if not found:
            raise InputError(where, "the fit has no friction or damping for it to act on", "--covariate NAME:force is")
        found.sort(key=lambda rival: float(rival.left @ rival.left))
        text = _said(found, _left(base.residual, columns), one.acts is not None, tuple(refused))
        said.append(f"{text}{_little(one.name, shares[found[0].covariate.acts])}")
        chosen.append(found[0].covariate)
        columns.append(found[0].column)
    return replace(problem, first=replace(problem.first, covariates=tuple(chosen)), enters=tuple(said))


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


def _little(name: str, share: float) -> str:
    """A caution where little of a covariate decides its gain."""
    if share * COVARIATE_APART.value >= 1.0:
        return ""
    said = f"The base model and time say {100.0 * (1.0 - share):.3g} % of what {name} does"
    return f" {said}: the rest decides the gain, and a law that is left out moves it easily."


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
        yield _Rival(replace(covariate, gain=-float(found[-1])), column, left)
        return
    name = "f_k" if covariate.acts is Acts.FRICTION else "c"
    at = next(i for i, f in enumerate(base.free) if f.name == name)
    level = float(getattr(base.model, name) + found[at])
    if level > 0.0:
        yield _Rival(replace(covariate, gain=float(found[-1]) / level), column, left)


def _said(found: list[_Rival], without: FloatArray, asked: bool, refused: tuple[Acts, ...]) -> str:
    """Which rival was chosen and by how much, in BIC."""
    best = found[0]
    name, independent = best.covariate.name, memory(best.left).independent

    def behind(left: FloatArray) -> float:
        return independent * math.log(float(left @ left) / max(float(best.left @ best.left), 1e-300))

    gained = behind(without) - math.log(independent)
    parts = [f"BIC {gained:.0f} better than without it"]
    parts += [f"{behind(r.left):.0f} better than as {_NAMED[r.covariate.acts]}" for r in found[1:]]
    parts += [f"{_NAMED[acts]} was not tried, as that follows from the base model and time" for acts in refused]
    text = f"{name} enters as {best.covariate.said}{', as asked' if asked else ''}: {', '.join(parts)}."
    near = [_NAMED[r.covariate.acts] for r in found[1:] if behind(r.left) < DECISIVE.value]
    if near:
        text += f" Below {DECISIVE.value:g} it is not told from {' or '.join(near)}."
    if gained < DECISIVE.value:
        text += f" Below {DECISIVE.value:g} nothing shows that {name} acts at all."
    return f"{text} Held-out figures are given {name}; it is not predicted."
