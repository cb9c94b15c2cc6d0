"""Simulated logs of an SO-101's joints, goal and position at 30 and 50 Hz: are other motions foretold, is f_k right?

python -m benchmarks.servo_logs [--draws 40] [--seed 1]

The plant is that of the proof (harness.proof.paths), which shares no code with the fit: quantised encoder and duty, a
supply that sags, delays, friction by load or larger at rest in two thirds. Each joint is fitted on 40 s of leading and
run freely through 15 s of another motion. Foretold: rms error at most 1.3 times that of noise and quantisation alone.
f_k is asked within 6 % where the log's own standard error is at most 3 %; else the log must say that it is weak.
"""

import argparse
import math
import sys
from dataclasses import dataclass, replace

import numpy as np
from scipy.stats import binomtest

from harness.core.arrays import FloatArray
from harness.proof.paths import plant
from harness.proof.paths.forms import SERVO
from harness.proof.paths.joints import ROTOR
from harness.proof.paths.rigs import VOLTS, Rig, draw_rig, goals, spoiled
from harness.robot.servo.fit import Logs
from harness.robot.servo.plant import Run
from harness.robot.servo.presets import preset
from harness.robot.servo.servo import identified

RATES, FITTED, FORETOLD = (30.0, 50.0), 40.0, 15.0
GAIN, NEAR, FLOOR, TOLD = 16.0, 0.06, 1.3, 0.03
KINDS = ("plain", "rest", "load")


@dataclass(frozen=True)
class Joint:
    """rig : with goals of its own. p : what else its friction and its supply have. kind : of ``KINDS``."""

    rig: Rig
    p: FloatArray
    kind: str

    @classmethod
    def drawn(cls, rng: np.random.Generator, rate: float) -> "Joint":
        """About as an arm has them."""
        rig, p = replace(draw_rig(SERVO, rng), dt=1.0 / rate, every=round(1000.0 / rate)), np.zeros(plant.SIZE)
        p[plant.SAG], kind = rng.uniform(0.0, 0.05), KINDS[int(rng.integers(3))]
        if kind == "rest":
            p[plant.STRIBECK], p[plant.STRIBECK_V] = rng.uniform(0.2, 0.6) * rig.b[3], rng.uniform(0.05, 0.3)
        elif kind == "load":
            p[plant.GEAR], p[plant.GEAR_U] = rng.uniform(0.05, 0.2), 1e-3 * rig.b[2]
        return cls(rig, p, kind)

    def run(self, seconds: float, rng: np.random.Generator) -> tuple[Run, float]:
        """A log of another motion, and rms of the sensor's noise and steps in it, rad."""
        t = self.rig.dt * np.arange(round(seconds / self.rig.dt), dtype=np.float64)
        rig = replace(self.rig, drive=(goals(t, rng),))
        x = rig.run(self.p)[:, 0]
        seen = spoiled(rig, {"x": x}, rng)["x"]
        model = (1.0 - ROTOR) * rig.b[0], rig.b[2] * math.cos(rig.zero), -rig.b[2] * math.sin(rig.zero)
        run = Run(t, seen, rig.drive[0], np.full(t.size, VOLTS), np.ones(t.size), np.tile(model, (t.size, 1)), GAIN)
        return run, float(np.sqrt(np.mean((seen - x - rig.zero) ** 2)))


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
    ratios, plain, off, told = [], [], [], []
    for m in range(asked.draws):
        rate = RATES[m % 2]
        joint = Joint.drawn(rng, rate)
        fitted, (other, floor) = joint.run(FITTED, rng)[0], joint.run(FORETOLD, rng)
        found = identified([fitted], preset("sts3215"), loaded=True)
        best, logs, f_k = found.best, Logs.of([other], found.best.logs.known), float(joint.rig.b[3])
        ratios.append(best.under(logs).rms / floor)
        plain.append(found.found.base.under(logs).rms / floor)
        off.append(best.values["f_k"] / f_k - 1.0)
        told.append(best.errors["f_k"] <= TOLD * best.values["f_k"])
        names = ", ".join(step.term.name for step in found.found.steps) or "-"
        print(
            f"{m:3d} {rate:3.0f} Hz, floor {1e3 * floor:.2f} mrad: {1e3 * floor * plain[-1]:.2f} (x {plain[-1]:.2f})"
            f" by Coulomb alone, {1e3 * floor * ratios[-1]:.2f} (x {ratios[-1]:.2f}); f_k {100 * off[-1]:+.1f} %"
            f" {'told' if told[-1] else 'weak'}; friction {joint.kind}: {names}",
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
