"""What has no name gets a model where a force is fitted: the last step of such a diagnosis.

Tables fitted to a measured force: what inverse dynamics leave over, by least squares; nothing is simulated.

The force asked for is linear in a table's values, so that their partials are the force that a unit of each adds. What
is held out are blocks of strokes; the first ones, and those that reach furthest or are fastest, are in every fit, so
that no table is asked beyond what it has seen.
"""

import math
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import dataclass, replace

import numpy as np

from harness.core.arrays import BoolArray, FloatArray
from harness.core.errors import SimulationError
from harness.diagnosis.explain.graded import prediction, remainder_of
from harness.diagnosis.fit.observe import Observation
from harness.diagnosis.fit.parameters import base_of, free_of, with_friction
from harness.diagnosis.grading.prediction import Predicted, blocks_of, ratio
from harness.diagnosis.inverse_dynamics.force_fit import ForceFit, as_fit, simulated
from harness.diagnosis.inverse_dynamics.force_screen import seen_in
from harness.diagnosis.inverse_dynamics.grade import ForceGraded
from harness.diagnosis.inverse_dynamics.grade import held_out as held_out_alone
from harness.diagnosis.inverse_dynamics.holdout import left_out, predicted_windows
from harness.diagnosis.inverse_dynamics.measured import BLOCK, Measured
from harness.diagnosis.inverse_dynamics.strokes import ForceWords
from harness.diagnosis.outcome import Holdout, Outcome
from harness.diagnosis.problems.driven import InverseDynamics
from harness.diagnosis.rules import TABLE_BETTER, TABLE_OVER_NOISE, TABLE_WORDS
from harness.diagnosis.tables.basis import Basis, Rung, basis_of
from harness.diagnosis.tables.curve import strength_by_blocks
from harness.diagnosis.tables.drawn import Drawn
from harness.diagnosis.tables.fitted import FIRST, Look, TableFit, minimised
from harness.diagnosis.tables.selection import Tabulated, climbed, comes_back, improves
from harness.diagnosis.tables.step import RULES, Modelled, told
from harness.kernels.solve import Scales
from harness.model.model import Model
from harness.model.term import Slot

_CHI2_A_WORD = 30.0
"""Squares of the start a word, in the units of a misfit."""
_ABOUT = 1.1
"""Times the effective parameters allowed: a fit's partials move a little with it."""
_AGAIN = 8
"""Steps of a refit that starts from the fit to all."""


