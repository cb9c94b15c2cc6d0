"""What differs between two conditions of one thing, from what repeated measurements say of its numbers.

Numbers of a condition are alike up to what repeats differ by (a random effect beside the error of each measurement).
Between the conditions they are moved along as few directions as leave no more than chance explains: of one number
alone, or of several in proportion, as a larger inertia makes all forces per mass less. Every measurement is weighed by
its whole covariance (generalised least squares; Rao 1973, Linear Statistical Inference, 4a), so that two numbers which
a recording hardly parts are not told to have changed one against the other.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.special import fdtrc

from harness.core.arrays import BoolArray, FloatArray
from harness.estimate.repeated import repeated


@dataclass(frozen=True, slots=True)
class Repeats:
    """What is known beforehand of how far repeats differ: relative (p,), as so many degrees of freedom."""

    relative: FloatArray
    freedom: float


@dataclass(frozen=True, slots=True)
class Moved:
    """A direction: what its numbers are afterwards over what they were, with one standard error."""

    ratio: float
    stderr: float


@dataclass(frozen=True, slots=True)
class Changed:
    """directions : those that were moved, the clearest first. chance : that alike conditions differ so much. left :
    that what is left differs so much. before, after (p, 2) : numbers with errors. moves : of every number and
    direction, beside those that were moved. between (p,) : standard deviation of repeats.
    """

    directions: tuple[str, ...]
    chance: float
    left: float
    before: FloatArray
    after: FloatArray
    moves: Mapping[str, Moved]
    between: FloatArray


class Conditions:
    """Measurements values (n, p) with covariances (n, p, p), which (n,) of them are of the second condition.

    together : further directions by name, as the numbers (p,) that they move in proportion.
    """

    def __init__(
        self,
        names: Sequence[str],
        values: FloatArray,
        covariances: FloatArray,
        second: BoolArray,
        together: Mapping[str, BoolArray],
        repeats: Repeats,
    ) -> None:
        self.names, self.second, self.freedom = tuple(names), second, repeats.freedom
        # each number in units of itself before: a move is a relative one
        size = np.abs(np.mean(values[~second], axis=0))
        everywhere = np.sqrt(np.mean(np.diagonal(covariances, axis1=1, axis2=2), axis=0))
        self.size: FloatArray = np.maximum(size, everywhere)
        self.values = values / self.size
        self.within = covariances / np.outer(self.size, self.size)
        self.between, self.degrees = self._between(repeats)
        self.precision = np.linalg.inv(self.within + np.diag(self.between**2))
        p = len(self.names)
        mean = np.mean(self.values[~second], axis=0)
        self.ways = {
            **{name: np.eye(p)[i] for i, name in enumerate(self.names)},
            **{name: np.where(of, mean, 0.0) for name, of in together.items()},
        }

    def _between(self, repeats: Repeats) -> tuple[FloatArray, float]:
        """Standard deviation of repeats (p,), and the degrees of freedom that it rests on."""
        found, seen = repeats.freedom * repeats.relative**2, 0
        errors = np.sqrt(np.diagonal(self.within, axis1=1, axis2=2))
        for of in (self.second, ~self.second):
            more = int(np.count_nonzero(of)) - 1
            if more > 0:
                each = zip(self.values[of].T, errors[of].T, strict=True)
                found = found + more * np.array([repeated(y.tolist(), e.tolist()).between ** 2 for y, e in each])
                seen += more
        return np.sqrt(found / (repeats.freedom + seen)), repeats.freedom + seen

    def fitted(self, ways: Sequence[str]) -> tuple[FloatArray, FloatArray, float]:
        """Means before and moves along ways (p + s,), their covariance, and chi-square."""
        p, s = len(self.names), len(ways)
        normal, pull, squares = np.zeros((p + s, p + s)), np.zeros(p + s), 0.0
        along = np.column_stack([self.ways[way] for way in ways]) if s else np.zeros((p, 0))
        for y, weight, after in zip(self.values, self.precision, self.second, strict=True):
            design = np.hstack((np.eye(p), along * float(after)))
            normal += design.T @ weight @ design
            pull += design.T @ weight @ y
            squares += float(y @ weight @ y)
        covariance = np.asarray(np.linalg.pinv(normal, hermitian=True), dtype=np.float64)
        found: FloatArray = covariance @ pull
        return found, covariance, max(squares - float(pull @ found), 0.0)

    def chance(self, ways: Sequence[str]) -> float:
        """That conditions which differ along these ways alone differ so much."""
        freedom = len(self.names) - len(ways)
        if freedom <= 0:
            return 1.0
        more = max(self.fitted(ways)[2] - self.fitted(self.names)[2], 0.0)
        return float(fdtrc(freedom, self._degrees(), more / freedom))

    def _degrees(self) -> float:
        """Of the whole variance, of which repeats are a share (Satterthwaite 1946)."""
        own = np.mean(np.diagonal(self.within, axis1=1, axis2=2), axis=0)
        share = float(np.max(self.between**2 / (self.between**2 + own)))
        return self.degrees / max(share**2, 1e-12)

    def compared(self, alike: float, most: int) -> Changed:
        """The fewest directions, at most so many, beside which what is left is no rarer than ``alike``."""
        chosen: list[str] = []
        whole = left = self.chance(())
        while left < alike and len(chosen) < most:
            able = [way for way in self.ways if way not in chosen]
            best = min(able, key=lambda way: self.fitted((*chosen, way))[2])
            chosen.append(best)
            left = self.chance(chosen)
        found, covariance, _ = self.fitted(chosen)
        p = len(self.names)
        along = np.column_stack([self.ways[way] for way in chosen]) if chosen else np.zeros((p, 0))
        shift = np.hstack((np.eye(p), along))
        after, spread = shift @ found, shift @ covariance @ shift.T
        before = np.column_stack((found[:p], np.sqrt(np.diag(covariance)[:p])))
        moves = {way: self._moved(way, chosen) for way in self.ways}
        size = self.size.reshape(-1, 1)
        return Changed(
            tuple(sorted(chosen, key=lambda way: -abs(moves[way].ratio - 1.0) / moves[way].stderr)),
            whole,
            left,
            before * size,
            np.column_stack((after, np.sqrt(np.diag(spread)))) * size,
            moves,
            self.between * self.size,
        )

    def _moved(self, way: str, chosen: Sequence[str]) -> Moved:
        """By how much a direction is moved, beside those that were chosen."""
        ways = [*(one for one in chosen if one != way), way]
        found, covariance, _ = self.fitted(ways)
        start = 1.0 if way not in self.names else max(abs(float(found[self.names.index(way)])), 1e-300)
        return Moved(1.0 + float(found[-1]) / start, math.sqrt(max(float(covariance[-1, -1]), 0.0)) / start)
