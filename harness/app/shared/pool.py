"""Where rows are computed: a local pool of processes, or a dask.distributed cluster, behind concurrent.futures."""

import multiprocessing
import os
import signal
import time
from concurrent.futures import CancelledError, Executor, ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from contextlib import suppress
from importlib import import_module
from typing import Any, TypeAlias, final

from harness.core.cores import one_thread
from harness.core.errors import HarnessError, InputError

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
        self.executor.shutdown(wait=False, cancel_futures=True)
        for process in processes:
            with suppress(OSError, ValueError):
                process.terminate()
        for process in processes:
            with suppress(OSError, ValueError, AssertionError):
                process.join(5.0)


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
