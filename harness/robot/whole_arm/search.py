"""Which candidates belong to the model of the whole arm: the surest first, until none is sure enough."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from harness.core.arrays import FloatArray, IntArray
from harness.robot.whole_arm.columns import DELAY, FRICTION, PAYLOAD, TILT, Candidate
from harness.robot.whole_arm.design import Design, Named, Part, Score, Whitened
from harness.robot.whole_arm.noise import Noise
from harness.robot.whole_arm.rules import MOST, NAMED, RIVAL, SIZE

BLOCK = 1.0
"""s: longer than the memory of the noise, shorter than a period of the motion."""
FOLDS = 5
"""Every fifth block is left out at a time."""


def folds(t: FloatArray) -> IntArray:
    """Which fold each time (m,) is in: every fifth block of a second."""
    return np.asarray(((t - t[0]) // BLOCK).astype(np.int64) % FOLDS)


def errors(design: Design, t: FloatArray) -> FloatArray:
    """Errors (rows,) of held-out whitened samples, fold by fold; t (m,) : times of all samples."""
    found = np.empty(design.rows)
    for out, numbers in _without(design, t):
        found[out] = design.y[out] - design.matrix[out] @ numbers
    return found


def rms(design: Design, t: FloatArray) -> FloatArray:
    """Root mean square (k,) of the held-out error of each joint's torque, guarded, N m or N."""
    squares = np.zeros(len(design.parts))
    fold = folds(t)
    for one, (_, numbers) in enumerate(_without(design, t)):
        for j, part in enumerate(design.parts):
            rows = part.stretches.kept & (fold == one)
            left = part.torque[rows] - part.base[rows] @ numbers[design.places[j]]
            for named, place in zip(design.named, design.places[len(design.parts) :], strict=True):
                columns = named.candidate.settings[named.setting].columns
                if j in columns:
                    left = left - columns[j][rows] @ numbers[place]
            squares[j] += float(left @ left)
    return np.sqrt(squares / [np.sum(part.stretches.kept) for part in design.parts])


def _without(design: Design, t: FloatArray) -> Iterator[tuple[IntArray, FloatArray]]:
    """By fold: its whitened rows, and the numbers fitted to all others."""
    fold = np.concatenate([folds(t)[part.stretches.kept] for part in design.parts])
    matrix, y = design.matrix, design.y
    scale = np.sqrt(np.sum(matrix**2, axis=0))
    scale[scale == 0.0] = 1.0
    scaled = matrix / scale
    normal, pull = scaled.T @ scaled, scaled.T @ y
    for one in range(FOLDS):
        out = np.flatnonzero(fold == one)
        part = scaled[out]
        numbers = np.linalg.pinv(normal - part.T @ part, rcond=1e-12, hermitian=True) @ (pull - part.T @ y[out])
        yield out, numbers / scale


CORRECTED = (PAYLOAD, DELAY, TILT)
"""Errors of the model whose effect is not linear in their size."""
_POLISHINGS = 5
_SEEN = 1e-8
"""Share of the largest eigenvalue below which columns are taken for alike."""
_SETTINGS = 3
"""Of each candidate that the noise is learnt beside."""


@dataclass(frozen=True, slots=True)
class Chosen:
    """A candidate in the model: where it stood when it was chosen, and which others would have done nearly as well."""

    named: Named
    evidence: float
    rivals: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class Model:
    """What was chosen, and the problem solved with it, its noise learnt from what it leaves."""

    chosen: tuple[Chosen, ...]
    design: Design
    left_out: float
    """Evidence of the best candidate that was not chosen."""
    again: bool = False
    """Whether the last one chosen has to be corrected, and the search begun anew."""


