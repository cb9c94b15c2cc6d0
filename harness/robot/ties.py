"""Joints of a compiled model that do not move alone: two on a ratio, and those in loops or on tendons that pull.

What couples joints leaves the other joints' equations as they are: its forces are inner ones of what hangs on them.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

import mujoco

_BODY, _SITE = mujoco.mjtObj.mjOBJ_BODY.value, mujoco.mjtObj.mjOBJ_SITE.value
_JOINT = mujoco.mjtWrap.mjWRAP_JOINT.value
_ON_BODY = (mujoco.mjtWrap.mjWRAP_SITE.value, mujoco.mjtWrap.mjWRAP_SPHERE.value, mujoco.mjtWrap.mjWRAP_CYLINDER.value)
_SLOPE, _DEGREES = 1, slice(2, 5)
"""Of an equality's polynomial."""


@dataclass(frozen=True, slots=True)
class Tie:
    """q of the joint ``follows`` is start + ratio q of the joint ``leads``; numbers of joints, rad or m."""

    follows: int
    leads: int
    ratio: float
    start: float


@dataclass(frozen=True, slots=True)
class Coupled:
    """ties : pairs on a ratio. alone : by joint, why it neither moves alone nor on a ratio. notes : what was left out,
    one sentence each.
    """

    ties: tuple[Tie, ...]
    alone: Mapping[int, str]
    notes: tuple[str, ...]


def coupled(model: Any) -> Coupled:
    """What couples the joints of a model that has hinges and slides alone."""
    ties, alone, notes = list[Tie](), dict[int, str](), list[str]()
    for i in range(model.neq):
        if not model.eq_active0[i]:
            continue
        kind = mujoco.mjtEq(int(model.eq_type[i])).name.removeprefix("mjEQ_").lower()
        said = f"the {kind} equality{' ' * bool(model.equality(i).name)}{model.equality(i).name}"
        both = [int(one) for one in (model.eq_obj1id[i], model.eq_obj2id[i]) if one >= 0]
        if kind in ("joint", "tendon"):
            joints = both if kind == "joint" else [j for one in both for j in _pulled(model, one)]
            tie = _on_joints(model, i, both) if kind == "joint" else _on_tendons(model, i, both)
            if tie is not None:
                ties.append(tie)
            else:
                alone |= dict.fromkeys(joints, f"{said} couples it with another")
            continue
        site = int(model.eq_objtype[i]) == _SITE
        bodies = [int(model.site_bodyid[one]) if site else one for one in both]
        hand = next((b for b in bodies if model.body_mocapid[model.body_rootid[b]] >= 0), None)
        if hand is not None:
            notes.append(f"{said} is not used: {model.body(hand).name} is a simulation's hand on the robot")
            continue
        alone |= dict.fromkeys(_between(model, bodies), f"{said} closes a loop that it is in")
    forces = (model.tendon_stiffness, model.tendon_damping, model.tendon_frictionloss, model.tendon_armature)
    for i in range(model.ntendon):
        if any(float(one[i]) != 0.0 for one in forces):
            alone |= dict.fromkeys(_pulled(model, i), f"the tendon {model.tendon(i).name or i + 1} pulls it")
    return Coupled(tuple(ties), alone, tuple(notes))


def moved_with(ties: tuple[Tie, ...], joint: int) -> dict[int, tuple[float, float]]:
    """By joint that a joint moves by ratios, itself among them: ratio and start of its position on that one's."""
    found, ways = {joint: (1.0, 0.0)}, [joint]
    while ways:
        at = ways.pop()
        for tie in ties:
            if tie.leads == at and tie.follows not in found:
                other, ratio, start = tie.follows, tie.ratio, tie.start
            elif tie.follows == at and tie.leads not in found and tie.ratio != 0.0:
                other, ratio, start = tie.leads, 1.0 / tie.ratio, -tie.start / tie.ratio
            else:
                continue
            own = found[at]
            found[other] = (ratio * own[0], start + ratio * own[1])
            ways.append(other)
    return found


def _on_joints(model: Any, equality: int, joints: list[int]) -> Tie | None:
    """q1 - ref1 is a line of q2 - ref2, or rests."""
    data = model.eq_data[equality]
    first, other = joints[0], joints[-1]
    ref = [float(model.qpos0[model.jnt_qposadr[j]]) for j in (first, other)]
    if len(joints) < 2 or any(data[_DEGREES]):
        return None
    slope = float(data[_SLOPE])
    return Tie(first, other, slope, ref[0] + float(data[0]) - slope * ref[1])


def _on_tendons(model: Any, equality: int, tendons: list[int]) -> Tie | None:
    """The same of tendons over two joints in all; L1 - L1_ref is a line of L2 - L2_ref, or rests."""
    data, sums = model.eq_data[equality], dict[int, float]()
    slope = float(data[_SLOPE]) if len(tendons) > 1 else 0.0
    if any(data[_DEGREES]):
        return None
    for tendon, times in zip(tendons, (1.0, -slope), strict=False):
        for w in _wraps(model, tendon):
            if int(model.wrap_type[w]) != _JOINT:
                return None
            joint = int(model.wrap_objid[w])
            sums[joint] = sums.get(joint, 0.0) + times * float(model.wrap_prm[w])
    if len(sums) != 2 or not all(sums.values()):
        return None
    (first, one), (other, two) = sums.items()
    ref = [float(model.qpos0[model.jnt_qposadr[j]]) for j in (first, other)]
    ratio = -two / one
    return Tie(first, other, ratio, ref[0] + float(data[0]) / one - ratio * ref[1])


def _wraps(model: Any, tendon: int) -> range:
    first = int(model.tendon_adr[tendon])
    return range(first, first + int(model.tendon_num[tendon]))


def _pulled(model: Any, tendon: int) -> set[int]:
    """Joints that change a tendon's length."""
    wraps = [(int(model.wrap_type[w]), int(model.wrap_objid[w])) for w in _wraps(model, tendon)]
    places = [
        int(model.site_bodyid[one] if kind == _ON_BODY[0] else model.geom_bodyid[one])
        for kind, one in wraps
        if kind in _ON_BODY
    ]
    return {one for kind, one in wraps if kind == _JOINT} | _between(model, places)


def _between(model: Any, bodies: list[int]) -> set[int]:
    """Joints by which bodies move against each other; a single one against the world."""
    ways = [set(_rooted(model, body)) for body in (bodies if len(bodies) != 1 else [*bodies, 0])]
    some = {body for way in ways for body in way if not all(body in other for other in ways)}
    return {j for j in range(model.njnt) if int(model.jnt_bodyid[j]) in some}


def _rooted(model: Any, body: int) -> Iterator[int]:
    """A body and those it hangs on, the world last."""
    while True:
        yield body
        if body == 0:
            return
        body = int(model.body_parentid[body])
