"""python -m harness.proof.plant --out DIR --seed N --count M: recordings with effects concealed, and the answers."""

import argparse
import json
import os
import sys
import time
from collections.abc import Sequence
from concurrent.futures import ProcessPoolExecutor
from itertools import combinations
from pathlib import Path
from typing import Any

import numpy as np

from harness.core.errors import HarnessError, InputError
from harness.proof.plant.cases import SETTINGS, draw, truth, write_csv
from harness.proof.plant.effects import ALIENS, KINDS, compatible

Job = tuple[str, tuple[str, ...], int, int, str, str]


def plan(kinds: Sequence[str], count: int, controls: int, pairs: int, aliens: int, seed: int) -> list[tuple[str, ...]]:
    """What each recording hides, in random order; () is a control."""
    rng = np.random.default_rng([seed, 0])
    jobs: list[tuple[str, ...]] = [(kind,) for kind in kinds for _ in range(count)]
    jobs += [()] * controls
    possible = [(a, b) for a, b in combinations(KINDS, 2) if compatible(a, b)]
    jobs += [possible[int(i)] for i in rng.choice(len(possible), pairs, replace=pairs > len(possible))]
    jobs += [(list(ALIENS)[i % len(ALIENS)],) for i in range(aliens)]
    order = rng.permutation(len(jobs))
    return [jobs[int(i)] for i in order]


def one(job: Job) -> tuple[str, dict[str, Any] | None, str, float]:
    """Draw one case and write its recording; the answer, or why there is none, and the seconds it took."""
    path, kinds, seed, index, setting, noise = job
    began = time.perf_counter()
    rng = np.random.default_rng([seed, 1, index])
    kind = "control" if not kinds else kinds[0] if len(kinds) == 1 else kinds
    try:
        case = draw(kind, rng, setting=setting, noise=noise)
    except HarnessError as error:
        return path, None, str(error), time.perf_counter() - began
    write_csv(case, Path(path))
    return path, truth(case), "", time.perf_counter() - began


def main(argv: Sequence[str] | None = None) -> int:
    """Run from the command line; the exit code."""
    parser = argparse.ArgumentParser(prog="python -m harness.proof.plant", description=__doc__)
    parser.add_argument("--out", required=True, type=Path, help="new folder for the recordings and truth.json")
    parser.add_argument("--seed", required=True, type=int)
    parser.add_argument("--count", type=int, default=1, help="recordings of each kind (default 1)")
    parser.add_argument("--kinds", nargs="*", default=list(KINDS), help="names; all of the catalogue when left out")
    parser.add_argument("--controls", type=int, default=0)
    parser.add_argument("--pairs", type=int, default=0)
    parser.add_argument("--aliens", type=int, default=0)
    parser.add_argument("--setting", choices=SETTINGS, default="decay")
    parser.add_argument("--noise", choices=("white", "coloured", "quantised", "mixed"), default="white")
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
    told.out.mkdir(parents=True, exist_ok=True)
    hidden = plan(told.kinds, told.count, told.controls, told.pairs, told.aliens, told.seed)
    jobs = [
        (str(told.out / f"{i:03d}.csv"), kinds, told.seed, i, told.setting, told.noise)
        for i, kinds in enumerate(hidden)
    ]
    answers: dict[str, Any] = {}
    failed, spent = 0, 0.0
    with ProcessPoolExecutor(max_workers=told.jobs) as pool:
        for (path, answer, why, seconds), kinds in zip(pool.map(one, jobs, chunksize=2), hidden, strict=True):
            spent += seconds
            if answer is None:
                failed += 1
                print(f"{' + '.join(kinds) or 'control'}: {why}", file=sys.stderr)
            else:
                answers[os.path.basename(path)] = answer
    beside = told.out / "truth.json.part"
    beside.write_text(json.dumps(answers, indent=1))
    beside.rename(told.out / "truth.json")
    print(f"{len(answers)} recordings in {told.out}, {failed} given up, {spent / max(1, len(jobs)):.2f} s each")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
