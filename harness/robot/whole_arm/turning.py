"""What happens at reversals, which the guard leaves out: presliding, static friction, backlash, a late torque.

Each is a torque along the motion, sent through the filter of the torque and compared with all samples. How sure it is
comes from how the reversals agree with each other: what is common to a reversal's neighbourhood is one observation.
"""

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
from scipy.special import betainc

from harness.core.arrays import BoolArray, FloatArray, IntArray
from harness.model.terms import backlash, presliding, static_friction
from harness.robot.whole_arm.columns import (
    DELAY,
    FRICTION,
    MODEL,
    STRIBECK,
    WHICH_IS_LATE,
    Candidate,
    Setting,
    free,
    signs,
)
from harness.robot.whole_arm.correct import Solved
from harness.robot.whole_arm.design import Design, Named, Part, Whitened, evidence_of_chance
from harness.robot.whole_arm.differentiate import Filtered
from harness.robot.whole_arm.noise import Stretches
from harness.robot.whole_arm.prepare import reversals, sure_speed
from harness.robot.whole_arm.rules import (
    AT_EDGE,
    COVERED,
    ENOUGH_TURNS,
    GUARD,
    HELD_LEAST,
    HELD_MOST,
    LONGEST_SLIP,
    NAMED,
    RIVAL,
    STICKS,
)
from harness.robot.whole_arm.search import Chosen, left_over, polished

PRESLIDING, STATIC, BACKLASH = presliding.TERM.name, static_friction.TERM.name, backlash.TERM.name
_LENGTHS = 12
"""Lengths, and speeds, that are tried."""


@dataclass(frozen=True, slots=True)
class Turned:
    """joint : which. chosen : what was named at its reversals. reversals : how many there are.

    numbers, errors : what was found, in the candidate's order. share : of what the base leaves beyond the noise.
    of_stribeck : it is the foot of a fall with speed that the guarded samples saw the top of, and replaces it.
    """

    joint: int
    chosen: Chosen
    reversals: int
    numbers: FloatArray
    errors: FloatArray
    share: float
    of_stribeck: bool = False


def at_reversals(solved: Solved) -> Iterator[Turned]:
    """What is named at the reversals of each joint, at most one thing a joint."""
    filtered, design = solved.problem.filtered, solved.model.design
    for j, part in enumerate(design.parts):
        dof = filtered.dof[j]
        v = filtered.v_fine[:, dof]
        turns, free = _sliding(filtered, j, reversals(v, sure_speed(filtered, j)))
        if turns.size < ENOUGH_TURNS.value:
            continue
        whole = replace(part, torque=_own(design, j), stretches=Stretches.of(filtered.good & free))
        local = [n for n in design.named if n.candidate.joint == j]
        held = tuple(Named(Whitened.of(_alone(n.candidate), (whole,)), n.setting) for n in local)
        nearest = _nearest(filtered, turns)[whole.stretches.kept]
        plain = Design((whole,), held)
        coulomb, viscous = abs(float(design.numbers[design.places[j]][0])), float(design.numbers[design.places[j]][1])
        rigid = solved.problem.rigid[:, j]
        *shapes, late = _candidates(filtered, j, turns, (coulomb, viscous), rigid)
        # how friction changes within a rest too short to be seen is not known, and looks like a time
        unseen = 0.5 * STICKS.value / filtered.band.lowpass
        timing = Named(Whitened.of(replace(late, spread=np.array([unseen])), (whole,)), 0)
        moved = plain.score(timing.whitened).gain
        held = (*held, timing)
        base = Design((whole,), held)
        tried = [_try(base, shape, nearest, moved) for shape in shapes] + [_try(plain, late, nearest)]
        found = [t for t in tried if t is not None and _plausible(t, coulomb, unseen)]
        found.sort(key=lambda one: -one.gain)
        sure = [one for one in found if one.evidence >= NAMED.value]
        if sure and sure[0] is found[0]:
            rivals = tuple(one.named.candidate.name for one in found[1:] if one.gain > found[0].gain - RIVAL.value)
            falling = [n for n in local if n.candidate.name == STRIBECK]
            sharper = bool(falling) and found[0].named.candidate.name == STATIC
            if sharper:
                if falling[0].candidate.settings[0].values[0][2] > AT_EDGE.value * _covered(filtered, j, part):
                    continue
                held = tuple(n for n in held if n.candidate.name != STRIBECK)
                base = Design((whole,), held)
            if found[0].named.candidate.name == DELAY:
                held, base = held[:-1], plain
            named, fitted = polished((whole,), held, found[0].named)
            count = named.candidate.spread.size
            errors = np.sqrt(np.diag(fitted.covariance()))[-count:]
            errors[0] = max(errors[0], found[0].error)
            if named.candidate.name == PRESLIDING and _too_short(filtered, j, named, float(errors[-1])):
                continue
            turning = filtered.good & ~part.stretches.kept
            squares = [float(np.sum(left_over(one, 0)[0][turning] ** 2)) for one in (base, fitted)]
            floor = float(np.sum(turning)) * float(filtered.torque_noise[j]) ** 2
            share = float(np.clip((squares[0] - squares[1]) / max(squares[0] - floor, 1e-300), 0.0, 1.0))
            chosen = Chosen(named, found[0].evidence, rivals)
            yield Turned(j, chosen, turns.size, fitted.numbers[-count:], errors, share, sharper)


