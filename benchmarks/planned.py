"""``python -m benchmarks.planned ROBOT ...``: what motions of ``harness plan`` are worth, by logs simulated along them.

Errors of Coulomb and viscous friction by the diagnosis of a whole arm (the own friction of each model, torque noise of
2 % of the largest torque, encoders of 2^16 counts), random motions over the planned one: as large as limits
allow, and as they are drawn. --feasible N: of each only whether N random motions keep the limits.
"""

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from harness.core.arrays import FloatArray
from harness.core.errors import InputError
from harness.core.robot import JointLog
from harness.robot.arm import Arm, load_arm
from harness.robot.plan import Limits, Motion, planned, random_motion
from harness.robot.whole_arm.whole import whole_arm

_SECONDS, _RATE, _NOISE, _STEP, _MOST = 20.0, 500.0, 0.02, 2.0 * np.pi / 2**16, 12


def main(argv: Sequence[str] | None = None) -> int:
    """A line for each model; exit code."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.planned", description=__doc__)
    parser.add_argument("robot", type=Path, nargs="+")
    parser.add_argument("--speed", type=float)
    parser.add_argument("--draws", type=int, default=4)
    parser.add_argument("--feasible", type=int, metavar="N")
    told = parser.parse_args(argv)
    kept = tried = 0
    for path in told.robot:
        try:
            arm = load_arm(path)
            names = [name for name in arm.joints if name not in arm.coupled][:_MOST]
            limits = Limits.of(path, arm, names, told.speed, None)
            rng = np.random.default_rng(1)
            tried += 1
            if told.feasible:
                motions = [random_motion(arm, names, limits, _SECONDS, rng) for _ in range(told.feasible)]
                within = all(np.all(motion.torque(100.0) <= limits.torque) for motion in motions)
                kept += within
                print(f"{path.name}: {'within' if within else 'BEYOND'} its limits", flush=True)
            else:
                print(f"{path.name}: {_compared(arm, names, limits, rng, told.draws)}", flush=True)
        except InputError as error:
            print(f"{path.name}: REFUSED {error.found}", flush=True)
    if told.feasible:
        print(f"{kept} of {tried} models")
    return 0


def _compared(arm: Arm, names: list[str], limits: Limits, rng: np.random.Generator, draws: int) -> str:
    largest = [random_motion(arm, names, limits, _SECONDS, rng) for _ in range(20)]
    noise = np.median([motion.torque() for motion in largest], axis=0)
    drawn = [random_motion(arm, names, limits, _SECONDS, rng, largest=False) for _ in range(draws)]
    least = _errors(planned(arm, names, limits, _SECONDS, noise), noise)
    ratios = [
        float(np.exp(np.mean(np.log(np.median([_errors(one, noise) for one in some], axis=0) / least))))
        for some in (largest[:draws], drawn)
    ]
    return f"{ratios[0]:.2f} as large as limits allow, {ratios[1]:.2f} as drawn"


def _errors(motion: Motion, noise: FloatArray) -> FloatArray:
    """Standard errors (k, 2) that a diagnosis gives for a log along a motion."""
    t, q, v, a = motion.at(_RATE)
    arm, dofs = motion.arm, [motion.arm.index(name) for name in motion.joints]
    torque = (arm.inverse(q, v, a) + arm.frictionloss * np.sign(v) + arm.damping * v)[:, dofs]
    torque += _NOISE * noise * np.random.default_rng(0).standard_normal(torque.shape)
    position, effort = (
        {name: y[:, k] for k, name in enumerate(motion.joints)} for y in (np.round(q[:, dofs] / _STEP) * _STEP, torque)
    )
    found = whole_arm(JointLog(t, position, effort=effort), arm)
    errors = [[one.stderr or np.nan for one in (found.joint(j).coulomb, found.joint(j).viscous)] for j in motion.joints]
    return np.array(errors)


if __name__ == "__main__":
    sys.exit(main())
