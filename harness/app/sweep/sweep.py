"""The friction-fidelity matrix: computed row by row, kept as it comes, resumed where it was left."""

import json
import logging
import time
from collections.abc import Callable, Iterator, Mapping
from contextlib import nullcontext
from dataclasses import dataclass
from functools import partial
from itertools import chain
from pathlib import Path
from typing import Any

from harness.app.shared.machine import this_machine
from harness.app.shared.progress import NAME as LOG
from harness.app.shared.progress import SILENT, Progress, journal
from harness.app.shared.rows import folder_of, resumable, worked
from harness.app.sweep.parts import Parts, check_new, compute, computed, lost
from harness.core.checks import positive
from harness.core.errors import HarnessError, InputError, SimulationError, StoreError
from harness.engines import registry
from harness.engines.base import ROUTES, Engine, choice
from harness.fidelity.compare import Ladder
from harness.fidelity.matrix import Matrix, preset_names
from harness.fidelity.row import Bundle, Spec
from harness.fidelity.select import Selection
from harness.io.store import held
from harness.results.common import Machine
from harness.results.sweep import Convergence, SweepRow

LOGGER = logging.getLogger(__name__)

PART_ROWS, PART_S = 64, 5.0
"""A part is written after so many rows, or so many seconds, whichever comes first."""
BATCH = 256
"""Sliders that an engine is given at once, at most."""
RESULT, PAGE, TRACES = "result.json", "report.html", "traces"

Compute = Callable[[Spec], dict[str, Any]]


@dataclass(frozen=True, slots=True)
class SweepOptions:
    """What to sweep and with what.

    engines : names, empty for all that are installed. routes : empty for all. presets, steps (s), short, sliders : as
    in Matrix.
    jobs : local processes, None for one a core. cluster : address of a dask scheduler, None for the local pool.
    keep : how many of the worst rows to keep as traces. resume : go on with the rows a folder holds.
    only, skip, xfail : patterns of rows, as in Selection.

    Raises InputError for what does not exist.
    """

    engines: tuple[str, ...] = ()
    routes: tuple[str, ...] = ()
    presets: tuple[str, ...] = ()
    steps: tuple[float, ...] = ()
    short: bool = False
    sliders: int = 0
    jobs: int | None = None
    cluster: str | None = None
    keep: int = 0
    resume: bool = False
    only: tuple[str, ...] = ()
    skip: tuple[str, ...] = ()
    xfail: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        for step in self.steps:
            positive("--dt", step, "s")
        for name in self.engines:
            registry.check(name, "--engine")
        for route in self.routes:
            choice("--route", route, ROUTES)

    @property
    def matrix(self) -> Matrix:
        routes = tuple(route for route in ROUTES if not self.routes or route in self.routes)
        return Matrix(routes, self.presets, self.steps, self.short, self.sliders, self.rows)

    @property
    def whole(self) -> bool:
        """Whether patterns choose from all rows of an engine."""
        return not (self.routes or self.presets or self.steps or self.short)

    @property
    def rows(self) -> Selection:
        """Rows that are run, skipped and known to fail."""
        return Selection.of(self.only, self.skip, self.xfail)


@dataclass(frozen=True, slots=True)
class Sweep:
    """A finished sweep: rows stay on disk and are read when asked for.

    folder : where everything is. total : rows. computed : those of this call. failed : rows with an error.
    """

    folder: Path
    machine: Machine
    command: str
    notes: tuple[str, ...]
    total: int
    computed: int
    failed: int
    wall_s: float

    def rows(self) -> Iterator[dict[str, Any]]:
        """Every row as plain data, one part in memory at a time."""
        yield from Parts(self.folder).read()

    def convergence(self) -> list[Convergence]:
        ladder = Ladder()
        for row in self.rows():
            ladder.add(row)
        return ladder.orders()

    def files(self) -> dict[str, str]:
        there = {"result": RESULT, "report": PAGE, "rows": "rows", "traces": TRACES, "log": LOG}
        return {name: str(self.folder / path) for name, path in there.items() if (self.folder / path).exists()}

    def json(self) -> Iterator[str]:
        """harness.sweep/1 as pieces of text, one row at a time."""
        head = {
            "schema": "harness.sweep/1",
            "machine": self.machine.model_dump(mode="json"),
            "command": self.command,
            "notes": list(self.notes),
            "files": self.files(),
        }
        yield json.dumps(head, indent=1)[:-2] + ',\n "rows": ['
        between = "\n  "
        for row in self.rows():
            yield between + SweepRow.model_validate(row).model_dump_json()
            between = ",\n  "
        orders = ",\n  ".join(one.model_dump_json() for one in self.convergence())
        yield f'\n ],\n "convergence": [\n  {orders}\n ]\n}}\n'


