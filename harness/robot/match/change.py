"""What may be wrong with positions and names in a log, each tried against the model: zeros, axes, swapped columns."""

import itertools
import math
from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
from scipy.optimize import minimize_scalar

from harness.core.arrays import FloatArray
from harness.robot.arm import Arm
from harness.robot.match.sampled import Sampled, fitted, unexplained
from harness.robot.whole_arm.perturb import loaded_bodies, with_load
from harness.robot.whole_arm.rules import LOADED

_LOOKED_AT = 250
"""Samples that many changes are tried at."""
_STEPS = 12
"""Zero offsets that are tried over a turn; the nearest is at most 15 degrees off, which leaves 7 % of a torque."""
_FLOOR = 0.01
"""Share of a joint's torque below which nothing is gained by explaining more: its ripple and noise."""
_ROUNDS = 4
"""Changes of one log, at most."""
WORTH = math.log(4.0)
"""What a change must take off the summed logarithms of what is unexplained: three quarters of one joint's squares."""
MENDED = 0.05
"""Share of every joint's torque that may be unexplained after the changes, for the log to be called mended."""
_KG, _BESIDE, _LIGHTEST = 0.1, 0.05, 0.02
"""kg and m by which a load is moved to see what it does; kg, from which a load is one."""
_ROUND = math.radians(15.0)
"""Zeros are off by whole multiples of this, where the torque does not say otherwise by more than _NEAR."""
_NEAR = math.radians(1.0)
_FELT = 1e-4
"""Of the direction in which torques tell gravity best: below it a direction of gravity is not felt."""
_AS_LARGE = 0.1
"""Share by which gravity may differ from the model's: masses and motor constants are not exact either."""
_UPRIGHT = math.radians(3.0)
"""A base stands along an axis where the torques say so to this; the rest is a tilt, which is fitted later."""


@dataclass(frozen=True, slots=True)
class Change:
    """option, value : of the command, that makes it. said : what it is. joints : those it is of."""

    option: str
    value: str
    said: str
    joints: tuple[str, ...]


def worth_trying(shares: FloatArray) -> bool:
    """Whether so much of joints' torques (k,) is unexplained that a change could be worth it."""
    return _score(shares) - _score(np.zeros_like(shares)) > WORTH


def mended(
    sampled: Sampled, arm: Arm, shares: FloatArray, rival: FloatArray | None = None
) -> tuple[Sampled, tuple[Change, ...]]:
    """The log with the changes by which the model explains it, and these; as it is where none do, or a rival as well.

    shares, rival (k,) : unexplained of each joint's torque as it is, and with another explanation than a change.
    """
    found: list[Change] = []
    other, now = sampled, _score(shares)
    while len(found) < _ROUNDS:
        thin = _thin(other)
        tried = [(_score(unexplained(one, arm)), change) for change, one in _changes(thin, arm)]
        if not tried:
            break
        best, change = min(tried, key=lambda one: one[0])
        change, changed = _refined(change, other, thin, arm)
        left = unexplained(changed, arm)
        if now - _score(left) < WORTH:
            break
        near = {(one.option, one.joints): one for score, one in tried if score - best < WORTH}
        near.pop((change.option, change.joints))
        twins = [_refined(one, other, thin, arm) for one in near.values()]
        alike = [one for one, log in twins if float(np.max(unexplained(log, arm) - left)) < _FLOOR]
        other, now = changed, _score(left)
        if alike:
            more = ", ".join(f"or {one.said} ({one.option} {one.value})" for one in alike)
            change = replace(change, said=f"{change.said}, {more}: the log does not tell which")
        found.append(change)
    zeros = [change for change in found if change.option == "--offset"]
    if len(zeros) > 1:
        # each was found beside the error of those found after it
        for zero in (*zeros, *zeros):
            name, i = zero.joints[0], [one.joints for one in found].index(zero.joints)
            rest, other = _refined(_zero(name, 0.0), other, _thin(other), arm)
            found[i] = _zero(name, _offset(found[i]) + _offset(rest))
    after = unexplained(other, arm)
    # a joint that was nearly explained, and whose noise is the rest, needs only not be worse
    least = np.where(shares < 2.0 * MENDED, np.maximum(shares, MENDED), MENDED)
    if not found or np.any(after > least) or (rival is not None and _score(rival) <= _score(after)):
        return sampled, ()
    return other, tuple(found)


