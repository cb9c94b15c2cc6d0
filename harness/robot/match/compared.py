"""A log against its model, joint by joint: correlation and slope of the torques, and what a mismatch looks like."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType

import numpy as np

from harness.core.robot import JointLog
from harness.robot.arm import Arm
from harness.robot.match.change import Change, mended, with_load_of, worth_trying
from harness.robot.match.sampled import (
    BY_FRICTION,
    CORRELATED,
    FEWEST,
    LARGEST_SCALE,
    SURE,
    UNIT_NEAR,
    Sampled,
    Slope,
    fitted,
    loss,
    slope,
    unexplained,
)

UNITS: Mapping[str, float] = {
    "mN m": 1e3,
    "N cm": 1e2,
    "kgf cm": 10.19716,
    "kgf m": 0.1019716,
    "lbf ft": 0.7375621,
    "lbf in": 8.850746,
    "ozf in": 141.6119,
}
"""What one newton metre is in them."""
_JUMPS = 0.5
"""Of a torque's power, in what it changes by from sample to sample, from which on its samples hardly say its mean."""
_ALIKE = 2.0
"""Standard errors within which a slope is one."""
_THOUSANDTHS = 2e-3
"""Times the model's: no current is so little of a torque, and no torque is logged in kN m."""
UNCHECKED = "neither gravity nor inertia shows in it: not checked"


@dataclass(frozen=True, slots=True)
class Match:
    """A joint's torque against the model's.

    by : "gravity", "inertia" or "". correlation, slope, error : of logged on modelled torque; None where that is not
    told. offset : constant torque beside, N m or N. suspicion : what is wrong with it, "" for nothing. option : what
    mends it, "" where nothing does. wrong : whether it stands against a diagnosis.
    """

    joint: str
    by: str
    correlation: float | None
    slope: float | None
    error: float | None
    offset: float
    suspicion: str = ""
    option: str = ""
    wrong: bool = False


@dataclass(frozen=True, slots=True)
class Compared:
    """matches : one a joint with effort. statement : what is wrong, in a sentence, "" for nothing. option : of the
    command, that mends all of it, "" where none does. unlogged : whether what acts between samples is all that is
    wrong."""

    matches: tuple[Match, ...]
    statement: str = ""
    option: str = ""
    unlogged: bool = False

    def fits(self, joint: str) -> bool:
        """Whether log and model go together as far as a joint is concerned: others whose torque alone is strange do not
        count, as long as an option does not mend them and most follow the model."""
        strange = [one.joint for one in self.matches if one.wrong]
        beside = not self.option and joint not in strange and 2 * len(strange) < len(self.matches)
        return not self.statement or beside


@dataclass(frozen=True, slots=True)
class _Joint:
    """What a joint's torque says. slope : by gravity, or by inertia where that does not show. whole : by both. friction
    : by friction alone is so large a share explained; left : and such a share by neither friction nor the model. lost,
    lost_error : power of friction, W. jumps : whether its samples hardly say the torque between them."""

    name: str
    by: str = ""
    slope: Slope | None = None
    whole: Slope | None = None
    offset: float = 0.0
    friction: float = 0.0
    left: float = 0.0
    lost: float = 0.0
    lost_error: float = math.inf
    jumps: bool = False

    @property
    def told(self) -> Slope | None:
        """Its slope where that is a scale."""
        return self.slope if self.slope is not None and self.slope.follows else None

    @property
    def agrees(self) -> bool:
        """Whether the model's torque shows in the log at its own size, however much else the torque holds."""
        return self.slope is not None and self.slope.seen and abs(self.slope.value - 1.0) < _ALIKE * self.slope.error

    @property
    def driving(self) -> bool:
        """Whether friction surely drives, which none does."""
        return self.lost < -SURE * self.lost_error

    @property
    def turned(self) -> bool:
        """Whether the torque's sign is the other one: against the model, and friction would drive."""
        if self.told:
            return self.told.value < 0.0 and self.lost < SURE * self.lost_error
        return self.driving

    def strange(self, scale: float) -> bool:
        """Whether the model's torque times a scale would show, and does not."""
        found, against = self.whole, self.told is not None and self.told.value < 0.0
        if self.agrees:
            return False
        if (against and not self.turned) or self.left > 1.0 - CORRELATED.value**2:
            return True
        if found is None or self.told or found.follows or self.friction > BY_FRICTION.value:
            return False
        return scale * found.size > CORRELATED.value * float(np.hypot(found.left, scale * found.size))