def _sliding(filtered: Filtered, joint: int, turns: FloatArray) -> tuple[FloatArray, BoolArray]:
    """Reversals in which a joint does not rest, and the samples (m,) that no rest comes near.

    At rest friction is whatever holds the joint, and says nothing of the law by which it slides. One that creeps, as in
    engines, rests too: it is slow for half longer than a reversal's acceleration takes through such speeds.
    """
    reach, slowest = GUARD.value / filtered.band.lowpass, sure_speed(filtered, joint)
    turning = float(np.quantile(np.abs(filtered.a[:, filtered.dof[joint]]), 0.75))
    slow = np.pad(np.abs(filtered.v_fine[:, filtered.dof[joint]]) < slowest, 1).astype(np.int8)
    spans = filtered.t_fine[np.minimum(np.flatnonzero(np.diff(slow)), filtered.t_fine.size - 1)].reshape(-1, 2)
    longest = max(STICKS.value / filtered.band.lowpass, 1.5 * 2.0 * slowest / max(turning, 1e-12))
    crept = spans[spans[:, 1] - spans[:, 0] > longest]
    resting = np.zeros(filtered.t.size, dtype=np.bool_)
    for first, last in (*filtered.rests[joint], *crept):
        resting |= (filtered.t > first - reach) & (filtered.t < last + reach)
    at = filtered.t_fine[0] + turns / filtered.fine.rate
    near = np.clip(np.searchsorted(filtered.t, at), 0, filtered.t.size - 1)
    return turns[~resting[near]], ~resting


def _within(filtered: Filtered, joint: int) -> float:
    """How far, rad, a joint goes of its own reversal in the time in which nothing of it is seen (rule sticks)."""
    turning = float(np.median(np.abs(filtered.a[:, filtered.dof[joint]])))
    return 0.5 * turning * (STICKS.value / filtered.band.lowpass) ** 2


def _too_short(filtered: Filtered, joint: int, named: Named, error: float) -> bool:
    """Whether a length of presliding is not surely above what a reversal's own rest makes."""
    return named.candidate.settings[named.setting].values[0][2] < _within(filtered, joint) + 2.0 * error


def _covered(filtered: Filtered, joint: int, part: Part) -> float:
    """The least Stribeck speed that guarded samples cover, rad/s."""
    return float(np.quantile(np.abs(filtered.v[part.stretches.kept, filtered.dof[joint]]), COVERED.value))


def _alone(candidate: Candidate) -> Candidate:
    """A candidate of one joint, in a problem of that joint alone."""
    return replace(
        candidate,
        joint=0,
        settings=tuple(Setting(s.values, dict(enumerate(s.columns.values()))) for s in candidate.settings),
    )


def _own(design: Design, joint: int) -> FloatArray:
    """Torque (m,) of a joint without what errors of the model that several joints share take of it."""
    torque = np.array(design.parts[joint].torque)
    for one, place in zip(design.named, design.places[len(design.parts) :], strict=True):
        columns = one.candidate.settings[one.setting].columns
        if one.candidate.joint is None and joint in columns:
            torque -= columns[joint] @ design.numbers[place]
    return torque


def _nearest(filtered: Filtered, turns: FloatArray) -> IntArray:
    """The reversal that each sample (m,) of the fit is nearest to."""
    times = filtered.t_fine[0] + turns / filtered.fine.rate
    return np.asarray(np.searchsorted((times[1:] + times[:-1]) / 2.0, filtered.t), dtype=np.int64)


