"""What happens at reversals, which the guard leaves out: presliding, static friction, backlash, a late torque.

Each is a torque along the motion, sent through the filter of the torque and compared with all samples. How sure it is
comes from how the reversals agree with each other: what is common to a reversal's neighbourhood is one observation.
"""

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from itertools import accumulate

import numpy as np
from scipy.special import betainc

from harness.core.arrays import BoolArray, FloatArray, IntArray
from harness.model.terms import backlash, presliding, static_friction
from harness.robot.whole_arm.columns import DELAY, STRIBECK, Candidate, fall_with_speed, of_friction, signs
from harness.robot.whole_arm.design import Design, Named, Stretches, Whitened, evidence_of_chance
from harness.robot.whole_arm.differentiate import Filtered, reversals
from harness.robot.whole_arm.rules import (
    ENOUGH_TURNS,
    FOOT,
    GUARD,
    HELD_LEAST,
    HELD_MOST,
    LONGEST_SLIP,
    MAIN,
    NAMED,
    RIVAL,
    STICKS,
)
from harness.robot.whole_arm.search import Solved, polished

PRESLIDING, STATIC, BACKLASH = presliding.TERM.name, static_friction.TERM.name, backlash.TERM.name
AT_REVERSALS = PRESLIDING, STATIC, BACKLASH, DELAY
"""What may be named there."""
AT_REST, _WHILE = "friction-at-rest", 0.3
"""What is allowed for beside them, and 1/f_lowpass within which the filter does not show how that changes."""
_LENGTHS = 12
"""Lengths, and speeds, that are tried."""


@dataclass(frozen=True, slots=True)
class Turned:
    """named : at the reversals of a joint. numbers, errors : what was found, in the candidate's order. share : of what
    the base leaves beyond the noise. of_stribeck : it is the foot of a fall with speed that the guarded samples saw the
    top of, and replaces it.
    """

    named: Named
    numbers: FloatArray
    errors: FloatArray
    share: float
    of_stribeck: bool = False


def at_reversals(solved: Solved, joint: int) -> Turned | None:
    """What is named at the reversals of a joint, at most one thing.

    A fall with speed is static friction where the reversals tell that and guarded samples see its foot alone.
    """
    filtered, design = solved.problem.filtered, solved.model.design
    falling = [one for one in solved.model.of_joint(joint) if one.candidate.name == STRIBECK]
    seen = np.quantile(np.abs(filtered.v[design.parts[joint].stretches.kept, filtered.dof[joint]]), FOOT.value)
    # of a Gaussian, which has fallen by most at its speed; another form's tail they saw
    if falling and not falling[0].candidate.form and falling[0].value < float(seen):
        instead = _turned(solved, joint, without=STRIBECK)
        if instead and instead.named.candidate.name == STATIC:
            return replace(instead, of_stribeck=True)
    found = _turned(solved, joint)
    return None if falling and found and found.named.candidate.name == STATIC else found


