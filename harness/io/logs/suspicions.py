"""What is odd about a log, in sentences: units that look wrong, torque without a sign, coarse steps.

Numbers here decide what is said, and whether an effort is taken for one; no verdict rests on them.
"""

from collections.abc import Mapping

import numpy as np

from harness.core.arrays import FloatArray
from harness.io.logs.raw import SI_UNITS, Field

Joints = Mapping[str, FloatArray]

FACTORS: tuple[tuple[float, str], ...] = (
    (180.0 / np.pi, "velocity in deg/s beside positions in rad"),
    (np.pi / 180.0, "positions in degrees beside velocity in rad/s"),
    (1000.0, "velocity in mm/s beside positions in m, or times in ms that are read as s"),
    (1e-3, "positions in mm beside velocity in m/s"),
    (1e6, "times in us that are read as s"),
    (30.0 / np.pi, "velocity in rpm"),
    (0.5 / np.pi, "velocity in turns per second"),
    (-1.0, "velocity with the sign turned"),
)
"""What the velocity over the derivative of the position may be, and what that looks like."""
NEAR = 0.05
"""Of a factor: nearer than this share it is taken for one of them, or for 1."""
TOLD = 0.99
"""Correlation of the integrated velocity with the position from which their ratio is said."""
RESOLVED = 2.0
"""Steps that a velocity's standard deviation is of, at least, where its ratio is said."""
TURNS = 4.0 * np.pi
"""rad; positions beyond two turns either way are looked at."""
TOUCHES = 0.02
"""An effort that never is negative and comes nearer to 0 than this share of its largest may have no sign."""
FOLDED = 0.5
"""Of the squares that a line through place and way leaves of an effort: the absolute value of one leaves less than this
share of one that has lost its sign (pytest tests/io/test_bad_joint_logs.py)."""
STARTS = (0.0, 0.125, 0.25, 0.375, 0.5, 0.625, 0.75, 0.875)
"""Half turns by which the zero of an arm's angle may be off where its signs are begun."""
TURNED = 10
"""Times that signs are taken from the line before, at most."""
MOVES = 0.05
"""A joint goes both ways when its smaller way is more than this share of the larger."""
COARSE, FEW = 0.05, 0.1
"""A step is said when it is more than the first share of a channel's standard deviation, and samples have fewer values
than the second share of their number."""
FEWEST_LEVELS = 3
"""Values from which a channel can be said to come in steps."""
ROUNDING = 1e-9
"""Of a channel's range: values nearer than this are one."""
ONE_STEP = 1.5
"""Gaps up to so many times the least are one step, of which the typical one is taken."""
OFF, ON_STEPS = 0.05, 0.95
"""Of a step: nearer to a whole multiple, more than this share of gaps make a channel one of steps."""
MOST_SHOWN = 4
"""Joints that a message names before it counts."""


def called(joints: list[str], of: int) -> str:
    """Some of a log's joints as a message lists them."""
    if len(joints) == of:
        return "all joints" if of > 2 else " and ".join(joints)
    shown, more = (
        (joints, "") if len(joints) <= MOST_SHOWN else (joints[:MOST_SHOWN], f"{len(joints) - MOST_SHOWN} more")
    )
    parts = [*shown, more] if more else list(shown)
    return " and ".join([*([", ".join(parts[:-1])] if len(parts) > 1 else []), parts[-1]])


def ratio(t: FloatArray, position: FloatArray, velocity: FloatArray) -> float | None:
    """The velocity over the derivative of the position, both (n,), without differentiating; None where it is not told.

    The velocity is integrated; its offset makes a straight line, which is taken off both.
    """
    from_velocity = np.concatenate([[0.0], np.cumsum(0.5 * (velocity[1:] + velocity[:-1]) * np.diff(t))])
    scaled = (t - t.mean()) / max(float(t[-1] - t[0]), np.finfo(float).tiny)
    line = np.column_stack([np.ones_like(scaled), scaled])
    pair = np.column_stack([position, from_velocity])
    left, *_ = np.linalg.lstsq(line, pair, rcond=None)
    q, integral = (pair - line @ left).T
    size = float(np.sqrt((q @ q) * (integral @ integral)))
    if not np.isfinite(size) or size == 0.0 or abs(float(q @ integral)) < TOLD * size:
        return None
    return float(q @ integral) / float(q @ q)


