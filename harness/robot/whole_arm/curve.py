"""Friction curves of an arm's joints: every joint's torque fitted with splines over its speed in place of laws of it.

What else was named stays beside them, taken about its mean, so that a curve is friction at the mean position and load
of the log. All inertial numbers of all bodies may go along, each expected near the model's, where torque that was not
fitted is then predicted better.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from harness.core.arrays import FloatArray, IntArray
from harness.core.quantity import Quantity
from harness.robot.arm import Arm
from harness.robot.friction_curve import Change, FrictionCurve, curve, drawn, knots, splines, widened
from harness.robot.whole_arm.columns import (
    ARMATURE,
    ASYMMETRIC,
    DRIFT,
    INERTIA,
    LOAD,
    MOTOR,
    POSITION,
    POWER,
    QUADRATIC,
    SENSOR,
    STRIBECK,
    Candidate,
    of_friction,
    signs,
)
from harness.robot.whole_arm.design import Design, Named, Noise, Part, Whitened
from harness.robot.whole_arm.differentiate import Filtered
from harness.robot.whole_arm.perturb import inertials
from harness.robot.whole_arm.rules import BODY_SPREAD, SAID_BETTER
from harness.robot.whole_arm.search import BLOCK, Problem, held_out, rms

RIGID = "inertial numbers of all bodies"
_OF_SPEED = (STRIBECK, ASYMMETRIC, QUADRATIC, POWER)
_OF_BODIES = (INERTIA, MOTOR, ARMATURE, SENSOR)
_BESIDE = (LOAD, POSITION, DRIFT)


@dataclass(frozen=True, slots=True)
class Curved:
    """found : the curve. friction (m,) : torque of all samples beyond the corrected model, with the offset taken off.

    rigid : whether inertial numbers went along.
    """

    found: FrictionCurve
    friction: FloatArray
    rigid: bool


def curves(
    problem: Problem, design: Design, arm: Arm, units: Mapping[int, tuple[str, str]], gain: Mapping[int, float]
) -> dict[int, Curved]:
    """Curves by joint; joints whose speeds are too few are left out.

    design : what was chosen, solved. arm : as corrected. units : of Coulomb and viscous friction. gain : of the torque.
    """
    filtered, t = problem.filtered, problem.filtered.t
    block, speeds = ((t - t[0]) // BLOCK).astype(np.int64), dict[int, FloatArray]()
    for j, part in design.parts.items():
        kept = part.stretches.kept
        if (own := knots(filtered.v[kept, filtered.dof[j]], block[kept])) is not None:
            speeds[j] = own
    if not speeds:
        return {}
    parts = {j: _splined(filtered, j, part, speeds.get(j)) for j, part in design.parts.items()}
    beside = [
        _about_mean(one, design.parts, parts)
        for one in design.named
        if not (one.candidate.name in _OF_SPEED and one.candidate.joint in speeds)
    ]
    best = Design(parts, beside)
    # they take the place of what was named of masses, rotors and scales of torque
    bodies, others = _bodies(filtered, arm), [one for one in beside if one.candidate.name not in _OF_BODIES]
    wider = Design(parts, [*others, Named(Whitened.of(bodies, parts))])
    rigid = held_out(wider, t) < SAID_BETTER.value**2 * held_out(best, t)
    if rigid:
        best, gain = _relearnt(wider, len(bodies.spread) // len(parts)), dict.fromkeys(parts, 1.0)
    covariance, draws, left = best.covariance(), _drawn(best, block), rms(best, t)
    blocks = int(np.ceil(filtered.seconds / BLOCK))
    changes = _changes(problem, best, gain)
    told = {}
    for j, own in speeds.items():
        place = slice(best.base[j].start, best.base[j].start + 2 * own.size)
        spread = widened(covariance[place, place], draws[:, place]) / gain[j] ** 2
        values, v = best.numbers[place] / gain[j], filtered.v[:, filtered.dof[j]]
        found = curve(own, values, spread, v[parts[j].stretches.kept], blocks - 1, units[j])
        offset = float(np.mean(values - found.friction))
        friction = (parts[j].base[:, : 2 * own.size] @ best.numbers[place] + best.left(j)) / gain[j] - offset
        told[j] = Curved(
            replace(found, changes=changes[j], left=float(left[list(parts).index(j)]) / abs(gain[j])), friction, rigid
        )
    return told


def _relearnt(design: Design, shared: int) -> Design:
    """The same with the noise of what it leaves; shared : numbers beside a joint's own that count for it."""
    parts = {}
    for j, part in design.parts.items():
        fitted = part.spread.size + shared
        parts[j] = replace(part, noise=Noise.learnt(design.left(j), part.stretches, fitted, part.floor))
    return Design(parts, [replace(one, whitened=Whitened.of(one.candidate, parts)) for one in design.named])


def _splined(filtered: Filtered, joint: int, part: Part, speeds: FloatArray | None) -> Part:
    """A part whose Coulomb, viscous friction and offset have become splines."""
    if speeds is None:
        return part
    v = filtered.v_fine[:, filtered.dof[joint]]
    own = filtered.column(splines(v, signs(v), speeds), jumps=True)
    spread = np.concatenate((np.full(own.shape[1], np.inf), part.spread[3:]))
    return replace(part, base=np.column_stack((own, part.base[:, 3:])), spread=spread)


