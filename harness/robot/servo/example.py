"""A log of goal and position, as an arm of servos leaves it: python -m harness.robot.servo.example FILE.csv

The elbow of models/arm is carried by MuJoCo under a servo like an STS3215 at 7.4 V with a gain of 16; its friction is
known. The others stand still. Goals are sent at 50 Hz and act 12 ms later; positions come in steps of the encoder.
"""

import argparse
import math
from pathlib import Path

import mujoco
import numpy as np

from harness.core.arrays import FloatArray
from harness.core.writing import replacing
from harness.engines.models import folder
from harness.robot.arm import load_arm
from harness.robot.servo.presets import preset

F_K, C, ARMATURE = 0.1, 0.05, 0.028
"""N m, N m s/rad, kg m^2."""
_GAIN, _DELAY, _RATE, _SECONDS = 16.0, 0.012, 50.0, 30.0
_STEP, _ENCODER, _NOISE, _LOCKED = 2.5e-4, 2.0 * math.pi / 4096, 0.5, 1e9
_PLACES, _MOVES = 0.8, (0.6, 1.8)
"""rad from the middle, and how long a move lasts, s."""


def goals(t: FloatArray, rng: np.random.Generator) -> FloatArray:
    """Goals (n,), rad, as somebody leads an arm: smoothly from place to place, with rests."""
    times, places = [0.0], [0.0]
    while times[-1] < t[-1]:
        times += [times[-1] + rng.uniform(*_MOVES), 0.0]
        times[-1] = times[-2] + rng.choice([0.0, 0.5])
        places += [rng.uniform(-_PLACES, _PLACES)] * 2
    at = np.minimum(np.searchsorted(times, t, side="right") - 1, len(times) - 2)
    begun, span = np.take(times, at), np.maximum(np.diff(times)[at], 1e-9)
    s = np.clip((t - begun) / span, 0.0, 1.0)
    return np.asarray(np.take(places, at) + (3.0 * s**2 - 2.0 * s**3) * np.diff(places)[at])


def followed(seed: int = 0) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Times (n,), s, goals and positions (n,), rad, of the elbow; the same for the same seed."""
    rng, servo = np.random.default_rng(seed), preset("sts3215")
    arm = load_arm(folder() / "arm" / "arm.xml")
    model, at = arm.model, arm.index("elbow")
    model.opt.disableflags = mujoco.mjtDisableBit.mjDSBL_CONTACT.value
    model.opt.timestep, model.opt.integrator = _STEP, mujoco.mjtIntegrator.mjINT_IMPLICITFAST.value
    model.actuator_gainprm[:] = model.actuator_biasprm[:] = 0.0
    model.dof_armature[:] = _LOCKED
    model.dof_armature[at], model.dof_frictionloss[at], model.dof_damping[at, ...] = ARMATURE, F_K, C
    t = np.arange(0.0, _SECONDS, 1.0 / _RATE)
    goal, data, found = goals(t, rng), mujoco.MjData(model), np.empty(t.size)
    for i in range(t.size):
        found[i] = data.qpos[at]
        for j in range(round(1.0 / (_RATE * _STEP))):
            sent = goal[max(int((t[i] + j * _STEP - _DELAY) * _RATE + 1e-9), 0)]
            duty = min(max(servo.gain or 0.0, 0.0) * _GAIN * (sent - float(data.qpos[at])), servo.limit)
            torque = servo.stall * servo.volts * max(duty, -servo.limit)
            data.qfrc_applied[at] = torque - servo.brake * float(data.qvel[at])
            mujoco.mj_step(model, data)
    return t, goal, _ENCODER * np.round(found / _ENCODER + _NOISE * rng.standard_normal(t.size))


def main() -> None:
    """Write a log as CSV."""
    parser = argparse.ArgumentParser(description="Goal and position of the elbow of models/arm, with known friction.")
    parser.add_argument("file", type=Path)
    parser.add_argument("--seed", type=int, default=0)
    given = parser.parse_args()
    with replacing(given.file) as file:
        rows = np.column_stack(followed(given.seed))
        np.savetxt(file, rows, "%.9g", ",", header="t,elbow.goal,elbow.position", comments="", encoding="utf-8")


if __name__ == "__main__":
    main()
