"""How smooth tables are: as inner blocks say, each left out in turn and predicted.

The model is linear about a fit, so that no block needs a simulation of its own (Stone 1974, J. R. Stat. Soc. B 36,
111).
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from harness.core.arrays import BoolArray, FloatArray
from harness.diagnosis.tables.fitted import TableFit
from harness.fit.covariance import inverse_of

STRENGTHS = tuple(10.0**power for power in range(-5, 4))
"""Penalties tried, in units at which the penalty weighs as much as the recording."""
_HALVINGS = 5
"""Of the step between two penalties, towards the one that uses all the freedom there is."""


@dataclass(frozen=True, slots=True)
class Blocks:
    """What each block of a recording says of a linear model about a fit: J'J (m, p, p), J'y (m, p), y'y (m,).

    Number 0 is what is in no block, the largest swings, and is never left out.
    """

    normal: FloatArray
    pull: FloatArray
    size: FloatArray

    @classmethod
    def of(cls, found: TableFit, block: FloatArray) -> "Blocks":
        """block (n,) : number of each sample's block, -1 for those in none."""
        number = np.tile(block.astype(np.int64) + 1, found.residual.size // block.size)
        b = len(found.free)
        offset = np.concatenate((np.zeros(b), found.at))
        # about the fit: base parameters by what they move, tables by their coordinates
        y = found.residual + found.jacobian @ offset
        parts = [number == i for i in range(int(number.max()) + 1)]
        return cls(
            np.array([found.jacobian[p].T @ found.jacobian[p] for p in parts]),
            np.array([found.jacobian[p].T @ y[p] for p in parts]),
            np.array([float(y[p] @ y[p]) for p in parts]),
        )

    def missed(self, keep: BoolArray, out: BoolArray, penalty: FloatArray) -> float:
        """Squares missed of the blocks ``out`` by a fit to the blocks ``keep``; penalty (p, p)."""
        p = inverse_of(self.normal[keep].sum(axis=0) + penalty) @ self.pull[keep].sum(axis=0)
        return float(self.size[out].sum() - 2.0 * p @ self.pull[out].sum(axis=0) + p @ self.normal[out].sum(axis=0) @ p)


def strength_by_blocks(found: TableFit, block: FloatArray, keep: Sequence[int], most: float) -> float:
    """The penalty at which blocks of ``keep``, left out one at a time, are predicted best.

    most : effective parameters that the tables may have; where none of the penalties tried keeps to it, the largest.
    """
    blocks, b, p = Blocks.of(found, block), len(found.free), found.jacobian.shape[1]
    rough = np.zeros((p, p))
    rough[b:, b:] = found.penalty.T @ found.penalty
    best, least = STRENGTHS[-1], np.inf
    for strength in _within(found, most):
        missed = 0.0
        for i in keep:
            rest = np.zeros(len(blocks.size), dtype=np.bool_)
            rest[[0, *(j + 1 for j in keep if j != i)]] = True
            out = np.zeros(len(blocks.size), dtype=np.bool_)
            out[i + 1] = True
            missed += blocks.missed(rest, out, strength * rough)
        if missed < least:
            best, least = strength, missed
    return best


def _within(found: TableFit, most: float) -> list[float]:
    """The penalties that keep to so many effective parameters, the strongest first, and last the one that uses all."""
    kept: list[float] = []
    curvature = found.curvature
    for strength in reversed(STRENGTHS):
        if curvature.effective(strength) > most:
            if kept:
                low, high = math.log(strength), math.log(kept[-1])
                for _ in range(_HALVINGS):
                    middle = 0.5 * (low + high)
                    within = curvature.effective(math.exp(middle)) <= most
                    low, high = (low, middle) if within else (middle, high)
                kept.append(math.exp(high))
            break
        kept.append(strength)
    return kept


def rougher(found: TableFit, block: FloatArray) -> FloatArray:
    """Coordinates (q,) of the tables as rough as blocks alone would have them, however few words there are.

    Linear about the fit; those of the fit itself where the words do not bound it.
    """
    strength = strength_by_blocks(found, block, range(int(block.max()) + 1), np.inf)
    if strength >= found.strength:
        return found.at
    b = len(found.free)
    y = found.residual + found.jacobian[:, b:] @ found.at
    return np.asarray((inverse_of(found.curvature.at(strength)) @ (found.jacobian.T @ y))[b:])
