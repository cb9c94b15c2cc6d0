"""Which candidates belong to the model of the whole arm: the surest first, until none is sure enough.

Every joint's guarded samples, its base and everything that may be missing are made ready of a filtered log; the search
is begun anew with each error of the model corrected whose effect is not linear in its size.
"""

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from harness.core.arrays import BoolArray, FloatArray, IntArray
from harness.core.errors import InputError
from harness.core.robot import JointLog
from harness.robot.arm import Arm
from harness.robot.whole_arm.columns import (
    CARRIED,
    DELAY,
    OF_GRAVITY,
    OF_MOTION,
    PAYLOAD,
    POWER,
    TILT,
    WITHIN_A_SAMPLE,
    ZERO,
    Candidate,
    Key,
    concave,
    convex,
    falling,
    friction_candidates,
    model_candidates,
    signs,
)
from harness.robot.whole_arm.design import Design, Named, Noise, Part, Parts, Stretches, Whitened
from harness.robot.whole_arm.differentiate import Filtered, differentiate
from harness.robot.whole_arm.perturb import tilted, with_load, with_zeros
from harness.robot.whole_arm.rules import GUARD, HELD_WITHIN, LEAST_SAMPLES, MOST, NAMED, RIVAL, SIZE, WITHIN

_EXACT = 3e-4
"""Share of a joint's rms torque to which filter and columns are exact: less is no noise of a sensor."""
_WIDER = 1.5
"""Times that a guard grows in one step."""
_WIDEST = 8
"""Steps of growth, by then fifteen times the least width."""
_SEEN = 1e-8
"""Share of the largest eigenvalue below which columns are taken for alike."""
_POSES = 50
"""Of an arm, of which its inertias are a mean."""
_SETTINGS = 3
"""Of each candidate that the noise is learnt beside."""


@dataclass(frozen=True, slots=True)
class Known:
    """What the user vouches for: the load at the end, the side of the sensor, the scale of the torque."""

    payload: bool = False
    sensor: bool = False
    gain: bool = False


@dataclass(frozen=True, slots=True)
class Problem:
    """filtered : the log, of the joints that move enough. parts : one a joint. guard (k,) : s. rigid, gravity (m, k) :
    torque of the model and of gravity alone, N m. noise (k,) : N m, of the torque beyond the model's. candidates :
    everything that may be missing.
    """

    filtered: Filtered
    parts: Parts
    guard: tuple[float, ...]
    rigid: FloatArray
    gravity: FloatArray
    noise: FloatArray
    candidates: tuple[Candidate, ...]


def prepare(filtered: Filtered, arm: Arm, known: Known) -> Problem:
    """The problem of a filtered log whose joints all move."""
    moving = arm.inverse(*filtered.wide)[:, filtered.dof]
    rigid = filtered.column(moving)
    gravity, weight = (
        arm.inverse(q, np.zeros_like(q), np.zeros_like(q))[:, filtered.dof] for q in (filtered.q_fine, filtered.q)
    )
    parts, guards, candidates = {}, [], list[Candidate]()
    for j, dof in enumerate(filtered.dof):
        torque, v = filtered.torque[:, j] - rigid[:, j], filtered.v[:, dof]
        sign = filtered.column(signs(filtered.v_fine[:, dof]), jumps=True)
        base = np.stack((sign, v, np.ones_like(sign)), axis=1)
        floor = _EXACT * float(np.sqrt(np.mean(filtered.torque[:, j] ** 2)))
        width, kept, numbers, noise = _guarded(filtered, j, torque, base, floor)
        guards.append(width)
        v_fine = filtered.v_fine[:, dof]
        carried = moving[:, j] + np.column_stack((signs(v_fine), v_fine)) @ numbers[:2]
        loads = {OF_GRAVITY: gravity[:, j], OF_MOTION: moving[:, j], CARRIED: carried}
        candidates += friction_candidates(filtered, j, loads, kept)
        # What viscous friction does that acts some time after the rest of the torque. Within one sample a log tells no
        # order of what happened: a controller holds its torque, an integrator takes friction from the speed at the end
        # of its step. Left out, this is an inertia of viscous friction times that time.
        base = np.column_stack((base, float(numbers[1]) * filtered.a[:, dof]))
        spread = np.array([np.inf, np.inf, np.inf, 1.0 / filtered.band.rate])
        parts[j] = Part(torque, base, spread, Stretches.of(kept), noise, floor)
    candidates += model_candidates(filtered, arm, known.payload, known.sensor, known.gain)
    learnt = {j: _beside_everything(part, j, candidates) for j, part in parts.items()}
    return Problem(filtered, learnt, tuple(guards), rigid, weight, _noise(filtered, arm), tuple(candidates))


