"""A servo's pendulum (Rhoban/bam, XL330 with 0.49 kg at 0.1 m): fitted on three gains, run freely on the fourth.

python -m benchmarks.servo_logs.pendulum DIR [--test 200]

DIR holds BAM's logs as JSON. The servo's gain is known (its logged duty over the error of position), the load from
mass and length; everything else is fitted. Figures are mean absolute errors of position, mrad, of whole logs from their
first sample on. What is printed beside each law is of nested models, each refitted.
"""

import argparse
import json
import sys
from pathlib import Path

import numpy as np

from harness.robot.servo.fit import Logs, ServoFit
from harness.robot.servo.plant import Run
from harness.robot.servo.presets import preset
from harness.robot.servo.servo import averaged, identified

_G = 9.80665


def read(path: Path) -> tuple[Run, str]:
    """A log of BAM, and what it is a trajectory of."""
    held = json.loads(path.read_text(encoding="utf-8"))
    names = ("timestamp", "position", "goal_position", "input_volts", "torque_enable")
    t, q, goal, volts, on = np.array([[float(row[name]) for name in names] for row in held["entries"]]).T.copy()
    mass, length = held["mass"], held["length"]
    load = np.tile((mass * length**2, mass * _G * length, 0.0), (t.size, 1))
    return Run(t, q, goal, averaged(t, volts), on, load, float(held["kp"]), str(path)), held["trajectory"]


def by_log(found: ServoFit) -> list[float]:
    """Mean absolute error of each log, mrad."""
    return [1e3 * float(np.mean(np.abs(part))) for part in found.logs.split(found.residual)]


def main(words: list[str]) -> int:
    """Print the table; 0 where the error is at most 33 mrad."""
    parser = argparse.ArgumentParser()
    parser.add_argument("folder", type=Path)
    parser.add_argument("--test", type=float, default=200.0)
    asked = parser.parse_args(words)
    logs = [read(path) for path in sorted(asked.folder.glob("*.json"))]
    ours = identified([run for run, _ in logs if run.kp != asked.test], preset("xl330"), loaded=True)
    tests = [(run, name) for run, name in logs if run.kp == asked.test]
    others = Logs.of([run for run, _ in tests], ours.best.logs.known)
    fits = [("Coulomb and viscous", ours.found.base), *((f"+ {s.term.name}", s.found) for s in ours.found.steps)]
    print(f"{'law':28s} {'fitted':>7s} {'free run':>8s}  " + "  ".join(f"{name:>15s}" for _, name in tests))
    for name, found in fits:
        run = found.under(others)
        print(
            f"{name:28s} {1e3 * found.mae:7.1f} {1e3 * run.mae:8.1f}  " + "  ".join(f"{x:15.1f}" for x in by_log(run))
        )
    for step in ours.found.steps:
        out = f"{1e3 * step.held_out[0]:.1f} to {1e3 * step.held_out[1]:.1f} mrad"
        ties = ", ".join(f"{name} (by {worse:.1f})" for name, worse in step.rivals.items()) or "none"
        print(f"{step.term.name}: evidence {step.gain:.1f}, gains held out {out}; not ruled out in its place: {ties}")
    best = ours.best
    for name, value in best.values.items():
        print(f"{name:12s} {value:10.5g} +- {best.errors[name]:.2g}")
    return 0 if best.under(others).mae <= 0.033 else 1


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
