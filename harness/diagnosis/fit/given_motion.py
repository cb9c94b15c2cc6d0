"""A motion with covariates as they were measured, piece after piece, with partials through the seams.

Over a piece friction and damping are held (given.py); a push acts as it was measured, and is held in the partials
alone. Where a piece ends the next begins: its start, and what that hangs on, are handed over.
"""

from collections.abc import Iterator
from dataclasses import dataclass, fields, replace

import numpy as np

from harness.core.arrays import FloatArray
from harness.core.events import Events
from harness.diagnosis.fit.given import changes, held, pieces, resumed, scaled
from harness.diagnosis.problem import Problem
from harness.kernels.solve import By, Effort, Scales, Solution, solve
from harness.model.covariate import Acts
from harness.model.model import Model, ModelTerm
from harness.model.registry import TERMS

_PUSH = next(term for term in TERMS if term.name == "constant-force")
_STARTS: tuple[By, ...] = ("x0", "v0")


@dataclass(frozen=True, slots=True)
class _Piece:
    """A stretch over which covariates hardly change.

    model : held over it, with a push of nothing as its last term. sums : for each number asked for, which of the
    piece's own numbers it moves, and how much. until : s, where the next begins; None at the end.
    """

    model: Model
    sums: tuple[tuple[tuple[By, float], ...], ...]
    until: float | None


def motion_given(
    model: Model,
    t: FloatArray,
    by: tuple[By, ...],
    problem: Problem,
    samples: slice,
    scales: Scales | None,
    effort: Effort,
    want_a: bool,
) -> Solution:
    """The motion at the times t (n,), s, over these samples of a recording, as ``solve`` gives it.

    problem : with the push of covariates in its drive. Raises SimulationError.
    """
    if not model.covariates:
        return solve(model, t, by, problem.drive, scales, effort, want_a)
    parts: list[Solution] = []
    at, now = 0, model
    by_start = np.zeros((2, len(by)))
    for piece in _pieces(model, by, problem, samples):
        end = t.size if piece.until is None else int(np.searchsorted(t, piece.until))
        times = t[at:] if piece.until is None else np.append(t[at:end], piece.until)
        if times.size == 0:
            break
        begun = replace(piece.model, x0=now.x0, v0=now.v0, t0=now.t0, terms=_begun(piece.model, now))
        names = tuple(dict.fromkeys((*_STARTS, *(name for one in piece.sums for name, _ in one)))) if by else ()
        found = solve(begun, times, names, problem.drive, scales, effort, want_a)
        first = now is model
        weights = np.zeros((len(names), len(by)))
        for q, one in enumerate(piece.sums):
            for name, factor in one:
                weights[names.index(name), q] += factor
        if by and not first:
            weights[:2] += by_start
        dx, dv, da = found.dx @ weights, found.dv @ weights, found.da @ weights
        keep = slice(0, end - at)
        parts.append(
            Solution(
                found.x[keep], found.v[keep], found.a[keep], found.mode[keep],
                dx[keep], dv[keep], da[keep], by, found.events, found.steps,
            )
        )  # fmt: skip
        if piece.until is None:
            break
        by_start = np.stack((dx[-1], dv[-1]))
        ran = np.append(t[:end], piece.until), np.append(np.concatenate([p.v for p in parts]), found.v[-1])
        now = resumed(model, problem, ran[0], float(found.x[-1]), ran[1])
        at = end
    return _joined(parts)


def _begun(piece: Model, now: Model) -> tuple[ModelTerm, ...]:
    """The piece's terms with the internal states that the motion has left, the last term besides."""
    own = (replace(e, internal0=n.internal0) for e, n in zip(piece.terms, now.terms, strict=False))
    return (*own, *piece.terms[len(now.terms) :])


def _pieces(model: Model, by: tuple[By, ...], problem: Problem, samples: slice) -> Iterator[_Piece]:
    begin, end, _ = samples.indices(problem.t.size)
    wanted = any(_of_push(model, b) is not None for b in by)
    stretches = list(pieces(model, problem.covariates, begin, end, smooth=bool(problem.acting)))
    starts = {*_STARTS, *(name for names in model.internal_names for name in names)}
    at = begin
    for piece in stretches:
        # before its release a slider does not know what acts on it
        if piece.stop < end and problem.t[piece.stop] <= model.t0:
            continue
        whole, first = slice(at, piece.stop), at == begin
        at = piece.stop
        own = held(model, problem.covariates, whole)
        push: By = (len(own.terms), 0)
        if wanted:
            own = replace(own, terms=(*own.terms, ModelTerm(_PUSH, (0.0,))))
        sums = tuple(_sum(model, b, problem, whole, push) if first or b not in starts else () for b in by)
        yield _Piece(own, sums, None if piece.stop >= end else float(problem.t[piece.stop]))


def _of_push(model: Model, by: By) -> int | None:
    """Which covariate's push a number belongs to; None of any other."""
    found = [i for i, p in enumerate(model.covariates) if p.acts is Acts.FORCE and by in p.fitted]
    return found[0] if found else None


def _sum(model: Model, by: By, problem: Problem, piece: slice, push: By) -> tuple[tuple[By, float], ...]:
    """Which numbers of a piece's own model one of the whole model's moves, and by how much."""
    mean = {name: float(np.mean(y[piece])) for name, y in problem.covariates.items()}
    for one in model.covariates:
        if by not in one.fitted:
            continue
        change = mean[one.name] - one.about if by == one.parameter else 1.0
        if one.acts is Acts.FORCE:
            return ((push, change),)
        if one.acts is Acts.DAMPING:
            return (("c", change * model.c),)
        return tuple((name, change * value) for name, value in scaled(model).items())
    dry, wet = changes(model, problem.covariates, piece)
    factor = wet if by == "c" else dry if by in scaled(model) else 1.0
    return ((by, factor),)


def _joined(parts: list[Solution]) -> Solution:
    """Pieces one after another."""
    if len(parts) == 1:
        return parts[0]
    arrays = {f: np.concatenate([getattr(p, f) for p in parts]) for f in ("x", "v", "a", "mode", "dx", "dv", "da")}
    events = Events(**{f.name: np.concatenate([getattr(p.events, f.name) for p in parts]) for f in fields(Events)})
    return Solution(**arrays, by=parts[0].by, events=events, steps=sum(p.steps for p in parts))
