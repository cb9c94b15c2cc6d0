"""What the sensors would have shown of a model's motion, with partials: slot O, composed per channel.

What covariates do: measured columns that push the slider, or make its friction or damping more or less.

A motion with covariates as they were measured: laws with tables of them, and partials by their gains.
"""

from collections.abc import Mapping, Sequence
from dataclasses import fields, replace
from typing import TypeAlias

import numpy as np

from harness.core.arrays import FloatArray, IntArray
from harness.core.events import Events
from harness.diagnosis.problem import Observation, Problem
from harness.diagnosis.sensor_model import Kinematics, Reading, lag_of, read
from harness.diagnosis.starts import Start
from harness.kernels.solve import By, Effort, Scales, Solution, solve
from harness.model.covariate import GIVEN, Acts, Covariate
from harness.model.model import Model, ModelTerm
from harness.model.term import Slot

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
    smooth = tuple(model.terms[i] for i in frictionless_terms(model))
    return replace(model, f_k=0.0, f_s=None, terms=smooth, covariates=())


def frictionless_terms(model: Model) -> tuple[int, ...]:
    """Which terms of a model are none of dry friction."""
    return tuple(i for i, entry in enumerate(model.terms) if entry.term.slot not in _FRICTION)


_MOST = 2000
"""Values of all tables: a column that is slow beside the motion, or smooth, has no more to say."""


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

    Raises SimulationError.
    """
    if not model.covariates:
        return solve(model, t, by, problem.drive, scales, effort, want_a)
    first = len(model.terms)
    entries = tuple(_law(one, problem, samples) for one in model.covariates)
    whole = replace(model, terms=(*model.terms, *entries), covariates=())
    sums = [_sum(model, first, b) for b in by]
    names = tuple(dict.fromkeys(name for one in sums for name in one))
    found = solve(whole, t, names, problem.drive, scales, effort, want_a)
    weights = np.zeros((len(names), len(by)))
    for q, one in enumerate(sums):
        for name, factor in one.items():
            weights[names.index(name), q] = factor
    return replace(found, dx=found.dx @ weights, dv=found.dv @ weights, da=found.da @ weights, by=by)


def _law(one: Covariate, problem: Problem, samples: slice) -> ModelTerm:
    """A covariate as a law with its table over a stretch of a recording."""
    t, values = problem.t[samples], problem.covariates[one.name][samples] - one.about
    even = np.linspace(t[0], t[-1], max(min(t.size, _MOST // len(problem.covariates)), 2))
    rate = (even.size - 1) / max(float(t[-1] - t[0]), 1e-300)
    table = (float(t[0]), rate, float(even.size - 1), *np.interp(even, t, values).tolist())
    own = (one.gain, one.level) if one.acts is Acts.FORCE else (one.gain,)
    return ModelTerm(GIVEN[one.acts], own, given=table)


def _sum(model: Model, first: int, by: By) -> dict[By, float]:
    """Which numbers of the laws one of the model moves, and by how much; first : place of the first covariate's law."""
    for i, one in enumerate(model.covariates):
        if by in one.fitted:
            return {(first + i, 0 if by == one.parameter else 1): 1.0}
    found: dict[By, float] = {by: 1.0}
    if by == "c" and model.c > 0.0:
        # what is in proportion to the damping moves with it
        wet = ((first + i, one) for i, one in enumerate(model.covariates) if one.acts is Acts.DAMPING)
        found |= {(i, 0): one.gain / model.c for i, one in wet}
    return found


FINE = Effort(1e-8, 1500)
"""Far below any noise."""
COARSE = Effort(1e-6, 600)
"""For a first look; a law too stiff for it is not worth one."""

Samples: TypeAlias = IntArray | slice
"""Which of a motion's samples a channel shows; all of them without a copy."""


def _is_sensor(model: Model, by: By) -> bool:
    return by == "offset" or (isinstance(by, tuple) and model.terms[by[0]].term.slot is Slot.OBSERVATION)


def observe(
    model: Model, problem: Problem, by: tuple[By, ...] = (), scales: Scales | None = None, effort: Effort = FINE
) -> Observation:
    """Channels of ``problem`` as ``model`` predicts them, with partials by the parameters ``by``.

    Each stretch is simulated from its own start, with covariates as they were measured. Raises SimulationError when the
    motion cannot be followed.
    """
    scales = scales or Scales.of(model, problem.drive)
    return _joined([_from(start, problem, by, scales, effort) for start in problem.starts.of(model)])


