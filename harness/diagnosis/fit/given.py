"""Covariates in a simulation: measured columns that push the slider, or make its friction or damping more or less.

A push is part of the drive. Friction and damping are held over pieces in which they hardly change, one after another,
so that the motion is that of a staircase within ``_HELD`` of what was measured.
"""

from collections.abc import Iterator, Mapping
from dataclasses import replace

import numpy as np

from harness.core.arrays import FloatArray
from harness.diagnosis.problem import Problem
from harness.diagnosis.problems.starts import Windows
from harness.kernels.solve import By, Drive
from harness.model.covariate import Acts
from harness.model.history import History
from harness.model.model import Model, ModelTerm
from harness.model.term import Slot

_HELD = 0.02
"""Share of f_k or c that may change within a piece."""
_HELD_COLUMN = 0.04
"""Share of a covariate's own range that may: what a gain does, which may be nil yet, is told by steps of it."""
_LEVELS = frozenset({Slot.FRICTION_LEVEL, Slot.BREAK_AWAY})
_FRICTION = _LEVELS | {Slot.FRICTION_LAW, Slot.FRICTION_MODULATION}


def factor(model: Model, values: Mapping[str, FloatArray], acts: Acts) -> FloatArray:
    """What f_k or c is times, (n,) or a number as the values are; never below 0, where nothing is left of it."""
    effects = [p.effect(values[p.name]) for p in model.covariates if p.acts is acts]
    return np.maximum(1.0 + np.sum(effects, axis=0), 0.0) if effects else np.ones(())


def pushed(model: Model, values: Mapping[str, FloatArray]) -> FloatArray:
    """The force (n,), N, by which covariates push the slider."""
    effects = [p.effect(values[p.name]) for p in model.covariates if p.acts is Acts.FORCE]
    return np.asarray(np.sum(effects, axis=0)) if effects else np.zeros(())


def frictionless(model: Model) -> Model:
    """The same without dry friction and without covariates."""
    smooth = tuple(entry for entry in model.terms if entry.term.slot not in _FRICTION)
    return replace(model, f_k=0.0, f_s=None, terms=smooth, covariates=())


def with_push(model: Model, problem: Problem) -> Problem:
    """The problem with the push of covariates in its drive."""
    push, drive = pushed(model, problem.covariates), problem.drive
    if push.ndim == 0:
        return problem
    if drive is None:
        return replace(problem, drive=Drive(problem.t, push))
    return replace(problem, drive=Drive(drive.t, drive.u + np.interp(drive.t, problem.t, push)))


def changes(model: Model, values: Mapping[str, FloatArray], piece: slice) -> tuple[float, float]:
    """What f_k and c are times in the mean of a piece."""
    mean = {name: np.asarray(np.mean(y[piece])) for name, y in values.items()}
    return float(factor(model, mean, Acts.FRICTION)), float(factor(model, mean, Acts.DAMPING))


def scaled(model: Model) -> dict[By, float]:
    """The numbers that friction's factor multiplies, and their values."""
    laws = ((i, entry) for i, entry in enumerate(model.terms) if entry.term.slot in _LEVELS)
    sized = ((i, j, entry) for i, entry in laws for j, p in enumerate(entry.term.parameters) if p.unit == "N")
    return {"f_k": model.f_k, **{(i, j): entry.values[j] for i, j, entry in sized}}


def held(model: Model, values: Mapping[str, FloatArray], piece: slice) -> Model:
    """The model with friction and damping as they are in the mean of a piece; its push is in the drive."""
    dry, wet = changes(model, values, piece)
    f_s = None if model.f_s is None else dry * model.f_s
    terms = tuple(_scaled(entry, dry) for entry in model.terms)
    return replace(model, f_k=dry * model.f_k, f_s=f_s, c=wet * model.c, terms=terms, covariates=())


def _scaled(entry: ModelTerm, dry: float) -> ModelTerm:
    """A law of the friction's level with its forces times ``dry``."""
    if entry.term.slot not in _LEVELS:
        return entry
    sized = zip(entry.values, entry.term.parameters, strict=True)
    return replace(entry, values=tuple(dry * value if p.unit == "N" else value for value, p in sized))


def pieces(
    model: Model, values: Mapping[str, FloatArray], begin: int, end: int, smooth: bool = False
) -> Iterator[slice]:
    """Samples from ``begin`` to ``end`` in pieces over which friction and damping hardly change.

    smooth : nor do the covariates, which have little noise then.
    """
    part = {name: y[begin:end] for name, y in values.items()}
    both = (np.broadcast_to(factor(model, part, acts), (end - begin,)) for acts in (Acts.FRICTION, Acts.DAMPING))
    steps = [_HELD / _HELD_COLUMN / (float(np.ptp(part[p.name])) or 1.0) for p in model.covariates if smooth]
    columns = [step * part[p.name] for step, p in zip(steps, model.covariates, strict=False)]
    levels = np.column_stack((*both, *columns)).tolist()
    first = 0
    for i, level in enumerate(levels):
        if any(abs(now - then) > _HELD for now, then in zip(level, levels[first], strict=True)):
            yield slice(begin + first, begin + i)
            first = i
    yield slice(begin + first, end)


def resumed(model: Model, problem: Problem, t: FloatArray, x: float, v: FloatArray) -> Model:
    """The model as its motion, of speeds v (n,) at t (n,), s, leaves it; x : where it is, m.

    Internal states are those that this motion implies, after the recorded one before it.
    """
    before, speeds = t[:0], v[:0]
    if isinstance(problem.starts, Windows):
        earlier = problem.starts.t < t[0]
        before, speeds = problem.starts.t[earlier], problem.starts.v[earlier]
    motion = History(np.concatenate((before, t)), np.concatenate((speeds, v)), t[-1:], v[-1:], model.f_k)
    return replace(model, x0=x, v0=float(v[-1]), t0=float(t[-1]), terms=tuple(_left_by(motion, e) for e in model.terms))


def _left_by(motion: History, entry: ModelTerm) -> ModelTerm:
    if entry.term.implied is None:
        return entry
    return replace(entry, internal0=tuple(entry.term.implied(entry.values, motion).values[0].tolist()))
