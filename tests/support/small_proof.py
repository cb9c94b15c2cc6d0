"""What the tests of a proof share: its size, a diagnosis that is quick, and the files it leaves."""

import sys
from collections.abc import Callable, Iterator
from concurrent.futures import Executor, Future
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import prove_stub
import pytest

from harness.app.prove import prove, worker
from harness.app.shared import rows
from harness.proof.plan import Sizes


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
    """A pool without a process of its own, each of which loads everything anew."""

    count, executor = 1, ThisProcess()

    def __init__(self, jobs: int) -> None: ...

    def attend(self) -> None: ...

    def close(self) -> None:
        """The process that answered ends, as with its worker."""
        for process in worker._own.__dict__.pop("running", {}).values():
            process.close()


@contextmanager
def in_this_process() -> Iterator[None]:
    """Recordings are drawn, and verdicts asked for, where the test is."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(rows, "LocalPool", Here)
        yield


STUB = (sys.executable, str(Path(prove_stub.__file__)))
SIZES = Sizes(2, 3, 0, 1)
VERDICTS = "verdicts/harness.jsonl.gz"
BASELINE = "verdicts/pysindy.jsonl.gz"


@contextmanager
def unchanged_sources() -> Iterator[None]:
    """Sources that seem the same throughout: somebody may be working on them while tests run."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(prove, "code_digest", lambda: "the same")
        yield
