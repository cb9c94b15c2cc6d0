"""python -m benchmarks.recordings bench|machines --out DIR --seed N ...: recordings of concealed effects, and answers.

bench: one effect, two, none or one of no catalogue on a slider. machines: one large effect in a crowd of small ones.
"""

import argparse
import json
import sys
import time
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor
from itertools import combinations
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.recordings.driven import DRIVEN
from harness.core.errors import HarnessError, InputError, SimulationError
from harness.proof.machines.kinds import FREE, Job, Kind
from harness.proof.machines.kinds import plan as plan_machines
from harness.proof.machines.made import made
from harness.proof.plant.cases import SETTINGS, csv_text, draw, truth
from harness.proof.plant.effects import ALIENS, KINDS, compatible

KINDS_OF_MACHINE = {**FREE, **DRIVEN}
Bench = tuple[tuple[str, ...], int, int, str, str]


def plan(kinds: Sequence[str], count: int, controls: int, pairs: int, aliens: int, seed: int) -> list[tuple[str, ...]]:
    """What each recording of a bench hides, in random order; () is a control."""
    rng = np.random.default_rng([seed, 0])
    jobs: list[tuple[str, ...]] = [(kind,) for kind in kinds for _ in range(count)]
    jobs += [()] * controls
    possible = [(a, b) for a, b in combinations(KINDS, 2) if compatible(a, b)]
    jobs += [possible[int(i)] for i in rng.choice(len(possible), pairs, replace=pairs > len(possible))]
    jobs += [(list(ALIENS)[i % len(ALIENS)],) for i in range(aliens)]
    return [jobs[int(i)] for i in rng.permutation(len(jobs))]


def chosen_kinds(names: Sequence[str]) -> list[Kind]:
    """Kinds of machine by name, "free" and "driven" for all of them. Raises InputError for one that is none."""
    found: dict[str, Kind] = {}
    for name in names:
        if name not in ("free", "driven", *KINDS_OF_MACHINE):
            raise InputError("--kind", name, f"free, driven or one of {', '.join(KINDS_OF_MACHINE)}")
        found |= {"free": FREE, "driven": DRIVEN}.get(name) or {name: KINDS_OF_MACHINE[name]}
    return list(found.values())


def on_a_bench(job: Bench) -> tuple[str, Mapping[str, Any]]:
    """A recording, and its answer."""
    kinds, seed, index, setting, noise = job
    kind = "control" if not kinds else kinds[0] if len(kinds) == 1 else kinds
    case = draw(kind, np.random.default_rng([seed, 1, index]), setting=setting, noise=noise)
    return csv_text(case), truth(case)


def of_a_machine(task: tuple[int, Job]) -> tuple[str, Mapping[str, Any]]:
    """A recording, and its answer."""
    found = made(*task)
    return found.recording, found.answer


def _one(task: tuple[Callable[[Any], tuple[str, Mapping[str, Any]]], Any]) -> tuple[str, Any, float]:
    """A recording and its answer, or "" and why there is none; the seconds of computing it took."""
    began = time.process_time()
    make, job = task
    try:
        return *make(job), time.process_time() - began
    except SimulationError as error:
        return "", str(error), time.process_time() - began


def main(argv: Sequence[str] | None = None) -> int:
    """Generate and write; exit code."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.recordings", description=__doc__)
    plants = parser.add_subparsers(dest="plant", required=True)
    bench, machines = plants.add_parser("bench"), plants.add_parser("machines")
    for one in (bench, machines):
        one.add_argument("--out", required=True, type=Path, help="folder, new or empty, for CSV files and truth.json")
        one.add_argument("--seed", required=True, type=int)
        one.add_argument("--jobs", type=int, default=2)
        one.add_argument("--controls", type=int, default=0, help="with nothing, or small effects alone")
    bench.add_argument("--count", type=int, default=1, help="recordings of each kind (default 1)")
    bench.add_argument("--kinds", nargs="*", default=list(KINDS), help="names; all of the catalogue when left out")
    bench.add_argument("--pairs", type=int, default=0)
    bench.add_argument("--aliens", type=int, default=0)
    bench.add_argument("--setting", choices=SETTINGS, default="decay")
    bench.add_argument("--noise", choices=("white", "coloured", "quantised", "mixed"), default="white")
    machines.add_argument("--count", type=int, default=0, help="recordings with a main effect of the catalogue")
    machines.add_argument("--unknown", type=int, default=0, help="with a main effect that no catalogue holds")
    machines.add_argument("--tables", type=int, default=0, help="with a static one that no catalogue holds")
    machines.add_argument("--kind", nargs="+", default=["free"], help="free (default), driven, or names of kinds")
    told = parser.parse_args(argv)
    try:
        return _generate(told)
    except HarnessError as error:
        print(error, file=sys.stderr)
        return error.exit_code


def _generate(told: argparse.Namespace) -> int:
    if told.out.exists() and any(told.out.iterdir()):
        raise InputError("--out", f"{told.out} holds something", "a new or empty folder")
    tasks: list[tuple[Callable[[Any], Any], Any]]
    if told.plant == "bench":
        hidden = plan(told.kinds, told.count, told.controls, told.pairs, told.aliens, told.seed)
        tasks = [(on_a_bench, (kinds, told.seed, i, told.setting, told.noise)) for i, kinds in enumerate(hidden)]
        what = [" + ".join(kinds) or "control" for kinds in hidden]
    else:
        kinds = chosen_kinds(told.kind)
        jobs = plan_machines(kinds, told.count, told.controls, told.unknown, told.tables, told.seed)
        tasks = [(of_a_machine, (told.seed, job)) for job in jobs]
        what = [f"{job.main or 'control'} on a {job.kind.name}" for job in jobs]
    told.out.mkdir(parents=True, exist_ok=True)
    answers: dict[str, Any] = {}
    seconds = []
    with ProcessPoolExecutor(max_workers=told.jobs) as pool:
        for i, (recording, answer, spent) in enumerate(pool.map(_one, tasks)):
            seconds.append(spent)
            if not recording:
                print(f"{what[i]}: {answer}", file=sys.stderr)
                continue
            (told.out / f"{i:03d}.csv").write_text(recording, encoding="utf-8")
            answers[f"{i:03d}.csv"] = answer
    beside = told.out / "truth.json.part"
    beside.write_text(json.dumps(answers, indent=1))
    beside.rename(told.out / "truth.json")
    mean, longest = sum(seconds) / max(1, len(seconds)), max(seconds, default=0.0)
    print(f"{len(answers)} of {len(tasks)} recordings in {told.out}, {mean:.2f} s each, {longest:.1f} s the longest")
    return 0 if len(answers) == len(tasks) else 1


if __name__ == "__main__":
    sys.exit(main())
