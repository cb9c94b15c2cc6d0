"""One least-squares problem of the whole arm: every joint's guarded, whitened torque under what is in the model.

The noise of a filtered series with gaps is an autoregression learnt on stretches; whitened, the series has no memory.
"""

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import pairwise

import numpy as np
from scipy.fft import next_fast_len
from scipy.sparse import csr_array
from scipy.special import gammaincc, gammaln, ndtri_exp

from harness.core.arrays import BoolArray, FloatArray, IntArray
from harness.fit.series import memory
from harness.robot.whole_arm.columns import Candidate, Key
from harness.robot.whole_arm.rules import RIVAL

_ORDER = 8
"""Of the autoregression: follows the fall of a filter's gain within a band of one and a half times its own."""
_FREQUENCIES, _DIP = 513, 2.0
"""Frequencies at which a spectrum is looked at, and how far it may fall below what it was at lower ones."""


@dataclass(frozen=True, slots=True)
class Stretches:
    """kept (m,) : samples that count. depth (m,) : how many kept ones lie before each without a gap; -1 if not kept."""

    kept: BoolArray
    depth: IntArray

    @classmethod
    def of(cls, kept: BoolArray) -> "Stretches":
        """The stretches of a mask (m,)."""
        rows = np.arange(kept.size)
        last_gap = np.maximum.accumulate(np.where(kept, -1, rows))
        return cls(kept, np.where(kept, rows - last_gap - 1, -1))


@dataclass(frozen=True, slots=True)
class Noise:
    """predictors : of orders 0 to p, the coefficients (k+1,) that leave the error of prediction, 1 first.

    sigma (p+1,) : standard deviation of that error by order, the unit of the series.
    """

    predictors: tuple[FloatArray, ...]
    sigma: FloatArray

    @classmethod
    def learnt(cls, series: FloatArray, stretches: Stretches, fitted: int, floor: float = 0.0) -> "Noise":
        """By Burg's method from a residual (m,) of a fit with so many numbers; always stable.

        floor : standard deviation of white noise that is there whatever the residual shows.

        Of no less than half the density anywhere that it has at some lower frequency. What is left at low frequencies
        is often not noise but what the model lacks. A likelihood that took it for noise would trust the highest
        frequencies alone, where torque has least to say; this one weights all alike, and counts the errors by the low
        ones.
        """
        forward = np.where(stretches.kept, series, 0.0)
        backward = forward.copy()

        def burg(k: int, *_: object) -> float:
            valid = np.flatnonzero(stretches.depth >= k)
            f, b = forward[valid], backward[valid - 1]
            below = float(f @ f + b @ b)
            found = -2.0 * float(f @ b) / below if valid.size > _ORDER and below > 0.0 else 0.0
            forward[valid], backward[valid] = f + found * b, b + found * f
            return found

        own = cls._of(float(forward @ forward) / max(int(np.sum(stretches.kept)) - fitted, 1), burg)
        turn = np.exp(-1j * math.pi * np.linspace(0.0, 1.0, _FREQUENCIES))
        density = (own.sigma[-1] / np.abs(np.polyval(own.predictors[-1][::-1], turn))) ** 2
        density = np.maximum(density, np.maximum.accumulate(density) / _DIP) + floor**2
        covariance = np.fft.irfft(density)

        def levinson(k: int, last: FloatArray, power: float) -> float:
            return -float(last @ covariance[k:0:-1]) / max(power, 1e-300)

        return cls._of(float(covariance[0]), levinson)

    @classmethod
    def _of(cls, power: float, reflection: Callable[[int, FloatArray, float], float]) -> "Noise":
        """By the variance of a series and its reflections, of each order, the predictor before it, and its error's."""
        predictors, powers = [np.ones(1)], [power]
        for k in range(1, _ORDER + 1):
            found, last = reflection(k, predictors[-1], powers[-1]), np.append(predictors[-1], 0.0)
            predictors.append(last + found * last[::-1])
            powers.append(powers[-1] * (1.0 - found**2))
        return cls(tuple(predictors), np.sqrt(np.maximum(powers, 1e-300)))

    def whitening(self, stretches: Stretches) -> "Whitening":
        """What makes a series' kept samples errors of prediction in units of theirs."""
        weights = np.zeros((_ORDER + 1, _ORDER + 1))
        for k, predictor in enumerate(self.predictors):
            weights[k, : k + 1] = predictor
        rows = np.flatnonzero(stretches.kept)
        order = np.minimum(stretches.depth[rows], _ORDER)
        ends = np.concatenate(([0], np.cumsum(order + 1)))
        lag = np.arange(ends[-1]) - np.repeat(ends[:-1], order + 1)
        terms = weights[np.repeat(order, order + 1), lag], np.repeat(rows, order + 1) - lag, ends
        return Whitening(csr_array(terms, (rows.size, stretches.kept.size)), self.sigma[order])