def _noise(filtered: Filtered, arm: Arm) -> FloatArray:
    """Standard deviation (k,) that noise gives a joint's torque beyond the model's, N m: that of the torque itself, and
    what the arm's inertias make of that of all positions.
    """
    poses = filtered.q[:: max(len(filtered.q) // _POSES, 1)]
    still = np.zeros_like(poses)
    weight = arm.inverse(poses, still, still)
    turned = (arm.inverse(poses, still, still + one) - weight for one in np.eye(len(arm.joints)))
    inertia = np.stack([np.mean(one[:, filtered.dof] ** 2, axis=0) for one in turned], axis=1)
    return np.sqrt(np.square(filtered.torque_noise) + inertia @ filtered.acceleration_noise**2)


_Guard = tuple[float, BoolArray, FloatArray, Noise]
"""Width, s, of a guard, samples (m,) outside of it, numbers of a fit to them and the noise of what it leaves."""


def _guarded(filtered: Filtered, joint: int, torque: FloatArray, base: FloatArray, floor: float) -> _Guard:
    """Width, s, and samples of the guard that stands when Coulomb friction moves by less than its error.

    With them Coulomb, viscous friction and offset by plain least squares, and the noise of what is left. Beside a bend
    with speed that the narrowest guard shows as surely as a name asks it may as well stand: that moves Coulomb friction
    all the way, and a guard that grew for it would leave none of the samples that tell it.
    """

    def plain(width: float, columns: FloatArray) -> _Guard:
        kept = filtered.away(joint, width)
        numbers = np.linalg.lstsq(columns[kept], torque[kept], rcond=None)[0]
        noise = Noise.learnt(torque - columns @ numbers, Stretches.of(kept), columns.shape[1], floor)
        return width, kept, np.asarray(numbers, dtype=np.float64), noise

    def steady(one: _Guard, wider: _Guard, columns: FloatArray) -> bool:
        white = wider[3].whitening(Stretches.of(wider[1])).of(columns)
        return bool(abs(wider[2][0] - one[2][0]) < np.sqrt(np.linalg.pinv(white.T @ white)[0, 0]))

    found = [plain(GUARD.value / filtered.band.lowpass, base)]
    part = Part(torque, base, np.full(base.shape[1], np.inf), Stretches.of(found[0][1]), found[0][3], floor)
    tried = [base]
    if (bent := _bent(filtered, joint, part)) is not None:
        tried.append(np.column_stack((base, bent)))
        found.append(plain(found[0][0], tried[1]))
    for _ in range(_WIDEST):
        width, kept = found[0][0] * _WIDER, found[0][1]
        if np.sum(filtered.away(joint, width)) < max(LEAST_SAMPLES.value, 0.5 * np.sum(kept)):
            break
        wider = [plain(width, columns) for columns in tried]
        if any(map(steady, found, wider, tried)):
            break
        found = wider
    return found[-1]


def _bent(filtered: Filtered, joint: int, part: Part) -> FloatArray | None:
    """Column (m, 1) of the bend with speed that guarded samples surely show, None where they show none."""
    parts, laws = {joint: part}, [concave(filtered, joint), convex(filtered, joint)]
    if (fall := falling(filtered, joint, part.stretches.kept)) is not None:
        laws += fall, *fall.forms
    plain = Design(parts, ())
    surest = max((plain.score(Whitened.of(law, parts)) for law in laws), key=lambda one: one.gain)
    if surest.evidence < NAMED.value:
        return None
    (best,), _ = settled(parts, [surest])
    return best.torque[joint][:, :1]


def _beside_everything(part: Part, joint: int, candidates: list[Candidate]) -> Part:
    """A part whose noise is learnt from what all candidates together leave of its torque."""
    kept = part.stretches.kept
    columns = [part.base]
    # what other zeros change is as good as what a load, masses and a tilt do, and what a power of the speed does is as
    # good as what viscous friction, its fall and a drag do
    asked = (one for one in candidates if one.joint in (joint, None) and one.name not in (ZERO, POWER))
    for candidate in asked:
        count = len(candidate.values)
        places = np.unique(np.linspace(0, count - 1, min(count, _SETTINGS)).round().astype(int))
        columns += [candidate.torque(candidate.values[i])[joint] for i in places]
    everything = np.hstack(columns)
    size = np.sqrt(np.mean(everything[kept] ** 2, axis=0))
    everything = everything[:, size > 0.0] / size[size > 0.0]
    power, turn = np.linalg.eigh(everything[kept].T @ everything[kept])
    seen = power > _SEEN * power[-1]
    u = everything[kept] @ (turn[:, seen] / np.sqrt(power[seen]))
    left = np.zeros(kept.size)
    left[kept] = part.torque[kept] - u @ (u.T @ part.torque[kept])
    return replace(part, noise=Noise.learnt(left, part.stretches, u.shape[1], part.floor))


BLOCK = 1.0
"""s: longer than the memory of the noise, shorter than a period of the motion."""
FOLDS = 5
"""Every fifth block is left out at a time."""


def _without(design: Design, t: FloatArray) -> Iterator[tuple[IntArray, IntArray, FloatArray]]:
    """By fold of blocks: which each sample (m,) is in less this one, its whitened rows, and the numbers fitted to all
    others; t (m,) : of all samples, s.
    """
    of = np.asarray(((t - t[0]) // BLOCK).astype(np.int64) % FOLDS)
    fold = np.concatenate([of[part.stretches.kept] for part in design.parts.values()])
    scale = np.sqrt(np.sum(design.matrix**2, axis=0))
    scale[scale == 0.0] = 1.0
    scaled = design.matrix / scale
    normal, pull = scaled.T @ scaled, scaled.T @ design.y
    for one in range(FOLDS):
        out = np.flatnonzero(fold == one)
        part = scaled[out]
        numbers = np.linalg.pinv(normal - part.T @ part, rcond=1e-12, hermitian=True) @ (pull - part.T @ design.y[out])
        yield of - one, out, numbers / scale


def held_out(design: Design, t: FloatArray) -> float:
    """Sum of squares of whitened samples that were held out, fold by fold."""
    return sum(
        float(np.sum((design.y[out] - design.matrix[out] @ numbers) ** 2)) for _, out, numbers in _without(design, t)
    )


def rms(design: Design, t: FloatArray) -> FloatArray:
    """Root mean square (k,) of the held-out error of each joint's torque, guarded, N m or N."""
    squares = np.zeros(len(design.parts))
    for fold, _, numbers in _without(design, t):
        for j, part in design.parts.items():
            squares[j] += float(np.sum(design.left(j, numbers)[part.stretches.kept & (fold == 0)] ** 2))
    return np.sqrt(squares / [np.sum(part.stretches.kept) for part in design.parts.values()])


CORRECTED = (PAYLOAD, DELAY, TILT, ZERO)
"""Errors of the model whose effect is not linear in their size."""
_POLISHINGS, _STEADY = 20, 1e-4
"""Steps at most of what is not linear, and the share of a value below which a step is the last."""
_ROUNDS = 8
"""Of searching and correcting, at most."""


@dataclass(frozen=True, slots=True)
class Model:
    """design : solved with what was chosen, in its order, the noise learnt from what it leaves.

    left_out : evidence of the best candidate that was not chosen. alone : of every candidate that was not refused,
    beside nothing but what was corrected. again : the last one chosen has to be corrected, and the search begun anew.
    """

    design: Design
    left_out: float = 0.0
    alone: Mapping[Key, float] = field(default_factory=dict)
    again: bool = False

    def of_joint(self, joint: int) -> tuple[Named, ...]:
        """Effects of one joint's friction."""
        return _of_joint(self.design.named, joint)


def _of_joint(chosen: Sequence[Named], joint: int | None) -> tuple[Named, ...]:
    return tuple(one for one in chosen if one.candidate.joint == joint and one.candidate.of_friction)


def _search(problem: Problem, candidates: Sequence[Candidate], forced: Sequence[Named]) -> Model:
    """The model of the whole arm; the parts hold the noise learnt beside everything.

    forced : errors of the model that were found and corrected, whose rest is fitted along. The search ends early where
    it names another that has to be corrected first.
    """
    parts, t = problem.parts, problem.filtered.t
    whitened = {candidate.key: Whitened.of(candidate, parts) for candidate in candidates}
    chosen = [replace(one, whitened=whitened[one.candidate.key]) for one in forced]
    if not any(one.candidate.key == _SHARED_DELAY for one in chosen):
        chosen.insert(0, Named(Whitened.of(_within_a_sample(problem), parts)))
    always, design = len(chosen), Design(parts, chosen)
    refused: set[Key] = set()
    best: Named | None = None
    while True:
        taken = {one.candidate.key for one in chosen} | refused
        asked = [w for key, w in whitened.items() if key not in taken and not _full(chosen, w.candidate)]
        if not asked:
            break
        scores = [_without_its_part(design, w.candidate).score(w) for w in asked]
        best = max(scores, key=lambda s: s.evidence)
        if best.evidence < NAMED.value:
            break
        others = _without_its_part(design, best.candidate)
        named, trial = polished(parts, others.named, best)
        before, after = (held_out(one, t) for one in (others, trial))
        told = _sized(trial) and all(_shaped(trial)) and _within_reach(trial)
        if after >= before or not told or _driving(trial) > _driving(design):
            refused.add(best.candidate.key)
            continue
        design = trial
        chosen = [*named[:-1], replace(named[-1], rivals=_rivals(best, scores, design))]
        design.named = tuple(chosen)
        if chosen[-1].candidate.name in CORRECTED:
            return Model(design, again=True)
    model = _pruned(parts, chosen, always, best)
    return replace(model, alone=_alone(model, always, [one for one in candidates if one.key not in refused]))


_SHARED_DELAY = DELAY, None


def _within_a_sample(problem: Problem) -> Candidate:
    """What every model has: a delay of all torques by some part of a sample, of which no log is free.

    Too small to be named it shifts viscous friction by many of its errors.
    """
    (delay,) = (one for one in problem.candidates if one.key == _SHARED_DELAY)
    return replace(delay, name=WITHIN_A_SAMPLE, spread=np.array([WITHIN.value / problem.filtered.band.rate]))


def _without_its_part(design: Design, candidate: Candidate) -> Design:
    """The model to which a candidate is added: a delay takes the place of that within a sample."""
    if candidate.key != _SHARED_DELAY:
        return design
    return Design(design.parts, [one for one in design.named if one.candidate.name != WITHIN_A_SAMPLE])


def _full(chosen: Sequence[Named], candidate: Candidate) -> bool:
    """Whether there are as many names as a joint, or the model, may have."""
    if candidate.of_friction:
        return len(_of_joint(chosen, candidate.joint)) >= MOST.value
    names = {one.candidate.name for one in chosen if not one.candidate.of_friction}
    return len(names) >= MOST.value and candidate.name not in names


def _sized(design: Design) -> bool:
    """Whether the numbers of every candidate are of a size that its name can have; a later one may make one grow."""
    return all(
        bool(np.all(np.abs(design.numbers[place]) <= SIZE.value * one.candidate.spread))
        and (not one.candidate.positive or float(design.numbers[place][0]) > 0.0)
        for one, place in zip(design.named, design.places, strict=True)
        if one.candidate.name != WITHIN_A_SAMPLE
    )


def _shaped(design: Design) -> list[bool]:
    """Of each that was named whether it has a shape: at the least speed, wave or exponent that is tried, this by two
    errors of it, or else its size and the joint's Coulomb friction beside it.

    The least wave is a slope, and the least power of the speed Coulomb friction, which loses its number to it.
    """
    errors = np.sqrt(np.diag(design.covariance()))
    sure = np.abs(design.numbers) > 2.0 * errors

    def told(one: Named, at: slice) -> bool:
        if one.candidate.among is None or one.candidate.joint is None:
            return True
        shape, coulomb = at.stop - 1, design.base[one.candidate.joint].start
        stays = bool(sure[coulomb]) and float(design.numbers[coulomb]) > 0.0
        inside = one.value > one.candidate.among.values[0] * (1.0 + _STEADY)
        known = 2.0 * float(errors[shape]) < one.value
        return inside or known or (stays and bool(np.any(sure[at.start : shape])))

    return [told(one, at) for one, at in zip(design.named, design.places, strict=True)]


def _within_reach(design: Design) -> bool:
    """Whether a load that was named last may hang where its moments say, within their errors."""
    if not design.named[-1].candidate.bodies:
        return True
    at = design.places[-1]
    errors = np.sqrt(np.diag(design.covariance())[at])
    least = float(np.linalg.norm(np.maximum(np.abs(design.numbers[at]) - 2.0 * errors, 0.0)[1:]))
    return least <= HELD_WITHIN.value * (abs(float(design.numbers[at][0])) + 2.0 * float(errors[0]))


def _driving(design: Design) -> int:
    """How many joints have Coulomb or viscous friction that is surely negative, and would drive."""
    errors = np.sqrt(np.diag(design.covariance()))
    return sum(int(np.any(design.numbers[at][:2] < -2.0 * errors[at][:2])) for at in design.base.values())


def polished(parts: Parts, others: Sequence[Named], named: Named) -> tuple[list[Named], Design]:
    """What is in a model and a further candidate, all brought to their best values, and the model that has them.

    A law has its own form unless another is surely better, or would drive in it. Viscous friction beside it, a number
    more, has to be as sure.
    """
    forms, beside = named.candidate.forms, Design(parts, others)
    found, drive = settled(parts, [*others, named]), _driving(beside)
    least = math.inf if forms and _driving(found[1]) > drive else _squares(found)
    for form in forms:
        one = beside.score(Whitened.of(form, parts))
        many = replace(one.whitened, looks=one.whitened.looks * (1 + len(forms)))
        tried = settled(parts, [*others, replace(one, whitened=many, evidence=named.evidence)])
        worth = _squares(tried) + (-RIVAL.value if form.viscous else RIVAL.value)
        if worth < least and _driving(tried[1]) <= drive:
            found, least = tried, worth
    return found


def _squares(fitted: tuple[list[Named], Design]) -> float:
    return float(fitted[1].residual @ fitted[1].residual)


def settled(parts: Parts, named: Sequence[Named]) -> tuple[list[Named], Design]:
    """What is not linear in each of a model's candidates brought to its best value beside the others, and the model.

    Each law changes where the others are at their best, and so does what is known of the noise: a value that was best
    when its law was chosen would stand, with errors that know nothing of it.
    """
    found, design = list(named), Design(parts, named)
    for _ in range(_POLISHINGS):
        moved = [_moved(parts, one, design.numbers[at]) for one, at in zip(found, design.places, strict=True)]
        steady = all(
            abs(new.value - old.value) <= _STEADY * abs(old.value) for new, old in zip(moved, found, strict=True)
        )
        if steady and all(new is old or old.candidate.among for new, old in zip(moved, found, strict=True)):
            break
        found, design = moved, Design(parts, moved)
    return found, design


def _moved(parts: Parts, one: Named, numbers: FloatArray) -> Named:
    """What was named a step further, to where its numbers say; itself where it has no value that goes smoothly."""
    candidate = one.candidate
    if candidate.what is None or not candidate.smooth:
        return one
    count = (candidate.among or candidate).spread.size
    value = candidate.stepped(one.value, float(numbers[count])) if candidate.among else one.value
    around = candidate.around(value, numbers[:count], one.whitened.looks)
    return replace(one, whitened=Whitened.of(around, parts), setting=0)


def _rivals(best: Named, scores: Sequence[Named], after: Design) -> dict[Key, float]:
    """Others that were nearly as sure and are not any more once the best is in, with by how much less."""
    near = [s for s in scores if s is not best and s.evidence > best.evidence - RIVAL.value]
    one = best.candidate
    near = [s for s in near if s.candidate.joint in (one.joint, None) or one.joint is None]
    # all motors are no rival of one
    near = [s for s in near if s.candidate.name != one.name or s.candidate.joint is not None]
    found = [s for s in near if _without_its_part(after, s.candidate).score(s.whitened).evidence < NAMED.value]
    return {s.candidate.key: best.evidence - s.evidence for s in sorted(found, key=lambda s: -s.evidence)}


def _alone(model: Model, forced: int, candidates: Sequence[Candidate]) -> dict[Key, float]:
    """Evidence of each candidate beside what is ``forced`` alone, held against the noise that the model leaves."""
    parts = model.design.parts
    plain = Design(parts, model.design.named[:forced])
    asked = [one for one in candidates if one.key not in {named.candidate.key for named in plain.named}]
    return {one.key: _without_its_part(plain, one).score(Whitened.of(one, parts)).evidence for one in asked}


def _pruned(parts: Parts, chosen: Sequence[Named], forced: int, left_out: Named | None) -> Model:
    """Without what is not sure any more beside what was chosen after it; the noise learnt anew."""
    kept = list(chosen)
    design = Design(parts, kept)
    while True:
        # the second time the weights are those of the noise itself
        for _ in range(2):
            parts = {j: replace(part, noise=_learnt(design, j)) for j, part in design.parts.items()}
            kept, design = settled(parts, [replace(one, whitened=Whitened.of(one.candidate, parts)) for one in kept])
        sure = []
        for i, (one, shaped) in enumerate(zip(kept, _shaped(design), strict=True)):
            others = Design(parts, [*kept[:i], *kept[i + 1 :]])
            sure.append(others.score(one.whitened).evidence if shaped else 0.0)
        kept[forced:] = [replace(one, evidence=value) for one, value in zip(kept[forced:], sure[forced:], strict=True)]
        design.named = tuple(kept)
        if not sure[forced:] or min(sure[forced:]) >= NAMED.value:
            break
        del kept[forced + int(np.argmin(sure[forced:]))]
        kept, design = settled(parts, kept)
    if left_out is None or left_out.candidate.key in {one.candidate.key for one in kept}:
        return Model(design)
    beside = _without_its_part(design, left_out.candidate)
    return Model(design, beside.score(Whitened.of(left_out.candidate, parts)).evidence)


def _learnt(design: Design, joint: int) -> Noise:
    """Noise of what a model leaves of a joint."""
    part = design.parts[joint]
    count = part.spread.size + sum(
        one.candidate.spread.size for one in design.named if one.candidate.joint in (joint, None)
    )
    return Noise.learnt(design.left(joint), part.stretches, count, part.floor)


@dataclass(frozen=True, slots=True)
class Solved:
    """model : what was chosen. problem : with every correction. first : the problem without any.

    arm : as corrected. corrected : by name, the sum of what was corrected, in the candidate's numbers. still : joints
    that hardly move.
    """

    model: Model
    problem: Problem
    first: Problem
    arm: Arm
    corrected: dict[str, FloatArray]
    still: tuple[str, ...]

    def total(self, named: Named) -> FloatArray:
        """Numbers of what was named: what was fitted, and what was corrected before."""
        numbers = self.model.design.numbers[self.model.design.place(named)]
        return np.asarray(self.corrected.get(named.candidate.name, np.zeros(numbers.size)) + numbers)


def solve(log: JointLog, arm: Arm, joints: Sequence[str] | None, lowpass: float | None, known: Known) -> Solved:
    """Search, correct, and search again, until nothing is to be corrected.

    Raises InputError where no joint moves enough.
    """
    applied, now = dict[str, FloatArray](), arm
    everything = differentiate(log, arm, joints, lowpass)
    going = everything.moving
    if not going:
        raise InputError(log.file, "no joint that moves to and fro", "a log in which joints move both ways")
    still = tuple(name for j, name in enumerate(everything.joints) if j not in going)
    names = [everything.joints[j] for j in going]
    first = problem = prepare(differentiate(log, arm, names, everything.band.lowpass), arm, known)
    model = _search(problem, problem.candidates, ())
    steady = 0
    for _ in range(_ROUNDS):
        forced = [one for one in model.design.named if one.candidate.name in CORRECTED]
        if not model.again and (steady or not forced):
            break
        # what is left of a correction is taken up once more, by itself: it is no other error beside
        steady = 0 if model.again else steady + 1
        for one in forced:
            numbers = model.design.numbers[model.design.place(one)]
            applied[one.candidate.name] = applied.get(one.candidate.name, np.zeros(numbers.size)) + numbers
        now, late = _corrected(arm, applied, forced)
        problem = prepare(differentiate(log, now, names, everything.band.lowpass, late), now, known)
        keys = {one.candidate.key for one in forced}
        model = _search(problem, [one for one in problem.candidates if steady or one.key in keys], forced)
    return Solved(model, problem, first, now, applied, still)


def _corrected(arm: Arm, applied: dict[str, FloatArray], forced: Sequence[Named]) -> tuple[Arm, float]:
    """The arm with what was found, and the delay, s."""
    for one in forced:
        if one.candidate.name == ZERO:
            shift = np.zeros(len(arm.joints))
            shift[[arm.index(name) for name, _ in one.candidate.numbers]] = applied[ZERO]
            arm = with_zeros(arm, shift)
        if one.candidate.name == PAYLOAD and (load := applied[PAYLOAD])[0] > 0.0:
            arm = with_load(arm, float(load[0]), load[1:] / float(load[0]), one.candidate.bodies[one.setting])
    if (turn := applied.get(TILT)) is not None:
        arm = tilted(tilted(arm, float(turn[0]), 0), float(turn[1]), 1)
    late = applied.get(DELAY)
    return arm, 0.0 if late is None else float(late[0])
