"""Sweeps: rows on disk as they come, resumed, interrupted, damaged, and with workers that die."""

import json
import math
import signal
import subprocess
import sys
import threading
import time
from collections import Counter
from collections.abc import Iterator, Sequence
from concurrent.futures import Future
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any, ClassVar, final

import numpy as np
import pytest
import sweep_deaths
from dask_cluster import two_workers
from jsonschema import Draft202012Validator
from killing import stopped

import harness
from harness.app.shared.rows import Cluster, LocalPool, completed
from harness.app.sweep import sweep as room
from harness.app.sweep.parts import Parts, computed, failed_row
from harness.app.sweep.sweep import SweepOptions, sweep
from harness.cli.main import run
from harness.core.errors import HarnessError, NoDeviceError, SimulationError, StoreError
from harness.core.trajectory import Source, Trajectory
from harness.core.writing import explained
from harness.engines import registry
from harness.engines.base import Engine, Preset, Route, Task
from harness.fidelity.row import repeats, run_rows, succeeded, task
from harness.results.generate import schema_text
from harness.results.sweep import SweepResult, SweepRow

PRESETS = ("as-shipped", "tuned", "undamped")
SMALL = SweepOptions(("mujoco", "pybullet"), ("joint",), PRESETS, (2e-3,), jobs=2)
"""Settings of the joint route at one step, what ships at its own step too."""


def rows_of(folder: Path) -> list[dict[str, Any]]:
    return list(Parts(folder).read())


def physics(rows: list[dict[str, Any]]) -> dict[str, Any]:
    """What has to be the same whoever computed it."""
    return {row["key"]: (row["name"], row["metrics"], row["exact"], row["settings"], row["error"]) for row in rows}


@pytest.fixture(scope="module")
def swept(pybullet: None, tmp_path_factory: pytest.TempPathFactory) -> room.Sweep:
    return sweep(replace(SMALL, jobs=1), tmp_path_factory.mktemp("sweep") / "out")


def test_every_row_once_and_all_of_them_right(swept: room.Sweep) -> None:
    engines = room.engines_for(SMALL)
    expected = [spec.key for spec in SMALL.matrix.specs(engines)]
    rows = list(swept.rows())
    assert sorted(row["key"] for row in rows) == sorted(expected)
    assert (swept.total, swept.computed, swept.failed) == (len(expected), len(expected), 0)
    assert len(expected) == SMALL.matrix.size(engines)
    for row in rows:
        SweepRow.model_validate(row)


@final
class AtOnce(Engine):
    """Runs many at once, if it ran at all."""

    name: ClassVar[str] = "mujoco"
    package: ClassVar[str] = "mujoco"
    batches: ClassVar[bool] = True

    def presets(self, route: Route, preset: Preset, dt: float | None = None) -> dict[str, Any]:
        return {}

    def simulate(self, task: Task) -> Trajectory:
        raise SimulationError("never")


@final
class Forgetful(Engine):
    """Gives each run another place, and each world of a batch."""

    name: ClassVar[str] = "mujoco"
    package: ClassVar[str] = "mujoco"
    batches: ClassVar[bool] = True
    runs = 0

    def __init__(self, batch: HarnessError | None = None, gpu: HarnessError | None = None) -> None:
        self.batch, self.gpu = batch, gpu

    def presets(self, route: Route, preset: Preset, dt: float | None = None) -> dict[str, Any]:
        return {}

    def simulate(self, task: Task) -> Trajectory:
        if self.gpu is not None and task.settings.get("device") == "gpu":
            raise self.gpu
        t = np.linspace(0.0, 1.0, 5)
        Forgetful.runs += 1
        return Trajectory(t, t + 1e-3 * self.runs, t, t, Source("forgetful", "tuned", settings={"device": "cpu"}))

    def simulate_all(self, tasks: Sequence[Task]) -> list[Trajectory | HarnessError]:
        found = super().simulate_all(tasks)
        return found if self.batch is None else [*found[1:], self.batch]


