"""Rows of work that outlive a call: a folder to go on with, and none lost and none double, whoever dies."""

import math
import time
from collections import Counter, deque
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import FIRST_COMPLETED, CancelledError, Future, wait
from contextlib import contextmanager
from itertools import islice
from pathlib import Path
from typing import Protocol, TypeVar

from harness.app.shared.machine import cores
from harness.app.shared.pool import Cluster, LocalPool, Workers
from harness.app.shared.progress import Progress
from harness.core.errors import HarnessError, InputError
from harness.io.store import growing_folder

AHEAD = 4
"""Rows handed out per worker: enough to keep it busy, few enough to keep memory flat."""
CHANCES = 2
"""Times a row may take its worker down, alone, before it is given up."""
MOMENTS = 0.5
"""Seconds after a death in which a broken pool gives its other rows back."""
LOOK_S = 5.0
"""Seconds between two looks at workers that give nothing."""


class InterruptionError(HarnessError):
    """Stopped by the user; what was done is kept."""

    exit_code = 130


def folder_of(name: str, out: Path | None, resume: bool, what: str, begun: str = "") -> Path:
    """The folder that rows go to: ``out``, or reports/NAME-TIME here; with resume one that holds some already.

    what : is in it. begun : the file or folder in it by which it is known. Raises InputError for a folder that cannot
    be gone on with, StoreError for one that is taken or cannot be made.
    """
    if not resume:
        return growing_folder(name, out)
    if out is None:
        raise InputError("--resume", "given without --out", f"it goes with --out, the folder of the {what}")
    if not (out / begun).exists():
        found = f"holds no {what} to resume" if begun else "no such folder to resume"
        raise InputError(f"--out {out}", found, "the folder of one, or no --resume")
    return out.absolute()


@contextmanager
def resumable(folder: Path, kept: Callable[[], str]) -> Iterator[None]:
    """Say what is kept of work that is stopped, and how to go on with it; bad input stays as it is."""
    try:
        yield
    except InputError:
        raise
    except (KeyboardInterrupt, HarnessError) as error:
        kind, what = (
            (type(error), str(error)) if isinstance(error, HarnessError) else (InterruptionError, "interrupted")
        )
        raise kind(f"{what}; {kept()}, the same command with --resume --out {folder} goes on") from None


class Keyed(Protocol):
    """Something to do, with a key of its own."""

    @property
    def key(self) -> str:
        """The same for the same thing to do."""


Spec = TypeVar("Spec", bound=Keyed)
Row = TypeVar("Row")


@contextmanager
def worked(
    what: str,
    tasks: Iterable[Spec],
    compute: Callable[[Spec], Row],
    failed: Callable[[Spec, str], Row],
    progress: Progress,
    count: tuple[int, int],
    *,
    jobs: int | None = None,
    cluster: str | None = None,
    idle: tuple[float, Callable[[], None]] | None = None,
    chances: int = CHANCES,
    rows_of: Callable[[Row], int] = lambda row: 1,
) -> Iterator[Iterator[Row]]:
    """Rows of tasks as they are done, by processes here or a dask scheduler, which are let go when the block ends.

    what : as progress says it. count : rows there are already, and rows there will be. jobs : processes, None for one a
    core, never more than there are tasks. rows_of : how many rows a task gave. The rest as in ``completed``.
    """
    had, total = count
    wanted = max(1, min(jobs or cores(), total - had))
    workers: Workers = LocalPool(wanted) if cluster is None else Cluster(cluster)

    def rows() -> Iterator[Row]:
        progress(what, had, total)
        done = had
        for one in completed(tasks, workers, compute, failed, idle, chances):
            yield one
            done += rows_of(one)
            progress(what, done, total)

    try:
        yield rows()
    finally:
        workers.close()


def completed(
    specs: Iterable[Spec],
    workers: Workers,
    compute: Callable[[Spec], Row],
    failed: Callable[[Spec, str], Row],
    idle: tuple[float, Callable[[], None]] | None = None,
    chances: int = CHANCES,
) -> Iterator[Row]:
    """Rows of ``specs`` in the order in which they are done; ``failed`` makes the row of one that took workers down.

    idle : seconds in which no row came, and what is called then, again and again. chances : as CHANCES.
    When a worker dies, every row that was in work is tried again by itself, so that the one that killed it is found and
    becomes a row with that reason, and the others lose nothing.
    """
    todo, running = iter(specs), dict[Future[Row], Spec]()
    suspects, deaths = deque[Spec](), Counter[str]()

    def hand_out(some: Iterable[Spec]) -> None:
        for spec in some:
            try:
                future = workers.executor.submit(compute, spec)
            except RuntimeError as error:  # a pool that broke while nobody looked
                future = Future()
                future.set_exception(error)
            running[future] = spec

    def ended() -> tuple[list[Row], list[Spec]]:
        """Rows that are done, and specs whose worker died."""
        rows, lost = [], []
        for future in [future for future in running if future.done()]:
            spec = running.pop(future)
            error = CancelledError() if future.cancelled() else future.exception()
            if error is None:
                rows.append(future.result())
            elif workers.died(error):
                lost.append(spec)
            else:
                rows.append(failed(spec, f"internal error, {type(error).__name__}: {error}"))
        return rows, lost

    patience, since = math.inf if idle is None else idle[0], time.monotonic()
    while True:
        if suspects and not running:
            hand_out([suspects.popleft()])
        elif not suspects:
            hand_out(islice(todo, AHEAD * workers.count - len(running)))
        if not running:
            return
        alone = len(running) == 1
        done, _ = wait(running, min(patience, LOOK_S), FIRST_COMPLETED)
        if not done:
            workers.attend()
            if idle is not None and time.monotonic() - since >= patience:
                idle[1]()
                since = time.monotonic()
            continue
        since = time.monotonic()
        rows, lost = ended()
        if lost:
            # a local pool that broke ends all its futures within moments; a cluster goes on with them
            wait(running, timeout=MOMENTS)
            more_rows, more_lost = ended()
            rows, lost = rows + more_rows, lost + more_lost
        yield from rows
        if lost:
            workers.renew()
        for spec in lost:
            deaths[spec.key] += alone
            if deaths[spec.key] >= chances:
                yield failed(spec, f"its worker process died, {chances} times out of {chances}")
            else:
                suspects.append(spec)