def _from(start: Start, problem: Problem, by: tuple[By, ...], scales: Scales, effort: Effort) -> Observation:
    """One stretch on its own clock, its starts (the internal ones too) moving with the parameters that decide them."""
    here: list[By | None] = [start.own.get(b, b) for b in by]
    moving = [name for b in here if b is not None for name in start.slopes.get(b, {})]
    asked = tuple(dict.fromkeys((*(b for b in here if b is not None), *moving)))
    t = problem.t[start.samples] - start.clock
    shown = _stretch(start, problem.on_clock(start.clock, t), t, asked, scales, effort)
    if start.clock != 0.0:
        shown = replace(shown, events=replace(shown.events, t=shown.events.t + start.clock))
    if list(asked) == here:
        return shown
    dy = {}
    for c, partials in shown.dy.items():
        dy[c] = np.zeros((t.size, len(by)))
        for column, b in enumerate(here):
            if b is not None:
                dy[c][:, column] = partials[:, asked.index(b)]
                for name, slope in start.slopes.get(b, {}).items():
                    dy[c][:, column] += slope * partials[:, asked.index(name)]
    return replace(shown, dy=dy)


def _joined(parts: Sequence[Observation]) -> Observation:
    """Stretches one after another; arrays of shape (n,) and (n, q) as for one stretch."""
    if len(parts) == 1:
        return parts[0]
    channels = parts[0].y
    events = [p.events for p in parts]
    return Observation(
        {c: np.concatenate([p.y[c] for p in parts]) for c in channels},
        {c: np.concatenate([p.dy[c] for p in parts]) for c in channels},
        x=np.concatenate([p.x for p in parts]),
        v=np.concatenate([p.v for p in parts]),
        a=np.concatenate([p.a for p in parts]),
        mode=np.concatenate([p.mode for p in parts]),
        events=Events(**{f.name: np.concatenate([getattr(e, f.name) for e in events]) for f in fields(Events)}),
    )


def _stretch(
    start: Start, problem: Problem, t: FloatArray, by: tuple[By, ...], scales: Scales | None, effort: Effort
) -> Observation:
    """A stretch simulated from its start."""
    model = start.model
    dynamic = tuple(b for b in by if not _is_sensor(model, b))
    column = {b: i for i, b in enumerate(dynamic)}
    want_a = "a" in problem.channels
    lag = lag_of(model)
    at: Samples
    late: Samples
    if lag != 0.0 and "x" in problem.channels:
        times = np.concatenate((t, t - lag))
        order = np.argsort(times, kind="stable")
        sorted_times, back = np.unique(times[order], return_inverse=True)
        place = np.empty(times.size, dtype=np.int64)
        place[order] = back
        at, late = place[: t.size], place[t.size :]
        motion = motion_given(model, sorted_times, dynamic, problem, start.samples, scales, effort, want_a)
    else:
        at = late = slice(None)
        motion = motion_given(model, t, dynamic, problem, start.samples, scales, effort, want_a)
    source = np.array([column.get(b, -1) for b in by], dtype=np.int64)
    moved = source >= 0

    def through(reading: Reading, partials: FloatArray, rows: Samples) -> FloatArray:
        """Partials (n, q) of a channel: the motion's through the sensors, the sensors' own beside them."""
        own = partials[rows]
        if reading.by_motion is not None:
            own = own * reading.by_motion[:, None]
        if np.any(reading.by_place):
            own = own + motion.dx[rows] * np.asarray(reading.by_place)[:, None]
        if moved.all() and len(column) == len(by):
            return own
        out = np.zeros((t.size, len(by)))
        out[:, moved] = own[:, source[moved]]
        for i, b in enumerate(by):
            if b in reading.by:
                out[:, i] = reading.by[b]
        return out

    true = Kinematics(motion.x[at], motion.v[at], motion.a[at])
    delayed = true if late is at else Kinematics(motion.x[late], motion.v[late], motion.a[late])
    readings = read(model, t, true, delayed, problem.channels)
    moves = {"x": (motion.dx, late), "v": (motion.dv, at), "a": (motion.da, at)}
    y = {c: reading.y for c, reading in readings.items()}
    dy = {c: through(reading, *moves[c]) for c, reading in readings.items()}
    return Observation(y, dy, true.x, true.v, true.a, motion.mode[at], motion.events)
