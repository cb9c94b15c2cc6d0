"""``python -m benchmarks.robot_logs --draws N --seed S``: what is said of clean arms in closed loop."""

import argparse
import sys
import time
from collections.abc import Sequence

import numpy as np

from benchmarks.robot_logs.plants import KINDS, Clean, clean
from harness.robot.match.compared import compare
from harness.robot.whole_arm.result import WholeArm
from harness.robot.whole_arm.whole import whole_arm


def main(argv: Sequence[str] | None = None) -> int:
    """Draw, and print; exit code."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.robot_logs", description=__doc__)
    parser.add_argument("--draws", type=int, default=20, help="of each kind")
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--only", choices=KINDS, action="append")
    parser.add_argument("--each", action="store_true", help="a line for every log")
    told = parser.parse_args(argv)
    for kind in told.only or KINDS:
        quiet, refused, errors, claimed = [], [], [], []
        for number in range(told.first, told.first + told.draws):
            began = time.perf_counter()
            one = clean(told.seed, number, kind)
            made = time.perf_counter() - began
            refused.append(bool(compare(one.arm, one.log).statement))
            found = whole_arm(one.log, one.arm)
            quiet.append(not found.named)
            error, sure = _errors(one, found)
            errors.append(error)
            claimed.append(sure)
            if told.each:
                spent = time.perf_counter() - began - made
                print(f"{kind} {number} ({one.said}; {made:.1f} + {spent:.1f} s): {_line(found)}", flush=True)
                print(f"   f_c {100 * error[:, 0].round(4)} %, f_v {100 * error[:, 1].round(3)} %", flush=True)
        error, sure = np.concatenate(errors), np.concatenate(claimed)
        good = np.all(np.isfinite(error), axis=1)
        within = np.abs(error[good]) < (0.01, 0.05)
        covered = np.abs(error[good]) < 2.0 * sure[good]
        print(f"{kind}: quiet {sum(quiet)} of {len(quiet)}, refused {sum(refused)}")
        near = [f"{100.0 * float(one):.1f} %" for one in (*within.mean(axis=0), *covered.mean(axis=0))]
        print(f"  of {int(good.sum())} joints f_c within 1 % {near[0]}, f_v within 5 % {near[1]}; ", end="")
        print(f"two standard errors cover {near[2]} and {near[3]}")
    return 0


def _errors(one: Clean, found: WholeArm) -> tuple[np.ndarray, np.ndarray]:
    """Errors and standard errors (7, 2) of Coulomb and viscous friction, shares of the true ones."""
    rows = [[(j.coulomb.value, j.coulomb.stderr), (j.viscous.value, j.viscous.stderr)] for j in found.joints]
    values = np.array([[[np.nan if x is None else x for x in p] for p in row] for row in rows], dtype=np.float64)
    truth = np.stack((one.plant.coulomb, one.plant.viscous), axis=1)
    return (values[:, :, 0] - truth) / truth, values[:, :, 1] / truth


def _line(found: WholeArm) -> str:
    said = [e.statement for j in found.joints for e in j.effects] + [e.statement for e in found.model]
    return " | ".join(said) or "quiet"


if __name__ == "__main__":
    sys.exit(main())
