"""Tables beside a model: fitted, and which of them stay.

Those stay that predict blocks of strokes which took no part in their fit, clearly better than without. Outer blocks
judge; how smooth a table is was chosen by inner ones, anew for each fold, so that no block takes part in what predicts
it. The first cycle, with the largest swings, is in every fit. Where a motion is followed each step of a fit is a
simulation; where a force is fitted the force asked for is linear in a table's values, and what reaches furthest or is
fastest is in every fit, too, so that no table is asked beyond what it has seen.
"""

import math
from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping
from contextlib import suppress
from dataclasses import dataclass, replace

import numpy as np

from harness.core.arrays import BoolArray, FloatArray, IntArray
from harness.core.errors import SimulationError
from harness.diagnosis.fit.model_fit import Fit, evaluate, whitened
from harness.diagnosis.grading.misfit import Misfit
from harness.diagnosis.grading.prediction import Predicted, blocks_of, by_blocks, ratio, surely_less
from harness.diagnosis.inverse_dynamics.strokes import ForceWords
from harness.diagnosis.inverse_dynamics.validate import held_out, left_out
from harness.diagnosis.parameters import Free, base_of, free_of, with_friction
from harness.diagnosis.problem import Problem
from harness.diagnosis.problems.inverse import InverseDynamics
from harness.diagnosis.problems.measured import Measured
from harness.diagnosis.problems.simulated import COARSE, FINE, observe
from harness.diagnosis.rules import PATH_AGAIN, PATH_APART, TABLE_BETTER, TABLE_ERRORS, TABLE_WORDS
from harness.diagnosis.tables.basis import RUNGS, Basis, Rung, basis_of, is_swept, over_plane
from harness.diagnosis.tables.fitted import FIRST, Look, TableFit, minimised, strength_by_blocks
from harness.kernels.solve import Effort, Scales
from harness.model.model import Model
from harness.model.term import Slot

_CELLS = 8
"""Cells along each side of the plane that was swept."""
_AGAIN = 8
"""Steps of a refit that starts from the fit to all."""
_FEWEST_BLOCKS = 4
"""Blocks below which their scatter says nothing."""
_CHI2_A_WORD = 30.0
"""Squares of the start a word, in the units of a misfit."""
_ABOUT = 1.1
"""Times the effective parameters allowed: a fit's partials move a little with it."""

Seeing = Callable[[Model, tuple[Free, ...], BoolArray | None, Effort], Callable[[Model], Look]]
"""From a start, what is free of it, the samples or values that are kept and the effort to a model beside the rest."""


@dataclass(frozen=True, slots=True)
class Tabulated:
    """A rung fitted to all, and what it misses of what it was not fitted to."""

    rung: Rung
    fit: TableFit
    held: Predicted


class Beside(ABC):
    """A model without a table, and what it leaves.

    base : names of the base parameters that are fitted. block (n,) : number of each value's block, -1 for those in
    every fit. words : of what is left. squares : that the model leaves.
    """

    def __init__(
        self, model: Model, base: tuple[str, ...], block: FloatArray, words: float, squares: float, scales: Scales
    ) -> None:
        self.model, self.base, self.block, self.scales = model, base, block, scales
        self.most = TABLE_WORDS.value * words
        self.squares = squares

    @property
    @abstractmethod
    def returns(self) -> bool:
        """Whether the path comes back, so that a force over the plane is told from a drift."""

    @abstractmethod
    def path(self, model: Model) -> tuple[FloatArray, FloatArray]:
        """x and v (n,) of the motion beside which tables of the model stand; raises SimulationError."""

    @abstractmethod
    def seeing(self, basis: Basis) -> Seeing:
        """How models with these tables are seen beside the recording."""

    @abstractmethod
    def missed(self, refitted: Callable[[BoolArray], Model]) -> Predicted | None:
        """What a model misses of blocks left out; refitted : to what is kept, which may raise SimulationError."""

    def fitted(self, rung: Rung) -> TableFit | None:
        """A rung, as smooth as blocks of strokes say; None where it cannot be simulated, or is of a direction in which
        nothing moves."""
        model = self.model
        if any(term.slot is Slot.FRICTION_MODULATION for term in rung.terms):
            model = with_friction(model, self.base, self.scales) or model
            if model.f_k <= 0.0:
                return None
        with suppress(SimulationError):
            x, v = self.path(model)
            if not is_swept(rung, v):
                return None
            basis = basis_of(rung, model, self.base, x, v, self.scales)
            # the terms of the model move with the base; of the tables only what the gauge leaves
            free, seeing, at = free_of(model, self.base), self.seeing(basis), np.zeros(basis.free.shape[1])
            found = minimised(basis, basis.model, at, free, seeing(basis.model, free, None, COARSE), FIRST)
            strength = strength_by_blocks(found, self.block, range(int(self.block.max()) + 1), self.most)
            look = seeing(found.model, free, None, COARSE)
            return minimised(basis, found.model, found.at, free, look, strength, found.penalty)
        return None

    def held_out(self, found: TableFit) -> Predicted | None:
        """What a rung misses of blocks that neither its values nor its smoothness were fitted to.

        None where it takes too little off of what it was fitted to: it would predict no better.
        """
        if found.squares > TABLE_BETTER.value**2 * self.squares:
            return None
        seeing = self.seeing(found.basis)

        def refitted(keep: BoolArray) -> Model:
            inner = np.unique(self.block[keep & (self.block >= 0)]).astype(np.int64).tolist()
            strength = strength_by_blocks(found, self.block, inner, self.most)
            return self.again(found, seeing, strength, keep).model

        return self.missed(refitted)

    def again(self, found: TableFit, seeing: Seeing, strength: float, keep: BoolArray) -> TableFit:
        """The same fitted to what is kept alone."""
        look = seeing(found.model, found.free, keep, COARSE)
        return minimised(found.basis, found.model, found.at, found.free, look, strength, found.penalty, _AGAIN)

    def tabulated(self, before: Predicted) -> tuple[Tabulated, ...]:
        """The rungs that stay, the one that predicts best first; before : what the model misses without a table.

        Simple ones come first, and each must predict clearly better than without it and than those that it holds.
        Where the path does not come back, a table over the plane would follow any drift.
        """
        kept: dict[str, Tabulated] = {}
        if before.by_span.size < _FEWEST_BLOCKS:
            return ()

        def tried(rung: Rung) -> None:
            found = self.fitted(rung)
            held = None if found is None else self.held_out(found)
            if found is None or held is None:
                return
            if all(improves(held, one) for one in (before, *(kept[on].held for on in rung.on if on in kept))):
                kept[rung.said] = Tabulated(rung, found, held)

        def best_first() -> list[Tabulated]:
            return sorted(kept.values(), key=lambda one: one.held.total)

        for rung in RUNGS:
            tried(rung)
        for rung in over_plane([one.rung for one in best_first()]) if self.returns else ():
            tried(rung)
        return tuple(best_first())