def _beside_friction(sampled: Sampled, known: FloatArray, columns: FloatArray) -> FloatArray:
    """What torques hold beyond those that are known (m, k), and columns (m, k, c) that may be in it, (n, 1 + c): of all
    joints, each less its friction and over its own torque.
    """
    rows = []
    for j in range(len(sampled.joints)):
        kept, friction = sampled.moves(j)
        torque = sampled.torque[kept, j]
        left = fitted(friction, np.column_stack((torque - known[kept, j], columns[kept, j])))[1]
        rows.append(left / max(float(np.std(torque)), 1e-12))
    return np.concatenate(rows)


def with_load_of(sampled: Sampled, arm: Arm) -> Arm | None:
    """The arm with the load that explains most of the torques, on one of its last bodies; None where that would weigh
    nothing.
    """
    thin = _thin(sampled)

    def rigid(other: Arm) -> FloatArray:
        return np.add(*thin.rigid(other))

    before, best = rigid(arm), (math.inf, 0.0, np.zeros(3), 0)
    for body in loaded_bodies(arm, int(LOADED.value)):
        middle = rigid(with_load(arm, _KG, on=body)) / _KG
        places = (with_load(arm, _KG, _BESIDE * axis, body) for axis in np.eye(3))
        moments = [(rigid(one) / _KG - middle) / _BESIDE for one in places]
        every = _beside_friction(thin, before, np.stack((middle - before / _KG, *moments), axis=2))
        found = np.linalg.lstsq(every[:, 1:], every[:, 0], rcond=1e-8)[0]
        left = float(np.sum((every[:, 0] - every[:, 1:] @ found) ** 2))
        if left < best[0]:
            best = left, float(found[0]), np.asarray(found[1:]), body
    _, kg, moment, body = best
    return with_load(arm, kg, moment / kg, body) if kg > _LIGHTEST else None


