"""What the noise of a measured force does to a slider, to first order along the motion of a model.

Between samples that noise is a straight line, or held, as the force is. Where the slider sticks it moves nothing, and a
reversal passes on that share of a disturbed speed which the acceleration keeps (the saltation of a Filippov system:
Leine and Nijmeijer 2004, ch. 7).
"""

import math
from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from harness.core.arrays import BoolArray, FloatArray, IntArray, read_only
from harness.core.errors import SimulationError
from harness.core.events import EventKind, Events, Mode
from harness.core.jit import compiled
from harness.diagnosis.fit.model_fit import Fit
from harness.diagnosis.problem import Observation, Problem, apart
from harness.diagnosis.problems.force_noise import ForceNoise
from harness.diagnosis.rules import DECISIVE
from harness.estimate.noise import Noise
from harness.kernels.solve import Drive
from harness.model.model import Model, Restoring

_SHOWS = 0.01
"""Share of its sensors' variance that the force's noise adds somewhere, from which it is allowed for."""
_LEVELS = (*(0.5**i for i in range(12)), 0.0)
"""Shares of a force's scatter that may be noise."""
_FINER = 2.0**0.5, 2.0**0.25
"""Factors between two of them, in turn."""
_BENT = 3
"""Samples that tell how a force bends; as many neighbours share it."""
_UNKNOWN = (1.0, 0.5, 0.25)
"""Shares of that which may not be known: a quarter is what a smooth force departs from its line."""
_NEARLY = 3.0
"""Deviations of a force's noise within which of breaking away a slider is not sure to rest."""
_SERIES = 5
"""Terms of the exponential of a step: the next is 1/720 at a step of one radian."""
_PLACED, _PLACED_EXACTLY = 0.1, 1e-3
"""Sampling intervals to which a force places an event, noisy or not: what it does between samples is a guess."""
_REVERSAL, _STICK, _BREAK_AWAY = int(EventKind.REVERSAL), int(EventKind.STICK), int(EventKind.BREAK_AWAY)


def force_noise(
    model: Model, shown: Observation, t: FloatArray, force: Noise, noise: Mapping[str, Noise],
    start: FloatArray | None = None, *, drive: Drive | None = None, between: FloatArray | None = None,
) -> ForceNoise | None:  # fmt: skip
    """What the noise of a force does to a recording at t (n,), s, that ``model`` follows as shown; None if nothing.

    noise : of the channels. drive : the force, straight between samples if it is not told. start (n, 2) : how little is
    known of position and speed where the motion is followed anew.
    """
    held = drive is not None and drive.held
    anew = np.zeros((t.size, 2)) if start is None else start
    unknown = np.zeros(t.size) if between is None else between
    if not force.found and not np.any(anew) and not np.any(unknown):
        return None
    bend = np.cos(shown.x) if model.restoring is Restoring.PENDULUM else np.ones(t.size)
    pull, drag, push = model.k / model.m * bend, model.c / model.m, 1.0 / model.m
    slips, events = shown.mode != Mode.STICK, shown.events
    times = np.ones(t.size)
    if drive is not None and force.found:
        nearly = _nearly_slips(model, shown, drive.at(t), force.sigma)
        slips, times[nearly] = slips | nearly, _NEARLY
        events = _surely_at_rest(events, t, slips)
    turns = events.kind == EventKind.REVERSAL
    share = np.zeros(len(events))
    share[turns] = events.a_after[turns] / np.where(events.a_before[turns] == 0.0, math.inf, events.a_before[turns])
    moves = np.zeros((t.size - 1, 2, 4))
    _moves(read_only(t), held, slips, pull, drag, push, events.t, events.kind, np.clip(share, 0.0, 1.0), moves)
    # what went before tells nothing of a new start
    moves[np.flatnonzero(np.any(anew[1:] > 0.0, axis=1))] = 0.0
    found = ForceNoise(
        t,
        force,
        moves,
        pull,
        drag,
        push,
        slips,
        np.zeros((t.size, 4)),
        np.zeros((t.size, 2)),
        between=unknown,
        times=times,
    )
    if not ((force.found or np.any(unknown)) and _shows(found, noise)):
        if not np.any(anew):
            return None
        found = replace(found, noise=replace(force, sigma=0.0, found=False))
    placed = _PLACED if found.noise.found else _PLACED_EXACTLY
    return replace(found, start=anew, jumps=_jumps(t, events, placed))