def beside_everything(part: Part, joint: int, candidates: Sequence[Candidate]) -> Part:
    """A part whose noise is learnt from what all candidates together leave of its torque."""
    kept = part.stretches.kept
    columns = [part.base]
    for candidate in (one for one in candidates if one.joint in (joint, None)):
        count = len(candidate.settings)
        places = np.unique(np.linspace(0, count - 1, min(count, _SETTINGS)).round().astype(int))
        columns += [candidate.settings[i].columns[joint] for i in places]
    everything = np.hstack(columns)
    size = np.sqrt(np.mean(everything[kept] ** 2, axis=0))
    everything = everything[:, size > 0.0] / size[size > 0.0]
    power, turn = np.linalg.eigh(everything[kept].T @ everything[kept])
    seen = power > _SEEN * power[-1]
    u = everything[kept] @ (turn[:, seen] / np.sqrt(power[seen]))
    left = np.zeros(kept.size)
    left[kept] = part.torque[kept] - u @ (u.T @ part.torque[kept])
    return replace(part, noise=Noise.learnt(left, part.stretches, u.shape[1], part.floor))


def search(parts: Sequence[Part], candidates: Sequence[Candidate], t: FloatArray, forced: Sequence[Chosen]) -> Model:
    """The model of the whole arm; parts hold the noise learnt beside everything, t (m,) : s.

    forced : errors of the model that were found and corrected, whose rest is fitted along. The search ends early where
    it names another that has to be corrected first.
    """
    whitened = [Whitened.of(candidate, parts) for candidate in candidates]
    by_key = {w.candidate.key: w for w in whitened}
    chosen = [replace(one, named=Named(by_key[one.named.candidate.key], 0)) for one in forced]
    design = Design(parts, [one.named for one in chosen])
    before = errors(design, t)
    refused: set[tuple[str, int | None]] = set()
    left_out: Named | None = None
    while True:
        taken = {one.named.candidate.key for one in chosen} | refused
        scores = [design.score(w) for w in whitened if w.candidate.key not in taken and not _full(chosen, w.candidate)]
        if not scores:
            break
        best = max(scores, key=lambda s: s.evidence)
        left_out = best.named
        if best.evidence < NAMED.value:
            break
        named, trial = polished(parts, [one.named for one in chosen], best.named)
        after = errors(trial, t)
        worse = float(after @ after) >= float(before @ before)
        if worse or not _sized(trial) or _driving(trial) > _driving(design):
            refused.add(best.named.candidate.key)
            continue
        design, before = trial, after
        chosen.append(Chosen(named, best.evidence, _rivals(best, scores, design)))
        if named.candidate.name in CORRECTED:
            return Model(tuple(chosen), design, 0.0, again=True)
    return _pruned(parts, chosen, len(forced), left_out)


def _full(chosen: Sequence[Chosen], candidate: Candidate) -> bool:
    """Whether there are as many names as a joint, or the model, may have."""
    if candidate.family == FRICTION:
        return len(of_joint(chosen, candidate.joint)) >= MOST.value
    names = {one.named.candidate.name for one in chosen if one.named.candidate.family != FRICTION}
    return len(names) >= MOST.value and candidate.name not in names


def _sized(design: Design) -> bool:
    """Whether the numbers of every candidate are of a size that its name can have; a later one may make one grow."""
    places = design.places[len(design.parts) :]
    return all(
        bool(np.all(np.abs(design.numbers[place]) <= SIZE.value * one.candidate.spread))
        for one, place in zip(design.named, places, strict=True)
    )


def _driving(design: Design) -> int:
    """How many joints have Coulomb or viscous friction that is surely negative, and would drive."""
    errors = np.sqrt(np.diag(design.covariance()))
    return sum(
        int(np.any(design.numbers[place][:2] < -2.0 * errors[place][:2]))
        for place in design.places[: len(design.parts)]
    )


