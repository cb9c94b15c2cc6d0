"""python -m harness.proof.machines --seed N --count K --out DIR: recordings of machines, and the answers."""

import argparse
import json
import sys
import time
from collections.abc import Sequence
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path
from typing import Any

from harness.core.errors import HarnessError, InputError, SimulationError
from harness.proof.machines.made import Made, made
from harness.proof.machines.plan import Job, chosen_kinds, plan


def _one(task: tuple[int, Job]) -> tuple[Made | None, str, float]:
    """A recording, or why there is none, and the seconds of computing it took."""
    began = time.process_time()
    try:
        found = made(*task)
    except SimulationError as error:
        return None, str(error), time.process_time() - began
    return found, "", time.process_time() - began


def main(argv: Sequence[str] | None = None) -> int:
    """Generate and write; exit code."""
    parser = argparse.ArgumentParser(prog="python -m harness.proof.machines", description="CSV files and truth.json")
    parser.add_argument("--out", required=True, type=Path, help="folder, new or empty, for CSV files and truth.json")
    parser.add_argument("--seed", required=True, type=int)
    parser.add_argument("--count", type=int, default=0, help="recordings with a main effect of the catalogue")
    parser.add_argument("--controls", type=int, default=0, help="with small effects alone")
    parser.add_argument("--unknown", type=int, default=0, help="with a main effect that no catalogue holds")
    parser.add_argument("--tables", type=int, default=0, help="with a static one that no catalogue holds")
    parser.add_argument("--kind", nargs="+", default=["free"], help="free (default), driven, or names of kinds")
    parser.add_argument("--jobs", type=int, default=2)
    told = parser.parse_args(argv)
    try:
        return _generate(told)
    except HarnessError as error:
        print(error, file=sys.stderr)
        return error.exit_code


def _generate(told: argparse.Namespace) -> int:
    if told.out.exists() and any(told.out.iterdir()):
        raise InputError("--out", f"{told.out} holds something", "a new or empty folder is accepted")
    jobs = plan(chosen_kinds(told.kind), told.count, told.controls, told.unknown, told.tables, told.seed)
    told.out.mkdir(parents=True, exist_ok=True)
    answers: dict[str, Any] = {}
    seconds = []
    with ProcessPoolExecutor(max_workers=told.jobs) as pool:
        for job, (found, why, spent) in zip(jobs, pool.map(_one, [(told.seed, job) for job in jobs]), strict=True):
            seconds.append(spent)
            if found is None:
                print(f"{job.main or 'control'} on a {job.kind}: {why}", file=sys.stderr)
                continue
            name = f"{job.index:03d}.csv"
            (told.out / name).write_text(found.recording, encoding="utf-8")
            answers[name] = found.answer
    beside = told.out / "truth.json.part"
    beside.write_text(json.dumps(answers, indent=1))
    beside.rename(told.out / "truth.json")
    mean, longest = sum(seconds) / max(1, len(seconds)), max(seconds, default=0.0)
    print(f"{len(answers)} of {len(jobs)} recordings in {told.out}, {mean:.2f} s each, {longest:.1f} s the longest")
    return 0 if len(answers) == len(jobs) else 1


if __name__ == "__main__":
    sys.exit(main())
