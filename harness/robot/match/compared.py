"""A log against its model, joint by joint: correlation and slope of the torques, and what a mismatch looks like."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType

import numpy as np

from harness.core.arrays import FloatArray
from harness.core.robot.joint_log import JointLog
from harness.robot.arm import Arm
from harness.robot.match.change import Change, mended, with_load_of, worth_trying
from harness.robot.match.rules import BY_FRICTION, CORRELATED, LARGEST_SCALE, UNIT_NEAR
from harness.robot.match.sampled import FEWEST, SURE, Sampled, Slope, loss, slope, unexplained

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
    command, that mends all of it, "" where none does."""

    matches: tuple[Match, ...]
    statement: str = ""
    option: str = ""

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
    lost_error : power of friction, W."""

    name: str
    by: str
    slope: Slope | None
    whole: Slope | None
    offset: float
    friction: float
    left: float
    lost: float
    lost_error: float

    @property
    def turned(self) -> bool:
        """Whether the torque's sign is the other one: against the model, and friction would drive."""
        return self.against and self.lost < SURE * self.lost_error if self.told else self.driving

    @property
    def driving(self) -> bool:
        """Whether friction surely drives, which none does."""
        return self.lost < -SURE * self.lost_error

    @property
    def against(self) -> bool:
        """Whether it goes against the model's."""
        return self.told and self.slope is not None and self.slope.value < 0.0

    @property
    def told(self) -> bool:
        """Whether its slope is a scale."""
        return self.slope is not None and self.slope.follows

    def strange(self, scale: float) -> bool:
        """Whether the model's torque times a scale would show, and does not."""
        found = self.whole
        if (self.against and not self.turned) or self.left > 1.0 - CORRELATED.value**2:
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
    if _strange(joints) or _some_turned(joints) or worth_trying(shares):
        heavier = with_load_of(sampled, arm)
        # a load turns torques as a zero offset does: whichever explains more
        other, changes = mended(sampled, arm, shares, None if heavier is None else unexplained(sampled, heavier))
        if changes:
            return _judged(_looked_at(other, arm), changes, gains)
        loaded = () if heavier is None else _looked_at(sampled, heavier)
        if loaded and not any(one.driving for one in loaded) and _judged(loaded, (), gains).fits(""):
            # a load that the model has not is named later, and is no mismatch
            return Compared(tuple(_match(one, (), {}, "", (), "") for one in joints))
    return _judged(joints, (), gains)


def _looked_at(sampled: Sampled, arm: Arm) -> tuple[_Joint, ...]:
    held, moved = sampled.rigid(arm)
    return tuple(_look(sampled, j, held[:, j], moved[:, j]) for j in range(len(sampled.joints)))


def _look(sampled: Sampled, j: int, held: FloatArray, moved: FloatArray) -> _Joint:
    """held, moved (m,) : torque of gravity and of inertia on a joint, N m or N."""
    kept, name = sampled.moves(j), sampled.joints[j]
    u, friction, rigid = sampled.torque[kept, j], sampled.friction(j)[kept], (held + moved)[kept]
    if u.size < FEWEST or float(np.ptp(u)) == 0.0:
        return _Joint(name, "", None, None, 0.0, 0.0, 0.0, 0.0, math.inf)
    by, found = "gravity", slope(u, held[kept], np.column_stack((friction, moved[kept])))
    if found is None or not found.seen:
        turning = slope(u, moved[kept], np.column_stack((friction, held[kept])))
        if turning is not None and (found is None or turning.seen or turning.size > found.size):
            by, found = "inertia", turning
    both = np.column_stack((rigid, friction))
    numbers = np.linalg.lstsq(both, u, rcond=1e-10)[0]
    left = float(np.var(u - both @ numbers) / np.var(u))
    alone = 1.0 - float(np.var(u - friction @ np.linalg.lstsq(friction, u, rcond=1e-10)[0]) / np.var(u))
    whole = slope(u, rigid, friction)
    return _Joint(name, by if found else "", found, whole, float(numbers[-1]), alone, left, *loss(u, rigid, friction))


def _scale(joints: Sequence[_Joint]) -> float:
    """The typical size of logged over modelled torque."""
    told = [abs(one.slope.value) for one in joints if one.told and one.slope]
    return float(np.median(told)) if told else 1.0


def _strange(joints: Sequence[_Joint]) -> list[str]:
    """Joints whose torque does not follow the model's, though it would show."""
    scale = _scale(joints)
    return [one.name for one in joints if one.strange(scale)]


