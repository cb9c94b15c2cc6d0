"""Commands killed at moments drawn at random: nothing half-written reads as done, and resuming ends as ever."""

import json
import random
import shutil
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from killing import ended, killed

from harness.app.prove.verify import verify_proof
from harness.app.sweep.parts import Parts
from harness.core.errors import HarnessError
from harness.core.scenario import FREE_DECAY
from harness.exact.decay import free_decay
from harness.results.diagnosis import DiagnosisResult
from harness.results.run import RunResult


def of_run(folder: Path) -> Any:
    """What a run found; its folder is there as a whole or not at all."""
    result = RunResult.model_validate_json((folder / "result.json").read_text())
    assert all(Path(path).exists() for path in result.files.values())
    return [(trace.source, trace.metrics, trace.estimates) for trace in result.traces]


def of_diagnose(folder: Path) -> Any:
    """What is said of each recording that has a result."""
    found = {}
    for one in sorted(entry for entry in folder.iterdir() if entry.is_dir() and not entry.name.startswith(".")):
        if any(one.iterdir()):  # an empty one is reserved, and nothing in it reads as a result
            result = DiagnosisResult.model_validate_json((one / "result.json").read_text())
            assert all(Path(path).exists() for path in result.files.values())
            found[one.name] = result.model_dump(exclude={"machine", "command", "files", "seconds", "timing"})
    if (folder / "result.json").exists():
        assert len(json.loads((folder / "result.json").read_text())) == len(found)
    return found


def of_sweep(folder: Path) -> Any:
    """Rows by key, without times."""
    parts = Parts(folder)
    rows = {row["key"]: (row["name"], row["metrics"], row["settings"], row["error"]) for row in parts.read()}
    assert parts.damaged == []
    if (folder / "result.json").exists():
        assert {row["key"] for row in json.loads((folder / "result.json").read_text())["rows"]} == set(rows)
    return rows


def of_prove(folder: Path) -> Any:
    """Whether it holds; a proof that is not finished is refused, and one that is was not changed."""
    assert verify_proof(folder, short=True, jobs=1).accepted
    assert not (folder / "secret").exists()
    return json.loads((folder / "result.json").read_text())["sizes"]


@dataclass(frozen=True, slots=True)
class Case:
    """A command; ``resumes`` as it is called to go on, None where there is nothing to go on with."""

    line: tuple[str, ...]
    resumes: tuple[str, ...] | None
    read: Callable[[Path], Any]


DIAGNOSE = ("diagnose", "d0.csv", "d1.csv", "--engine", "mujoco", "--jobs", "2", "--quiet", "--out", "out")
ONE_STEP = ("--engine", "mujoco", "--route", "joint", "--preset", "tuned", "--dt", "0.004")
SWEEP = ("sweep", *ONE_STEP, "--jobs", "1", "--quiet", "--out", "out")
PROVE = ("prove", "--singles", "1", "--controls", "1", "--pairs", "0", "--outside", "0", "--quiet", "--out", "out")
CASES = {
    "run": Case(("run", "--engine", "mujoco", "--preset", "tuned", "--quiet", "--out", "out"), None, of_run),
    "sweep": Case(SWEEP, (*SWEEP, "--resume"), of_sweep),
    "diagnose": Case(DIAGNOSE, (*DIAGNOSE, "--resume"), of_diagnose),
    "prove": Case(PROVE, ("prove", "--resume", "--quiet", "--out", "out"), of_prove),
}


def recordings(place: Path) -> None:
    t = np.arange(150, dtype=np.float64) * 0.02
    x = free_decay(FREE_DECAY, t).x
    for i in range(2):
        noise = 1e-3 * np.random.default_rng(i).normal(size=t.size)
        np.savetxt(place / f"d{i}.csv", np.column_stack([t, x + noise]), "%.9g", ",", header="t,x", comments="")


def looked_at(case: Case, folder: Path) -> None:
    """What a command that was killed has left is no result, or a whole one."""
    if not folder.is_dir() or not any(folder.iterdir()):
        return
    if case.resumes is None:
        case.read(folder)
        return
    try:
        case.read(folder)
    except HarnessError:
        assert case.read is of_prove  # said in one line to be unfinished


def gone_on_with(case: Case, place: Path) -> None:
    """The command again, as somebody would call it who finds what is left."""
    if case.resumes is None:
        if not (place / "out" / "result.json").exists():
            assert ended(case.line, place) == (0, "", "")
        return
    code, _, said = ended(case.resumes, place)
    if code == 2:  # killed before anything was begun
        assert said.count("\n") == 1
        assert "to resume" in said
        code, _, said = ended(case.line, place)
    assert (code, said) == (0, "")


def partial(folder: Path) -> list[str]:
    return sorted(str(path.relative_to(folder)) for path in folder.rglob("*.partial"))


@pytest.mark.full
@pytest.mark.parametrize("name", CASES)
def test_commands_that_are_killed_ten_times(name: str, tmp_path: Path) -> None:
    case, chance, times, place = CASES[name], random.Random(17), 10, tmp_path
    recordings(place)
    began = time.monotonic()
    assert ended(case.line, place) == (0, "", "")
    lasts = time.monotonic() - began
    undisturbed = case.read(place / "out")
    shutil.rmtree(place / "out")
    at_work = 0
    for _ in range(times):
        at_work += killed(case.line, place, chance.uniform(0.0, lasts))
        looked_at(case, place / "out")
        gone_on_with(case, place)
        assert case.read(place / "out") == undisturbed
        assert partial(place) == []
        shutil.rmtree(place / "out")
    assert at_work >= times // 2
