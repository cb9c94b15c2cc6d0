"""One least-squares problem of the whole arm: every joint's guarded, whitened torque under what is in the model."""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.fft import next_fast_len
from scipy.special import gammaincc, gammaln, ndtri_exp

from harness.core.arrays import FloatArray
from harness.fit.autocorrelation import memory
from harness.robot.whole_arm.columns import Candidate
from harness.robot.whole_arm.noise import Noise, Stretches

_FAR = 300.0
"""Half a chi-square beyond which its chance is too small for a float."""


def evidence(gain: float, columns: float, looks: float = 1.0) -> float:
    """Gain of one column that is as unlikely by chance as this one, (its estimate over its standard error) squared.

    gain : what a fit gains, twice the logarithm of its likelihood; chi-square of so many ``columns`` by chance alone.
    looks : independent settings of which it is the best. 0 where chance does as well.
    """
    if gain <= 0.0:
        return 0.0
    return evidence_of_chance(_log_tail(gain, columns), looks, gain)


def evidence_of_chance(log_chance: float, looks: float = 1.0, gain: float = 0.0) -> float:
    """The same from the logarithm of a chance of one setting.

    The best of many neighbours exceeds a gain more often than so many settings apart, as it may do so between them:
    by its square root (Davies 1987, Biometrika 74, 33).
    """
    between = math.sqrt(math.pi / 8.0) * (looks - 1.0) * math.sqrt(max(gain, 1.0))
    chance = log_chance + math.log1p(max(between, 0.0))
    return float(ndtri_exp(chance - math.log(2.0)) ** 2) if chance < 0.0 else 0.0


def _log_tail(gain: float, columns: float) -> float:
    """Logarithm of the chance that chi-square of so many degrees exceeds ``gain``."""
    half, x = columns / 2.0, gain / 2.0
    if x < _FAR:
        return math.log(max(float(gammaincc(half, x)), 1e-300))
    # leading terms for large x
    return -x + (half - 1.0) * math.log(x) - float(gammaln(half)) + math.log1p((half - 1.0) / x)


def looks(columns: FloatArray) -> float:
    """Independent settings among neighbours: the length of the way of their unit columns (n, s), in right angles.

    Neighbours that look alike count little more than one (Davies 1987: chance grows with that length).
    """
    size = np.sqrt(np.sum(columns**2, axis=0))
    unit = columns[:, size > 0.0] / size[size > 0.0]
    alike = np.clip(np.abs(np.sum(unit[:, 1:] * unit[:, :-1], axis=0)), 0.0, 1.0)
    return 1.0 + float(np.sum(np.arccos(alike))) / (math.pi / 2.0)


_SEEN = 1e-12
"""Share of the largest eigenvalue, columns scaled to one, below which a direction is rounding."""
_BYTES = 16_000_000
"""Of one candidate's columns that are kept at once."""
_LAGS = 60
"""Samples over which scores may remember: more than a second."""
_FEWEST = 4
"""Scores a lag: memory is looked for over a quarter of a stretch at most."""
_FLAT = 1e-9
"""Share of a column, beyond those of the model, below which it says nothing of its own."""


@dataclass(frozen=True, slots=True)
class Part:
    """A joint's guarded samples: torque (m,) beyond the rigid model, its base columns (m, p), and its noise.

    Coulomb, viscous and offset come first; spread (p,) : what each number is expected to be, inf for these. floor :
    standard deviation below which no noise is believed.
    """

    torque: FloatArray
    base: FloatArray
    spread: FloatArray
    stretches: Stretches
    noise: Noise
    floor: float

    def white(self, columns: FloatArray) -> FloatArray:
        """Guarded samples of columns (m, ...), whitened."""
        return self.noise.whitened(columns, self.stretches)


