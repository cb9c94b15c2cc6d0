"""A joint's log with goals as runs of its servo: which joint, its supply, and the load that its model says."""

from collections.abc import Mapping

import numpy as np

from harness.core.arrays import FloatArray
from harness.core.errors import InputError, did_you_mean
from harness.core.robot import JointLog
from harness.robot.arm import Arm
from harness.robot.reduction import reduced
from harness.robot.servo.plant import Run
from harness.robot.servo.presets import Preset
from harness.robot.servo.servo import averaged

_MOVES = 0.02
"""rad that goal and position go at least for a joint to be one that moves."""
_FARTHEST = 8.0 * np.pi
"""rad: four turns, which no servo of an arm makes."""
_POSES = 100
"""Poses of the others in which a load is read."""


def servo_joint(log: JointLog, asked: str | None) -> str:
    """The joint that was asked for, or whose goal goes farthest. Raises InputError where none has goal and motion."""
    moves = {
        name: float(min(np.ptp(goal), np.ptp(log.position[name])))
        for name, goal in log.goal.items()
        if name in log.position
    }
    if asked is not None:
        if moves.get(asked, 0.0) < _MOVES:
            those = ", ".join(name for name, far in moves.items() if far >= _MOVES) or "none"
            found = "no goal of it is logged" if asked not in moves else "goal and position hardly move"
            raise InputError(
                f"{log.file}: {asked}", found, f"one of those that move: {those}{did_you_mean(asked, moves)}"
            )
        return asked
    best = max(moves, key=moves.__getitem__, default=None)
    if best is None or moves[best] < _MOVES:
        raise InputError(log.file, "no joint whose goal and position move", "a log with both")
    return best


def run_of(log: JointLog, joint: str, servo: Preset | None, kp: float | None, arm: Arm | None) -> Run:
    """A log as a run of a joint's servo; kp : its gain in force, None for the preset's.

    Raises InputError as ``reduced`` does.
    """
    size, farthest = log.t.size, float(np.max(np.abs(log.position[joint])))
    if farthest > _FARTHEST:
        found = f"positions up to {farthest:.4g} rad, {farthest / (2.0 * np.pi):.2g} turns: degrees look so"
        raise InputError(f"{log.file}: {joint}", found, "try: --angle-unit deg")
    if joint in log.voltage:
        volts = averaged(log.t, log.voltage[joint])
    else:
        volts = np.full(size, 1.0 if servo is None else servo.volts)
    gain = kp if kp is not None else 1.0 if servo is None else servo.kp
    on = log.driven.get(joint, np.ones(size))
    load = np.zeros((size, 3)) if arm is None else loads(arm, log, joint)
    return Run(log.t, log.position[joint], log.goal[joint], volts, on, load, gain, log.file)


def loads(arm: Arm, log: JointLog, joint: str) -> FloatArray:
    """Inertia without the rotor and gravity's torque as sine and cosine (n, 3), the others where the log has them."""
    others = [name for name in arm.joints if name != joint and name in log.position]
    still = all(float(np.ptp(log.position[name])) < _MOVES for name in others)
    poses = [log.t.size // 2] if still else np.unique(np.linspace(0, log.t.size - 1, _POSES).astype(int)).tolist()
    rows = [_load(arm, joint, {name: float(log.position[name][i]) for name in others}) for i in poses]
    table = np.array(rows)
    if still:
        return np.repeat(table, log.t.size, axis=0)
    return np.column_stack([np.interp(log.t, log.t[poses], column) for column in table.T])


def _load(arm: Arm, joint: str, held: Mapping[str, float]) -> tuple[float, float, float]:
    own = reduced(arm, joint, held)
    if own.slides:
        raise InputError(f"{arm.file}: {joint}", "a slide", "a servo's joint is a hinge")
    return own.inertia, own.a, own.b