def _turned(solved: Solved, joint: int, without: str = "") -> Turned | None:
    """What is named at the reversals of a joint beside what is named of it, ``without`` a name."""
    filtered, design = solved.problem.filtered, solved.model.design
    part, rigid = design.parts[joint], solved.problem.rigid[:, joint]
    v = filtered.v_fine[:, filtered.dof[joint]]
    turns, rests = reversals(v, filtered.sure_speed(joint)), _rests(filtered, joint)
    reach, times = GUARD.value / filtered.band.lowpass, filtered.t_fine[0] + turns / filtered.fine.rate
    free = filtered.good & _clear(filtered.t, rests, reach)
    at = _Turns(np.searchsorted((times[1:] + times[:-1]) / 2.0, filtered.t)[free], _clear(times, rests, reach))
    if np.unique(at.nearest).size < ENOUGH_TURNS.value:
        return None
    # without what errors of the model that several joints share take of it
    own = part.torque - design.said(joint, lambda candidate: candidate.joint is None)
    parts = {joint: replace(part, torque=own, stretches=Stretches.of(free))}
    local = [
        replace(one, whitened=Whitened.of(one.candidate, parts))
        for one in design.named
        if one.candidate.joint == joint and one.candidate.name != without
    ]
    coulomb, viscous, *_ = design.numbers[design.base[joint]].tolist()
    if rests.size:
        local.append(Named(Whitened.of(_at_rest(filtered, joint, rests, abs(coulomb)), parts)))
    late = _late(filtered, joint, abs(coulomb), viscous, rigid)
    # how friction changes within a rest too short to be seen is not known, and looks like a time
    unseen = 0.5 * STICKS.value / filtered.band.lowpass
    timing = Named(Whitened.of(replace(late, spread=np.array([unseen])), parts))
    plain, held = Design(parts, local), [*local, timing]
    base, moved = Design(parts, held), plain.score(timing.whitened).gain
    tried = [_tried(base, shape, at, moved) for shape in _shapes(filtered, joint, turns, rigid)]
    tried.append(_tried(plain, late, at))
    found = sorted((one for one in tried if one is not None and _plausible(one, unseen)), key=lambda one: -one.gain)
    if not found or found[0].named.evidence < NAMED.value:
        return None
    first, *others = found
    best = replace(
        first.named,
        rivals={
            one.named.candidate.key: first.gain - one.gain for one in others if one.gain > first.gain - RIVAL.value
        },
    )
    if best.candidate.name == DELAY:
        held, base = local, plain
    (*_, named), fitted = polished(parts, held, best)
    errors = np.sqrt(np.diag(fitted.covariance()))[fitted.places[-1]]
    errors[0] = max(errors[0], first.error)
    # what a reversal's own rest makes is no presliding
    if named.candidate.name == PRESLIDING and named.value < _within(filtered, joint) + 2.0 * float(errors[-1]):
        return None
    # at rest friction is no law's: what only reversals with a rest show has to say that as well
    turning = (free if first.slid >= NAMED.value else filtered.good) & ~part.stretches.kept
    squares = [float(np.sum(one.left(joint)[turning] ** 2)) for one in (base, fitted)]
    floor = float(np.sum(turning)) * float(solved.problem.noise[joint]) ** 2
    share = float(np.clip((squares[0] - squares[1]) / max(squares[0] - floor, 1e-300), 0.0, 1.0))
    # what happens as a joint comes to rest, or begins, is many things, of which a law takes some
    if share <= MAIN.value:
        return None
    return Turned(named, fitted.numbers[fitted.places[-1]], errors, share)


def _clear(t: FloatArray, rests: FloatArray, reach: float) -> BoolArray:
    """Which times (n,) no rest comes as near to as ``reach``, s."""
    found = np.ones(t.size, dtype=np.bool_)
    for first, last in rests:
        found &= (t <= first - reach) | (t >= last + reach)
    return found


def _rests(filtered: Filtered, joint: int) -> FloatArray:
    """From when to when (r, 2), s, a joint rests.

    At rest friction is whatever holds the joint, and says nothing of the law by which it slides. One that creeps, as in
    engines, rests too: it is slow for half longer than a reversal's acceleration takes through such speeds.
    """
    slowest = filtered.sure_speed(joint)
    turning = float(np.quantile(np.abs(filtered.a[:, filtered.dof[joint]]), 0.75))
    slow = np.pad(np.abs(filtered.v_fine[:, filtered.dof[joint]]) < slowest, 1).astype(np.int8)
    spans = filtered.t_fine[np.minimum(np.flatnonzero(np.diff(slow)), filtered.t_fine.size - 1)].reshape(-1, 2)
    longest = max(STICKS.value / filtered.band.lowpass, 1.5 * 2.0 * slowest / max(turning, 1e-12))
    return np.vstack((filtered.rests[joint], spans[spans[:, 1] - spans[:, 0] > longest]))