@dataclass(frozen=True, slots=True)
class Whitened:
    """A candidate's columns on guarded samples, whitened, some settings at a time so that memory stays small.

    kept : the one block there is, or None where there are several, which are made anew each time they are asked for.
    looks : independent settings.
    """

    candidate: Candidate
    parts: Sequence[Part]
    kept: dict[int, FloatArray] | None
    looks: float

    @classmethod
    def of(cls, candidate: Candidate, parts: Sequence[Part]) -> "Whitened":
        """Whitened as the parts' noise asks."""
        kept: dict[int, FloatArray] | None = None
        tries, last = 1.0, None
        for first, block in _blocks(candidate, parts):
            kept = block if first == 0 else None
            if len(candidate.settings) > 1:
                (columns,) = block.values()
                tried = columns[:, :, 0] if last is None else np.column_stack((last, columns[:, :, 0]))
                tries, last = tries + looks(tried) - 1.0, columns[:, -1, 0]
        return cls(candidate, parts, kept, max(tries, candidate.looks))

    def blocks(self) -> Iterator[tuple[int, dict[int, FloatArray]]]:
        """The first setting of each block, and by joint (n_j, settings, c)."""
        yield from ((0, self.kept),) if self.kept is not None else _blocks(self.candidate, self.parts)

    def columns(self, setting: int) -> dict[int, FloatArray]:
        """By joint, (n_j, c) at one setting."""
        return {j: self.parts[j].white(c) for j, c in self.candidate.settings[setting].columns.items()}

    def at(self, setting: int) -> "Named":
        """At one of its settings."""
        return Named(self, setting)