def compare(arm: Arm, log: JointLog, gains: Mapping[str, float] = MappingProxyType({})) -> Compared:
    """Whether the torque of every joint that moves follows the model, and what mends it where it does not.

    gains : by joint, what the log's torque was multiplied by already; what is to be given takes its place.
    """
    sampled = Sampled.of(arm, log)
    if not sampled.joints:
        return Compared(())
    joints = _looked_at(sampled, arm)
    shares = unexplained(sampled, arm)
    if _in_thousandths(joints):
        return _judged(joints, (), gains)
    some_turned = len({one.turned for one in joints if one.told}) > 1
    if _strange(joints) or some_turned or worth_trying(shares):
        heavier = with_load_of(sampled, arm)
        # a load turns torques as a zero offset does: whichever explains more
        other, changes = mended(sampled, arm, shares, None if heavier is None else unexplained(sampled, heavier))
        if changes:
            return _judged(_looked_at(other, arm), changes, gains)
        loaded = [] if heavier is None else _looked_at(sampled, heavier)
        if loaded and not any(one.driving for one in loaded) and _judged(loaded, (), gains).fits(""):
            # a load that the model has not is named later, and is no mismatch
            return Compared(tuple(_match(one, [], "", False) for one in joints))
    return _judged(joints, (), gains)


def _looked_at(sampled: Sampled, arm: Arm) -> list[_Joint]:
    """What every joint's torque says."""
    every_held, every_moved = sampled.rigid(arm)
    joints = []
    for j, name in enumerate(sampled.joints):
        kept, friction = sampled.moves(j)
        u, held, moved = sampled.torque[kept, j], every_held[kept, j], every_moved[kept, j]
        if u.size < FEWEST or float(np.ptp(u)) == 0.0:
            joints.append(_Joint(name))
            continue
        by, found, rigid = "gravity", slope(u, held, np.column_stack((friction, moved))), held + moved
        if found is None or not found.seen:
            turning = slope(u, moved, np.column_stack((friction, held)))
            if turning is not None and (found is None or turning.seen or turning.size > found.size):
                by, found = "inertia", turning
        numbers, left = fitted(np.column_stack((rigid, friction)), u)
        alone = 1.0 - float(np.var(fitted(friction, u)[1]) / np.var(u))
        share, whole = float(np.var(left) / np.var(u)), slope(u, rigid, friction)
        offset, lost = float(numbers[-1]), loss(u, rigid, friction)
        jumps = sampled.jumps[j] > _JUMPS
        joints.append(_Joint(name, by if found else "", found, whole, offset, alone, share, *lost, jumps=jumps))
    return joints


def _strange(joints: Sequence[_Joint]) -> list[str]:
    """Joints whose torque does not follow the model's, though it would show."""
    told = [abs(one.told.value) for one in joints if one.told]
    scale = float(np.median(told)) if told else 1.0
    return [one.name for one in joints if one.strange(scale)]


def _in_thousandths(joints: Sequence[_Joint]) -> bool:
    """Whether every torque that is told is so little of the model's that the model is in other units."""
    told = [abs(one.told.value) for one in joints if one.told]
    return bool(told) and max(told) < _THOUSANDTHS


