"""Work that a command hands to processes, done where the test is: each process loads everything anew."""

from collections.abc import Callable, Iterator
from concurrent.futures import Executor, Future
from contextlib import contextmanager
from typing import Any

import pytest

from harness.app.prove import worker
from harness.app.shared import rows


class ThisProcess(Executor):
    """Does at once what it is handed."""

    def submit(self, fn: Callable[..., Any], /, *args: Any, **kwargs: Any) -> "Future[Any]":
        done: Future[Any] = Future()
        try:
            done.set_result(fn(*args, **kwargs))
        except Exception as error:
            done.set_exception(error)
        return done


class Here:
    """A pool without a process of its own."""

    count, executor = 1, ThisProcess()

    def __init__(self, jobs: int) -> None: ...

    def attend(self) -> None: ...

    def close(self) -> None:
        """The process that answered ends, as with its worker."""
        for process in worker._own.__dict__.pop("running", {}).values():
            process.close()


@contextmanager
def in_this_process() -> Iterator[None]:
    """For proofs, sweeps and several recordings, but where it is the processes that are looked at."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(rows, "LocalPool", Here)
        yield
