"""Tables fitted to a measured force: what inverse dynamics leave over, by least squares; nothing is simulated.

The force asked for is linear in a table's values, so that their partials are the force that a unit of each adds. What
is held out are blocks of strokes; the first ones, and those that reach furthest or are fastest, are in every fit, so
that no table is asked beyond what it has seen.
"""

import math
from contextlib import suppress
from dataclasses import dataclass, replace

import numpy as np

from harness.core.arrays import BoolArray, FloatArray
from harness.core.errors import SimulationError
from harness.diagnosis.fit.friction_back import with_friction
from harness.diagnosis.fit.parameters import base_of, free_of
from harness.diagnosis.grading.prediction import Predicted, blocks_of
from harness.diagnosis.inverse_dynamics.force_fit import ForceFit
from harness.diagnosis.inverse_dynamics.grade import held_out as held_out_alone
from harness.diagnosis.inverse_dynamics.left_out import left_out
from harness.diagnosis.inverse_dynamics.measured import BLOCK, Measured
from harness.diagnosis.inverse_dynamics.strokes import ForceWords
from harness.diagnosis.rules import TABLE_BETTER, TABLE_WORDS
from harness.diagnosis.tables.basis import Basis, basis_of
from harness.diagnosis.tables.fitted import FIRST, Look, TableFit, minimised
from harness.diagnosis.tables.path import comes_back
from harness.diagnosis.tables.rungs import Rung
from harness.diagnosis.tables.selection import Tabulated, climbed
from harness.diagnosis.tables.smoothness import strength_by_blocks
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
