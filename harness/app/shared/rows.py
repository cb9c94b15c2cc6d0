"""Rows of work that outlive a call: a folder to go on with, and none lost and none double, whoever dies.

They are computed in a local pool of processes or by a dask.distributed cluster, both behind concurrent.futures.
"""

import math
import multiprocessing
import os
import signal
import time
from collections import Counter, deque
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import FIRST_COMPLETED, CancelledError, Executor, Future, ProcessPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager, suppress
from importlib import import_module
from itertools import islice
from pathlib import Path
from shlex import quote
from typing import Any, Protocol, TypeAlias, TypeVar, final

from harness.app.shared.machine import cores
from harness.app.shared.progress import Progress
from harness.core.cores import one_thread
from harness.core.errors import HarnessError, InputError
from harness.io.store import growing_folder

WORKERLESS_S = 60.0
"""s for which a cluster may be without a worker."""
_LOOK_S = 0.2
"""s between two looks for the first one."""


@final
class LocalPool:
    """Processes on this machine, each with one thread. count : rows that run at a time. executor : takes them."""

    executor: Executor

    def __init__(self, jobs: int) -> None:
        self.count = jobs
        self._start()

    def _start(self) -> None:
        # a fresh interpreter: engines and compiled code do not survive a fork
        context = multiprocessing.get_context("spawn")
        self.executor = ProcessPoolExecutor(self.count, context, initializer=_settle, initargs=(os.getpid(),))

    def died(self, error: BaseException) -> bool:
        """Whether this exception of a future means that a worker died; that breaks the pool for all rows in it."""
        return isinstance(error, BrokenProcessPool)

    def renew(self) -> None:
        """Make the executor usable again after a death."""
        self.close()
        self._start()

    def attend(self) -> None:
        """Called while rows are waited for; a pool has its processes."""

    def close(self) -> None:
        """Let go of everything at once, rows in work too."""
        processes = list((getattr(self.executor, "_processes", None) or {}).values())
        manager = getattr(self.executor, "_executor_manager_thread", None)
        self.executor.shutdown(wait=False, cancel_futures=True)
        for process in processes:
            with suppress(OSError, ValueError):
                process.terminate()
        for process in processes:
            with suppress(OSError, ValueError, AssertionError):
                process.join(5.0)
        if manager is not None:
            manager.join(5.0)  # at exit the interpreter would write to pipes that this thread is closing


def _settle(parent: int) -> None:
    """In a new worker of the process ``parent``: one thread, an interruption is its business, no life after it."""
    one_thread(whatever_was_asked=True)
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    signal.signal(signal.SIGTERM, signal.SIG_DFL)
    with suppress(OSError, AttributeError):
        import ctypes

        set_parent_death_signal = 1
        ctypes.CDLL(None).prctl(set_parent_death_signal, signal.SIGTERM)
        if os.getppid() != parent:  # it ended before this was asked for
            os._exit(1)


@final
class Cluster:
    """A dask.distributed cluster that is already running, as a LocalPool; its own scheduler moves rows away from a
    worker that died.
    """

    executor: Executor

    def __init__(self, address: str, timeout_s: float = 5.0) -> None:
        try:
            distributed: Any = import_module("distributed")
        except ImportError:
            install = "try: pip install 'friction-harness[cluster]'"
            raise InputError("--cluster", "dask.distributed is not installed", install) from None
        self._address = address
        try:
            self._client = distributed.Client(address, timeout=timeout_s, set_as_default=False)
        except (OSError, ValueError, TimeoutError) as error:
            found = f"no scheduler answers ({type(error).__name__})"
            raise InputError(f"--cluster {address}", found, "an address such as tcp://127.0.0.1:8786") from None
        self.renew()
        self._seen = time.monotonic()
        while not (threads := self._client.nthreads()):
            self.attend()
            time.sleep(_LOOK_S)
        self.count: int = sum(threads.values())

    def died(self, error: BaseException) -> bool:
        """The scheduler gave a row up after several deaths, or lost it."""
        return isinstance(error, CancelledError) or type(error).__name__ in ("KilledWorker", "FutureCancelledError")

    def renew(self) -> None:
        """The cluster heals itself, as long as its scheduler answers; raises HarnessError where it does not."""
        if self._client.status != "running":
            raise HarnessError(f"--cluster {self._address}: the connection to the scheduler is lost")
        self.executor = self._client.get_executor(pure=False, retries=0)

    def attend(self) -> None:
        """Others may join a cluster that has lost its last worker, for a while; raises HarnessError after it."""
        now = time.monotonic()
        if self._client.status == "running" and self._client.nthreads():
            self._seen = now
        elif now - self._seen > WORKERLESS_S:
            raise HarnessError(
                f"--cluster {self._address}: no worker for {WORKERLESS_S:.0f} s; expected a scheduler with workers"
                f" (dask worker {self._address})"
            )

    def close(self) -> None:
        """Let go of it; the cluster itself goes on."""
        # dask's own executor cancels what is left when it does not wait
        self.executor.shutdown(wait=False)
        with suppress(OSError, TimeoutError):
            self._client.close(timeout=5.0)


Workers: TypeAlias = LocalPool | Cluster


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
        raise kind(f"{what}; {kept()}. Try: --resume --out {quote(str(folder))}") from None


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
