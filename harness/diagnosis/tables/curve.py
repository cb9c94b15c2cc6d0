"""A fitted table as a curve: what it says over the swept range, with one standard error, and what its gauge leaves out.

The error is the larger of two: the penalised fit read as a posterior (Nychka 1988, J. Am. Stat. Assoc. 83, 1134), its
noise as large as the scores of strokes scatter, and those scores through the fit (Liang and Zeger 1986). A misfit
says one thing for half a swing; samples are no independent words. To it is added what else may be in the table: small
effects that it has taken in are held to be as large, in proportion, as what it leaves of blocks left out; and what a
rougher table says otherwise, which the blocks ask for and so few words do not allow. How much all of that falls short
of, simulated machines say (rule table-band).

How smooth tables are: as inner blocks say, each left out in turn and predicted.

The model is linear about a fit, so that no block needs a simulation of its own (Stone 1974, J. R. Stat. Soc. B 36,
111).
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal, TypeAlias

import numpy as np

from harness.core.arrays import BoolArray, FloatArray
from harness.diagnosis.baseline.words import Strokes
from harness.diagnosis.grading.prediction import blocks_of
from harness.diagnosis.outcome import Table
from harness.diagnosis.rules import TABLE_BAND
from harness.diagnosis.tables.basis import partials
from harness.diagnosis.tables.fitted import TableFit
from harness.fit.covariance import inverse_of
from harness.kernels.solve import Scales
from harness.model.model import ModelTerm
from harness.model.term import Slot

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


Quantity: TypeAlias = Literal["x", "v", "|v|"]
POINTS = 121
"""Of a curve."""


@dataclass(frozen=True, slots=True)
class Strip:
    """A piece of a curve over one quantity: where it is known, and the fit's partials (m, q) of its force there."""

    of: Quantity
    at: FloatArray
    columns: FloatArray
    unit_force: bool


_LEAST_TAKEN = 0.01
"""Share of the squares that a table takes at least, as the band counts it."""


def covariances(found: TableFit, strokes: Strokes) -> tuple[FloatArray, FloatArray]:
    """Posterior and sandwich (p, p) of base parameters and coordinates of the tables; strokes : of the residual."""
    curvature = found.curvature
    inverse = inverse_of(curvature.at(found.strength))
    cluster, count = strokes.of, strokes.count
    n, p = cluster.size, found.jacobian.shape[1]
    scores = np.zeros((count, p))
    for i in range(found.residual.size // n):
        rows = slice(i * n, (i + 1) * n)
        each = found.jacobian[rows] * found.residual[rows, None]
        scores += np.column_stack([np.bincount(cluster, each[:, j], count) for j in range(p)])
    # the fit has taken its own share of what the strokes say
    taken = len(found.free) + curvature.effective(found.strength)
    meat = scores.T @ scores * count / max(count - taken, 1.0)
    inflated = float(np.trace(inverse @ meat)) / max(float(np.trace(inverse @ curvature.seen)), 1e-300)
    return inverse * inflated, inverse @ meat @ inverse


def table_of(
    found: TableFit, strokes: Strokes, scales: Scales, numbers: tuple[int, ...], said: str, held: float
) -> Table:
    """Some of the tables of a fit as one curve.

    strokes : of the residual, (n,). numbers : of the tables, places among the model's terms. held : held-out error with
    them, over that without.
    """
    strips = [_strip(found, i, scales) for i in numbers]
    strips.sort(key=lambda one: float(one.at[0]))
    of: Quantity = strips[0].of if len(strips) == 1 else "v"
    at = np.concatenate([s.at for s in strips])
    columns = np.vstack([s.columns for s in strips])
    level = math.inf if strips[0].unit_force else found.model.f_k
    factor = 1.0 if math.isinf(level) else level
    x, v = found.look.x, found.look.v
    quantity = {"x": x, "|v|": np.abs(v), "v": v}[of]
    # in the middle of parts of equal counts: their mean is the motion's
    looks = np.quantile(quantity[v != 0.0], (np.arange(POINTS) + 0.5) / POINTS)
    # friction is never below none
    force = np.maximum(factor * (columns @ found.at), -level)
    size = float(np.sqrt(np.mean(np.interp(looks, at, force) ** 2)))
    # a modulation of no friction is no force, and its error none
    stderr = factor * errors(found, strokes, columns, size / factor if factor > 0.0 else 0.0, held)
    return Table(said, of, at, force, stderr, looks, _gauge(found, of, strips[0].unit_force))


def errors(found: TableFit, strokes: Strokes, columns: FloatArray, size: float, held: float) -> FloatArray:
    """One standard error of what tables say, (m,), by their partials (m, q); size : rms of it over the motion."""
    b = len(found.free)
    spread = [
        np.sqrt(np.maximum(np.einsum("ij,jk,ik->i", columns, v[b:, b:], columns), 0.0))
        for v in covariances(found, strokes)
    ]
    beside = size * held / math.sqrt(max(1.0 - held**2, _LEAST_TAKEN))
    smoothed = columns @ (rougher(found, blocks_of(strokes)) - found.at)
    said = np.hypot(np.hypot(np.maximum(*spread), beside), smoothed)
    return np.asarray(TABLE_BAND.value * said, dtype=np.float64)


def _gauge(found: TableFit, of: Quantity, unit_force: bool) -> tuple[str, ...]:
    """What the table has none of: "constant" or "level" (one that is a given force's), "line"."""
    names = {f.name for f in found.free}
    if of != "x":
        return ("line",)
    if not unit_force:
        return ("constant",)
    constant = ("constant",) if "offset" in names else (("level",) if found.model.has_level else ())
    return (*constant, *(("line",) if "k" in names else ()))


def _strip(found: TableFit, number: int, scales: Scales) -> Strip:
    """One table over the range in which it is known."""
    entry: ModelTerm = found.model.terms[number]
    known = entry.term.known
    assert known is not None
    low, high = known.ends(entry.values)
    at = np.linspace(low, high, POINTS)
    mine = [c for c, (i, _) in enumerate(found.basis.places) if i == number]
    side = -1.0 if known.of == "-v" else 1.0
    x, v = (at, np.ones(POINTS)) if known.of == "x" else (np.zeros(POINTS), side * at)
    rows = partials(found.model, number, x, v, scales) @ found.basis.free[mine]
    if side < 0.0:
        at, rows = -at[::-1], rows[::-1]
    of: Quantity = "v" if known.of in ("v", "-v") else "x" if known.of == "x" else "|v|"
    return Strip(of, at, rows, entry.term.slot is Slot.SMOOTH)