@dataclass(frozen=True, slots=True)
class Whitening:
    """predicted (k, m) : error of predicting each kept sample of a series. sigma (k,) : its standard deviation."""

    predicted: csr_array
    sigma: FloatArray

    def of(self, series: FloatArray) -> FloatArray:
        """Kept samples (k, ...) of a series (m, ...), whitened."""
        found = self.predicted @ series.reshape(series.shape[0], -1) / self.sigma[:, None]
        return np.asarray(found.reshape(-1, *series.shape[1:]))


_FAR = 300.0
"""Half a chi-square beyond which its chance is too small for a float."""


def evidence(gain: float, columns: float, looks: float = 1.0) -> float:
    """Gain of one column that is as unlikely by chance as this one, (its estimate over its standard error) squared.

    gain : what a fit gains, twice the logarithm of its likelihood; chi-square of so many ``columns`` by chance alone.
    looks : independent settings of which it is the best. 0 where chance does as well.
    """
    half, x = columns / 2.0, gain / 2.0
    if gain <= 0.0:
        return 0.0
    if x < _FAR:
        chance = math.log(max(float(gammaincc(half, x)), 1e-300))
    else:  # leading terms
        chance = -x + (half - 1.0) * math.log(x) - float(gammaln(half)) + math.log1p((half - 1.0) / x)
    return evidence_of_chance(chance, looks, gain)


def evidence_of_chance(log_chance: float, looks: float, gain: float) -> float:
    """The same from the logarithm of a chance of one setting.

    The best of many neighbours exceeds a gain more often than so many settings apart, as it may do so between them:
    by its square root (Davies 1987, Biometrika 74, 33).
    """
    between = math.sqrt(math.pi / 8.0) * (looks - 1.0) * math.sqrt(max(gain, 1.0))
    chance = log_chance + math.log1p(max(between, 0.0))
    return float(ndtri_exp(chance - math.log(2.0)) ** 2) if chance < 0.0 else 0.0


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
    whitening: Whitening = field(init=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "whitening", self.noise.whitening(self.stretches))

    def white(self, columns: FloatArray) -> FloatArray:
        """Guarded samples of columns (m, ...), whitened."""
        return self.whitening.of(columns)

    def expected(self, other_viscous: bool) -> FloatArray:
        """The spread (p,) of the base's numbers; other_viscous : another law is viscous friction, none is beside."""
        found = self.spread.copy()
        if other_viscous:
            found[1] = _NONE
        return found


_NONE = 1e-9
"""N m s/rad that is as good as none."""
Parts = Mapping[int, Part]
"""By joint."""


@dataclass(frozen=True, slots=True)
class Whitened:
    """A candidate's columns on guarded samples, whitened, some settings at a time so that memory stays small.

    kept : the one block there is, or None where there are several, which are made anew each time they are asked for.
    looks : independent settings.
    """

    candidate: Candidate
    parts: Parts
    kept: dict[int, FloatArray] | None
    looks: float

    @classmethod
    def of(cls, candidate: Candidate, parts: Parts) -> "Whitened":
        """Whitened as the parts' noise asks."""
        kept: dict[int, FloatArray] | None = None
        tries, last = 1.0, None
        for first, block in _blocks(candidate, parts):
            kept = block if first == 0 else None
            if len(candidate.values) > 1:
                columns = np.concatenate([one[:, :, 0] for one in block.values()])
                tried = columns if last is None else np.column_stack((last, columns))
                tries, last = tries + looks(tried) - 1.0, columns[:, -1]
        return cls(candidate, parts, kept, max(tries, candidate.looks))

    def blocks(self) -> Iterator[tuple[int, dict[int, FloatArray]]]:
        """The first setting of each block, and by joint (n_j, settings, c)."""
        yield from ((0, self.kept),) if self.kept is not None else _blocks(self.candidate, self.parts)