def odd_velocity(t: FloatArray, position: Joints, velocity: Joints) -> list[str]:
    """Joints whose velocity is a constant times the derivative of their position."""
    found: dict[str, list[str]] = {}
    for joint in (name for name in velocity if name in position):
        step = step_of(velocity[joint])
        if step is not None and velocity[joint].std() < RESOLVED * step:
            continue
        factor = ratio(t, position[joint], velocity[joint])
        if factor is not None and abs(factor - 1.0) > NEAR:
            near = ((value, said) for value, said in FACTORS if abs(factor / value - 1.0) < NEAR)
            value, looks = next(near, (factor, ""))
            what = f"{value:.4g} times the derivative of the position{looks and f', as {looks}'}"
            found.setdefault(what, []).append(joint)
    return [f"The velocity of {called(joints, len(velocity))} is {what}." for what, joints in found.items()]


def degrees(position: Joints, told: str) -> str | None:
    """The sentence for positions that go farther than a hinge does, where nobody said their unit."""
    far = {name: float(np.abs(q).max()) for name, q in position.items() if np.abs(q).max() > TURNS}
    if told or not far:
        return None
    largest = max(far.values())
    return (
        f"Positions of {called(list(far), len(position))} go to {largest:.4g}, {largest / (2.0 * np.pi):.2g} turns if "
        "they are rad: degrees look so; --angle-unit deg reads them as such. Shares of LeRobot's ranges, -100 to 100,"
        " are read by --calibration FILE."
    )


def _both_ways(q: FloatArray) -> bool:
    steps = np.diff(q)
    up, down = float(steps[steps > 0.0].sum()), float(-steps[steps < 0.0].sum())
    return min(up, down) > MOVES * max(up, down)


def unsigned(position: Joints, effort: Joints) -> list[str]:
    """Joints whose effort is a magnitude: never negative, although they move both ways, and folded where it comes to 0.

    A driver that gives magnitudes does so of every joint: one effort that changes its sign clears all.
    """
    if any(u.min() < 0.0 for u in effort.values()):
        return []
    moving = [name for name, u in effort.items() if name in position and np.ptp(u) > 0.0 and _both_ways(position[name])]
    touching = [name for name in moving if effort[name].min() <= TOUCHES * effort[name].max()]
    folded = [name for name in touching if _folded(position[name], effort[name])]
    return list(effort) if folded and folded == moving else []


def _folded(q: FloatArray, u: FloatArray) -> bool:
    """Whether an effort u (n,) follows place and way of a position q (n,) better as a magnitude than with its sign.

    Gravity, a spring, friction and damping are linear in these; the signs of a magnitude are taken from the line that
    is fitted, again and again, from a friction's, a gravity's and a spring's.
    """
    v = np.gradient(q)
    to, _ = np.linalg.qr(np.column_stack([np.ones_like(q), q, np.cos(q), np.sin(q), v, np.sign(v)]))

    def line(y: FloatArray) -> FloatArray:
        return np.asarray(to @ (to.T @ y), dtype=np.float64)

    def left(signs: FloatArray) -> float:
        for _ in range(TURNED):
            signs, before = np.sign(line(signs * u)), signs
            if np.array_equal(signs, before):
                break
        return float(np.sum((u - np.abs(line(signs * u))) ** 2))

    begun = (v, q - q.mean(), *(np.sin(q + np.pi * share) for share in STARTS))
    return min(left(np.sign(one)) for one in begun) < FOLDED * float(np.sum((u - line(u)) ** 2))


def step_of(values: FloatArray) -> float | None:
    """The step of a channel (n,) that is coarse against what it does; None where it has none, or a fine one."""
    levels = np.unique(values)
    if levels.size < FEWEST_LEVELS or levels.size > FEW * values.size:
        return None
    gaps = np.diff(levels)
    least = gaps[gaps > ROUNDING * np.ptp(levels)].min()
    step = float(np.median(gaps[gaps < ONE_STEP * least]))
    whole = np.abs(gaps / step - np.round(gaps / step))
    return step if step > COARSE * float(values.std()) and np.mean(whole < OFF) > ON_STEPS else None


def coarse(kind: Field, channels: Joints) -> list[str]:
    """Sentences for the steps of a field."""
    steps: dict[str, list[str]] = {}
    for joint, values in channels.items():
        step = step_of(values)
        if step is not None:
            steps.setdefault(f"{step:.3g}", []).append(joint)
    unit = SI_UNITS[kind]
    return [
        f"The {kind} of {called(joints, len(channels))} comes in steps of {step} {unit}."
        for step, joints in steps.items()
    ]