def _judged(joints: Sequence[_Joint], changes: Sequence[Change], given: Mapping[str, float]) -> Compared:
    """What is said of every joint, and of the log."""
    strange = _strange(joints)
    gains, unit = _gains([one for one in joints if one.name not in strange])
    options: dict[str, list[str]] = {}
    for change in changes:
        options.setdefault(change.option, []).append(change.value)
    if gains:
        asked = {name: gain * given.get(name, 1.0) for name, gain in gains.items()}
        same = len({*asked.values()}) == 1 and len(asked) == len(joints)
        values = [f"{name}={gain:.7g}" for name, gain in asked.items()]
        options["--gain"] = [f"{next(iter(asked.values())):.7g}"] if same else values
    option = " ".join(f"{name} {','.join(values)}" for name, values in options.items())
    turned = [name for name, gain in gains.items() if gain < 0.0]
    said = [change.said for change in changes]
    if turned:
        said.append(f"the torque of {_listed(turned, len(joints))} has the other sign")
    said += [unit] if unit else []
    matches = []
    for one in joints:
        own = [change.said for change in changes if one.name in change.joints]
        own += ["its torque has the other sign"] if one.name in turned else []
        own += [unit] if unit and (one.name in gains or _in_thousandths(joints)) else []
        matches.append(_match(one, own, option, one.name in strange))
    if strange and not said and all(one.jumps for one in joints if one.name in strange):
        said = [
            f"the torque of {_listed(strange, len(joints))} jumps from sample to sample, and its mean is not logged"
        ]
        return Compared(tuple(matches), said[0], unlogged=True)
    if strange:
        said.append(f"the torque of {_listed(strange, len(joints))} does not follow the model's")
    if len(strange) > len(joints) / 2.0 and not option:
        said = ["the model is hardly this robot's: " + said[-1]]
    return Compared(tuple(matches), "; ".join(said), "" if strange and not changes and not gains else option)


def _match(one: _Joint, own: Sequence[str], option: str, strange: bool) -> Match:
    """own : what is wrong with the joint and is mended by an option."""
    found, said = one.slope, [*own, *(["its torque does not follow the model's"] if strange else [])]
    unchecked = not said and found is not None and not found.seen
    suspicion = UNCHECKED if unchecked else "; ".join(said)
    option, wrong = option if own else "", bool(said)
    if found is None:
        return Match(one.name, one.by, None, None, None, one.offset, suspicion, option, wrong)
    return Match(
        one.name, one.by, found.correlation, found.value, found.error, one.offset, suspicion, option, wrong
    )  # fmt: skip


def _gains(joints: Sequence[_Joint]) -> tuple[dict[str, float], str]:
    """By joint what its torque is to be multiplied by, for those for which that is not 1, and what the unit is."""
    signs = {one.name: -1.0 if one.turned else 1.0 for one in joints}
    told = {one.name: one.told for one in joints if one.told}
    sizes = np.array([abs(found.value) for found in told.values()])
    turned = {name: sign for name, sign in signs.items() if sign < 0.0}
    if not told:
        return turned, ""
    if _in_thousandths(joints):
        return turned, "torque is a thousandth of the model's: its lengths are in mm, or its masses in g"
    scale, errors = float(np.median(sizes)), np.array([found.error for found in told.values()])
    alike = bool(np.all(np.abs(sizes - scale) < UNIT_NEAR.value * scale + SURE * errors))
    if alike and (len(told) > 1 or LARGEST_SCALE.value < max(scale, 1.0 / scale)):
        near = (name for name, size in UNITS.items() if abs(scale / size - 1.0) < UNIT_NEAR.value)
        if unit := next(near, ""):
            return {name: sign / UNITS[unit] for name, sign in signs.items()}, f"torque is in {unit}"
    far = [max(size, 1.0 / size) > LARGEST_SCALE.value for size in sizes]
    if sum(far) * 2 <= len(far):
        return turned, ""
    by_joint = dict(zip(told, (1.0 / sizes).tolist(), strict=True))
    rest = float(np.median([*by_joint.values()]))
    gains = {name: float(f"{sign * by_joint.get(name, rest):.4g}") for name, sign in signs.items()}
    lowest, highest = sizes.min(), sizes.max()
    times = f"{lowest:.3g}" if alike else f"{lowest:.3g} to {highest:.3g}"
    rough = [name for name in gains if name not in told or told[name].error > UNIT_NEAR.value * abs(told[name].value)]
    hardly = f" (of {_listed(rough, len(gains))} that is hardly told)" if rough else ""
    return gains, f"torque is {times} times the model's, as a current in A is{hardly}"


def _listed(names: Sequence[str], of: int) -> str:
    return "every joint" if len(names) == of and of > 1 else ", ".join(names)
