"""Simulated logs of an SO-101's joints, goal and position at 30 and 50 Hz: are other motions foretold, is f_k right?

python -m benchmarks.servo_logs [--draws 40] [--seed 1]

The plant is benchmarks.servo_logs.plant, which shares no code with the fit: quantised encoder and duty, a supply that
sags, delays, friction by load or larger at rest in two thirds. Each joint is fitted on 40 s of leading and run freely
through 15 s of another motion. Foretold: rms error at most 1.3 times that of noise and quantisation alone. f_k is asked
within 6 % where the log's own standard error is at most 3 %; else the log must say that it is weak.
"""

import argparse
import sys

import numpy as np
from scipy.stats import binomtest

from benchmarks.servo_logs.plant import Array, Joints, drawn, goals, moved
from harness.robot.servo.fit import Logs
from harness.robot.servo.plant import Run
from harness.robot.servo.presets import preset
from harness.robot.servo.servo import identified

RATES, FITTED, FORETOLD = (30.0, 50.0), 40.0, 15.0
GAIN, NEAR, FLOOR, TOLD = 16.0, 0.06, 1.3, 0.03
Moved = tuple[Array, Array, Array, Array]


def motion(joints: Joints, rate: float, seconds: float, rng: np.random.Generator) -> Moved:
    """t (n,), goals, logged and true positions (n, m)."""
    t = np.arange(0.0, seconds, 1.0 / rate)
    goal = goals(t, joints.f_k.size, rng)
    return t, goal, *moved(joints, t, goal, rng)


def run_of(joints: Joints, m: int, of: Moved) -> Run:
    """The log of one joint."""
    t, goal, seen, _ = of
    sine, cosine = joints.gravity[m] * np.cos(joints.rest[m]), -joints.gravity[m] * np.sin(joints.rest[m])
    load = np.tile((joints.inertia[m], sine, cosine), (t.size, 1))
    return Run(t, seen[:, m], goal[:, m], np.full(t.size, 7.4), np.ones(t.size), load, GAIN)


def counted(what: str, right: int, of: int) -> None:
    """Print a count with its interval."""
    low, high = binomtest(right, of).proportion_ci(0.95, "wilson") if of else (0.0, 1.0)
    share = 100.0 * right / max(of, 1)
    print(f"{what}: {right} of {of} ({share:.0f} %, 95 % interval {100.0 * low:.0f} to {100.0 * high:.0f} %)")


def main(words: list[str]) -> int:
    """Print a row a joint, then the counts; 0 where 80 % are foretold and every f_k that is told is right."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--draws", type=int, default=40)
    parser.add_argument("--seed", type=int, default=1)
    asked = parser.parse_args(words)
    rng = np.random.default_rng(asked.seed)
    joints = drawn(asked.draws, rng)
    of = {rate: (motion(joints, rate, FITTED, rng), motion(joints, rate, FORETOLD, rng)) for rate in RATES}
    ratios, plain, off, told = [], [], [], []
    for m in range(asked.draws):
        rate = RATES[m % 2]
        fitted, other = of[rate]
        found = identified([run_of(joints, m, fitted)], preset("sts3215"), loaded=True)
        best, logs = found.best, Logs.of([run_of(joints, m, other)], found.best.logs.known)
        floor = float(np.sqrt(np.mean((other[2][:, m] - other[3][:, m]) ** 2)))
        ratios.append(best.under(logs).rms / floor)
        plain.append(found.found.base.under(logs).rms / floor)
        off.append(best.values["f_k"] / joints.f_k[m] - 1.0)
        told.append(best.errors["f_k"] <= TOLD * best.values["f_k"])
        kind = "load" if joints.load[m] else "rest" if joints.f_s[m] > joints.f_k[m] else "plain"
        names = ", ".join(step.term.name for step in found.found.steps) or "-"
        print(
            f"{m:3d} {rate:3.0f} Hz, floor {1e3 * floor:.2f} mrad: {1e3 * floor * plain[-1]:.2f} (x {plain[-1]:.2f})"
            f" by Coulomb alone, {1e3 * floor * ratios[-1]:.2f} (x {ratios[-1]:.2f}); f_k {100 * off[-1]:+.1f} %"
            f" {'told' if told[-1] else 'weak'}; friction {kind}: {names}",
            flush=True,
        )
    near = [abs(one) <= NEAR for one, sure in zip(off, told, strict=True) if sure]
    counted("foretold within 1.3 of the floor", sum(x <= FLOOR for x in ratios), len(ratios))
    counted("by torque, damping and Coulomb friction alone", sum(x <= FLOOR for x in plain), len(plain))
    counted("f_k within 6 % where it is told", sum(near), len(near))
    print(f"f_k said to be weak: {len(told) - len(near)}; seed {asked.seed}")
    return 0 if sum(x <= FLOOR for x in ratios) >= 0.8 * len(ratios) and all(near) else 1


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