@dataclass(frozen=True, slots=True)
class ForceLeft:
    """A model whose force is fitted, and what it leaves for tables.

    start : without a table. block (m,) : of the values that are held out, -1 for those in every fit.
    """

    start: ForceFit
    measured: Measured
    words: ForceWords
    scales: Scales
    block: FloatArray

    @classmethod
    def of(cls, start: ForceFit, measured: Measured, words: ForceWords, scales: Scales) -> "ForceLeft":
        """Blocks as for names, but for the strokes that reach furthest."""
        return cls(start, measured, words, scales, _covered(words, measured))

    @property
    def motion(self) -> tuple[FloatArray, FloatArray]:
        """x (the model's) and v where the force is fitted, at every sample."""
        inside = np.repeat(self.measured.moving, BLOCK)
        return self.measured.x[inside] - self.start.model.offset, self.measured.v[inside]

    @property
    def weight(self) -> float:
        """From force to the units of a misfit."""
        return math.sqrt(_CHI2_A_WORD * self.words.words / max(self.start.squares, 1e-300))

    def predicted(self, other: ForceFit | None = None) -> Predicted | None:
        """What the start, or another model without a table, misses of what is held out."""
        return held_out_alone(other or self.start, self.measured, self.block)

    def tabulated(self, before: Predicted) -> tuple[Tabulated, ...]:
        """The rungs that stay beside the start, the one that predicts best first; before : what it misses."""
        return climbed(self.fitted, self.held_out, before, self.returns)

    @property
    def returns(self) -> bool:
        """Whether the path comes back."""
        return comes_back(*(self.measured.blocks(y) for y in (self.measured.t, self.measured.x, self.measured.v)))

    def fitted(self, rung: Rung) -> TableFit | None:
        """A rung, as smooth as blocks of strokes say; None where a law overflows."""
        base, model = base_of(self.start.free), self.start.model
        if any(term.slot is Slot.FRICTION_MODULATION for term in rung.terms):
            model = with_friction(model, base, self.scales) or model
            if model.f_k <= 0.0:
                return None
        x, v = self.motion
        with suppress(SimulationError):
            basis = basis_of(rung, model, base, x, v, self.scales)
            seen = _Seen.of(self, basis)
            every = np.ones(self.block.size, dtype=np.bool_)
            found = self._fit(seen, basis.model, np.zeros(basis.free.shape[1]), FIRST, None, every)
            strength = strength_by_blocks(found, self.block, range(int(self.block.max()) + 1), self._most)
            return self._fit(seen, found.model, found.at, strength, found.penalty, every)
        return None

    def held_out(self, found: TableFit) -> Predicted | None:
        """What a rung misses of blocks of strokes that neither its values nor its smoothness were fitted to.

        None where it takes too little off of what it was fitted to, so that it would predict no better, and where even
        the smoothest has more freedom than the words allow.
        """
        if found.squares > TABLE_BETTER.value**2 * _CHI2_A_WORD * self.words.words:
            return None
        if found.effective > _ABOUT * self._most:
            return None
        seen = _Seen.of(self, found.basis)

        def refitted(keep: BoolArray) -> Model:
            inner = np.unique(self.block[keep & (self.block >= 0)]).astype(np.int64).tolist()
            strength = strength_by_blocks(found, self.block, inner, self._most)
            return self._fit(seen, found.model, found.at, strength, found.penalty, keep, _AGAIN).model

        return left_out(self.measured, self.block, refitted)

    def over(self, found: TableFit, keep: BoolArray) -> Model:
        """The tables' model fitted to the values (m,) that are kept alone, as smooth as it was."""
        seen = _Seen.of(self, found.basis)
        return self._fit(seen, found.model, found.at, found.strength, found.penalty, keep, _AGAIN).model

    @property
    def _most(self) -> float:
        """Effective parameters of the tables."""
        return TABLE_WORDS.value * self.words.words

    def _fit(
        self,
        seen: "_Seen",
        start: Model,
        at: FloatArray,
        strength: float,
        penalty: FloatArray | None,
        keep: BoolArray,
        iterations: int = 12,
    ) -> TableFit:
        free = free_of(replace(start, terms=start.terms[: len(self.start.model.terms)]), base_of(self.start.free))
        by = self.measured.even(self.measured.asked_by(start, free)[1])
        return minimised(
            seen.basis, start, at, free, lambda model: seen.look(model, by, keep), strength, penalty, iterations
        )


@dataclass(frozen=True, slots=True)
class _Seen:
    """Tables beside a force. by_values (m, K) : of the force asked for; rubs (K,) : those that grow with friction."""

    left: ForceLeft
    basis: Basis
    by_values: FloatArray
    rubs: BoolArray

    @classmethod
    def of(cls, left: ForceLeft, basis: Basis) -> "_Seen":
        """Of the tables as they are at first, without any force: what is asked for is linear in their values."""
        terms = basis.model.terms
        rubs = np.array([terms[i].term.slot is Slot.FRICTION_MODULATION for i, _ in basis.places])
        numbers = {f.by: f for f in free_of(basis.model, ())}
        _, by = left.measured.asked_by(basis.model, tuple(numbers[place] for place in basis.places))
        return cls(left, basis, left.measured.even(by), rubs)

    def look(self, model: Model, by: FloatArray, keep: BoolArray) -> Look:
        """A model beside the values that are kept; by (m, b) : partials by the base parameters."""
        measured, weight = self.left.measured, self.left.weight
        columns = self.by_values
        if np.any(self.rubs):
            columns = np.where(self.rubs, columns * (model.f_k / self.basis.model.f_k), columns)
        residual = measured.even(measured.blocks(measured.u) - measured.asked(model))
        return Look((weight * residual)[keep], weight * np.hstack((by, columns))[keep], *self.left.motion)


def _covered(words: ForceWords, measured: Measured) -> FloatArray:
    """Blocks (m,) without the pieces of strokes that reach furthest and are fastest, numbered on."""
    block = blocks_of(words.pieces)
    x, v = measured.blocks(measured.x), measured.blocks(measured.v)
    ends = [int(i) for y in (x, v) for i in (np.argmin(y), np.argmax(y))]
    block = np.where(np.isin(words.pieces.of, words.pieces.of[ends]), -1.0, block)
    numbers = np.unique(block[block >= 0])
    return np.asarray(np.where(block >= 0, np.searchsorted(numbers, block), -1.0), dtype=np.float64)