def _nearly_slips(model: Model, shown: Observation, u: FloatArray, sigma: float) -> BoolArray:
    """Where (n,) a slider rests that noise of its force u (n,), N, may have stopped or may move.

    The most that it withstands at rest is told by the motion itself: models differ in what breaks it away.
    """
    rests = shown.mode == Mode.STICK
    x = shown.x - model.offset
    pulled = np.abs(u - model.k * (np.sin(x) if model.restoring is Restoring.PENDULUM else x))
    most = float(np.max(pulled[rests], initial=0.0))
    return np.asarray(rests & (pulled > most - _NEARLY * sigma), dtype=np.bool_)


def _surely_at_rest(events: Events, t: FloatArray, slips: BoolArray) -> Events:
    """Events without those that begin or end a rest of which noise leaves nothing sure."""
    before = np.clip(np.searchsorted(t, events.t, side="right") - 1, 0, t.size - 2)
    at = np.where(events.kind == EventKind.BREAK_AWAY, before, before + 1)
    rest = (events.kind == EventKind.BREAK_AWAY) | (events.kind == EventKind.STICK)
    return events.where(~(rest & slips[at]))


def between(problem: Problem, told: Noise) -> FloatArray:
    """Standard deviation (n,), N, of what is not known of a force beside each sample, if that is how its samples bend.

    What a controller does between two samples of a slow log no line between them tells. A force that is held is known.
    told : the noise of the force, which bends them too.
    """
    t, drive = problem.t, problem.drive
    if drive is None or drive.held or t.size < _BENT:
        return np.zeros(t.size)
    u = np.interp(t, drive.t, drive.u)
    later = (t[1:-1] - t[:-2]) / (t[2:] - t[:-2])
    bend = u[1:-1] - (1.0 - later) * u[:-2] - later * u[2:]
    square = np.zeros(t.size)
    square[1:-1] = bend**2 - told.sigma**2 * (1.0 + later**2 + (1.0 - later) ** 2)
    return np.sqrt(np.maximum(np.convolve(square, np.full(_BENT, 1.0 / _BENT), mode="same"), 0.0))


def unlikely(found: Fit, problem: Problem) -> float:
    """Minus twice the logarithm of the likelihood of what a fit leaves under a problem's noise, but for a constant."""
    left = left_of(problem, found.shown)
    if problem.force_noise is not None:
        return problem.force_noise.unlikely(problem.t, problem.noise, problem.weight, left)
    white = apart(problem, left)
    size = sum(
        float(np.count_nonzero(problem.weight[c])) * math.log(n.sigma**2 * (1.0 - n.phi**2))
        for c, n in problem.noise.items()
    )
    return size + sum(float(np.sum(w**2)) for w in white.values())


def left_of(problem: Problem, shown: Observation) -> dict[str, FloatArray]:
    """What a motion leaves (n,) of each channel."""
    return {c: y - shown.y[c] for c, y in problem.channels.items()}


def as_it_shows(force: ForceNoise, problem: Problem, shown: Observation) -> ForceNoise | None:
    """The noise of a force at the level that the motion shows beside a model; None where that is none.

    A controller's command scatters with its encoder, and the slider has felt every bit of that: the largest level is
    taken that is not decidedly less likely than the best one. Raises SimulationError where none is likely.
    """
    left = left_of(problem, shown)
    told = force.as_told()
    levels = [force.at(told.sigma * level) for level in _LEVELS] if told.found else []
    if not levels:
        return force
    off = [one.unlikely(problem.t, problem.noise, problem.weight, left) for one in levels]
    most = min((by for by in off if math.isfinite(by)), default=math.nan) + DECISIVE.value
    if math.isnan(most):
        raise SimulationError("what noise of the force does to the motion leaves all bounds")
    within = next(i for i, by in enumerate(off) if by <= most)
    found = levels[within]
    for finer in _FINER if within and found.noise.found else ():
        one = found.at(found.noise.sigma * finer)
        if one.unlikely(problem.t, problem.noise, problem.weight, left) <= most:
            found = one
    return found if found.noise.found or np.any(found.start) else None


def unknown_between(found: Fit, problem: Problem) -> float:
    """Share of how a force bends that is not known of it between samples, as a fit tells; 0 where it is all known.

    The largest that is not decidedly less likely than the best, where that all is known is so.
    """
    force = problem.force_noise
    told = Noise(0.0, found=False) if force is None else force.as_told()
    left, bends = left_of(problem, found.shown), between(problem, told)
    if force is None and problem.drive is not None:
        force = force_noise(
            found.model, found.shown, problem.t, told, problem.noise, drive=problem.drive, between=bends
        )
    if force is None:
        return 0.0
    off = {
        share: replace(force, between=share * bends).unlikely(problem.t, problem.noise, problem.weight, left)
        for share in (0.0, *_UNKNOWN)
    }
    best = min(off.values())
    return next((share for share in _UNKNOWN if off[share] <= best + DECISIVE.value < off[0.0]), 0.0)