def improves(held: Predicted, before: Predicted) -> bool:
    """Whether so much less is missed that a table, or a further one, stays."""
    return ratio(held, before) <= TABLE_BETTER.value and surely_less(held, before, TABLE_ERRORS.value)


class MotionLeft(Beside):
    """What is left of a motion that is followed; names : base parameters of the model's fit."""

    def __init__(self, misfit: Misfit, model: Model, names: tuple[str, ...]) -> None:
        base = tuple(dict.fromkeys((*names, *misfit.problem.starts.names)))
        super().__init__(model, base, blocks_of(misfit.strokes), misfit.words, misfit.base.chi2, misfit.scales)
        self.misfit, self.problem = misfit, misfit.problem

    @property
    def returns(self) -> bool:
        """See ``returns``."""
        return returns(self.problem, self.misfit.base.shown.x, self.misfit.base.shown.v)

    def path(self, model: Model) -> tuple[FloatArray, FloatArray]:
        """Of the model."""
        shown = observe(model, self.problem, (), self.scales, COARSE)
        return shown.x, shown.v

    def seeing(self, basis: Basis) -> Seeing:
        """By simulation."""
        tables = tuple(Free(place, f"table {i}", -np.inf, np.inf, False) for i, place in enumerate(basis.places))

        def seen(_: Model, free: tuple[Free, ...], keep: BoolArray | None, effort: Effort) -> Callable[[Model], Look]:
            problem = self.problem if keep is None else self.problem.weighted(keep)

            def look(model: Model) -> Look:
                residual, jacobian, shown = evaluate(model, problem, (*free, *tables), self.scales, effort)
                return Look(residual, jacobian, shown.x, shown.v, shown)

            return look

        return seen

    def missed(self, refitted: Callable[[BoolArray], Model]) -> Predicted | None:
        """Of blocks of cycles, channel by channel."""

        def shown(out: BoolArray) -> Mapping[str, FloatArray] | None:
            with suppress(SimulationError):
                return observe(refitted(~out), self.problem, (), self.scales, FINE).y
            return None

        return by_blocks(self.problem, self.misfit.strokes, shown)

    def finished(self, found: Tabulated) -> Tabulated:
        """The same, fitted finely."""
        fit = found.fit
        with suppress(SimulationError):
            look = self.seeing(fit.basis)(fit.model, fit.free, None, FINE)
            fit = minimised(fit.basis, fit.model, fit.at, fit.free, look, fit.strength, fit.penalty)
        return replace(found, fit=fit)


