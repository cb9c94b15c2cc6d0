"""``python -m benchmarks.draws KIND --draws N --seed S``: fresh draws, how many answers are right, which are not.

KIND: pairs (two effects that hide in a free decay), sensor-pairs (one of them a sensor's), sensor-shapes (a curved
scale or gravity, in a free decay), bench (one effect, or none), path:NAME (a way of the proof on all ways: effects in
other forms, and none), simulations (a right simulation by MuJoCo beside a recording), wrong-simulations (one
parameter of it is wrong), FAULT:COMMAND (a recording at rest, or with a fault that is to be told, by each command),
whole (recordings against which nothing is to be said), faster (a simulation whose frequency is off), drifting-clock,
misfit (identify of a hidden law), undamped (identify of nearly no damping), layouts (files of loggers), goals (a
commanded position in one), still (an axis at rest most of the time, slowly and irregularly sampled), wrapped (an
angle within a turn), loads (an arm that carries a load unsaid), motions (of ten kinds), run-downs (an effect hidden
in one), run-down-controls (none), run-downs-both-ways (a push, or none), slips (a robot's joint that sticks), pastes
(what is pasted of one that swings), and files of engines by name (cap-rk4 and others: a joint of a file as it is).
"""

import argparse
import sys
import time
from collections.abc import Sequence
from functools import partial

from benchmarks.draws import (
    bench,
    engine_cases,
    faults,
    layouts,
    logs,
    motions,
    pairs,
    paths,
    rates,
    robot_joints,
    run_downs,
    shapes,
    simulations,
)
from benchmarks.draws.shared import Draw, interval
from harness.core.errors import SimulationError

KINDS: dict[str, Draw] = {
    "pairs": partial(pairs.answer, sensor=False),
    "sensor-pairs": partial(pairs.answer, sensor=True),
    "sensor-shapes": shapes.answer,
    "bench": bench.answer,
    "simulations": partial(simulations.answer, wrong=False),
    "wrong-simulations": partial(simulations.answer, wrong=True),
    "whole": faults.whole,
    "faster": rates.faster,
    "drifting-clock": rates.drifting_clock,
    "misfit": rates.misfit,
    "undamped": rates.undamped,
    "layouts": layouts.answer,
    "goals": layouts.goals,
    "motions": motions.answer,
    **{
        f"{fault}:{command}": partial(faults.answer, fault=fault, command=command)
        for fault in faults.FAULTS
        for command in faults.COMMANDS
    },
    "still": logs.still,
    "wrapped": logs.wrapped,
    "loads": logs.loads,
    **{f"path:{name}": partial(paths.answer, path=path) for name, path in paths.NAMES.items()},
    "run-downs": run_downs.named,
    "run-down-controls": run_downs.controls,
    "run-downs-both-ways": run_downs.both_ways,
    "slips": robot_joints.slips,
    "pastes": robot_joints.pastes,
    **{kind: partial(engine_cases.answer, kind=kind) for kind in engine_cases.KINDS},
}


def main(argv: Sequence[str] | None = None) -> int:
    """Draw, ask and print; exit code."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.draws", description=__doc__)
    parser.add_argument("kind", choices=KINDS)
    parser.add_argument("--draws", type=int, default=20)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--seed", type=int, default=1)
    told = parser.parse_args(argv)
    right, asked, longest = 0, 0, 0.0
    for number in range(told.first, told.first + told.draws):
        began = time.process_time()
        try:
            one = KINDS[told.kind](told.seed, number)
        except SimulationError as none:
            print(f"{number:4d} given up: {none}", flush=True)
            continue
        took = time.process_time() - began
        right, asked, longest = right + one.right, asked + 1, max(longest, took)
        print(f"{number:4d} {'ok   ' if one.right else 'WRONG'} {took:5.1f} s  {one.said}", flush=True)
    low, high = interval(right, asked)
    rate = f"{right} of {asked} right ({low:.0%} to {high:.0%})"
    print(f"{told.kind}, seed {told.seed}: {rate}; slowest {longest:.0f} s")
    return 0


if __name__ == "__main__":
    sys.exit(main())