def _blocks(candidate: Candidate, parts: Sequence[Part]) -> Iterator[tuple[int, dict[int, FloatArray]]]:
    """So many settings at a time as fit."""
    settings = candidate.settings
    size = sum(8 * columns.size for columns in settings[0].columns.values())
    at_once = max(_BYTES // size, 2)
    for first in range(0, len(settings), at_once):
        some = [one.columns for one in settings[first : first + at_once]]
        stacked = {j: np.stack([columns[j] for columns in some], axis=1) for j in some[0]}
        yield first, {j: parts[j].white(columns) for j, columns in stacked.items()}


@dataclass(frozen=True, slots=True)
class Named:
    """A candidate in the model, at one of its settings."""

    whitened: Whitened
    setting: int

    @property
    def candidate(self) -> Candidate:
        """Which one."""
        return self.whitened.candidate

    @property
    def columns(self) -> dict[int, FloatArray]:
        """By joint, (n_j, c), whitened."""
        return self.whitened.columns(self.setting)

    def again(self, parts: Sequence[Part]) -> "Named":
        """The same under other noise."""
        return Named(Whitened.of(self.candidate, parts), self.setting)


@dataclass(frozen=True, slots=True)
class Score:
    """What a candidate would add: its best setting, the gain there, and the evidence on the scale of one column."""

    named: Named
    gain: float
    evidence: float


class Design:
    """Stacked and solved: ``at[j]`` are the rows of joint j, those of expectations stand last."""

    def __init__(self, parts: Sequence[Part], named: Sequence[Named]) -> None:
        self.parts, self.named = parts, tuple(named)
        sizes = [int(np.sum(part.stretches.kept)) for part in parts]
        ends = np.concatenate(([0], np.cumsum(sizes)))
        self.at = [slice(int(ends[j]), int(ends[j + 1])) for j in range(len(parts))]
        blocks: list[tuple[dict[int, FloatArray], FloatArray]] = [
            ({j: part.white(part.base)}, part.spread) for j, part in enumerate(parts)
        ]
        blocks += [(one.columns, one.candidate.spread) for one in self.named]
        self.places, columns = [], 0
        for _, spread in blocks:
            self.places.append(slice(columns, columns + spread.size))
            columns += spread.size
        matrix = np.zeros((int(ends[-1]) + columns, columns))
        for (by_joint, spread), place in zip(blocks, self.places, strict=True):
            for j, c in by_joint.items():
                matrix[self.at[j], place] = c
            rows = np.arange(place.start, place.stop)
            matrix[int(ends[-1]) + rows, rows] = 1.0 / spread
        self.rows = int(ends[-1])
        self.matrix = matrix
        self.y = np.zeros(matrix.shape[0])
        for j, part in enumerate(parts):
            self.y[self.at[j]] = part.white(part.torque)
        scale = np.sqrt(np.sum(matrix**2, axis=0))
        scale[scale == 0.0] = 1.0
        scaled = matrix / scale
        power, turn = np.linalg.eigh(scaled.T @ scaled)
        seen = power > _SEEN * power[-1]
        root = turn[:, seen] / np.sqrt(power[seen])
        self._u = scaled @ root
        self._back = root / scale[:, None]
        self.numbers = self._back @ (self._u.T @ self.y)
        self.residual = self.y - self._u @ (self._u.T @ self.y)

    def covariance(self) -> FloatArray:
        """Of the numbers (p, p): noise of size one where it is white, more where its scores remember or swing."""
        plain = self._back @ self._back.T
        influence = self._back @ self._u.T
        factor = np.ones(plain.shape[0])
        for i in range(factor.size):
            factor[i] = max(1.0, self._forgotten(influence[i], self.residual))
        return np.asarray(plain * np.sqrt(np.outer(factor, factor)))

    def _forgotten(self, weight: FloatArray, residual: FloatArray) -> float:
        """Variance of sum(weight residual) over what it is for white noise of size one."""
        nominal = float(weight @ weight)
        if nominal <= 0.0:
            return 1.0
        total = 0.0
        for rows in self.at:
            scores = weight[rows] * residual[rows]
            if scores.size > _FEWEST:
                # zeros to a length that Fourier is quick at change nothing of what it remembers
                padded = np.zeros(next_fast_len(scores.size, real=True))
                padded[: scores.size] = scores
                total += float(scores @ scores) * memory(padded, min(scores.size // _FEWEST, _LAGS)).time
        return total / nominal

    def inside(self, columns: FloatArray) -> FloatArray:
        """What columns (rows, c) have in common with those of the model."""
        basis = self._u[: columns.shape[0]]
        return np.asarray(basis @ (basis.T @ columns))

    def score(self, whitened: Whitened) -> Score:
        """What a candidate would add to the model, by its best setting."""
        gain, best = 0.0, whitened.at(0)
        for first, block in whitened.blocks():
            gains = self._gains(block, whitened.candidate.spread)
            most = int(np.argmax(gains))
            if gains[most] > gain:
                gain, best = float(gains[most]), whitened.at(first + most)
        if gain <= 0.0:
            return Score(best, 0.0, 0.0)
        added, count, left = self._beyond(best)
        # the place of a polished one is counted by its looks
        count -= whitened.candidate.looks > 1.0
        gain /= max(1.0, self._forgotten(added, left))
        return Score(best, gain, evidence(gain, count, whitened.looks))

    def _gains(self, block: dict[int, FloatArray], spread: FloatArray) -> FloatArray:
        """What each of a block's settings (s,) would gain."""
        settings = next(iter(block.values())).shape[1]
        normal = np.zeros((settings, spread.size, spread.size)) + np.diag(1.0 / spread**2)
        pull = np.zeros((settings, spread.size))
        inside = np.zeros((settings, self._u.shape[1], spread.size))
        for j, columns in block.items():
            normal += np.einsum("nsc,nsd->scd", columns, columns)
            pull += np.einsum("nsc,n->sc", columns, self.residual[self.at[j]])
            inside += np.einsum("nu,nsc->suc", self._u[self.at[j]], columns, optimize=True)
        before = np.einsum("scc->sc", normal).copy()
        normal -= np.einsum("suc,sud->scd", inside, inside)
        after = np.einsum("scc->sc", normal)
        inverse = np.linalg.pinv(normal, rcond=_FLAT, hermitian=True)
        gains = np.einsum("sc,scd,sd->s", pull, inverse, pull)
        return np.asarray(gains * np.all(after > _FLAT * before, axis=1))

    def _beyond(self, named: Named) -> tuple[FloatArray, float, FloatArray]:
        """Torque (rows,) that it would add beyond the model, as how many free numbers it counts, and what is left."""
        spread = named.candidate.spread
        own = np.zeros((self.y.size, spread.size))
        for j, columns in named.columns.items():
            own[self.at[j]] = columns
        own -= self._u @ (self._u.T @ own)
        gram = own.T @ own
        inverse = np.linalg.pinv(gram + np.diag(1.0 / spread**2), rcond=_FLAT, hermitian=True)
        added = own @ (inverse @ (own.T @ self.residual))
        return added, max(float(np.trace(inverse @ gram)), 1.0), self.residual - added