class ForceLeft(Beside):
    """What is left of a measured force."""

    def __init__(self, start: Fit, problem: InverseDynamics, words: ForceWords, scales: Scales) -> None:
        block, squares = _covered(words, problem.measured), _CHI2_A_WORD * words.words
        super().__init__(start.model, base_of(start.free), block, words.words, squares, scales)
        self.start, self.problem, self.words = start, problem, words
        # from the problem's units to those of a misfit
        self.weight = math.sqrt(squares / max(start.chi2, 1e-300))
        measured = problem.measured
        inside = measured.slides
        self.motion = measured.x[inside] - start.model.offset, measured.v[inside]

    @property
    def returns(self) -> bool:
        """See ``comes_back``."""
        measured = self.problem.measured
        return comes_back(*(measured.blocks(y) for y in (measured.t, measured.x, measured.v)))

    def predicted(self, other: Fit | None = None) -> Predicted | None:
        """What the start, or another model without a table, misses of what is held out."""
        return held_out(other or self.start, self.problem, self.block)

    def path(self, model: Model) -> tuple[FloatArray, FloatArray]:
        """As it was measured, wherever the force is fitted."""
        return self.motion

    def seeing(self, basis: Basis) -> Seeing:
        """Tables are seen as they are at first, without any force: what is asked for is linear in their values."""
        terms, problem, weight = basis.model.terms, self.problem, self.weight
        # a factor on friction grows with it
        rubs = np.array([terms[i].term.slot is Slot.FRICTION_MODULATION for i, _ in basis.places])
        by_values = whitened(problem, problem.shows(basis.model, basis.places, self.scales, COARSE).dy)

        def seen(start: Model, free: tuple[Free, ...], keep: BoolArray | None, _: Effort) -> Callable[[Model], Look]:
            by = evaluate(start, problem, free, self.scales, COARSE)[1]
            kept = slice(None) if keep is None else keep

            def look(model: Model) -> Look:
                columns = by_values
                if np.any(rubs):
                    columns = np.where(rubs, columns * (model.f_k / basis.model.f_k), columns)
                residual = evaluate(model, problem, (), self.scales, COARSE)[0]
                return Look((weight * residual)[kept], weight * np.hstack((by, columns))[kept], *self.motion)

            return look

        return seen

    def held_out(self, found: TableFit) -> Predicted | None:
        """None too where even the smoothest has more freedom than the words allow."""
        return None if found.effective > _ABOUT * self.most else super().held_out(found)

    def missed(self, refitted: Callable[[BoolArray], Model]) -> Predicted | None:
        """Of blocks of strokes."""
        return left_out(self.problem, self.block, lambda part: refitted(self._inside(part)))

    def over(self, found: TableFit, part: InverseDynamics) -> Model:
        """The tables' model fitted to the values that count in a part of the problem, as smooth as it was."""
        return self.again(found, self.seeing(found.basis), found.strength, self._inside(part)).model

    def _inside(self, part: InverseDynamics) -> BoolArray:
        """Which of the values (m,) count in a part of the problem."""
        return part.measured.moving[self.problem.measured.moving]


def _covered(words: ForceWords, measured: Measured) -> FloatArray:
    """Blocks (m,) without the pieces of strokes that reach furthest and are fastest, numbered on."""
    block = blocks_of(words.pieces)
    x, v = measured.blocks(measured.x), measured.blocks(measured.v)
    ends = [int(i) for y in (x, v) for i in (np.argmin(y), np.argmax(y))]
    block = np.where(np.isin(words.pieces.of, words.pieces.of[ends]), -1.0, block)
    numbers = np.unique(block[block >= 0])
    return np.asarray(np.where(block >= 0, np.searchsorted(numbers, block), -1.0), dtype=np.float64)


def returns(problem: Problem, x: FloatArray, v: FloatArray) -> bool:
    """Whether the path of a motion x, v (n,) that is followed comes back: several amplitudes, or a drive that does it.

    A free decay passes each place of the plane once, and two alike pass the same ones.
    """
    return problem.parts_amplitude_from_time if problem.drive is None else comes_back(problem.t, x, v)


def comes_back(t: FloatArray, x: FloatArray, v: FloatArray) -> bool:
    """Whether most of the time is spent in cells that are seen again at clearly different times; each (n,)."""
    return time_again(t, x, v) >= PATH_AGAIN.value


def time_again(t: FloatArray, x: FloatArray, v: FloatArray) -> float:
    """Share of the samples whose cell of the plane is seen at times so far apart; each (n,)."""
    if float(np.ptp(x)) == 0.0 or float(np.ptp(v)) == 0.0:
        return 0.0

    def part(y: FloatArray) -> IntArray:
        return np.asarray(np.minimum(_CELLS * (y - y.min()) / np.ptp(y), _CELLS - 1), dtype=np.int64)

    cell = _CELLS * part(x) + part(v)
    first, last = np.full(_CELLS**2, np.inf), np.full(_CELLS**2, -np.inf)
    np.minimum.at(first, cell, t)
    np.maximum.at(last, cell, t)
    return float(np.mean((last - first)[cell] >= PATH_APART.value * float(t[-1] - t[0])))
