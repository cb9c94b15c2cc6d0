"""Which tables stay: those that predict blocks of cycles that took no part in their fit, clearly better than without.

Outer blocks judge; how smooth a table is was chosen by inner ones, anew for each fold, so that no block takes part in
what predicts it. The first cycle, with the largest swings, is in every fit.

Whether a path through the plane of position and speed comes back, so that a force over it is told from a drift.
"""

from collections.abc import Callable, Mapping
from contextlib import suppress
from dataclasses import dataclass, replace

import numpy as np

from harness.core.arrays import BoolArray, FloatArray, IntArray
from harness.core.errors import SimulationError
from harness.diagnosis.fit.observe import COARSE, FINE, observe
from harness.diagnosis.fit.parameters import free_of, with_friction
from harness.diagnosis.grading.misfit import Misfit
from harness.diagnosis.grading.prediction import Predicted, blocks_of, by_blocks, ratio, surely_less
from harness.diagnosis.problem import Problem
from harness.diagnosis.rules import PATH_AGAIN, PATH_APART, TABLE_BETTER, TABLE_ERRORS, TABLE_WORDS
from harness.diagnosis.tables.basis import RUNGS, Rung, basis_of, over_plane
from harness.diagnosis.tables.curve import strength_by_blocks
from harness.diagnosis.tables.fitted import FIRST, TableFit, fit_tables
from harness.model.model import Model
from harness.model.term import Slot

_CELLS = 8
"""Cells along each side of the plane that was swept."""


def comes_back(t: FloatArray, x: FloatArray, v: FloatArray) -> bool:
    """Whether most of the time is spent in cells that are seen again at clearly different times; each (n,)."""
    return time_again(t, x, v) >= PATH_AGAIN.value


def time_again(t: FloatArray, x: FloatArray, v: FloatArray) -> float:
    """Share of the samples whose cell of the plane is seen at times so far apart; each (n,)."""
    if float(np.ptp(x)) == 0.0 or float(np.ptp(v)) == 0.0:
        return 0.0
    cell = _CELLS * _part(x) + _part(v)
    first, last = np.full(_CELLS**2, np.inf), np.full(_CELLS**2, -np.inf)
    np.minimum.at(first, cell, t)
    np.maximum.at(last, cell, t)
    return float(np.mean((last - first)[cell] >= PATH_APART.value * float(t[-1] - t[0])))


def _part(y: FloatArray) -> IntArray:
    return np.asarray(np.minimum(_CELLS * (y - y.min()) / np.ptp(y), _CELLS - 1), dtype=np.int64)


def returns(problem: Problem, x: FloatArray, v: FloatArray) -> bool:
    """Whether the path of a motion x, v (n,) that is followed comes back: several amplitudes, or a drive that does it.

    A free decay passes each place of the plane once, and two alike pass the same ones.
    """
    if problem.drive is None:
        return problem.parts_amplitude_from_time
    return comes_back(problem.t, x, v)


_AGAIN = 8
"""Steps of a refit that starts from the fit to all."""
_FEWEST_BLOCKS = 4
"""Blocks below which their scatter says nothing."""


@dataclass(frozen=True, slots=True)
class Tabulated:
    """A rung fitted to all, and what it misses of what it was not fitted to."""

    rung: Rung
    fit: TableFit
    held: Predicted


def fitted(rung: Rung, misfit: Misfit, model: Model, base: tuple[str, ...]) -> TableFit | None:
    """A rung beside a model, as smooth as blocks of the recording say; None where it cannot be simulated."""
    problem, scales = misfit.problem, misfit.scales
    if any(term.slot is Slot.FRICTION_MODULATION for term in rung.terms):
        model = with_friction(model, base, scales) or model
    most, block = TABLE_WORDS.value * misfit.words, blocks_of(misfit.strokes)
    with suppress(SimulationError):
        shown = observe(model, problem, (), scales, COARSE)
        basis = basis_of(rung, model, base, shown.x, shown.v, scales)
        free = free_of(model, base)
        # the terms of the model move with the base; of the tables only what the gauge leaves
        at = np.zeros(basis.free.shape[1])
        found = fit_tables(basis, basis.model, at, free, problem, scales, FIRST)
        every = range(int(block.max()) + 1)
        strength = strength_by_blocks(found, block, every, most)
        return fit_tables(basis, found.model, found.at, free, problem, scales, strength, found.penalty)
    return None