def engines_for(options: SweepOptions) -> dict[str, Engine]:
    """The engines to sweep; one that was asked for and is not installed is an error, others are left out."""
    if options.engines:
        try:
            found = {name: registry.load(name) for name in dict.fromkeys(options.engines)}
        except SimulationError as error:
            raise InputError("--engine", str(error), "try: harness doctor") from None
    else:
        found = {name: registry.load(name) for name, why in registry.available().items() if why is None}
    labels = [engine.label for engine in found.values()]
    if twice := {label for label in labels if labels.count(label) > 1}:
        same = ", ".join(sorted(twice))
        raise InputError("--engine", f"{same} twice", "environments with names of their own")
    for preset in options.presets:
        choice("--preset", preset, preset_names(found))
    return found


def sweep(
    options: SweepOptions,
    out: Path | None = None,
    progress: Progress = SILENT,
    command: str = "",
    function: Compute = compute,
    stays: bool = True,
) -> Sweep:
    """Compute the matrix into a folder; rows are on disk as they come.

    out : folder, None for reports/sweep-TIME here. function : what a worker runs. stays : whether the folder outlives
    the call, so that a sweep that is stopped can be resumed. Raises StoreError for a folder that cannot
    be written, is taken or in use, InterruptionError after an interruption, HarnessError when a cluster is lost; in
    each case the rows that were done are kept and the message says how to go on.
    """
    started = time.perf_counter()
    engines = engines_for(options)
    if not options.resume and out is not None:
        check_new(out)
    folder = folder_of("sweep", out, options.resume, "sweep", "rows")
    with held(folder), journal(folder / LOG):
        parts = Parts(folder)
        have = parts.keys() if options.resume else set()
        notes = [_damaged(name) for name in parts.damaged]
        total = options.matrix.size(engines)
        wanted = (spec for spec in options.matrix.specs(engines) if int(spec.key, 16) not in have)
        done = _compute(
            options, parts, bundled(wanted, engines, options), (len(have), total), progress, function, stays
        )
        count = failures = 0
        for row in parts.read():
            count, failures = count + 1, failures + (row["error"] is not None)
        notes += [_damaged(name) for name in parts.damaged[len(notes) :]]
    wall = time.perf_counter() - started
    machine = this_machine()
    return Sweep(folder, machine, command, tuple(notes), count, done, failures, wall)


def bundled(specs: Iterator[Spec], engines: Mapping[str, Engine], options: SweepOptions) -> Iterator[Bundle]:
    """Rows that differ in their slider alone together, where an engine runs many at once; the others one by one."""
    alike: dict[tuple[Any, ...], list[Spec]] = {}
    for spec in specs:
        if not (options.sliders and engines[spec.engine].batches):
            yield Bundle((spec,))
            continue
        about = (spec.engine, spec.route, spec.preset, spec.changed, spec.dt, spec.scenario.name)
        group = alike.setdefault(about, [])
        group.append(spec)
        if len(group) == BATCH:
            yield Bundle(tuple(alike.pop(about)))
    yield from (Bundle(tuple(group)) for group in alike.values())


def _damaged(name: str) -> str:
    return f"rows/{name} was damaged and set aside as {name}.damaged; its rows are computed again"


def _compute(
    options: SweepOptions,
    parts: Parts,
    bundles: Iterator[Bundle],
    having: tuple[int, int],
    progress: Progress,
    function: Compute,
    stays: bool,
) -> int:
    """Compute and keep; returns how many rows were computed. having : rows there were, and rows of the matrix."""
    first = next(bundles, None)
    if first is None:
        return 0
    had, total = having
    buffer: list[dict[str, Any]] = []
    done, flushed = 0, time.monotonic()

    def keep() -> None:
        nonlocal flushed
        if buffer:
            parts.write(buffer)
            buffer.clear()
        flushed = time.monotonic()

    kept = partial(worked, jobs=options.jobs, cluster=options.cluster, idle=(PART_S, keep))
    with (
        resumable(parts.folder.parent, lambda: f"{had + done - len(buffer)} of {total} rows are kept")
        if stays
        else nullcontext(),
        kept(
            "rows", chain([first], bundles), partial(computed, one=function), lost, progress, having, rows_of=len
        ) as found,
    ):
        try:
            for rows in found:
                buffer += rows
                done += len(rows)
                if len(buffer) >= PART_ROWS or time.monotonic() - flushed > PART_S:
                    keep()
            keep()
        except (KeyboardInterrupt, HarnessError) as error:
            if not isinstance(error, StoreError):
                keep()
            raise
    return done