def _some_turned(joints: Sequence[_Joint]) -> bool:
    """Whether some and not all of the joints that tell have the other sign."""
    signs = {one.turned for one in joints if one.told}
    return len(signs) > 1


def _judged(joints: Sequence[_Joint], changes: Sequence[Change], given: Mapping[str, float]) -> Compared:
    """What is said of every joint, and of the log."""
    strange = _strange(joints)
    gains, unit = _gains([one for one in joints if one.name not in strange])
    asked = {name: gain * given.get(name, 1.0) for name, gain in gains.items()}
    options, said = _options(changes, asked, joints), [change.said for change in changes]
    turned = [name for name, gain in gains.items() if gain < 0.0]
    if turned:
        said.append(f"the torque of {_listed(turned, len(joints))} has the other sign")
    if unit:
        said.append(unit)
    if strange:
        said.append(f"the torque of {_listed(strange, len(joints))} does not follow the model's")
    matches = tuple(_match(one, changes, gains, unit, strange, options) for one in joints)
    if not said:
        return Compared(matches)
    if len(strange) > len(joints) / 2.0 and not options:
        said = ["the model is hardly this robot's: " + said[-1]]
    return Compared(matches, "; ".join(said), "" if strange and not changes and not gains else options)


def _match(
    one: _Joint, changes: Sequence[Change], gains: Mapping[str, float], unit: str, strange: Sequence[str], options: str
) -> Match:
    own = [change.said for change in changes if one.name in change.joints]
    if one.name in gains:
        own += [*(["its torque has the other sign"] if gains[one.name] < 0.0 else []), *([unit] if unit else [])]
    option = options if own else ""
    if one.name in strange:
        own.append("its torque does not follow the model's")
    wrong = bool(own)
    if not own and not one.told and one.slope is not None and not one.slope.seen:
        own.append(UNCHECKED)
    found = one.slope
    return Match(
        one.name,
        one.by,
        None if found is None else found.correlation,
        None if found is None else found.value,
        None if found is None else found.error,
        one.offset,
        "; ".join(own),
        option,
        wrong,
    )


def _gains(joints: Sequence[_Joint]) -> tuple[dict[str, float], str]:
    """By joint what its torque is to be multiplied by, for those for which that is not 1, and what the unit is."""
    signs = {one.name: -1.0 if one.turned else 1.0 for one in joints}
    told = [(one.name, one.slope) for one in joints if one.told and one.slope is not None]
    sizes = np.array([abs(found.value) for _, found in told])
    errors = np.array([found.error for _, found in told])
    turned = {name: sign for name, sign in signs.items() if sign < 0.0}
    if not told:
        return turned, ""
    scale = float(np.median(sizes))
    alike = bool(np.all(np.abs(sizes - scale) < UNIT_NEAR.value * scale + SURE * errors))
    unit = _unit(scale) if alike and (len(told) > 1 or LARGEST_SCALE.value < max(scale, 1.0 / scale)) else ""
    if unit:
        return {name: sign / UNITS[unit] for name, sign in signs.items()}, f"torque is in {unit}"
    far = [max(size, 1.0 / size) > LARGEST_SCALE.value for size in sizes]
    if sum(far) * 2 <= len(far):
        return turned, ""
    by_joint = {name: 1.0 / size for (name, _), size in zip(told, sizes, strict=True)}
    rest = float(np.median([*by_joint.values()]))
    gains = {name: float(f"{sign * by_joint.get(name, rest):.4g}") for name, sign in signs.items()}
    lowest, highest = sizes.min(), sizes.max()
    times = f"{lowest:.3g}" if alike else f"{lowest:.3g} to {highest:.3g}"
    return gains, f"torque is {times} times the model's, as a current in A is"


def _unit(scale: float) -> str:
    """The unit of torque that is so many times smaller than N m; "" for none."""
    return next((name for name, size in UNITS.items() if abs(scale / size - 1.0) < UNIT_NEAR.value), "")


def _options(changes: Sequence[Change], gains: Mapping[str, float], joints: Sequence[_Joint]) -> str:
    """The options of the command that mend it."""
    by_option: dict[str, list[str]] = {}
    for change in changes:
        by_option.setdefault(change.option, []).append(change.value)
    if gains:
        values = set(gains.values())
        same = len(values) == 1 and len(gains) == len(joints)
        by_option["--gain"] = (
            [f"{next(iter(values)):.7g}"] if same else [f"{name}={gain:.7g}" for name, gain in gains.items()]
        )
    return " ".join(f"{option} {','.join(values)}" for option, values in by_option.items())


def _listed(names: Sequence[str], of: int) -> str:
    return "every joint" if len(names) == of and of > 1 else ", ".join(names)
