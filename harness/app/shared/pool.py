"""Where rows are computed: a local pool of processes, or a dask.distributed cluster, behind concurrent.futures."""

import multiprocessing
import os
import signal
import time
from abc import ABC, abstractmethod
from concurrent.futures import CancelledError, Executor, ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from contextlib import suppress
from importlib import import_module
from typing import Any, final

from harness.core.cores import one_thread
from harness.core.errors import HarnessError, InputError

WORKERLESS_S = 60.0
"""s for which a cluster may be without a worker."""
_LOOK_S = 0.2
"""s between two looks for the first one."""


class Workers(ABC):
    """Worker processes behind an Executor. Close them when done."""

    @property
    @abstractmethod
    def count(self) -> int:
        """How many rows can run at a time."""

    @property
    @abstractmethod
    def executor(self) -> Executor:
        """What takes rows."""

    @abstractmethod
    def died(self, error: BaseException) -> bool:
        """Whether this exception of a future means that a worker process died, not that the row failed."""

    @abstractmethod
    def renew(self) -> None:
        """Make the executor usable again after a death; raises HarnessError when it cannot be."""

    @abstractmethod
    def attend(self) -> None:
        """Called while rows are waited for; raises HarnessError when nobody is there to compute them."""

    @abstractmethod
    def close(self) -> None:
        """Let go of everything at once, rows in work too."""


@final
class LocalPool(Workers):
    """Processes on this machine, each with one thread."""

    def __init__(self, jobs: int) -> None:
        self._jobs = jobs
        self._executor = self._start()

    def _start(self) -> ProcessPoolExecutor:
        # a fresh interpreter: engines and compiled code do not survive a fork
        context = multiprocessing.get_context("spawn")
        return ProcessPoolExecutor(self._jobs, context, initializer=_settle, initargs=(os.getpid(),))

    @property
    def count(self) -> int:
        """See Workers."""
        return self._jobs

    @property
    def executor(self) -> Executor:
        """See Workers."""
        return self._executor

    def died(self, error: BaseException) -> bool:
        """See Workers; one death breaks the pool for all rows in it."""
        return isinstance(error, BrokenProcessPool)

    def renew(self) -> None:
        """See Workers."""
        self.close()
        self._executor = self._start()

    def attend(self) -> None:
        """See Workers; a pool has its processes."""

    def close(self) -> None:
        """See Workers."""
        processes = list((getattr(self._executor, "_processes", None) or {}).values())
        self._executor.shutdown(wait=False, cancel_futures=True)
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
class Cluster(Workers):
    """A dask.distributed cluster that is already running; its own scheduler moves rows away from a worker that died."""

    def __init__(self, address: str, timeout_s: float = 5.0) -> None:
        try:
            distributed: Any = import_module("distributed")
        except ImportError:
            raise InputError(
                "--cluster", "dask.distributed is not installed", "friction-harness[cluster] has it"
            ) from None
        self._address = address
        try:
            self._client = distributed.Client(address, timeout=timeout_s, set_as_default=False)
        except (OSError, ValueError, TimeoutError) as error:
            found = f"no scheduler answers ({type(error).__name__})"
            raise InputError(
                f"--cluster {address}", found, "an address such as tcp://127.0.0.1:8786 is accepted"
            ) from None
        self._executor: Executor = self._client.get_executor(pure=False, retries=0)
        self._seen = time.monotonic()
        while not (threads := self._client.nthreads()):
            self.attend()
            time.sleep(_LOOK_S)
        self._count: int = sum(threads.values())

    @property
    def count(self) -> int:
        """See Workers."""
        return self._count

    @property
    def executor(self) -> Executor:
        """See Workers."""
        return self._executor

    def died(self, error: BaseException) -> bool:
        """See Workers: the scheduler gave a row up after several deaths, or lost it."""
        return isinstance(error, CancelledError) or type(error).__name__ in ("KilledWorker", "FutureCancelledError")

    def renew(self) -> None:
        """See Workers; the cluster heals itself, as long as its scheduler answers."""
        if self._client.status != "running":
            raise HarnessError(f"--cluster {self._address}: the connection to the scheduler is lost")
        self._executor = self._client.get_executor(pure=False, retries=0)

    def attend(self) -> None:
        """See Workers; others may join a cluster that has lost its last worker, for a while."""
        now = time.monotonic()
        if self._client.status == "running" and self._client.nthreads():
            self._seen = now
        elif now - self._seen > WORKERLESS_S:
            raise HarnessError(
                f"--cluster {self._address}: no worker for {WORKERLESS_S:.0f} s; a scheduler with workers is accepted"
                f" (dask worker {self._address})"
            )

    def close(self) -> None:
        """See Workers; the cluster itself goes on."""
        # dask's own executor cancels what is left when it does not wait
        self._executor.shutdown(wait=False)
        with suppress(OSError, TimeoutError):
            self._client.close(timeout=5.0)