def _at_rest(filtered: Filtered, joint: int, rests: FloatArray, coulomb: float) -> Candidate:
    """Friction at rest, of no law and about as large as when a joint slides, as far as the filter spreads it."""
    resting = np.any([(filtered.t_fine >= first) & (filtered.t_fine <= last) for first, last in rests], axis=0)
    rows = np.flatnonzero(resting)
    whiles = max(round(_WHILE / filtered.band.lowpass * filtered.fine.rate), 1)
    begun = np.flatnonzero(np.diff(resting.astype(np.int8), prepend=0) == 1)
    since = rows - begun[np.searchsorted(begun, rows, "right") - 1]
    which = np.cumsum(since % whiles == 0) - 1
    fine = np.zeros((resting.size, int(which[-1]) + 1))
    fine[rows, which] = 1.0
    numbers = tuple((f"at rest {i}", "N m") for i in range(fine.shape[1]))
    found = of_friction(AT_REST, joint, numbers, filtered.column(fine, jumps=True))
    return replace(found, spread=np.full(fine.shape[1], coulomb))


def _within(filtered: Filtered, joint: int) -> float:
    """How far, rad, a joint goes of its own reversal in the time in which nothing of it is seen (rule sticks)."""
    turning = float(np.median(np.abs(filtered.a[:, filtered.dof[joint]])))
    return 0.5 * turning * (STICKS.value / filtered.band.lowpass) ** 2


def _shapes(filtered: Filtered, joint: int, turns: FloatArray, rigid: FloatArray) -> Iterator[Candidate]:
    """Laws of friction that show at reversals."""
    dof = filtered.dof[joint]
    q, v = filtered.q_fine[:, dof], filtered.v_fine[:, dof]
    sliding = filtered.column(signs(v), jumps=True)
    quantum, turning = filtered.position_step[joint], float(np.median(np.abs(filtered.a[:, dof])))
    least = max(4.0 * quantum, 1e-4 * np.ptp(q), _within(filtered, joint))
    lengths = np.geomspace(least, max(LONGEST_SLIP.value * np.ptp(q), 2.0 * least), _LENGTHS)

    def held(length: float) -> FloatArray:
        return (filtered.column(bristles(q, length)) - sliding)[:, None]

    yield of_friction(PRESLIDING, joint, (("held", "N m"),), held, ("length", "rad"), lengths)
    # within one step of the encoder a reversal has no speed of its own, and within one sample no shape
    least = max(2.0 * math.sqrt(2.0 * turning * quantum), 3.0 * turning / filtered.fine.rate)
    fastest = max(float(np.quantile(np.abs(v), 0.15)), 2.0 * least)
    speeds = np.geomspace(least, fastest, _LENGTHS)
    yield fall_with_speed(STATIC, filtered, joint, speeds, (least, float(np.max(np.abs(v)))))
    load, marks = np.interp(filtered.t_fine, filtered.t, rigid), np.zeros(q.size, dtype=np.int64)
    # the sample of the last reversal before each, the first one before any
    places = np.round(turns).astype(np.int64)
    marks[places] = places
    since = np.abs(q - q[np.maximum.accumulate(marks)])

    def loose(gap: float) -> FloatArray:
        return filtered.column(-load * (since < gap), jumps=True)[:, None]

    yield of_friction(BACKLASH, joint, (("share", "1"),), loose, ("gap", "rad"), lengths, smooth=False)


def _late(filtered: Filtered, joint: int, coulomb: float, viscous: float, rigid: FloatArray) -> Candidate:
    """The torque of one joint that is late."""
    dof = filtered.dof[joint]
    jump = filtered.fine.filtered(signs(filtered.v_fine[:, dof]), filtered.out, 1, means=True)[1][filtered.out.trimmed]
    change = coulomb * jump + viscous * filtered.a[:, dof] + np.gradient(rigid, 1.0 / filtered.out.rate)
    return of_friction(DELAY, joint, (("delay", "s"),), -change[:, None])