def test_what_does_not_repeat_itself_is_told_between_runs_worlds_and_devices() -> None:
    spec = next(one for one in SMALL.matrix.specs({"mujoco": registry.load("mujoco")}) if one.repeats)
    asked = task(registry.load("mujoco"), spec)
    found = repeats(Forgetful(), asked, Forgetful().simulate(asked))
    assert found.apart_m == pytest.approx({"runs": 1e-3, "worlds": 15e-3, "devices": 18e-3})
    assert found.failed == {}
    for other in (replace(spec, draw=1), replace(spec, preset="stiff"), replace(spec, changed=(("dt", 1.0),))):
        assert not other.repeats


def test_what_fails_when_it_is_run_again_is_told_and_a_device_that_is_not_here_is_no_failure(tmp_path: Path) -> None:
    spec = next(one for one in SMALL.matrix.specs({"mujoco": registry.load("mujoco")}) if one.repeats)
    asked = task(registry.load("mujoco"), spec)
    engine = Forgetful(batch=SimulationError("diverged"), gpu=NoDeviceError("no gpu"))
    found = repeats(engine, asked, engine.simulate(asked))
    assert (list(found.apart_m), found.failed) == (["runs"], {"worlds": "diverged"})
    row = succeeded(spec, engine.simulate(asked), {}, found).model_dump()
    parts = Parts(tmp_path)
    parts.write([row, row | {"not_again": None}])
    assert [one["not_again"] for one in parts.read()] == [{"worlds": "diverged"}, None]


def test_rows_that_differ_in_their_slider_alone_go_together_to_an_engine_that_runs_many_at_once() -> None:
    for engine, sizes in ((AtOnce(), {3}), (registry.load("mujoco"), {1})):
        options = SweepOptions(("mujoco",), ("joint",), short=True, sliders=2)
        specs = list(options.matrix.specs({"mujoco": engine}))
        bundles = list(room.bundled(iter(specs), {"mujoco": engine}, options))
        assert {len(bundle.specs) for bundle in bundles} == sizes
        assert Counter(spec.key for bundle in bundles for spec in bundle.specs) == Counter(spec.key for spec in specs)
        for bundle in bundles:
            assert len({replace(spec, draw=0, scenario=specs[0].scenario).name for spec in bundle.specs}) == 1
            assert len({spec.scenario.name for spec in bundle.specs}) == 1


def test_what_fails_at_once_is_a_row_that_says_so() -> None:
    options = SweepOptions(("mujoco",), ("joint",), short=True, sliders=2)
    bundle = next(room.bundled(options.matrix.specs({"mujoco": AtOnce()}), {"mujoco": AtOnce()}, options))
    assert [row.error for row in run_rows(AtOnce(), bundle.specs)] == ["never"] * 3
    rows = computed(bundle)
    assert [row["key"] for row in rows] == [spec.key for spec in bundle.specs]
    assert all(row["error"] is None for row in rows)


def test_json_is_streamed_and_obeys_the_schema(swept: room.Sweep) -> None:
    data = json.loads("".join(swept.json()))
    schema = json.loads(schema_text("harness.sweep/1", SweepResult))
    Draft202012Validator(schema).validate(data)
    assert len(data["rows"]) == swept.total
    SweepResult.model_validate(data)


def test_a_program_gets_rows_and_page_and_no_folder() -> None:
    found = harness.sweep(engines=["mujoco"], routes=["joint"], presets=["tuned"], steps=[1e-2], jobs=1)
    assert {row.preset for row in found.rows} == {"tuned"}
    assert all(row.error is None for row in found.rows)
    assert found.files == {}
    assert found.plots
    assert "<iframe" in found._repr_html_()


def test_nothing_is_computed_again(swept: room.Sweep) -> None:
    before = physics(rows_of(swept.folder))
    again = sweep(
        SweepOptions(SMALL.engines, SMALL.routes, SMALL.presets, SMALL.steps, jobs=1, resume=True), swept.folder
    )
    assert again.computed == 0
    assert physics(rows_of(swept.folder)) == before


