"""python -m benchmarks.robot_calibrate.speed: seconds and memory of a whole arm's log, by its length."""

import argparse
import sys
import time
import tracemalloc
from collections.abc import Sequence

import numpy as np

from benchmarks.robot_calibrate.plant import Motion, Plant, seven_joints
from harness.robot.whole_arm.whole import whole_arm


def main(argv: Sequence[str] | None = None) -> int:
    """Print a line for each length; exit code."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.robot_calibrate.speed")
    parser.add_argument("--seconds", type=float, nargs="+", default=[20.0, 40.0, 80.0])
    told = parser.parse_args(argv)
    arm, rng = seven_joints(), np.random.default_rng(3)
    plant, motion = Plant.drawn(rng, arm), Motion.drawn(rng)
    for seconds in told.seconds:
        log = plant.log(rng, motion, seconds)
        began, processor = time.perf_counter(), time.process_time()
        whole_arm(log, arm, lowpass=15.0)
        spent, processor = time.perf_counter() - began, time.process_time() - processor
        tracemalloc.start()
        whole_arm(log, arm, lowpass=15.0)
        most = tracemalloc.get_traced_memory()[1] / 1e6
        tracemalloc.stop()
        held = log.t.nbytes * (1 + 2 * len(log.joints)) / 1e6
        print(
            f"{seconds:g} s of seven joints at 1 kHz ({held:.1f} MB): {spent:.1f} s, {processor:.1f} s of processor,"
            f" {most:.0f} MB at most beside the log"
        )
    return 0


if __name__ == "__main__":
    sys.exit(main())
