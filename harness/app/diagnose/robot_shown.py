"""What is shown of a robot besides its friction: itself, and its model before and after against the log in engines."""

import logging
from dataclasses import dataclass

import numpy as np

from harness.app.diagnose.robot_options import RobotOptions
from harness.core.errors import SimulationError
from harness.core.robot.joint_log import JointLog
from harness.results.robot import SimulatedResult
from harness.robot.arm import Arm
from harness.robot.paste import JointPaste
from harness.robot.pictured import pictured
from harness.robot.replay.replay import MUJOCO, PYBULLET, replayed
from harness.show.robot.shown import Left, Motion, Shown

LOGGER = logging.getLogger(__name__)


@dataclass(frozen=True, slots=True)
class Tried:
    """What is shown, and the figures of it."""

    shown: Shown
    results: tuple[SimulatedResult, ...]


def tried(
    arm: Arm, log: JointLog, paste: JointPaste, asked: RobotOptions, left: Left, offset: float, engines: tuple[str, ...]
) -> Tried:
    """Simulate the joint with the friction of its file and with what is to be pasted.

    offset : of the logged torque, N m or N. engines : those of mujoco and pybullet that were asked for.
    """
    held = {name: float(np.mean(log.position[name])) for name in arm.joints if name in log.position}
    results, motions = [], []
    for engine in [name for name in (MUJOCO, PYBULLET) if name in engines]:
        try:
            one = replayed(asked.file, arm, log, paste, held, asked.gravity, offset, asked.payload or 0.0, engine)
        except SimulationError as error:
            LOGGER.warning("%s", error)
            results.append(
                SimulatedResult(
                    engine=engine, dt_s=None, window_s=None, windows=0, before={}, after={}, error=str(error)
                )
            )
            continue
        if one is None:
            break
        motions.append(Motion(engine, one.t, one.logged, one.q_before, one.q_after))
        results.append(
            SimulatedResult(
                engine=engine,
                version=one.version,
                dt_s=one.dt,
                window_s=one.window,
                windows=one.windows,
                before=dict(one.before),
                after=dict(one.after),
                left_out=list(one.left_out),
            )
        )
    return Tried(Shown(left, tuple(motions), pictured(asked.file, arm, log, paste.joint)), tuple(results))