def test_a_damaged_part_is_set_aside_and_only_its_rows_are_computed_again(swept: room.Sweep, tmp_path: Path) -> None:
    folder = tmp_path / "copy"
    parts = Parts(folder)
    rows = list(swept.rows())
    parts.write(rows[:5])
    parts.write(rows[5:])
    damaged = sorted(parts.folder.glob("part-*.parquet"))[0]
    content = bytearray(damaged.read_bytes())
    middle = len(content) // 3
    content[middle : middle + 40] = bytes(40)
    damaged.write_bytes(bytes(content))
    again = sweep(SweepOptions(SMALL.engines, SMALL.routes, SMALL.presets, SMALL.steps, jobs=1, resume=True), folder)
    assert again.computed == 5
    assert again.notes == (
        "rows/part-000001.parquet was damaged and set aside as part-000001.parquet.damaged;"
        " its rows are computed again",
    )
    assert physics(rows_of(folder)) == physics(rows)


@pytest.mark.parametrize("how", [signal.SIGINT, signal.SIGKILL])
def test_a_stopped_sweep_goes_on_to_the_same_rows(how: signal.Signals, swept: room.Sweep, tmp_path: Path) -> None:
    """By the command, which says how to go on where it can."""
    folder = tmp_path / "out"
    presets = " ".join(f"--preset {name}" for name in PRESETS if name != "undamped")
    line = f"sweep --engine mujoco --route joint {presets} --dt 0.002 --jobs 1 --quiet --out {folder}"
    code, out, said = stopped(line.split(), tmp_path, "out/rows/part-*.parquet", how)
    alone = physics([row for row in swept.rows() if row["engine"] == "mujoco"])
    kept = rows_of(folder)
    assert 0 < len(kept) < len(alone)
    assert not (folder / "result.json").exists()
    assert (code, out) == (130 if how is signal.SIGINT else -how, "")
    if how is signal.SIGINT:
        assert f"{len(kept)} of {len(alone)} rows are kept. Try: harness sweep --engine mujoco " in said
        assert f" --quiet --resume --out {folder}\n" in said
        assert not list(folder.glob("rows/.*"))
    assert run([*line.split(), "--resume"]) == 0
    rows = rows_of(folder)
    assert rows[: len(kept)] == kept  # with the seconds they took: they are not computed again
    assert physics(rows) == alone
    assert not list(folder.rglob("*.partial"))
    SweepResult.model_validate_json((folder / "result.json").read_text())


@pytest.mark.parametrize("content", [b"", b"PAR1", b"nothing like it" * 100])
def test_what_is_no_part_is_set_aside(content: bytes, tmp_path: Path) -> None:
    parts = Parts(tmp_path)
    (parts.folder / "part-000001.parquet").write_bytes(content)
    assert list(parts.read()) == []
    assert parts.damaged == ["part-000001.parquet"]
    parts.write([sweep_deaths.light(sweep_deaths.spec(1))])
    assert len(list(parts.read())) == 1


def test_a_row_that_kills_its_worker_is_found_and_the_others_lose_nothing() -> None:
    specs = [sweep_deaths.spec(n, sweep_deaths.KILLER if n == 7 else "tuned") for n in range(24)]
    workers = LocalPool(2)
    try:
        rows = list(completed(specs, workers, sweep_deaths.light, failed_row))
    finally:
        workers.close()
    assert Counter(row["key"] for row in rows) == Counter(spec.key for spec in specs)
    reasons = {row["key"]: row["error"] for row in rows}
    for spec in specs:
        died = spec.preset == sweep_deaths.KILLER
        assert reasons[spec.key] == ("its worker process died, 2 times out of 2" if died else "light")


def test_a_pool_that_is_let_go_has_no_thread_left_that_closes_its_pipes_at_exit() -> None:
    before = set(threading.enumerate())
    workers = LocalPool(2)
    work = [workers.executor.submit(time.sleep, 0.2) for _ in range(50)]
    work[0].result()
    workers.close()
    assert set(threading.enumerate()) <= before


class Deserted:
    """A client of a scheduler without workers, or one whose workers left after the first look."""

    status = "running"

    def __init__(self, *looks: dict[str, int]) -> None:
        self.looks = list(looks)

    def nthreads(self) -> dict[str, int]:
        return self.looks.pop(0) if self.looks else {}

    def get_executor(self, **options: object) -> "Deserted":
        return self

    def submit(self, *work: object) -> "Future[dict[str, object]]":
        return Future()

    def shutdown(self, **options: object) -> None: ...

    def close(self, **options: object) -> None: ...