def with_force_tables(outcome: Outcome, graded: ForceGraded) -> Outcome:
    """The outcome with tables of the force that no name says, where they predict; as it is where none does."""
    left, problem = outcome.remainder, outcome.problem
    if left is None or left.over_noise <= TABLE_OVER_NOISE.value or not isinstance(problem, InverseDynamics):
        return outcome
    main = outcome.verdict == "main_effect"
    # in the place of what was kept without a headline, or on top of it
    starts = [graded.best] if main or graded.best is graded.base else [graded.base, graded.best]
    for start in starts:
        seen = ForceLeft.of(start, graded.measured, graded.counted, outcome.scales)
        before = seen.predicted()
        kept = () if before is None else seen.tabulated(before)
        # what was listed, or is a small part, is a model too
        rival = None if graded.best is start else seen.predicted(graded.best)
        if before is not None and kept and (rival is None or improves(kept[0].held, rival)):
            windows = _windows(kept[0].fit, seen, problem)
            # what cannot follow the motion, or misses more of it than the base model does, is no model of it
            if not _follows(windows, outcome.holdout):
                continue
            with suppress(SimulationError):
                shown = simulated(_by_force(kept[0].fit, seen), problem, outcome.scales)
                return _told(outcome, graded, seen, before, kept, problem, shown, windows)
    return replace(outcome, rules=(*outcome.rules, *RULES))


def _windows(found: TableFit, seen: ForceLeft, problem: InverseDynamics) -> dict[str, float] | None:
    """Rmse by channel over windows that tables took no part in."""
    return predicted_windows(problem, lambda part: seen.over(found, part.moving[seen.measured.moving]), seen.scales)


def _follows(windows: Mapping[str, float] | None, held: Holdout) -> bool:
    """Whether no channel is missed by more than by the base model."""
    before = held.baseline_rmse
    return windows is None or all(size <= before.get(channel, math.inf) for channel, size in windows.items())


def _told(
    outcome: Outcome,
    graded: ForceGraded,
    seen: ForceLeft,
    before: Predicted,
    kept: tuple[Tabulated, ...],
    problem: InverseDynamics,
    shown: Observation,
    windows: Mapping[str, float] | None,
) -> Outcome:
    """The outcome with the best of the tables that stay; before : what is missed without one. shown : with it."""
    first, start, measured = kept[0], seen.start, graded.measured
    found, scales = first.fit, outcome.scales
    after = _by_force(found, seen)
    refined = as_fit(after, problem, measured, graded.reference, shown)
    held, evidence = ratio(first.held, before), seen_in(start, measured, problem, scales)
    independent = graded.reference.memory.independent
    gained = start.bic(independent) - after.bic(independent) - found.effective * math.log(independent)
    base_held = before if start is graded.base else seen.predicted(graded.base)
    holdout = outcome.holdout
    if windows is not None:
        holdout = replace(holdout, refined_rmse=windows) if holdout.spans else holdout
    return told(
        outcome,
        Modelled(
            kept=kept,
            refined=refined,
            drawn=Drawn.of(first, start.model, problem, seen.words.pieces, scales, held, evidence),
            share=min(max((start.squares - after.squares) / graded.excess, 0.0), 1.0),
            gained=gained,
            doubt=_doubt(seen),
            predicted=prediction(base_held, first.held),
            holdout=holdout if windows is not None else Holdout.none("refined"),
            remainder=remainder_of(replace(graded, best=after)),
        ),
    )


def _by_force(found: TableFit, seen: ForceLeft) -> ForceFit:
    """The fit by its base parameters, in newtons; its partials are what the tables cannot take over."""
    b = len(found.free)
    by = found.beside(found.jacobian[:, :b], found.jacobian[:, b:])
    residual = found.residual / seen.weight
    return ForceFit(found.model, found.free, residual, by / seen.weight, seen.measured.begins)


def _doubt(seen: ForceLeft) -> str:
    """A path that repeats itself shows a place at one phase of the drive alone."""
    if seen.words.period is None:
        return ""
    return f"or it keeps time with the drive, which repeats itself every {seen.words.period:.3g} s"