def _blocks(candidate: Candidate, parts: Parts) -> Iterator[tuple[int, dict[int, FloatArray]]]:
    """So many settings at a time as fit."""
    size = sum(8 * columns.size for columns in candidate.torque(candidate.values[0]).values())
    at_once = max(_BYTES // size, 2)
    for first in range(0, len(candidate.values), at_once):
        some = [candidate.torque(value) for value in candidate.values[first : first + at_once]]
        stacked = {j: np.stack([columns[j] for columns in some], axis=1) for j in some[0]}
        yield first, {j: parts[j].white(columns) for j, columns in stacked.items()}


@dataclass(frozen=True, slots=True)
class Named:
    """A candidate at one of its settings, in a model or beside it.

    gain : of a fit that has it. evidence : the same on the scale of one column. rivals : others that would have done
    nearly as well when it was chosen, with by how much they are worse.
    """

    whitened: Whitened
    setting: int = 0
    gain: float = 0.0
    evidence: float = 0.0
    rivals: Mapping[Key, float] = field(default_factory=dict)

    @property
    def candidate(self) -> Candidate:
        """Which one."""
        return self.whitened.candidate

    @property
    def value(self) -> float:
        """What is not linear in its columns."""
        return self.candidate.values[self.setting]

    @property
    def torque(self) -> dict[int, FloatArray]:
        """By joint, (m, c), of all samples."""
        return self.candidate.torque(self.value)

    @property
    def columns(self) -> dict[int, FloatArray]:
        """By joint, (n_j, c), whitened."""
        return {j: self.whitened.parts[j].white(c) for j, c in self.torque.items()}


class Design:
    """Stacked and solved: ``at[j]`` are the rows of joint j, those of expectations stand last."""

    def __init__(self, parts: Parts, named: Sequence[Named]) -> None:
        self.parts, self.named = parts, tuple(named)
        ends = np.cumsum([0, *(int(np.sum(part.stretches.kept)) for part in parts.values())]).tolist()
        self.at = {j: slice(*both) for j, both in zip(parts, pairwise(ends), strict=True)}
        rows = ends[-1]
        other = {one.candidate.joint for one in self.named if one.candidate.viscous}
        blocks = [({j: part.white(part.base)}, part.expected(j in other)) for j, part in parts.items()]
        blocks += [(one.columns, one.candidate.spread) for one in self.named]
        lasts = np.cumsum([0, *(spread.size for _, spread in blocks)]).tolist()
        places = [slice(*both) for both in pairwise(lasts)]
        self.base, self.places = dict(zip(parts, places, strict=False)), places[len(parts) :]
        matrix = np.zeros((rows + lasts[-1], lasts[-1]))
        for (by_joint, spread), place in zip(blocks, places, strict=True):
            for j, c in by_joint.items():
                matrix[self.at[j], place] = c
            own = np.arange(place.start, place.stop)
            matrix[rows + own, own] = 1.0 / spread
        self.matrix, self.y = matrix, np.zeros(matrix.shape[0])
        for j, part in parts.items():
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

    def in_place_of_viscous(self, joint: int) -> str | None:
        """The law that takes the place of a joint's viscous friction, None where that is fitted."""
        own = (one.candidate for one in self.named if one.candidate.joint == joint)
        return next((one.name for one in own if one.viscous), None)

    def place(self, named: Named) -> slice:
        """Where the numbers of what is in the model stand."""
        return self.places[[one.candidate.key for one in self.named].index(named.candidate.key)]

    def said(
        self, joint: int, of: Callable[[Candidate], bool] = lambda _: True, numbers: FloatArray | None = None
    ) -> FloatArray:
        """Torque (m,) on a joint by what is in the model beside the base; numbers : by default those fitted."""
        numbers, found = self.numbers if numbers is None else numbers, np.zeros(self.parts[joint].torque.size)
        for one, place in zip(self.named, self.places, strict=True):
            if one.candidate.joint in (joint, None) and of(one.candidate):
                found += one.torque[joint] @ numbers[place]
        return found

    def left(self, joint: int, numbers: FloatArray | None = None) -> FloatArray:
        """Torque (m,) that the model leaves of a joint, guarded or not; numbers : as above."""
        part, own = self.parts[joint], self.numbers if numbers is None else numbers
        return part.torque - part.base @ own[self.base[joint]] - self.said(joint, numbers=numbers)

    def squares(self, joint: int) -> float:
        """Of what is left of a joint's guarded torque."""
        return float(np.sum(self.left(joint)[self.parts[joint].stretches.kept] ** 2))

    def covariance(self) -> FloatArray:
        """Of the numbers (p, p): noise of size one where it is white, more where its scores remember or swing."""
        plain = self._back @ self._back.T
        influence = self._back @ self._u.T
        factor = np.array([max(1.0, self._forgotten(own, self.residual)) for own in influence])
        return np.asarray(plain * np.sqrt(np.outer(factor, factor)))

    def _forgotten(self, weight: FloatArray, residual: FloatArray) -> float:
        """Variance of sum(weight residual) over what it is for white noise of size one."""
        nominal = float(weight @ weight)
        if nominal <= 0.0:
            return 1.0
        total = 0.0
        for rows in self.at.values():
            scores = weight[rows] * residual[rows]
            if scores.size > _FEWEST:
                # zeros to a length that Fourier is quick at change nothing of what it remembers
                padded = np.zeros(next_fast_len(scores.size, real=True))
                padded[: scores.size] = scores
                total += float(scores @ scores) * memory(padded, min(scores.size // _FEWEST, _LAGS)).time
        return total / nominal

    def beyond(self, columns: FloatArray) -> FloatArray:
        """What columns (n, c), n at most all rows, have that those of the model have not."""
        basis = self._u[: columns.shape[0]]
        return np.asarray(columns - basis @ (basis.T @ columns))

    def score(self, whitened: Whitened) -> Named:
        """What a candidate would add to the model, by its best setting."""
        if whitened.candidate.viscous:
            return self._instead(whitened)
        gain, best = 0.0, 0
        spread = whitened.candidate.spread
        for first, block in whitened.blocks():
            gains = self._gains(block, spread, whitened.candidate.positive)
            least = RIVAL.value if whitened.candidate.bodies else 0.0
            most = int(np.argmax(gains >= np.max(gains) - least))
            if gains[most] > gain + least * (first > 0):
                gain, best = float(gains[most]), first + most
        if gain <= 0.0:
            return Named(whitened)
        # torque that it would add beyond the model, and as how many free numbers it counts
        own = np.zeros((self.y.size, spread.size))
        for j, columns in Named(whitened, best).columns.items():
            own[self.at[j]] = columns
        own = self.beyond(own)
        gram = own.T @ own
        inverse = np.linalg.pinv(gram + np.diag(1.0 / spread**2), rcond=_FLAT, hermitian=True)
        added = own @ (inverse @ (own.T @ self.residual))
        # the place of a polished one is counted by its looks
        count = max(float(np.trace(inverse @ gram)), 1.0) - (whitened.candidate.looks > 1.0)
        gain /= max(1.0, self._forgotten(added, self.residual - added))
        return Named(whitened, best, gain, evidence(gain, count, whitened.looks))

    def _instead(self, whitened: Whitened) -> Named:
        """The same of a law that stands in place of the joint's viscous friction."""
        settings = range(len(whitened.candidate.values))
        every = [Design(self.parts, [*self.named, Named(whitened, i)]) for i in settings]
        other = min(every, key=lambda one: float(one.residual @ one.residual))
        gain = float(self.residual @ self.residual - other.residual @ other.residual)
        if gain <= 0.0 or other.numbers[other.places[-1]][0] <= 0.0:
            return Named(whitened)
        left = other.residual[: self.residual.size]
        gain /= max(1.0, self._forgotten(self.residual - left, left))
        return replace(other.named[-1], gain=gain, evidence=evidence(gain, 1.0, whitened.looks))

    def _gains(self, block: dict[int, FloatArray], spread: FloatArray, positive: bool) -> FloatArray:
        """What each of a block's settings (s,) would gain; positive : nothing where its first number is not above 0."""
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
        told = np.all(after > _FLAT * before, axis=1)
        if positive:
            told &= np.einsum("scd,sd->sc", inverse, pull)[:, 0] > 0.0
        return np.asarray(gains * told)