def _thin(sampled: Sampled) -> Sampled:
    return sampled.every(max(1, sampled.q.shape[0] // _LOOKED_AT))


def _score(shares: FloatArray) -> float:
    """Summed logarithm of what is unexplained."""
    return float(np.sum(np.log(shares + _FLOOR)))


def _changes(sampled: Sampled, arm: Arm) -> Iterator[tuple[Change, Sampled]]:
    """Everything that is tried, with the log as it then is."""
    hinges = [i for i, name in enumerate(arm.joints) if not arm.slides(name)]
    moved = [i for i in range(len(arm.joints)) if float(np.ptp(sampled.q[:, i])) > 0.0]
    for i in moved:
        name = arm.joints[i]
        other = _scaled(sampled, [i], -1.0)
        other.torque[:, [j for j, dof in enumerate(sampled.dof) if dof == i]] *= -1.0
        yield Change("--flip", name, f"{name} turns the other way than in the model", (name,)), other
    for i in (i for i in moved if i in hinges):
        for step in range(1, _STEPS):
            offset = math.remainder(2.0 * math.pi * step / _STEPS, 2.0 * math.pi)
            yield _zero(arm.joints[i], offset), _shifted(sampled, i, offset)
    if hinges and moved:
        degrees = Change("--angle-unit", "deg", "positions in degrees", tuple(arm.joints))
        yield degrees, _scaled(sampled, hinges, math.pi / 180.0)
    if turned := _turned(sampled, arm):
        yield turned
    for i, k in itertools.combinations(moved, 2):
        pair = one, two = arm.joints[i], arm.joints[k]
        order = np.arange(sampled.q.shape[1])
        order[[i, k]] = k, i
        places = {name: getattr(sampled, name)[:, order] for name in ("q", "v", "a")}
        logged = i in sampled.dof and k in sampled.dof
        torque = sampled.torque[:, [sampled.dof.index(int(order[dof])) for dof in sampled.dof]] if logged else None
        if torque is not None:
            both = Change("--names", f"{one}={two},{two}={one}", f"{one} and {two} have each other's names", pair)
            yield both, replace(sampled, **places, torque=torque)
            yield _swapped("effort", pair), replace(sampled, torque=torque)
        yield _swapped("position", pair), replace(sampled, **places)


def _turned(sampled: Sampled, arm: Arm) -> tuple[Change, Sampled] | None:
    """Gravity as the torques say it where it is as large as the model's and acts another way, with the log under it.

    Torques are linear in it. What no joint feels of it is what is missing of its size.
    """
    own = np.array(arm.model.opt.gravity)
    size = float(np.linalg.norm(own))
    if size == 0.0:
        return None
    without = np.add(*replace(sampled, gravity=np.zeros(3)).rigid(arm))
    each = [np.add(*replace(sampled, gravity=size * axis).rigid(arm)) - without for axis in np.eye(3)]
    every = _beside_friction(sampled, without, np.stack(each, axis=2))
    found, _, rank, _ = np.linalg.lstsq(every[:, 1:], every[:, 0], rcond=_FELT)
    felt = float(np.linalg.norm(found))
    if rank < len(found) and felt < 1.0:
        _, _, ways = np.linalg.svd(every[:, 1:], full_matrices=False)
        found = found + math.sqrt(1.0 - felt**2) * ways[-1] * np.sign(ways[-1] @ own or 1.0)
    elif abs(felt - 1.0) > _AS_LARGE:
        return None
    found = found / np.linalg.norm(found)
    nearest = np.round(found)
    along = nearest if math.acos(min(float(nearest @ found), 1.0)) < _UPRIGHT and nearest @ nearest == 1.0 else found
    gravity: FloatArray = np.asarray(size * along, dtype=np.float64)
    value = " ".join(f"{g:.4g}" for g in gravity + 0.0)
    said = f"the base stands otherwise than the model's: gravity is {value} m/s^2 there"
    return Change("--gravity", value, said, sampled.joints), replace(sampled, gravity=gravity)


def _scaled(sampled: Sampled, joints: list[int], by: float) -> Sampled:
    """Positions of some joints times a factor; the torque is a copy."""
    scale = np.ones(sampled.q.shape[1])
    scale[joints] = by
    moved = {name: getattr(sampled, name) * scale for name in ("q", "v", "a")}
    return replace(sampled, **moved, torque=sampled.torque.copy())


def _swapped(field: str, pair: tuple[str, str]) -> Change:
    one, two = pair
    value = f"{one}.{field}={two}.{field},{two}.{field}={one}.{field}"
    return Change("--names", value, f"the {field}s of {one} and {two} are swapped", pair)


def _zero(joint: str, offset: float) -> Change:
    said = f"{joint} is counted from a zero {abs(math.degrees(offset)):.3g} degrees from the model's"
    return Change("--offset", f"{joint}={offset:.6g}", said, (joint,))


def _offset(change: Change) -> float:
    return float(change.value.rpartition("=")[2])


def _shifted(sampled: Sampled, i: int, offset: float) -> Sampled:
    return replace(sampled, q=sampled.q + offset * (np.arange(sampled.q.shape[1]) == i))


def _refined(change: Change, sampled: Sampled, thin: Sampled, arm: Arm) -> tuple[Change, Sampled]:
    """A change with its zero offset, or its gravity, as the torque says it, and the log with it."""
    if change.option == "--gravity" and (turned := _turned(sampled, arm)):
        return turned
    if change.option != "--offset":
        # what every tenth sample spoke for, all of them may not
        return change, next((other for one, other in _changes(sampled, arm) if one == change), sampled)
    i, first, width = arm.joints.index(change.joints[0]), _offset(change), 2.0 * math.pi / _STEPS
    offset = float(
        minimize_scalar(
            lambda offset: float(np.sum(unexplained(_shifted(thin, i, float(offset)), arm))),
            bounds=(first - width, first + width),
            method="bounded",
            options={"xatol": 1e-3},
        ).x
    )
    whole = _ROUND * round(offset / _ROUND)
    offset = whole if abs(whole - offset) < _NEAR else offset
    return _zero(arm.joints[i], offset), _shifted(sampled, i, offset)