def _candidates(
    filtered: Filtered, joint: int, turns: FloatArray, friction: tuple[float, float], rigid: FloatArray
) -> Iterator[Candidate]:
    """What may happen at reversals; columns stand under joint 0, the only one of the problem."""
    dof = filtered.dof[joint]
    q, v = filtered.q_fine[:, dof], filtered.v_fine[:, dof]
    sign = signs(v)
    sliding = filtered.column(sign, jumps=True)
    quantum = float(filtered.position_step[joint])
    turning = float(np.median(np.abs(filtered.a[:, dof])))
    least = max(4.0 * quantum, 1e-4 * np.ptp(q), _within(filtered, joint))
    lengths = np.geomspace(least, max(LONGEST_SLIP.value * np.ptp(q), 2.0 * least), _LENGTHS)

    def settings(what: str, unit: str, values: FloatArray, columns: list[FloatArray]) -> tuple[Setting, ...]:
        return tuple(Setting(((what, unit, float(x)),), {0: c[:, None]}) for x, c in zip(values, columns, strict=True))

    def held(length: float) -> FloatArray:
        return (filtered.column(bristles(q, length)) - sliding)[:, None]

    tried = settings("length", "rad", lengths, [held(float(length))[:, 0] for length in lengths])
    yield Candidate(PRESLIDING, FRICTION, joint, tried, (("held", "N m"),), free(1), shape=held)
    # within one step of the encoder a reversal has no speed of its own, and within one sample no shape
    least = max(2.0 * math.sqrt(2.0 * turning * quantum), 3.0 * turning / filtered.fine.rate)
    speeds = np.geomspace(least, max(float(np.quantile(np.abs(v), 0.15)), 2.0 * least), _LENGTHS)

    def fallen(v_s: float) -> FloatArray:
        return filtered.column((sign * np.exp(-((v / v_s) ** 2)))[:, None], jumps=True)

    more = settings("v_s", "rad/s", speeds, [fallen(float(v_s))[:, 0] for v_s in speeds])
    yield Candidate(STATIC, FRICTION, joint, more, (("f_s - f_c", "N m"),), free(1), shape=fallen)
    load = np.interp(filtered.t_fine, filtered.t, rigid)
    since = np.abs(q - q[_last(turns, q.size)])
    loose = [filtered.column(-load * (since < gap), jumps=True) for gap in lengths]
    yield Candidate(BACKLASH, FRICTION, joint, settings("gap", "rad", lengths, loose), (("share", "1"),), free(1))
    jump = filtered.fine.filtered(sign, filtered.out, 1, means=True)[1][filtered.out.trimmed]
    coulomb, viscous = friction
    change = coulomb * jump + viscous * filtered.a[:, dof] + np.gradient(rigid, 1.0 / filtered.out.rate)
    late = (Setting((), {0: -change[:, None]}),)
    yield Candidate(DELAY, MODEL, joint, late, (("delay", "s"),), free(1), "early position", WHICH_IS_LATE)


def bristles(q: FloatArray, length: float) -> FloatArray:
    """Share (M,) of Coulomb friction along a path q (M,) by Dahl's law, exact on each straight step."""
    step = np.diff(q)
    sign, kept = np.sign(step), np.exp(-np.abs(step) / length)
    found = np.empty(q.size)
    state = float(sign[0])
    found[0] = state
    for i in range(step.size):
        state = sign[i] + (state - sign[i]) * kept[i]
        found[i + 1] = state
    return found


def _last(turns: FloatArray, size: int) -> IntArray:
    """The sample at which the last reversal before each was; the first sample before any."""
    marks = np.zeros(size, dtype=np.int64)
    places = np.round(turns).astype(np.int64)
    marks[places] = places
    return np.asarray(np.maximum.accumulate(marks))


@dataclass(frozen=True, slots=True)
class _Tried:
    named: Named
    gain: float
    evidence: float
    number: float
    error: float


def _try(base: Design, candidate: Candidate, nearest: IntArray, before: float = 0.0) -> _Tried | None:
    """A candidate at its best setting, as sure as the reversals agree on it.

    before : gain that the base has already.
    """
    whitened = Whitened.of(candidate, base.parts)
    score = base.score(whitened)
    if score.gain <= 0.0:
        return None
    with_it = Design(base.parts, [*base.named, score.named])
    columns = score.named.columns[0]
    own = columns[:, 0] - base.inside(columns)[:, 0]
    size = float(own @ own)
    scores = np.bincount(nearest, own * with_it.residual[: own.size])
    turns = int(np.sum(np.bincount(nearest) > 0))
    number = float(with_it.numbers[with_it.places[-1]][0])
    error = math.sqrt(float(scores @ scores) * turns / (turns - 1)) / size
    t = (number / error) ** 2 if error > 0.0 else 1e12
    chance = float(betainc((turns - 1) / 2.0, 0.5, (turns - 1) / (turns - 1 + t)))
    agreed = evidence_of_chance(math.log(max(chance, 1e-300)), whitened.looks, t)
    return _Tried(score.named, score.gain + before, min(agreed, score.evidence), number, error)


def _plausible(tried: _Tried, coulomb: float, unseen: float) -> bool:
    """Whether the size fits the name."""
    named, number = tried.named, tried.number
    least, most = HELD_LEAST.value, HELD_MOST.value
    if named.candidate.name == PRESLIDING:
        return least * coulomb < number < most * coulomb
    if named.candidate.name == BACKLASH:
        return least < number < most
    return abs(number) > unseen + 2.0 * tried.error if named.candidate.name == DELAY else number > 0.0