def bristles(q: FloatArray, length: float) -> FloatArray:
    """Share (M,) of Coulomb friction along a path q (M,) by Dahl's law, exact on each straight step."""
    step = np.diff(q)
    sign, kept = np.sign(step), np.exp(-np.abs(step) / length)
    # of plain numbers: those of an array are made one by one
    steps = zip(sign.tolist(), kept.tolist(), strict=True)
    return np.array(list(accumulate(steps, lambda state, s: s[0] + (state - s[0]) * s[1], initial=float(sign[0]))))


@dataclass(frozen=True, slots=True)
class _Turns:
    """nearest (n,) : reversal of each sample that counts. sliding (r,) : reversals at which the joint does not rest."""

    nearest: IntArray
    sliding: BoolArray

    def agreed(
        self, number: float, own: FloatArray, left: FloatArray, looks: float, slid: bool = False
    ) -> tuple[float, float]:
        """How sure all reversals that count are of a number, or those that ``slid``, and its error.

        own (n,) : its column beyond those of the model. left (n,) : what the model leaves with it.
        """
        counted = (self.sliding | (not slid)) & (np.bincount(self.nearest, minlength=self.sliding.size) > 0)
        many = int(np.sum(counted))
        if many < ENOUGH_TURNS.value:
            return 0.0, math.inf
        pulls, sizes = (np.bincount(self.nearest, own * by, self.sliding.size)[counted] for by in (left, own))
        more, size = float(np.sum(pulls) / np.sum(sizes)), float(np.sum(sizes))
        swing = pulls - more * sizes
        error = math.sqrt(float(swing @ swing) * many / (many - 1)) / size
        t = ((number + more) / error) ** 2 if error > 0.0 else 1e12
        chance = float(betainc((many - 1) / 2.0, 0.5, (many - 1) / (many - 1 + t)))
        return evidence_of_chance(math.log(max(chance, 1e-300)), looks, t), error


@dataclass(frozen=True, slots=True)
class _Tried:
    """A candidate at its best setting, as sure as the reversals agree on it, its number and the error of that.

    slid : as sure as those agree alone through which the joint slides. coulomb : friction beside it.
    """

    named: Named
    slid: float
    number: float
    error: float
    coulomb: float

    @property
    def gain(self) -> float:
        """What a fit gains by it and what the base has."""
        return self.named.gain


def _tried(base: Design, candidate: Candidate, turns: _Turns, before: float = 0.0) -> _Tried | None:
    """A candidate beside a base; None where it gains nothing. before : gain that the base has already."""
    score = base.score(Whitened.of(candidate, base.parts))
    if score.gain <= 0.0:
        return None
    with_it = Design(base.parts, [*base.named, score])
    ((_, columns),) = score.columns.items()
    own = base.beyond(columns)[:, 0]
    coulomb = abs(float(with_it.numbers[next(iter(with_it.base.values()))][0]))
    number = float(with_it.numbers[with_it.places[-1]][0])
    told = number, own, with_it.residual[: own.size], score.whitened.looks
    (sure, error), (slid, _) = turns.agreed(*told), turns.agreed(*told, slid=True)
    named = replace(score, gain=score.gain + before, evidence=min(sure, score.evidence))
    return _Tried(named, min(slid, score.evidence), number, error, coulomb)


def _plausible(tried: _Tried, unseen: float) -> bool:
    """Whether the size fits the name."""
    name, number = tried.named.candidate.name, tried.number
    if name == DELAY:
        return abs(number) > unseen + 2.0 * tried.error
    usual = {PRESLIDING: tried.coulomb, BACKLASH: 1.0}.get(name)
    return number > 0.0 if usual is None else HELD_LEAST.value * usual < number < HELD_MOST.value * usual