def _about_mean(one: Named, before: Mapping[int, Part], parts: Mapping[int, Part]) -> Named:
    """What was named, its columns less their mean along the motion where they are friction."""
    columns = one.torque
    if one.candidate.joint is not None and one.candidate.name in _BESIDE:
        j = one.candidate.joint
        columns = {j: _less_mean(columns[j], before[j])}
    fixed = replace(one.candidate, torque=lambda _: columns, values=(one.value,))
    return replace(one, whitened=Whitened.of(fixed, parts), setting=0)


def _less_mean(columns: FloatArray, part: Part) -> FloatArray:
    """Columns (m, c) of friction less their mean along the motion; the part's first column is the sign."""
    sign, kept = part.base[:, :1], part.stretches.kept
    return np.asarray(columns - sign * np.mean((sign * columns)[kept], axis=0))


def _bodies(filtered: Filtered, arm: Arm) -> Candidate:
    """Mass, first moments and inertia of every body, each expected within a share of what the model has; any rotors."""
    rigid, dofs = arm.inverse(filtered.q, filtered.v, filtered.a), list(filtered.dof)
    found, spread = [], []
    for other, step, size in inertials(arm):
        found.append((other.inverse(filtered.q, filtered.v, filtered.a) - rigid)[:, dofs] / step)
        spread.append(BODY_SPREAD.value * size)
    rotors = filtered.a[:, dofs, None] * np.eye(len(dofs))
    columns = np.concatenate((np.stack(found, axis=2), rotors), axis=2)
    by_joint = {j: columns[:, j].copy() for j in range(len(dofs))}
    spread += [np.inf] * len(dofs)
    return Candidate(RIGID, None, lambda _: by_joint, tuple(("", "") for _ in spread), np.array(spread))


def _drawn(design: Design, of: IntArray) -> FloatArray:
    """Numbers (draws, p) of a bootstrap over blocks of time; of (m,) : the block of each sample."""
    scale = np.sqrt(np.sum(design.matrix**2, axis=0))
    scale[scale == 0.0] = 1.0
    scaled = design.matrix / scale
    block = np.concatenate([of[part.stretches.kept] for part in design.parts.values()])
    rows = [np.flatnonzero(block == one) for one in range(int(of[-1]) + 1)]
    normal = np.stack([scaled[own].T @ scaled[own] for own in rows])
    pull = np.stack([scaled[own].T @ design.y[own] for own in rows])
    rest = scaled[block.size :]
    return np.asarray(drawn(normal, pull, rest.T @ rest + _FLAT * np.eye(scale.size)) / scale)


_FLAT = 1e-10
"""Of columns of length one, that keeps them solvable."""


def _changes(problem: Problem, design: Design, gain: Mapping[int, float]) -> dict[int, tuple[Change, ...]]:
    """How friction of each joint changes with its load, position, temperature and the time, all at once."""
    named = [one for one in design.named if one.candidate.name not in _BESIDE]
    asked = {j: _asked(problem, j) for j in design.parts}
    every = [Named(Whitened.of(one, design.parts)) for some in asked.values() for one in some]
    # what changes slowly is memory of the noise where it was not in the model
    wider = _relearnt(Design(design.parts, [*named, *every]), 0)
    every = list(wider.named[len(named) :])
    errors = np.sqrt(np.diag(wider.covariance()))
    found: dict[int, list[Change]] = {j: [] for j in asked}
    for one in every:
        j, ((what, unit),) = one.candidate.joint, one.candidate.numbers
        assert j is not None
        at = wider.place(one).start
        by = Quantity(float(wider.numbers[at]) / gain[j], float(errors[at]) / abs(gain[j]), unit)
        found[j].append(Change(what, by))
    for j, some in found.items():
        known = [one.what for one in some]
        if LOADED not in known:
            some.append(Change(LOADED, None, "gravity does not load it"))
        if WARMTH not in known:
            told = np.all(np.isfinite(problem.filtered.temperature[:, j]))
            said = f"it changes by less than {_WARMER:g} K" if told else "it is not logged"
            some.append(Change(WARMTH, None, said))
    return {j: tuple(some) for j, some in found.items()}


LOADED, WARMTH = "torque of gravity", "temperature"
_WARMER = 1.0
"""K: of less nothing is asked."""
_NOTHING = 1e-6
"""Share of a torque below which gravity is none."""


def _asked(problem: Problem, joint: int) -> list[Candidate]:
    """What friction may change with."""
    filtered, part = problem.filtered, problem.parts[joint]
    load, q = np.abs(problem.gravity[:, joint]), filtered.q[:, filtered.dof[joint]]
    every = {("position", "N m/rad"): q, ("time", "N m/s"): filtered.t}
    if np.ptp(load) > _NOTHING * float(np.sqrt(np.mean(filtered.torque[:, joint] ** 2))):
        every = {(LOADED, "1"): load, **every}
    if np.ptp(filtered.temperature[:, joint]) > _WARMER:  # nan where it was not logged
        every[WARMTH, "N m/K"] = filtered.temperature[:, joint]
    made = []
    for (what, unit), column in every.items():
        own = _less_mean(part.base[:, :1] * column[:, None], part)
        made.append(of_friction(f"friction by {what}", joint, ((what, unit),), own))
    return made