def _shows(force: ForceNoise, noise: Mapping[str, Noise]) -> bool:
    """Whether noise of a force adds to what sensors of this noise have of their own."""
    nothing = {c: np.zeros(force.t.size) for c in noise}
    _, variance = force.whitened(force.t, noise, nothing, nothing)
    return any(float(np.max(v)) > (1.0 + _SHOWS) * noise[c].sigma ** 2 for c, v in variance.items())


def _jumps(t: FloatArray, events: Events, placed: float) -> FloatArray:
    """At the nearest event (N, 4): jump of the acceleration, time to it, acceleration before it, its time's error."""
    found = np.zeros((t.size, 4))
    jump = np.abs(events.a_after - events.a_before)
    at = np.flatnonzero((jump > 0.0) & (events.a_before != 0.0))
    if at.size:
        middles = 0.5 * (events.t[at][1:] + events.t[at][:-1])
        nearest = at[np.searchsorted(middles, t)]
        found[:, 0], found[:, 2] = jump[nearest], np.abs(events.a_before[nearest])
        found[:, 1] = np.abs(t - events.t[nearest])
        found[:, 3] = placed * float(np.median(np.diff(t)))
    return found


def _row(pull: float, drag: float, h: float, x: float, v: float) -> tuple[float, float]:
    """By how much displacement and speed at first move x times the displacement and v times the speed after h (s)."""
    found_x, found_v = x, v
    for i in range(1, _SERIES + 1):
        # the next power of the 2 x 2 system
        x, v = -pull * v * (h / i), (x - drag * v) * (h / i)
        found_x, found_v = found_x + x, found_v + v
    return found_x, found_v


_compiled_row = compiled(_row)


def _step(pull: float, drag: float, push: float, h: float, begin: float, end: float, move: FloatArray) -> None:
    """Carry ``move`` (2, 4) on by h (s), while the force's noise goes from share ``begin`` of its way to ``end``."""
    x_x, x_v = _compiled_row(pull, drag, h, 1.0, 0.0)
    v_x, v_v = _compiled_row(pull, drag, h, 0.0, 1.0)
    for q in range(move.shape[1]):
        x, v = move[0, q], move[1, q]
        move[0, q], move[1, q] = x_x * x + x_v * v, v_x * x + v_v * v
    # the force's part by Simpson's rule
    middle = 0.5 * (begin + end)
    for r in range(2):
        _, half = _compiled_row(pull, drag, 0.5 * h, 1.0 - r, float(r))
        first, second, third = push * (v_v if r == 1 else x_v), push * half, push * r
        move[r, 2] += h / 6.0 * (first * (1.0 - begin) + 4.0 * second * (1.0 - middle) + third * (1.0 - end))
        move[r, 3] += h / 6.0 * (first * begin + 4.0 * second * middle + third * end)


_compiled_step = compiled(_step)


def _all_moves(
    t: FloatArray, held: bool, slips: BoolArray, pull: FloatArray, drag: float, push: float, events: FloatArray,
    kind: IntArray, share: FloatArray, out: FloatArray,
) -> None:  # fmt: skip
    """From each instant to the next (n - 1, 2, 4), through the events between."""
    e = 0
    for i in range(t.size - 1):
        move = out[i]
        move[:] = 0.0
        move[0, 0] = move[1, 1] = 1.0
        slipping, since, width = slips[i], t[i], t[i + 1] - t[i]
        while e < events.size and events[e] <= t[i]:
            e += 1
        while True:
            until = events[e] if e < events.size and events[e] <= t[i + 1] else t[i + 1]
            if slipping:
                # a force that is held keeps its noise as it was
                begin, end = (0.0, 0.0) if held else ((since - t[i]) / width, (until - t[i]) / width)
                _compiled_step(0.5 * (pull[i] + pull[i + 1]), drag, push, until - since, begin, end, move)
            else:
                move[1] = 0.0
            since = until
            if e >= events.size or events[e] > t[i + 1]:
                break
            if kind[e] == _REVERSAL:
                for q in range(move.shape[1]):
                    move[1, q] *= share[e]
            elif kind[e] == _STICK:
                slipping = False
            elif kind[e] == _BREAK_AWAY:
                slipping = True
                move[1] = 0.0
            e += 1
        if not slips[i + 1]:
            move[1] = 0.0


_moves = compiled(_all_moves)