def held_out(found: TableFit, misfit: Misfit) -> Predicted | None:
    """What a rung misses of blocks of cycles that neither its values nor its smoothness were fitted to.

    None where it takes too little off of what it was fitted to: it would predict no better.
    """
    if found.squares > TABLE_BETTER.value**2 * misfit.base.chi2:
        return None
    problem, scales, block = misfit.problem, misfit.scales, blocks_of(misfit.strokes)
    most = TABLE_WORDS.value * misfit.words

    def refitted(out: BoolArray) -> Mapping[str, FloatArray] | None:
        with suppress(SimulationError):
            left_out = set(np.unique(block[out]).tolist())
            keep = [i for i in range(int(block.max()) + 1) if i not in left_out]
            strength = strength_by_blocks(found, block, keep, most)
            again = fit_tables(
                found.basis,
                found.model,
                found.at,
                found.free,
                problem.weighted(~out),
                scales,
                strength,
                found.penalty,
                _AGAIN,
            )
            return observe(again.model, problem, (), scales, FINE).y
        return None

    return by_blocks(problem, misfit.strokes, refitted)


def tabulated(misfit: Misfit, model: Model, names: tuple[str, ...], before: Predicted) -> tuple[Tabulated, ...]:
    """The rungs that stay beside a model, the one that predicts best first; none where none does.

    names : base parameters of the model's fit. before : what it misses of the blocks without a table.
    """
    base = tuple(dict.fromkeys((*names, *misfit.problem.starts.names)))
    shown = misfit.base.shown
    again = returns(misfit.problem, shown.x, shown.v)
    return climbed(lambda rung: fitted(rung, misfit, model, base), lambda found: held_out(found, misfit), before, again)


def climbed(
    fitted: Callable[[Rung], TableFit | None],
    held_out: Callable[[TableFit], Predicted | None],
    before: Predicted,
    again: bool,
) -> tuple[Tabulated, ...]:
    """Rungs, simple ones first, that predict clearly better than without them and than those that they hold.

    again : whether the path comes back, so that a table over the plane is the last of them: else it would follow any
    drift.
    """
    if before.by_span.size < _FEWEST_BLOCKS:
        return ()
    kept: dict[str, Tabulated] = {}

    def tried(rung: Rung) -> None:
        found = fitted(rung)
        held = None if found is None else held_out(found)
        if found is None or held is None:
            return
        if all(improves(held, one) for one in (before, *(kept[on].held for on in rung.on if on in kept))):
            kept[rung.said] = Tabulated(rung, found, held)

    def best_first() -> list[Tabulated]:
        return sorted(kept.values(), key=lambda one: one.held.total)

    for rung in RUNGS:
        tried(rung)
    for rung in over_plane([one.rung for one in best_first()]) if again else ():
        tried(rung)
    return tuple(best_first())


def improves(held: Predicted, before: Predicted) -> bool:
    """Whether so much less is missed that a table, or a further one, stays."""
    return ratio(held, before) <= TABLE_BETTER.value and surely_less(held, before, TABLE_ERRORS.value)


def finished(found: Tabulated, misfit: Misfit) -> Tabulated:
    """The same, fitted finely."""
    fit = found.fit
    with suppress(SimulationError):
        fit = fit_tables(
            fit.basis,
            fit.model,
            fit.at,
            fit.free,
            misfit.problem,
            misfit.scales,
            fit.strength,
            fit.penalty,
            effort=FINE,
        )
    return replace(found, fit=fit)