@pytest.mark.parametrize("looks", [(), ({"worker": 1},)])
def test_a_cluster_without_workers_is_not_waited_for_without_end(
    looks: tuple[dict[str, int], ...], monkeypatch: pytest.MonkeyPatch
) -> None:
    there = SimpleNamespace(Client=lambda *address, **options: Deserted(*looks))
    monkeypatch.setitem(sys.modules, "distributed", there)
    monkeypatch.setattr("harness.app.shared.rows.WORKERLESS_S", 0.05)
    monkeypatch.setattr("harness.app.shared.rows.LOOK_S", 0.02)
    with pytest.raises(HarnessError, match=r"tcp://far:1: no worker .*dask worker tcp://far:1"):
        list(completed([sweep_deaths.spec(1)], Cluster("tcp://far:1"), sweep_deaths.light, failed_row))


def test_a_full_disk_keeps_what_was_done(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    written: list[int] = []
    write = Parts.write

    def until_full(self: Parts, rows: list[dict[str, Any]]) -> None:
        if written:
            with explained(self.folder):
                raise OSError(28, "No space left on device")
        write(self, rows)
        written.append(len(rows))

    monkeypatch.setattr(Parts, "write", until_full)
    monkeypatch.setattr(room, "PART_ROWS", 10)
    monkeypatch.setattr(room, "PART_S", math.inf)
    options = SweepOptions(("mujoco",), ("joint",), ("as-shipped",), (2e-3,), jobs=1)
    with pytest.raises(
        StoreError, match=r"no space left on the device.*; 10 of \d+ rows are kept. Try: --resume --out"
    ):
        sweep(options, tmp_path / "out")
    monkeypatch.undo()
    assert len(rows_of(tmp_path / "out")) == 10


def test_a_scheduler_that_does_not_answer_is_said() -> None:
    with pytest.raises(HarnessError, match="no scheduler answers"):
        Cluster("tcp://127.0.0.1:9", timeout_s=0.2)


# ---- on a cluster


@pytest.fixture(scope="module")
def cluster() -> Iterator[tuple[str, list["subprocess.Popen[str]"]]]:
    """Two worker processes of one thread on this machine."""
    with two_workers() as (address, processes):
        yield address, processes


@pytest.mark.usefixtures("pybullet")
def test_a_cluster_gives_the_same_rows_though_a_worker_is_killed(
    cluster: tuple[str, list["subprocess.Popen[str]"]], tmp_path: Path, swept: room.Sweep
) -> None:
    address, processes = cluster
    killed: list[int] = []

    def kill_one(step: str, done: int, total: int) -> None:
        if done >= 10 and not killed:
            killed.append(processes[1].pid)
            processes[1].kill()

    options = SweepOptions(("mujoco",), SMALL.routes, ("as-shipped",), SMALL.steps, cluster=address)
    result = sweep(options, tmp_path / "out", kill_one, function=sweep_deaths.slow)
    assert killed
    keys = Counter(row["key"] for row in result.rows())
    assert set(keys.values()) == {1}
    alone = physics(list(swept.rows()))
    assert physics(rows_of(result.folder)) == {key: alone[key] for key in keys}


@pytest.mark.usefixtures("pybullet")
def test_a_lost_scheduler_leaves_a_folder_to_resume(
    cluster: tuple[str, list["subprocess.Popen[str]"]], tmp_path: Path
) -> None:
    address, processes = cluster

    def kill_scheduler(step: str, done: int, total: int) -> None:
        if done == 10:
            processes[0].kill()

    options = SweepOptions(SMALL.engines, SMALL.routes, SMALL.presets, SMALL.steps, cluster=address)
    with pytest.raises(HarnessError, match=r"connection to the scheduler is lost; \d+ of \d+ rows are kept"):
        sweep(options, tmp_path / "out", kill_scheduler, function=sweep_deaths.slow)
    assert len(rows_of(tmp_path / "out")) >= 10