def polished(parts: Sequence[Part], others: Sequence[Named], named: Named) -> tuple[Named, Design]:
    """A candidate with what is not linear in it brought to its best value, and the model that has it."""
    design = Design(parts, [*others, named])
    candidate = named.candidate
    if candidate.shape is None:
        return named, design
    value = candidate.settings[named.setting].values[0][2]
    grid = [one.values[0][2] for one in candidate.settings]
    lower, upper = grid[max(named.setting - 1, 0)], grid[min(named.setting + 1, len(grid) - 1)]
    count = candidate.spread.size
    numbers = design.numbers[design.places[-1]][:count]
    for _ in range(_POLISHINGS):
        around = candidate.around(named.setting, value, numbers, named.whitened.looks)
        at = Named(Whitened.of(around, parts), 0)
        design = Design(parts, [*others, at])
        found = design.numbers[design.places[-1]]
        numbers, value = found[:count], float(np.clip(value + found[count], lower, upper))
    return at, design


def _rivals(best: Score, scores: Sequence[Score], after: Design) -> tuple[str, ...]:
    """Others that were nearly as sure and are not any more once the best is in."""
    near = [s for s in scores if s is not best and s.evidence > best.evidence - RIVAL.value]
    one = best.named.candidate
    near = [s for s in near if s.named.candidate.joint in (one.joint, None) or one.joint is None]
    near = [s for s in near if s.named.candidate.name != one.name]
    found = [s for s in near if after.score(s.named.whitened).evidence < NAMED.value]
    return tuple(dict.fromkeys(s.named.candidate.name for s in sorted(found, key=lambda s: -s.evidence)))


def left_over(design: Design, joint: int) -> tuple[FloatArray, int]:
    """Torque (m,) that the model leaves of a joint, guarded or not, and how many numbers were fitted to it."""
    part = design.parts[joint]
    left = part.torque - part.base @ design.numbers[design.places[joint]]
    count = part.base.shape[1]
    for one, where in zip(design.named, design.places[len(design.parts) :], strict=True):
        columns = one.candidate.settings[one.setting].columns
        if joint in columns:
            left = left - columns[joint] @ design.numbers[where]
            count += columns[joint].shape[1]
    return left, count


def relearnt(design: Design) -> list[Part]:
    """The parts with their noise learnt from what the model leaves."""
    left = [left_over(design, j) for j in range(len(design.parts))]
    return [
        replace(part, noise=Noise.learnt(rest, part.stretches, count, part.floor))
        for part, (rest, count) in zip(design.parts, left, strict=True)
    ]


def _pruned(parts: Sequence[Part], chosen: Sequence[Chosen], forced: int, left_out: Named | None) -> Model:
    """Without what is not sure any more beside what was chosen after it; the noise learnt anew."""
    kept = list(chosen)
    design = Design(parts, [one.named for one in kept])
    while True:
        # the second time the weights are those of the noise itself
        for _ in range(2):
            parts = relearnt(design)
            kept = [replace(one, named=one.named.again(parts)) for one in kept]
            design = Design(parts, [one.named for one in kept])
        sure = []
        for i, one in enumerate(kept):
            without = Design(parts, [other.named for k, other in enumerate(kept) if k != i])
            sure.append(without.score(one.named.whitened).evidence)
        kept = [
            one if i < forced else replace(one, evidence=value)
            for i, (one, value) in enumerate(zip(kept, sure, strict=True))
        ]
        if not sure[forced:] or min(sure[forced:]) >= NAMED.value:
            return Model(tuple(kept), design, _evidence(design, left_out))
        del kept[forced + int(np.argmin(sure[forced:]))]
        design = Design(parts, [one.named for one in kept])


def _evidence(design: Design, named: Named | None) -> float:
    """Of a candidate beside a model, under the model's own noise."""
    if named is None or named.candidate.key in {one.candidate.key for one in design.named}:
        return 0.0
    return design.score(Whitened.of(named.candidate, design.parts)).evidence


def of_joint(chosen: Sequence[Chosen], joint: int | None) -> tuple[Chosen, ...]:
    """Effects of one joint's friction."""
    return tuple(c for c in chosen if c.named.candidate.joint == joint and c.named.candidate.family == FRICTION)
